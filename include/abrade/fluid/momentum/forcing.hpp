#pragma once
// What a user does to the water of a place: a force per volume, and water that is put in or taken out.

#include <abrade/core/parallel.hpp>
#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/mesh/ghost_cells.hpp>
#include <abrade/fluid/mesh/volume_tolerance.hpp>
#include <abrade/fluid/mesh/water_cells.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abrade {

/// Upon the water of a place, f = push - resistance u per volume of water [N/m3].
template <int Dim>
struct FlowForce {
    Point<Dim> push = Point<Dim>::Zero();  ///< [N/m3]
    Real resistance = 0;                   ///< >= 0 [kg/(m3 s)]
};

/// Vegetation, a pump, a porous bed: anything that acts on water without being a body in it.
/// - `acts_at(x)`: whether it acts at a place [m]; asked once, of faces and cells, and again after
/// `set_wall`;
/// - `force(x, u, t)`: the force on water that flows with u [m/s] at time t [s]. Its resistance is taken
///   implicitly, at the velocity that the water comes to: it may be as large as it likes;
/// - `source(x, t)`, which may be left out: volume that is put in per volume of cell and second, < 0: taken
///   out [1/s]. It acts where there is water. What comes in is at rest (`push` gives it a velocity), what is
///   taken out leaves with the water's own.
/// `force` is called from many threads, and none of them may throw.
template <class F, int Dim>
concept Forcing = std::copyable<F> && requires(const F& f, const Point<Dim>& x, Real t) {
    { F::name } -> std::convertible_to<std::string_view>;
    { f.acts_at(x) } -> std::convertible_to<bool>;
    { f.force(x, x, t) } -> std::same_as<FlowForce<Dim>>;
};

template <class F, int Dim>
concept HasSource = Forcing<F, Dim> && requires(const F& f, const Point<Dim>& x, Real t) {
    { f.source(x, t) } -> std::convertible_to<Real>;
};

/// Nothing is compiled for it.
struct NoForcing {
    static constexpr std::string_view name = "NoForcing";
};

namespace detail {

/// What the velocity of a face gained in a step [m/s].
struct FaceGain {
    Offset face = 0;
    Real gain = 0;
    Real drained = 0;  ///< part of it: what water that is taken out took along
};

/// A Forcing on the faces and cells of a grid.
template <int Dim, Forcing<Dim> F>
class AppliedForcing {
public:
    struct Step {
        Real density = 1, dt = 0, time = 0;            ///< [kg/m3], [s], [s]
        const Field<Real>* liquid_fraction = nullptr;  ///< faces without are left alone; none: all is full
    };

    static_assert(
        !requires { &F::source; } || HasSource<F, Dim>,
        "a Forcing's source(x, t) is const, takes a Point<Dim> and a Real, and gives a Real");

    AppliedForcing(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries, const F& forcing,
                   const EmbeddedBoundary<Dim>* walls)
        : layout_(grid.layout()), boundaries_(boundaries) {
        if constexpr (HasSource<F, Dim>) rate_ = Field<Real>(layout_.total);
        grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            for (int a = 0; a < Dim; ++a) {
                if ((cell[a] == 0 && !boundaries.periodic(a)) || (walls && !(walls->aperture()[a][c] > 0)))
                    continue;
                if (const Point<Dim> x = grid.face_centre(a, cell); forcing.acts_at(x))
                    places_[a].push_back({x, 1 / grid.gap(a, cell[a])}), gains_[a].push_back({c});
            }
            if constexpr (HasSource<F, Dim>)
                if (const Point<Dim> x = grid.centre(cell);
                    forcing.acts_at(x) && (!walls || walls->open_fraction()[c] > 0))
                    centres_.push_back(x), sources_.push_back({c, 0, 0});
        });
    }

    /// Finds what the faces' velocities `u` gain in a step, ghosts of periodic sides filled. Throws
    /// InputError where a force is no number or a resistance below 0.
    template <class State>
    void find(const F& forcing, const FaceField<Dim, State>& u, const Step& step) {
        Real push_per_cell = 0;
        for (int a = 0; a < Dim; ++a) {
            std::vector<Real> pushes(places_[a].size(), 0);
            parallel_for(static_cast<Index>(places_[a].size()), [&](Index n) {
                const auto k = static_cast<std::size_t>(n);
                const Offset c = gains_[a][k].face, back = layout_.stride[a];
                gains_[a][k].gain = gains_[a][k].drained = 0;
                if (step.liquid_fraction && !((*step.liquid_fraction)[c] + (*step.liquid_fraction)[c - back] >
                                              volume_tolerance::face))
                    return;
                const Place& place = places_[a][k];
                const Point<Dim> at_face = velocity_at_face(u, a, c);
                const FlowForce<Dim> now = forcing.force(place.x, at_face, step.time);
                pushes[k] = std::abs(now.push[a]) * place.per_gap / step.density;
                const Point<Dim> pushed = at_face + step.dt / step.density * now.push;
                const auto slows = [&](Real share) {
                    const Real k_of = forcing.force(place.x, share * pushed, step.time).resistance;
                    return step.dt * (k_of / step.density + sink_at(a, c));
                };
                const Real left = share_kept(slows) * pushed[a];
                gains_[a][k].gain = left - at_face[a];
                gains_[a][k].drained = -step.dt * sink_at(a, c) * left;
                if (!(now.resistance >= 0)) gains_[a][k].gain = std::numeric_limits<Real>::quiet_NaN();
            });
            Real most = 0;
            for (std::size_t k = 0; k < pushes.size(); ++k) {
                if (!std::isfinite(gains_[a][k].gain)) fail_at(forcing, u, a, k, step);
                most = std::max(most, pushes[k]);
            }
            push_per_cell += most;
        }
        push_per_cell_ = push_per_cell;
    }
    /// Gives a share of that.
    template <class State>
    void give(FaceField<Dim, State>& u, Real share) const {
        for (int a = 0; a < Dim; ++a)
            for (const FaceGain& g : gains_[a]) u[a][g.face] += static_cast<State>(share * g.gain);
    }
    const PerAxis<std::vector<FaceGain>, Dim>& gains() const noexcept { return gains_; }

    /// What cells are to get. Throws InputError where that is no number.
    std::span<CellSource> find_sources([[maybe_unused]] const F& forcing, [[maybe_unused]] Real time) {
        if constexpr (HasSource<F, Dim>) {
            Real largest = 0;
            for (std::size_t k = 0; k < sources_.size(); ++k) {
                CellSource& s = sources_[k];
                s.rate = forcing.source(centres_[k], time), s.volume = 0;
                if (!std::isfinite(s.rate))
                    require_finite(s.rate,
                                   std::string(F::name) + ".source at " + place_text<Dim>(centres_[k]) +
                                       ", t = " + short_text(time) + " s",
                                   "1/s");
                largest = std::max(largest, std::abs(s.rate));
            }
            largest_rate_ = largest;
        }
        return sources_;
    }
    std::span<const CellSource> sources() const noexcept { return sources_; }
    /// Once cells have had theirs in a step of dt, of the liquid that they hold (none: all of them): drains
    /// that found less take less of the motion along.
    void know_taken(const Grid<Dim>& grid, const Field<Real>* liquid_fraction, Real dt) {
        if constexpr (HasSource<F, Dim>) {
            for (const CellSource& s : sources_) {
                const Real holds =
                    (liquid_fraction ? (*liquid_fraction)[s.cell] : 1) * grid.volume(layout_.number(s.cell));
                rate_[s.cell] = holds > 0 ? s.volume / (dt * holds) : 0;
            }
            fill_periodic(rate_, layout_, boundaries_);
        }
    }

    /// Sum over axes of the largest push over density and distance of cells [1/s2], and the largest source
    /// [1/s]: they limit the step.
    Real push_per_cell() const noexcept { return push_per_cell_; }
    Real largest_rate() const noexcept { return largest_rate_; }

    static void fields(auto&& field) {
        field("push_per_cell", "1/s2", &AppliedForcing::push_per_cell_),
            field("largest_rate", "1/s", &AppliedForcing::largest_rate_);
    }

