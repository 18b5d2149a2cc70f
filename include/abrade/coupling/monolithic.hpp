#pragma once
// Rigid bodies in water on a grid, whose velocities are found together with the pressure.

#include <abrade/core/fields.hpp>
#include <abrade/coupling/averaged.hpp>
#include <abrade/coupling/rigid_six.hpp>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// Solids as moving apertures (C. Batty, F. Bertails & R. Bridson 2007, doi:10.1145/1275808.1276502). A face
/// of which bodies cover the share sigma (SolidFace) lets pass
///   (1 - sigma) u + sigma v,  v = V + W x r,
/// and this mixture has no divergence. Pressure and rigid velocities q = (V, W) minimise
///   1/2 sum rho (1 - sigma) |u - u*|^2 + 1/2 sum (q - q*)^T M (q - q*)  under that:
///   [D (1 - sigma) rho^-1 D^T + sum over bodies J M^-1 J^T] p = -D ((1 - sigma) u* + sigma v*),
/// so the pressure is stable for any ratio of densities and any step. J^T p is its force.
///
/// Before that comes friction: in a control volume covered by sigma water is held back, implicitly in time,
///   du/dt = C nu / h^2 sigma / (1 - sigma) (v - u),  h^3 the volume,
/// and its body takes the impulse; C is calibrated on the drag of a sphere. Where bodies leave less than a
/// tenth of a face the water sticks. What friction and advection bring to a control volume and its water does
/// not keep, the body gets: momentum is conserved. All of it acts upon velocities that the last pressure and
/// the body's last load have acted on already: where all is at rest, nothing is exchanged. How fast a body
/// is when friction acts tells what its added mass lets it have of its forces: the pressure comes later.
///
/// Bodies of less than `resolved_from` cells to a diameter are averaged: AveragedBodies.
template <DenseDragLaw DragOfSmall = DiFelice>
class MonolithicSolids {
    using Six = detail::Six;
    using Matrix6 = Eigen::Matrix<Real, 6, 6>;

public:
    static constexpr std::string_view name = "MonolithicSolids";
    static constexpr bool present = true;

    struct Params {
        Real friction = 12;                   ///< C [-]
        Real resolved_from = 3;               ///< diameter of bodies that are not averaged [cell]
        Real added_mass = 0.5;                ///< C_m of those that are [-]
        typename DragOfSmall::Params drag{};  ///< theirs
        void validate() const {
            require(
                friction >= 0 && std::isfinite(friction),
                {"MonolithicSolids.friction", ">= 0 and finite", "", "12 is calibrated, 0 lets water glide"},
                friction);
            require(resolved_from >= 0,
                    {"MonolithicSolids.resolved_from", ">= 0", "cells", "0 resolves all, infinity none"},
                    resolved_from);
            require_not_negative(added_mass, "MonolithicSolids.added_mass", "");
            drag.validate();
        }
        void visit(auto&& f) const {
            f("friction", friction, "-"), f("resolved_from", resolved_from, "cell");
            f("added_mass", added_mass, "-"), drag.visit(f);
        }
    };

    MonolithicSolids() = default;
    explicit MonolithicSolids(Params params) : params_(params), averaged_(params.added_mass, params.drag) {
        params_.validate();
    }
    const Params& params() const noexcept { return params_; }
    std::span<const FlowBody> bodies() const noexcept { return bodies_; }
    Index averaged() const noexcept { return static_cast<Index>(faces_.cloud().count()); }  ///< of the bodies
    std::span<const SolidCover> covers() const noexcept {
        return faces_.covers();
    }                                                   ///< [body], of their cloud
    Real fastest() const noexcept { return fastest_; }  ///< of the bodies [m/s]

