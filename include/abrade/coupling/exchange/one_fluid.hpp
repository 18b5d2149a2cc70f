#pragma once
// Rigid bodies in water on a grid as parts of one fluid whose velocity is made rigid again after each step.

#include <abrade/coupling/exchange/bodies_in_flow.hpp>

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

/// One velocity for water and solids. sigma is the share of a face's control volume that bodies cover,
/// sigma_r that of their cores, bodies whose surface is `retracted`. With the densities
///   rho = (1 - sigma) rho_w + sigma rho_s,  rho_r = (1 - sigma_r) rho_w + sigma_r rho_s
/// (MixtureDensity: S. Fukuoka et al. 2014) or rho_w for both (WaterDensity: T. Kajishima & S. Takiguchi
/// 2002, doi:10.1016/S0142-727X(02)00159-5) the pressure makes
///   u = [(1 - sigma_r) rho_w u* + sigma_r rho_s v*] / rho_r - dt grad p / rho
/// free of divergence; u* is the water's velocity and v* the body's by all but the pressure (WaterDensity: u*
/// is that of both). The integral of -grad p + div(2 mu S) over the body's place moves it, and its rigid
/// velocity v = V + W x r replaces what is there,  u += sigma_r (v - u),  implicit in V and W. What water
/// gains by mixing and replacing its body loses, so momentum is conserved.
///
/// Water that sticks in cells that a body covers in part makes it larger than it is: velocities are therefore
/// mixed and replaced by the cores' shares. The density under the pressure counts the full shares; of a body
/// at the surface, what is below carries in rho what is above.
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

    void place(const Grid<3>& grid, const BoundaryConditions<3>& boundaries, std::span<const FlowBody> bodies,
               const FaceField<3>* aperture, Real density) {
        stand(grid, boundaries, bodies, 0, aperture, density, params_.retracted);
        density_ = density, ratio_.assign(bodies.size(), 1);
    }
    void close(Poisson<3>& m, std::span<const OpenFace> surface) {
        faces_.close(m, surface);
        parallel_for_resolved([&](std::size_t b) { find_ratio(b); });
        faces_.weigh(m, [&](std::size_t b) { return ratio_[b]; });
    }

    void force(FaceField<3>& u, const Field<Real>& pressure, const FlowStage& stage) {
        look_at(u, pressure, stage);
        FaceColumns& f = faces_.columns();
        parallel_for_resolved([&](std::size_t b) {
            find_motion(b, pressure, [](std::size_t) { return Real(0); });
            const Six by_old = stage_.dt * stage_.density * detail::pressed(faces_.cover(b), pressure);
            const Six expected = motion_[b].q + detail::accelerated(bodies_[b], by_old);
            for (const std::size_t i : faces_.of(b)) {
                const Real push = stage_.dt * f.gradient(pressure, i);
                if (f.leaves[i] && !stage_.pushed) f.velocity[i] += push;  // the old one does not act there
                f.solid[i] = f.along(i, expected);
                f.given[i] = mixed_by(i) * (f.solid[i] - f.velocity[i]);
                // `correct` gives it back
                if (!stage_.pushed && !f.leaves[i]) f.given[i] -= f.heavier[i] * push;
                f.velocity[i] += push;  // without the pressure
            }
        });
        faces_.by_planes([&](std::size_t i) { f.at(u, i) += f.given[i]; });
    }

    void slow(FaceField<3>&, const FlowStage&) const noexcept {}  // replaced as a whole, at the end
    void give_back(FaceField<3>&, Real) const noexcept {}
    template <class Number>
    void push(const Field<Number>&, Real) const noexcept {}
    template <class Number>
    void correct(FaceField<3>& u, const Field<Number>& of, Real factor, int plane, bool old) const {
        const FaceColumns& f = faces();
        faces_.on_plane(plane, [&](std::size_t i) {
            if (f.open[i] > 0 && !(old && f.leaves[i]))
                f.at(u, i) += f.heavier[i] * factor * f.gradient(of, i);
        });
    }
    Real add_product(const Field<float>&, Field<float>&) const noexcept { return 0; }

    void settle(FaceField<3>& u, Field<Real>& pressure) {
        parallel_for_resolved([&](std::size_t b) { replace(b, u, pressure); });
        FaceColumns& f = faces_.columns();
        const auto moves = [&](std::size_t i) { return f.along(i, motion_[f.body[i]].q); };
        faces_.by_planes([&](std::size_t i) { f.velocity[i] = f.at(u, i); },
                         [&](std::size_t i) { f.at(u, i) += f.held[i] * (moves(i) - f.velocity[i]); });
        // What water gains by mixing and replacing it gains from a body that moves with `q`.
        find_loss([&](std::size_t i) {
            const Real now = f.at(u, i), was = f.target[i];
            return f.mass[i] * part_of(i) * (now - was) * (moves(i) - 0.5 * (now + was));
        });
        find_fluxes([&](std::size_t i) { return -f.held[i] * (f.solid[i] - f.velocity[i]); });
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
        const FaceColumns& f = faces();
        for (const std::size_t i : faces_.of(b))
            if (f.axis[i] == Grid<3>::vertical && f.open[i] > 0)
                wet += f.share[i] * f.volume[i] / (f.gap[i] * f.per_gap[i]);
        ratio_[b] *= std::max(bodies_[b].volume / std::max(wet, least_wet * bodies_[b].volume), Real(1));
    }
    Real core_of(std::size_t i) const noexcept {
        return faces().open[i] > 0 ? std::min(faces().core[i] / faces().open[i], 1.0) : 0;
    }
    /// Share of the body in the momentum of what is in its core, if it is free to take any.
    Real mixed_by(std::size_t i) const noexcept {
        const std::size_t b = faces().body[i];
        if (!mixes || bodies_[b].inverse_mass == 0) return 0;
        const Real heavy = core_of(i) * ratio_[b];
        return heavy / (1 - core_of(i) + heavy);
    }

    /// The body's velocity after the pressure and with what replacing the face's velocity takes from it.
    /// Leaves in `push` the force and torque of the latter.
    void replace(std::size_t b, const FaceField<3>& u, const Field<Real>& pressure) {
        const FlowBody& body = bodies_[b];
        Motion& motion = motion_[b];
        Matrix6 drag = Matrix6::Zero();
        Six brought = Six::Zero();  // to the body: brought - drag q
        FaceColumns& f = faces_.columns();
        for (const std::size_t i : faces_.of(b)) {
            const Real mixed = f.at(u, i);
            f.target[i] = f.velocity[i] - stage_.dt * f.gradient(pressure, i);  // the water's by itself
            f.held[i] = core_of(i);
            const Real mass = f.mass[i] * f.water[i] / std::max(f.open[i], tiny<Real>);
            const Six c = f.coefficient(i);
            drag += mass * f.held[i] * c * c.transpose();
            brought += (mass * f.held[i] * mixed - f.mass[i] * part_of(i) * (mixed - f.target[i])) * c;
        }
        if (body.inverse_mass > 0) {
            const Matrix6 inertia = detail::inertia_of(body);
            const Six by_pressure = stage_.dt * stage_.density * detail::pressed(faces_.cover(b), pressure);
            motion.q = (inertia + drag).ldlt().solve(inertia * motion.q + by_pressure + brought);
        }
        motion.push = (brought - drag * motion.q) / stage_.dt;
    }

    /// Water in a face, its part beside this one of the bodies that cover it [-].
    Real part_of(std::size_t i) const noexcept {
        const FaceColumns& f = faces();
        const Real water = f.water[i] / std::max(f.open[i], tiny<Real>), all = 1 - water;
        return all > 0 ? water * f.covered[i] / all : 0;
    }

    static constexpr bool mixes = std::same_as<Density, MixtureDensity>;
    static constexpr Real least_wet = 1e-3;

    Params params_;
    Real density_ = 1;         ///< of the water [kg/m3]
    std::vector<Real> ratio_;  ///< [body] density in the pressure's equation, over the water's [-]
};

/// The paper's exchange, and that whose pressure knows the water's density alone.
using MixtureSolids = OneFluidSolids<MixtureDensity>;
using DirectForcing = OneFluidSolids<WaterDensity>;

static_assert(SolidsInFlow<MixtureSolids> && SolidsInFlow<DirectForcing>);

}  // namespace abrade