private:
    struct Place {
        Point<Dim> x;
        Real per_gap;  ///< [1/m]
    };

    /// The face's own component, and the mean of the four around it of each other one.
    template <class State>
    Point<Dim> velocity_at_face(const FaceField<Dim, State>& u, int a, Offset face) const noexcept {
        Point<Dim> found;
        for (int b = 0; b < Dim; ++b) {
            const Offset up = layout_.stride[b], back = layout_.stride[a];
            found[b] = b == a ? static_cast<Real>(u[a][face])
                              : 0.25 * static_cast<Real>(u[b][face] + u[b][face + up] + u[b][face - back] +
                                                         u[b][face + up - back]);
        }
        return found;
    }

    /// At which water is taken out about a face [1/s].
    Real sink_at(int a, Offset c) const noexcept {
        if constexpr (HasSource<F, Dim>)
            return 0.5 * (std::max(-rate_[c], Real(0)) + std::max(-rate_[c - layout_.stride[a]], Real(0)));
        return 0;
    }

    /// The root s of s (1 + z(s)) = 1, z the resistance times dt over density at s times the velocity. It
    /// lies between 1 / (1 + z(1)) and 1 where z does not fall with the speed; where it does the first is
    /// taken.
    static Real share_kept(auto&& z) {
        Real low = 1 / (1 + z(1)), high = 1;
        Real below = low * (1 + z(low)) - 1, above = z(1);
        constexpr Real enough = 1e-12;
        for (int n = 0; n < 60 && below < -enough; ++n) {  // Illinois
            const Real next = low - below * (high - low) / (above - below);
            const Real beyond = next * (1 + z(next)) - 1;
            if (std::abs(beyond) <= enough) return next;
            if (beyond < 0)
                low = next, below = beyond, above *= 0.5;
            else
                high = next, above = beyond, below *= 0.5;
        }
        return low;
    }

    template <class State>
    [[noreturn]] void fail_at(const F& forcing, const FaceField<Dim, State>& u, int a, std::size_t k,
                              const Step& step) const {
        const Point<Dim>& x = places_[a][k].x;
        const std::string where = " at " + place_text<Dim>(x) + ", t = " + short_text(step.time) + " s";
        const FlowForce<Dim> found = forcing.force(x, velocity_at_face(u, a, gains_[a][k].face), step.time);
        require(found.resistance >= 0,
                {std::string(F::name) + ".force" + where + ": resistance", ">= 0", "kg/(m3 s)",
                 "what drives the water is `push`"},
                found.resistance);
        require_finite(found.push[a], std::string(F::name) + ".force" + where + ": push", "N/m3");
        fail({std::string(F::name) + ".force" + where, "finite", "N/m3", "is the velocity there finite?"},
             "no number");
    }

    Layout<Dim> layout_;
    BoundaryConditions<Dim> boundaries_;
    PerAxis<std::vector<Place>, Dim> places_;    ///< of faces
    PerAxis<std::vector<FaceGain>, Dim> gains_;  ///< of the same
    std::vector<Point<Dim>> centres_;            ///< of cells
    std::vector<CellSource> sources_;            ///< of the same
    Field<Real> rate_;                           ///< of sources, over the liquid of a cell [1/s]
    Real push_per_cell_ = 0, largest_rate_ = 0;
};

}  // namespace detail

}  // namespace abrade