    void place(const Grid<3>& grid, const Sides<3>& sides, std::span<const FlowBody> bodies,
               const FaceField<3>* open_area) {
        bodies_.assign(bodies.begin(), bodies.end()), motion_.assign(bodies.size() + 1, {});
        faces_.place(grid, sides, bodies, params_.resolved_from, open_area);
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (faces_.cover(b).cut) bodies_[b].inverse_mass = 0, bodies_[b].inverse_inertia.setZero();
            for (CoveredFace& f : faces_.of(b)) f.solid = detail::along(f, detail::velocity_of(bodies_[b]));
        }
        averaged_.begin(faces_.of_cloud(), faces_.cloud(), bodies_);
    }
    std::vector<SolidPart> parts() const { return faces_.parts(true); }
    std::vector<SolidPart> resolved_parts() const { return faces_.parts(false); }
    std::span<const SolidFlux> fluxes() const noexcept { return fluxes_; }
    void mix_last(FaceField<3>& u) const {
        for (std::size_t i = 0; i < fluxes_.size(); ++i) u[fluxes_[i].axis][fluxes_[i].face] += beyond_[i];
    }
    void seep(FaceField<3>& u) const {
        for (std::size_t i = 0; i < fluxes_.size(); ++i)
            u[fluxes_[i].axis][fluxes_[i].face] += beyond_[i] - fluxes_[i].speed;
    }

    void close(Poisson<3>& m, std::span<const OpenFace> surface) { faces_.close(m, surface); }
    Real water_share(const OpenFace& open) const noexcept { return faces_.water_share(open); }
    void keep_wet(const Poisson<3>& m) { faces_.keep_wet(m); }

    void mix(FaceField<3>& u) const {
        faces_.by_planes([&](const CoveredFace& f) {
            Real& value = u[f.axis][f.face];
            value += f.covered * (f.solid - value);
        });
    }

    void force(FaceField<3>& u, const Field<Real>& pressure, const FlowStage& stage) {
        stage_ = stage;
        faces_.for_each([&](CoveredFace& f) {
            f.velocity = u[f.axis][f.face] - (stage_.pushed ? 0 : stage_.dt * f.gradient(pressure));
            f.mass = mass_of(f);
        });
        parallel_for_resolved([&](std::size_t b) { find_motion(b, pressure); });
        averaged_.force(faces_.of_cloud(), faces_.cloud(), bodies_, pressure, stage_);
        faces_.by_planes(
            [&](const CoveredFace& f) { u[f.axis][f.face] += f.held * (f.target - f.velocity) + f.given; },
            [&](CoveredFace& f) { f.velocity = u[f.axis][f.face]; },
            [&](CoveredFace& f) {
                u[f.axis][f.face] += f.covered * (f.solid - f.velocity);
                if (stage_.pushed || f.leaves) f.velocity += stage_.dt * f.gradient(pressure);
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
        faces_.on_plane(plane, [&](const CoveredFace& f) {
            // A closed face has lost none, but at the surface.
            const bool lost = f.leaves ? !old : f.water > 0 || f.at_surface();
            const Real back = lost ? factor * f.gradient(of) : 0;
            u[f.axis][f.face] += f.covered * (back + detail::along(f, motion_[f.body].push));
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
                product[c.cell] +=
                    static_cast<float>(c.way.dot(v.template head<3>()) + c.turn.dot(v.template tail<3>()));
        }
        return sum;
    }

    void settle(FaceField<3>& u, Field<Real>& pressure) {
        faces_.by_planes([&](const CoveredFace& f) {
            if (f.water > 0) u[f.axis][f.face] = f.velocity - stage_.dt * f.gradient(pressure);
        });
        const std::span<CoveredFace> all = faces_.all();
        fluxes_.resize(all.size()), beyond_.resize(all.size());
        parallel_for(static_cast<Index>(all.size()), [&](Index n) {
            const auto i = static_cast<std::size_t>(n);
            CoveredFace& f = all[i];
            if (f.body < bodies_.size()) f.solid = detail::along(f, motion_[f.body].q);
            fluxes_[i] = {f.face, f.axis, f.covered * f.solid};
            beyond_[i] = f.covered * (f.solid - u[f.axis][f.face]);
        });
        std::vector<Memory> next;
        next.reserve(bodies_.size());
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (faces_.cover(b).averaged) continue;
            FlowBody& body = bodies_[b];
            const Motion& motion = motion_[b];
            const Six by_pressure = stage_.density * detail::pressed(faces_.cover(b), pressure);
            const Six load = by_pressure + motion.by_friction;
            body.velocity = motion.q.template head<3>(), body.angular_velocity = motion.q.template tail<3>();
            if (!faces_.cover(b).cut) body.load = {load.template head<3>(), load.template tail<3>()};
            fill_inside(b, by_pressure.template head<3>(), pressure);
            const Memory* const before = with_id(memory_, body.id);
            const Six gained = before ? Six(motion.q - before->q) / stage_.dt : Six(Six::Zero());
            next.push_back({body.id, motion.q, gained, motion.covers, slip_of(b, u), by_pressure});
        }
        std::ranges::sort(next, {}, &Memory::id);
        memory_ = std::move(next);
        averaged_.settle(faces_.of_cloud(), faces_.cloud(), bodies_, faces_.covers(), pressure, stage_);
        fastest_ = 0;
        for (const FlowBody& body : bodies_) fastest_ = std::max(fastest_, body.velocity.norm());
    }
    static void fields(auto&& field) {
        field("memory", &MonolithicSolids::memory_), field("averaged", &MonolithicSolids::averaged_);
        field.bytes("fluxes", &MonolithicSolids::fluxes_);
        field("beyond", "m/s", &MonolithicSolids::beyond_);
        field("fastest", "m/s", &MonolithicSolids::fastest_);
    }

private:
    struct Motion {
        Six q = Six::Zero();            ///< velocity and spin [m/s], [rad/s]
        Six held = Six::Zero();         ///< the same while friction acts
        Six push = Six::Zero();         ///< its change by the last pressure
        Six by_friction = Six::Zero();  ///< [N], [N m]
        Real curvature = 0;
        Real covers = 0;  ///< mass of water in the body's place [kg]
    };
    /// What is known of a body from the last step.
    struct Memory {
        Index id = 0;
        Six q = Six::Zero();        ///< velocity and spin that it left [m/s], [rad/s]
        Six gained = Six::Zero();   ///< by these in the step [m/s2], [rad/s2]
        Real covers = 0;            ///< mass of water in the body's place [kg]
        Six slip = Six::Zero();     ///< of that water beyond the body's momentum [kg m/s], [kg m2/s]
        Six pressed = Six::Zero();  ///< force and torque of the pressure [N], [N m]

        static void fields(auto&& field) {
            field("id", &Memory::id), field.bytes("q", &Memory::q), field.bytes("gained", &Memory::gained);
            field("covers", "kg", &Memory::covers), field.bytes("slip", &Memory::slip);
            field.bytes("pressed", &Memory::pressed);
        }
    };
    static constexpr Real of_a_sphere = 0.5;  ///< added mass over that of its place [-]
    static constexpr Real sliver = 0.1;       ///< of a face: less water has no velocity of its own [-]

    Index count() const noexcept { return static_cast<Index>(bodies_.size()); }

    /// Of the control volume of a face, as far as walls leave it open and it lies below the surface [kg].
    Real mass_of(const CoveredFace& f) const noexcept {
        if (f.open == 0) return 0;
        const Real all = stage_.density * f.volume();
        if (!stage_.held) return all;
        return all * std::min(0.5 * ((*stage_.held)[f.face] + (*stage_.held)[f.low]) / f.open, 1.0);
    }
    Six slip_of(std::size_t b, const FaceField<3>& u) noexcept {
        Six sum = Six::Zero();
        for (const CoveredFace& f : faces_.of(b))
            sum += f.mass * f.share * (u[f.axis][f.face] - detail::along(f, motion_[b].q)) *
                   detail::coefficient(f);
        return sum;
    }

    void parallel_for_resolved(auto&& body) const {
        parallel_blocks(
            count(),
            [&](Index, Index first, Index last) {
                for (auto b = static_cast<std::size_t>(first); b < static_cast<std::size_t>(last); ++b)
                    if (!faces_.cover(b).averaged) body(b);
            },
            block_of_bodies);
    }

    /// The water's velocity by all but pressure and weight.
    Real unpushed(const CoveredFace& f, const Field<Real>& old) const noexcept {
        return f.velocity + stage_.dt * (f.gradient(old) - stage_.falls[f.axis]);
    }

    /// The body's velocity with friction, and with the old pressure as it acts on it where it is now.
    void find_motion(std::size_t b, const Field<Real>& old) {
        const FlowBody& body = bodies_[b];
        Motion& motion = motion_[b];
        const Memory* const before = with_id(memory_, body.id);
        const Real dt = stage_.dt;
        Matrix6 drag = Matrix6::Zero();  // impulse on the body = brought - drag q
        Six brought = Six::Zero(), within = Six::Zero();
        for (CoveredFace& f : faces_.of(b)) {
            const Real rate = params_.friction * stage_.viscosity * dt / square(std::cbrt(f.volume()));
            const Real stiff = rate * f.share, left = 1 - f.share;
            f.held = stiff > 0 ? stiff / (left + stiff) : 0;
            if (f.open > 0) f.held = std::max(f.held, 1 - f.water / (sliver * f.open));
            const Real held = f.mass * f.water * f.held, covers = f.mass * f.share;
            const Six c = detail::coefficient(f);
            drag += held * c * c.transpose();
            brought += held * f.velocity * c;
            motion.covers += covers / 3;
            if (before) within += covers * (unpushed(f, old) - detail::along(f, before->q)) * c;
        }
        if (before && before->covers > 0) {
            // What has left through the surface has taken its part along; what has come meets the body as it
            // will be, not as it was: it may be heavier than the body.
            const Real kept = std::min(1.0, before->covers / motion.covers);
            brought += kept * within - std::min(1.0, motion.covers / before->covers) * before->slip;
            for (const CoveredFace& f : faces_.of(b)) {
                if (kept == 1) break;
                const Six c = detail::coefficient(f);
                const Real comes = (1 - kept) * f.mass * f.share;
                brought += comes * unpushed(f, old) * c, drag += comes * c * c.transpose();
            }
        }
        const Six now = detail::velocity_of(body);
        motion.held = motion.q = now;
        if (body.inverse_mass > 0) {
            Matrix6 inertia = Matrix6::Zero();
            inertia.template topLeftCorner<3, 3>() = Mat3::Identity() / body.inverse_mass;
            inertia.template bottomRightCorner<3, 3>() = body.inverse_inertia.inverse();
            const Six begun = inertia * now - dt * (Six() << body.load.force, body.load.torque).finished();
            const Six pressure = dt * stage_.density * detail::pressed(faces_.cover(b), old);
            // Friction meets the last force of the pressure, whatever cells have become wet or dry since, and
            // what added mass makes of the rest.
            Matrix6 heavier = inertia;
            Six expected = before ? Six(dt * before->pressed) : pressure;
            const Real added = of_a_sphere * motion.covers;
            heavier.template topLeftCorner<3, 3>().diagonal().array() += added;
            if (before)
                expected.template head<3>() += added * (before->q + dt * before->gained).template head<3>();
            else
                expected.template head<3>() += added * body.velocity;
            motion.held = (heavier + drag).ldlt().solve(begun + expected + brought);
            motion.q = inertia.ldlt().solve(begun + brought - drag * motion.held);
            if (stage_.pushed) motion.q += detail::accelerated(body, pressure);  // or by the `push` to come
        }
        motion.by_friction = (brought - drag * motion.held) / dt;
        for (CoveredFace& f : faces_.of(b))
            f.target = detail::along(f, motion.held), f.solid = detail::along(f, motion.q);
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
            if (!stage_.held || (*stage_.held)[c.cell] >= 0.5)
                pressure[c.cell] = mean / cells + slope.dot(c.arm - middle / cells);
    }

    Params params_;
    std::vector<FlowBody> bodies_;
    std::vector<Motion> motion_;  ///< [body], and 0 of the cloud
    CoveredFaces faces_;
    AveragedBodies<DragOfSmall> averaged_;
    std::vector<Memory> memory_;     ///< by id
    std::vector<SolidFlux> fluxes_;  ///< as the last step left them
    std::vector<Real> beyond_;       ///< mixture's velocity beyond the water's at these faces [m/s]
    FlowStage stage_;
    Real fastest_ = 0;
};

static_assert(SolidsInFlow<MonolithicSolids<>>);

}  // namespace abrade
