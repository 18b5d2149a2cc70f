#pragma once
// Rigid bodies in water on a grid as parts of one fluid whose velocity is made rigid again after each step.

#include <abrade/coupling/bodies_in_flow.hpp>

#include <algorithm>
#include <concepts>
#include <span>

namespace abrade {

/// Which density bodies have in the equation of the pressure.
template <class D>
concept DensityOfBodies = requires(const FlowBody& body, Real water) {
    { D::of(body, water) } -> std::same_as<Real>;
    { D::name } -> std::convertible_to<std::string_view>;
};
/// Their own, so the pressure knows how heavy what it moves is. Fixed ones have the water's.
struct MixtureDensity {
    static constexpr std::string_view name = "MixtureDensity";
    static Real of(const FlowBody& body, Real water) noexcept {
        return body.inverse_mass > 0 ? 1 / (body.inverse_mass * body.volume) : water;
    }
};
/// The water's: the pressure's equation is that of water alone.
struct WaterDensity {
    static constexpr std::string_view name = "WaterDensity";
    static Real of(const FlowBody&, Real water) noexcept { return water; }
};

/// One velocity for water and solids. With sigma, the share of a face's control volume that bodies cover, and
/// rho = (1 - sigma) rho_w + sigma rho_s (MixtureDensity: S. Fukuoka et al. 2014) or rho_w (WaterDensity:
/// T. Kajishima & S. Takiguchi 2002, doi:10.1016/S0142-727X(02)00159-5), the pressure makes
///   u = [(1 - sigma) rho_w u* + sigma rho_s v* - dt grad p] / rho
/// free of divergence; u* is the water's velocity and v* the body's by all but the pressure (WaterDensity: u*
/// is that of both). The integral of -grad p + div(2 mu S) over the body's place moves it, and its rigid
/// velocity v = V + W x r replaces what is there,  u += sigma_f (v - u),  implicit in V and W. What water
/// gains by mixing and replacing its body loses, so momentum is conserved.
///
/// Water that sticks in cells that a body covers in part makes it larger than it is. sigma_f, which holds it,
/// is therefore the share of a body whose surface is `retracted`. Of a body at the surface, what is below
/// carries in rho what is above.
///
/// Below water MixtureDensity is stable from a ratio of 0.01 to 8 (tried). With WaterDensity the pressure
/// moves a body as heavy as water, and what it lacks follows a step later: a body much lighter than water
/// runs away, and a shorter step does not help. All bodies are resolved.
template <DensityOfBodies Density = MixtureDensity>
class OneFluidSolids : public BodiesInFlow {
public:
    static constexpr std::string_view name = "OneFluidSolids";
    static constexpr bool present = true;

    struct Params {
        Real retracted = 0.3;  ///< by how much the surface of what is replaced is [cell]
        void validate() const {
            require(retracted >= 0 && retracted < 1,
                    {"OneFluidSolids.retracted", "from 0 to below 1", "cells",
                     "0.3 is a compromise of slow and fast flow"},
                    retracted);
        }
        void visit(auto&& f) const { f("retracted", retracted, "cell"); }
    };

    OneFluidSolids() = default;
    explicit OneFluidSolids(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }
    Index averaged() const noexcept { return 0; }  ///< of the bodies

    void place(const Grid<3>& grid, const Sides<3>& sides, std::span<const FlowBody> bodies,
               const FaceField<3>* open_area, Real density) {
        stand(grid, sides, bodies, 0, open_area, params_.retracted);
        density_ = density, ratio_.assign(bodies.size(), 1);
    }
    void close(Poisson<3>& m, std::span<const OpenFace> surface) {
        faces_.close(m, surface);
        parallel_for_resolved([&](std::size_t b) { find_ratio(b); });
        faces_.weigh(m, [&](std::size_t b) { return ratio_[b]; });
    }

    void force(FaceField<3>& u, const Field<Real>& pressure, const FlowStage& stage) {
        look_at(u, pressure, stage);
        parallel_for_resolved([&](std::size_t b) {
            find_motion(b, pressure, [](const CoveredFace&) { return Real(0); });
            const Six by_old = stage_.dt * stage_.density * detail::pressed(faces_.cover(b), pressure);
            const Six expected = motion_[b].q + detail::accelerated(bodies_[b], by_old);
            for (CoveredFace& f : faces_.of(b)) {
                const Real push = stage_.dt * f.gradient(pressure);
                if (f.leaves && !stage_.pushed) f.velocity += push;  // the old pressure does not act there
                f.solid = detail::along(f, expected);
                f.given = mixed_by(f) * (f.solid - f.velocity);
                if (!stage_.pushed && !f.leaves) f.given -= f.heavier * push;  // `correct` gives it back
                f.velocity += push;                                            // without the pressure
            }
        });
        faces_.by_planes([&](const CoveredFace& f) { u[f.axis][f.face] += f.given; });
    }

