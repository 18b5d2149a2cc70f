#pragma once
// Rigid bodies in water on a grid, whose velocities are found together with the pressure.

#include <abrade/coupling/averaging/averaged.hpp>
#include <abrade/coupling/exchange/bodies_in_flow.hpp>

#include <algorithm>
#include <span>

namespace abrade {

/// Solids as moving apertures (C. Batty, F. Bertails & R. Bridson 2007, doi:10.1145/1275808.1276502). A face
/// of which bodies cover the share sigma (SolidFace) lets pass
///   (1 - sigma) u + sigma v,  v = V + W x r,
/// and this mixture has no divergence. Pressure and rigid velocities q = (V, W) minimise
///   1/2 sum rho (1 - sigma) |u - u*|^2 + 1/2 sum (q - q*)^T M (q - q*)  under that:
///   [D (1 - sigma) rho^-1 D^T + sum over bodies J M^-1 J^T] p = -D ((1 - sigma) u* + sigma v*),
/// so the pressure is stable for any ratio of densities and any step. J^T p is its force.
///
/// Before that comes friction: water at a distance d from the surface, in cells of size h, is held back,
/// implicitly in time,
///   du/dt = C nu / h^2 (1 - d) / (1 + d) (v - u),  -1 < d < 1,
/// and its body takes the impulse; C is calibrated on the drag of a sphere at Re 20. Where bodies leave less
/// than a tenth of what walls leave of a face, a share of its water sticks to them at least: it rises
/// linearly from 0 at a tenth to 1 at a closed face. How fast a body is when friction acts tells what its
/// added mass lets it have of its forces: the pressure comes later.
///
/// Bodies of less than `resolved_from` cells to a diameter are averaged: AveragedBodies.
template <DenseDragLaw DragOfSmall = DiFelice>
class MonolithicSolids : public BodiesInFlow {
public:
    static constexpr std::string_view name = "MonolithicSolids";
    static constexpr bool present = true;

    struct Params {
        Real friction = 3.8;                  ///< C [-]
        Real resolved_from = 3;               ///< diameter of bodies that are not averaged [cell]
        Real added_mass = 0.5;                ///< C_m of those that are [-]
        Real lift = 0;                        ///< C_L of those [-]
        typename DragOfSmall::Params drag{};  ///< theirs
        void validate() const {
            require(
                friction >= 0 && std::isfinite(friction),
                {"MonolithicSolids.friction", ">= 0 and finite", "", "3.8 is calibrated, 0 lets water glide"},
                friction);
            require(resolved_from >= 0,
                    {"MonolithicSolids.resolved_from", ">= 0", "cells", "0 resolves all, infinity none"},
                    resolved_from);
            require_not_negative(added_mass, "MonolithicSolids.added_mass", "");
            require_finite(lift, "MonolithicSolids.lift", "");
            drag.validate();
        }
        void visit(auto&& f) const {
            f("friction", friction, "-"), f("resolved_from", resolved_from, "cell");
            f("added_mass", added_mass, "-"), f("lift", lift, "-"), drag.visit(f);
        }
    };

    MonolithicSolids() = default;
    explicit MonolithicSolids(Params params)
        : params_(params), averaged_(params.added_mass, params.lift, params.drag) {
        params_.validate();
    }
    const Params& params() const noexcept { return params_; }
    Index averaged() const noexcept { return static_cast<Index>(faces_.cloud().count()); }  ///< of the bodies

    void place(const Grid<3>& grid, const BoundaryConditions<3>& boundaries, std::span<const FlowBody> bodies,
               const FaceField<3>* aperture, Real density) {
        grid_ = &grid, boundaries_ = &boundaries;
        stand(grid, boundaries, bodies, params_.resolved_from, aperture, density);
        averaged_.begin(faces_.columns(), faces_.cloud(), bodies_, density);
    }
    void close(Poisson<3>& m, std::span<const OpenFace> surface) { faces_.close(m, surface); }

    /// Towards what bodies had for a velocity when they were placed, where there is water that has a
    /// pressure.
    void slow(FaceField<3>& u, const FlowStage& stage) {
        const auto wet = [&](Offset cell) {
            return !stage.liquid_fraction || (*stage.liquid_fraction)[cell] >= 0.5;
        };
        FaceColumns& f = faces_.columns();
        faces_.of_bodies_by_planes(
            [&](std::size_t i) {
                const Real held = wet(f.face[i]) && wet(f.low[i]) ? held_by(i, stage) : 0;
                f.taken[i] = held * (f.at(u, i) - f.solid[i]);
            },
            [&](std::size_t i) { f.at(u, i) -= f.taken[i]; });
    }
    void give_back(FaceField<3>& u, Real share) const {
        const FaceColumns& f = faces();
        faces_.of_bodies_by_planes([&](std::size_t i) { f.at(u, i) += share * f.taken[i]; });
    }

    void mix(FaceField<3>& u) {
        averaged_.see(faces_.cloud(), bodies_, [&](const Vec3& x) -> Vec3 {
            return detail::flow_change<3, Real>(*grid_, boundaries_->periodic_axes(), u, nullptr, 0, x)
                .vorticity();
        });
        BodiesInFlow::mix(u);
    }
    void force(FaceField<3>& u, const Field<Real>& pressure, const FlowStage& stage) {
        look_at(u, pressure, stage);
        FaceColumns& f = faces_.columns();
        parallel_for_resolved([&](std::size_t b) {
            find_motion(b, pressure, [&](std::size_t i) { return held_by(i, stage_); });
            if (stage_.pushed)  // or by the `push` to come
                motion_[b].q += detail::accelerated(
                    bodies_[b], stage_.dt * stage_.density * detail::pressed(faces_.cover(b), pressure));
            for (const std::size_t i : faces_.of(b))
                f.target[i] = f.along(i, motion_[b].held), f.solid[i] = f.pushes(i, motion_[b].q);
        });
        averaged_.force(f, faces_.cloud(), bodies_, pressure, stage_);
        find_loss([&](std::size_t i) {
            const Real left = f.held[i] * (1 - 0.5 * f.held[i]);
            return f.mass[i] * f.water[i] * left * square(f.target[i] - f.velocity[i]);
        });
        faces_.by_planes(
            [&](std::size_t i) { f.at(u, i) += f.held[i] * (f.target[i] - f.velocity[i]) + f.given[i]; },
            [&](std::size_t i) { f.velocity[i] = f.at(u, i); },
            [&](std::size_t i) {
                f.at(u, i) += f.covered[i] * (f.solid[i] - f.velocity[i]);
                if (stage_.pushed || f.leaves[i]) f.velocity[i] += stage_.dt * f.gradient(pressure, i);
            });
    }

    template <class Number>
    void push(const Field<Number>& of, Real factor) {
        parallel_for_resolved([&](std::size_t b) {
            Motion& motion = motion_[b];
            motion.push = detail::accelerated(bodies_[b],
                                              stage_.density * factor * detail::pressed(faces_.cover(b), of));
            motion.q += motion.push;
        });
    }
    template <class Number>
    void correct(FaceField<3>& u, const Field<Number>& of, Real factor, int plane, bool old) const {
        const FaceColumns& f = faces();
        faces_.on_plane(plane, [&](std::size_t i) {
            // A closed face has lost none, but at the surface.
            const bool lost = f.leaves[i] ? !old : f.conducts[i] || f.at_surface(i);
            const Real kept = old ? 1 : 1 - f.yields(i);  // the old pressure has moved a cloud already
            const Real back = lost ? factor * kept * f.gradient(of, i) : 0;
            const Real pushed = i < f.cloud ? 0 : f.pushes(i, motion_[f.body[i]].push);
            f.at(u, i) += f.covered[i] * (back + pushed);
        });
    }
    Real add_product(const Field<float>& p, Field<float>& product) {
        parallel_for_resolved([&](std::size_t b) {
            Motion& motion = motion_[b];
            const Six sum = detail::pressed(faces_.cover(b), p);
            motion.push = detail::accelerated(bodies_[b], stage_.density * sum);
            motion.curvature = sum.dot(motion.push);
        });
        Real sum = 0;
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            const Six& v = motion_[b].push;
            sum += motion_[b].curvature;
            for (const SolidCell& c : faces_.cover(b).cells)
                product[c.cell] += static_cast<float>(c.area.dot(v.template head<3>()) +
                                                      c.area_moment.dot(v.template tail<3>()));
        }
        return sum;
    }

    void settle(FaceField<3>& u, Field<Real>& pressure) {
        FaceColumns& f = faces_.columns();
        faces_.covered_by_planes([&](std::size_t i) {
            if (f.water[i] > 0) f.at(u, i) = f.velocity[i] - stage_.dt * f.gradient(pressure, i);
        });
        for (const FaceColumns::Detour& d : f.detours)  // which is no velocity of water
            f.at(u, d.row) -= f.covered[d.row] * d.of.dot(motion_[f.body[d.row]].q);
        averaged_.yield(f, pressure, stage_.dt);
        find_fluxes([&](std::size_t i) { return f.covered[i] * (f.solid[i] - f.at(u, i)); });
        hand_out(u, pressure, [&](std::size_t b, const Six& pressed) {
            fill_inside(b, pressed.template head<3>(), pressure);
            return Six(pressed + motion_[b].by_friction);
        });
        averaged_.settle(f, faces_.cloud(), bodies_, faces_.covers(), pressure, stage_);
        finish();
    }
    static void fields(auto&& field) {
        BodiesInFlow::fields(field), field("averaged", &MonolithicSolids::averaged_);
    }

private:
    /// Share of the way to a body's velocity that friction takes a face's water in a step: bodies share what
    /// all of them do there. Of a face that they nearly close a share sticks to them.
    Real held_by(std::size_t i, const FlowStage& stage) const noexcept {
        constexpr Real sliver = 0.1;  // of what walls leave of a face
        const FaceColumns& f = faces();
        if (f.all_friction[i] == 0) return 0;
        const Real stiff = params_.friction * stage.viscosity * stage.dt * f.all_friction[i];
        const Real sticks = f.open[i] > 0 ? 1 - f.water[i] / (sliver * f.open[i]) : 0;
        return std::max(stiff / (1 + stiff), sticks) * f.friction[i] / f.all_friction[i];
    }

    /// The pressure goes on into the body as if its force were that of one gradient.
    void fill_inside(std::size_t b, const Vec3& force, Field<Real>& pressure) const noexcept {
        const SolidCover& cover = faces_.cover(b);
        if (cover.cells.empty()) return;
        Real mean = 0;
        Vec3 middle = Vec3::Zero();
        for (const SolidCell& c : cover.cells) mean += pressure[c.cell], middle += c.arm;
        const auto cells = static_cast<Real>(cover.cells.size());
        const Vec3 slope = -force / (stage_.density * bodies_[b].volume);
        for (const SolidCell& c : cover.inside)
            if (!stage_.liquid_fraction || (*stage_.liquid_fraction)[c.cell] >= 0.5)
                pressure[c.cell] = mean / cells + slope.dot(c.arm - middle / cells);
    }

    Params params_;
    AveragedBodies<DragOfSmall> averaged_;
    const Grid<3>* grid_ = nullptr;  ///< of the step
    const BoundaryConditions<3>* boundaries_ = nullptr;
};

static_assert(SolidsInFlow<MonolithicSolids<>>);

}  // namespace abrade