    void slow(FaceField<3>&, const FlowStage&) const noexcept {}  // replaced as a whole, at the end
    void give_back(FaceField<3>&, Real) const noexcept {}
    template <class Number>
    void push(const Field<Number>&, Real) const noexcept {}
    template <class Number>
    void correct(FaceField<3>& u, const Field<Number>& of, Real factor, int plane, bool old) const {
        faces_.on_plane(plane, [&](const CoveredFace& f) {
            if (f.open > 0 && !(old && f.leaves)) u[f.axis][f.face] += f.heavier * factor * f.gradient(of);
        });
    }
    Real add_product(const Field<float>&, Field<float>&) const noexcept { return 0; }

    void settle(FaceField<3>& u, Field<Real>& pressure) {
        parallel_for_resolved([&](std::size_t b) { replace(b, u, pressure); });
        faces_.by_planes([&](CoveredFace& f) { f.velocity = u[f.axis][f.face]; },
                         [&](const CoveredFace& f) {
                             u[f.axis][f.face] += f.held * (detail::along(f, motion_[f.body].q) - f.velocity);
                         });
        // What water gains by mixing and replacing it gains from a body that moves with `q`.
        find_loss([&](const CoveredFace& f) {
            const Real now = u[f.axis][f.face], moves = detail::along(f, motion_[f.body].q);
            return f.mass * part_of(f) * (now - f.target) * (moves - 0.5 * (now + f.target));
        });
        find_fluxes([&](const CoveredFace& f) { return -f.held * (f.solid - f.velocity); });
        hand_out(u, pressure, [&](std::size_t b, const Six& pressed) {
            return Six(pressed + motion_[b].by_friction + motion_[b].push);
        });
        finish();
    }

private:
    /// What lies below the surface carries what does not.
    void find_ratio(std::size_t b) noexcept {
        ratio_[b] = Density::of(bodies_[b], density_) / density_;
        if (!mixes || bodies_[b].inverse_mass == 0) return;
        Real wet = 0;
        for (const CoveredFace& f : faces_.of(b))
            if (f.axis == Grid<3>::vertical && f.open > 0) wet += f.share * f.area / f.per_gap;
        ratio_[b] *= std::max(bodies_[b].volume / std::max(wet, least_wet * bodies_[b].volume), Real(1));
    }
    static Real core_of(const CoveredFace& f) noexcept {
        return f.open > 0 ? std::min(f.core / f.open, 1.0) : 0;
    }
    /// Share of the body in the momentum of what is in its core, if it is free to take any.
    Real mixed_by(const CoveredFace& f) const noexcept {
        if (!mixes || bodies_[f.body].inverse_mass == 0) return 0;
        const Real heavy = core_of(f) * ratio_[f.body];
        return heavy / (1 - core_of(f) + heavy);
    }

    /// The body's velocity after the pressure and with what replacing the face's velocity takes from it.
    /// Leaves in `push` the force and torque of the latter.
    void replace(std::size_t b, const FaceField<3>& u, const Field<Real>& pressure) {
        const FlowBody& body = bodies_[b];
        Motion& motion = motion_[b];
        Matrix6 drag = Matrix6::Zero();
        Six brought = Six::Zero();  // to the body: brought - drag q
        for (CoveredFace& f : faces_.of(b)) {
            const Real mixed = u[f.axis][f.face];
            f.target = f.velocity - stage_.dt * f.gradient(pressure);  // the water's by itself
            f.held = core_of(f);
            const Real mass = f.mass * f.water / std::max(f.open, tiny);
            const Six c = detail::coefficient(f);
            drag += mass * f.held * c * c.transpose();
            brought += (mass * f.held * mixed - f.mass * part_of(f) * (mixed - f.target)) * c;
        }
        if (body.inverse_mass > 0) {
            const Matrix6 inertia = detail::inertia_of(body);
            const Six by_pressure = stage_.dt * stage_.density * detail::pressed(faces_.cover(b), pressure);
            motion.q = (inertia + drag).ldlt().solve(inertia * motion.q + by_pressure + brought);
        }
        motion.push = (brought - drag * motion.q) / stage_.dt;
    }

    /// Water in a face, its part beside this one of the bodies that cover it [-].
    static Real part_of(const CoveredFace& f) noexcept {
        const Real water = f.water / std::max(f.open, tiny), all = 1 - water;
        return all > 0 ? water * f.covered / all : 0;
    }

    static constexpr bool mixes = std::same_as<Density, MixtureDensity>;
    static constexpr Real tiny = 1e-300, least_wet = 1e-3;

    Params params_;
    Real density_ = 1;         ///< of the water [kg/m3]
    std::vector<Real> ratio_;  ///< [body] density in the pressure's equation, over the water's [-]
};

/// The paper's exchange, and that whose pressure knows the water's density alone.
using MixtureSolids = OneFluidSolids<MixtureDensity>;
using DirectForcing = OneFluidSolids<WaterDensity>;

static_assert(SolidsInFlow<MixtureSolids> && SolidsInFlow<DirectForcing>);

}  // namespace abrade
