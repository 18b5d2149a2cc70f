#pragma once
// Rigid bodies in water on a grid, whose velocities are found together with the pressure.

#include <abrade/core/fields.hpp>
#include <abrade/coupling/covered_faces.hpp>
#include <abrade/coupling/dense_drag.hpp>
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
/// Bodies of less than `resolved_from` cells to a diameter are averaged (SolidCoverFinder): in the same
/// equations, with the share sigma that they are spread over, and
/// - instead of friction the drag of a law, F = beta (u - v) (SpreadBody), u the mean over the spread, the
/// law's
///   porosity what other bodies leave: du/dt = beta / (rho V) sigma / (1 - sigma) (v - u);
/// - added mass C_m rho V, for which water is accelerated by g - grad p / rho; the water has its part a step
///   later.
/// They are not turned.
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
    explicit MonolithicSolids(Params params) : params_(params), drag_(params.drag) { params_.validate(); }
    const Params& params() const noexcept { return params_; }
    std::span<const FlowBody> bodies() const noexcept { return bodies_; }
    std::span<const SolidCover> covers() const noexcept { return faces_.covers(); }  ///< [body]
    Real fastest() const noexcept { return fastest_; }                               ///< of the bodies [m/s]

    void place(const Grid<3>& grid, const Sides<3>& sides, std::span<const FlowBody> bodies,
               const FaceField<3>* open_area) {
        bodies_.assign(bodies.begin(), bodies.end()), motion_.assign(bodies.size(), {});
        faces_.place(grid, sides, bodies, params_.resolved_from, open_area);
        for (std::size_t b = 0; b < bodies_.size(); ++b)
            if (faces_.cover(b).cut) bodies_[b].inverse_mass = 0, bodies_[b].inverse_inertia.setZero();
    }
    std::vector<SolidPart> parts() const { return faces_.parts(); }
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
        for (const CoveredFace& f : faces_.all()) {
            Real& value = u[f.axis][f.face];
            value += f.covered * (detail::along(f, detail::velocity_of(bodies_[f.body])) - value);
        }
    }

    void force(FaceField<3>& u, const Field<Real>& pressure, const FlowStage& stage) {
        stage_ = stage;
        parallel_for_bodies([&](std::size_t b) { find_motion(b, u, pressure); });
        for (const CoveredFace& f : faces_.all()) {
            Real& value = u[f.axis][f.face];
            value += f.held * (detail::along(f, motion_[f.body].held) - f.velocity);
            value += f.share * motion_[f.body].handed[f.axis];
        }
        for (CoveredFace& f : faces_.all()) f.velocity = u[f.axis][f.face];
        for (CoveredFace& f : faces_.all()) {
            u[f.axis][f.face] += f.covered * (detail::along(f, motion_[f.body].q) - f.velocity);
            if (stage_.pushed || f.leaves) f.velocity += stage_.dt * f.gradient(pressure);
        }
    }

    template <class Number>
    void push(const Field<Number>& of, Real factor) {
        parallel_for_bodies([&](std::size_t b) {
            Motion& motion = motion_[b];
            motion.push = pushed(b, stage_.density * factor * detail::pressed(faces_.cover(b), of));
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
        parallel_for_bodies([&](std::size_t b) {
            Motion& motion = motion_[b];
            const Six sum = detail::pressed(faces_.cover(b), p);
            motion.push = pushed(b, stage_.density * sum);
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
        for (const CoveredFace& f : faces_.all())
            if (f.water > 0) u[f.axis][f.face] = f.velocity - stage_.dt * f.gradient(pressure);
        fluxes_.clear(), beyond_.clear();
        for (const CoveredFace& f : faces_.all()) {
            if (f.covered == 0) continue;
            const Real solid = f.covered * detail::along(f, motion_[f.body].q);
            fluxes_.push_back({f.face, f.axis, solid});
            beyond_.push_back(solid - f.covered * u[f.axis][f.face]);
        }
        std::vector<Memory> next;
        next.reserve(bodies_.size());
        fastest_ = 0;
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            FlowBody& body = bodies_[b];
            const Motion& motion = motion_[b];
            const Six by_pressure = stage_.density * detail::pressed(faces_.cover(b), pressure);
            Six by_added = Six::Zero();
            if (motion.added > 0)
                by_added = params_.added_mass * by_pressure + motion.lead / stage_.dt,
                by_added.template head<3>() -= motion.added / stage_.dt * motion.q.template head<3>();
            const Six load = by_pressure + motion.by_friction + by_added;
            body.velocity = motion.q.template head<3>(), body.angular_velocity = motion.q.template tail<3>();
            if (!faces_.cover(b).cut) body.load = {load.template head<3>(), load.template tail<3>()};
            fastest_ = std::max(fastest_, body.velocity.norm());
            fill_inside(b, by_pressure.template head<3>(), pressure);
            const Memory* const before = memory_of(body.id);
            next.push_back({.id = body.id,
                            .q = motion.q,
                            .gained = before ? Six(motion.q - before->q) / stage_.dt : Six(Six::Zero()),
                            .covers = motion.covers,
                            .slip = slip_of(b, u),
                            .pressed = by_pressure,
                            .owed = stage_.dt * by_added.template head<3>() - motion.owed});
        }
        std::sort(next.begin(), next.end(), [](const Memory& a, const Memory& b) { return a.id < b.id; });
        memory_ = std::move(next);
    }
    static void fields(auto&& field) {
        field("memory", &MonolithicSolids::memory_), field.bytes("fluxes", &MonolithicSolids::fluxes_);
        field("beyond", "m/s", &MonolithicSolids::beyond_);
        field("fastest", "m/s", &MonolithicSolids::fastest_);
    }

private:
    struct Motion {
        Six q = Six::Zero();            ///< velocity and spin [m/s], [rad/s]
        Six held = Six::Zero();         ///< the same while friction acts
        Six push = Six::Zero();         ///< its change by the last pressure
        Six by_friction = Six::Zero();  ///< [N], [N m]
        Six lead = Six::Zero();         ///< what added mass had, and its weight gives [kg m/s]
        Vec3 owed = Vec3::Zero();       ///< by the water to its added mass [kg m/s]
        Vec3 handed = Vec3::Zero();     ///< to the water in its place for that [m/s]
        Real curvature = 0;
        Real covers = 0;  ///< mass of water in the body's place [kg]
        Real added = 0;   ///< mass, of those averaged [kg]
    };
    /// What is known of a body from the last step.
    struct Memory {
        Index id = 0;
        Six q = Six::Zero();        ///< velocity and spin that it left [m/s], [rad/s]
        Six gained = Six::Zero();   ///< by these in the step [m/s2], [rad/s2]
        Real covers = 0;            ///< mass of water in the body's place [kg]
        Six slip = Six::Zero();     ///< of that water beyond the body's momentum [kg m/s], [kg m2/s]
        Six pressed = Six::Zero();  ///< force and torque of the pressure [N], [N m]
        Vec3 owed = Vec3::Zero();   ///< what its added mass was given [kg m/s]

        static void fields(auto&& field) {
            field("id", &Memory::id), field.bytes("q", &Memory::q), field.bytes("gained", &Memory::gained);
            field("covers", "kg", &Memory::covers), field.bytes("slip", &Memory::slip);
            field.bytes("pressed", &Memory::pressed), field.bytes("owed", &Memory::owed);
        }
    };
    static constexpr Real tiny = 1e-300, of_a_sphere = 0.5;  ///< added mass over that of its place [-]
    static constexpr Real sliver = 0.1;  ///< of a face: less water has no velocity of its own [-]

    Index count() const noexcept { return static_cast<Index>(bodies_.size()); }

    /// By an impulse of the pressure, which acts on added mass, too.
    Six pushed(std::size_t b, const Six& impulse) const noexcept {
        const FlowBody& body = bodies_[b];
        if (!faces_.cover(b).averaged) return detail::accelerated(body, impulse);
        const Real more = 1 + params_.added_mass, with = 1 + body.inverse_mass * motion_[b].added;
        return detail::accelerated(body, more / with * impulse);
    }
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
            sum += mass_of(f) * f.share * (u[f.axis][f.face] - detail::along(f, motion_[b].q)) *
                   detail::coefficient(f);
        return sum;
    }

    void parallel_for_bodies(auto&& body) const {
        parallel_blocks(
            count(),
            [&](Index, Index first, Index last) {
                for (Index b = first; b < last; ++b) body(static_cast<std::size_t>(b));
            },
            block_of_bodies);
    }
    const Memory* memory_of(Index id) const noexcept {
        const auto found = std::lower_bound(memory_.begin(), memory_.end(), id,
                                            [](const Memory& m, Index wanted) { return m.id < wanted; });
        return found != memory_.end() && found->id == id ? &*found : nullptr;
    }

    /// The body's velocity with friction, and with the old pressure as it acts on it where it is now.
    void find_motion(std::size_t b, const FaceField<3>& u, const Field<Real>& old) {
        const FlowBody& body = bodies_[b];
        const bool averaged = faces_.cover(b).averaged;
        Motion& motion = motion_[b];
        const Memory* const before = memory_of(body.id);
        const Real dt = stage_.dt;
        Six within = Six::Zero();
        Vec3 weight = Vec3::Zero(), among = Vec3::Zero(), flow = Vec3::Zero();
        for (CoveredFace& f : faces_.of(b)) {
            const Real gradient = f.gradient(old), now = u[f.axis][f.face];
            f.velocity = stage_.pushed ? now : now - dt * gradient;
            const Real unpushed = f.velocity + dt * gradient, covers = mass_of(f) * f.share;
            weight[f.axis] += covers, among[f.axis] += covers * f.water, flow[f.axis] += covers * f.velocity;
            if (before)
                within += covers * (unpushed - dt * stage_.falls[f.axis] - detail::along(f, before->q)) *
                          detail::coefficient(f);
        }
        motion.covers = weight.mean();
        const Real small = averaged ? drag_rate(b, flow.cwiseQuotient(weight.cwiseMax(tiny))) : 0;
        Matrix6 drag = Matrix6::Zero();  // impulse on the body = brought - drag q
        Six brought = Six::Zero();
        for (CoveredFace& f : faces_.of(b)) {
            const Real rate =
                averaged ? small : params_.friction * stage_.viscosity / std::pow(f.volume(), 2.0 / 3);
            const Real stiff = rate * dt * f.share, left = 1 - f.share;
            f.held = stiff > 0 ? stiff / (left + stiff) : 0;
            if (f.open > 0 && !averaged) f.held = std::max(f.held, 1 - f.water / (sliver * f.open));
            const Real held = mass_of(f) * f.water * f.held;
            const Six c = detail::coefficient(f);
            drag += held * c * c.transpose();
            brought += held * f.velocity * c;
        }
        // What has left through the surface has taken its part along.
        if (before && before->covers > 0)
            brought += within - std::min(1.0, motion.covers / before->covers) * before->slip;
        const Six now = detail::velocity_of(body);
        if (body.inverse_mass == 0) {
            motion.held = motion.q = now;
            motion.by_friction = (brought - drag * now) / dt;
            return;
        }
        Matrix6 inertia = Matrix6::Zero();
        inertia.template topLeftCorner<3, 3>() = Mat3::Identity() / body.inverse_mass;
        inertia.template bottomRightCorner<3, 3>() = body.inverse_inertia.inverse();
        const Six begun = inertia * now - dt * (Six() << body.load.force, body.load.torque).finished();
        const Real more = averaged ? 1 + params_.added_mass : 1;
        // Friction meets the last force of the pressure, whatever cells have become wet or dry since.
        const Six pressure = stage_.density * detail::pressed(faces_.cover(b), old);
        const Six last = dt * more * (before ? before->pressed : pressure);
        // Of a resolved body the pressure knows the added mass: then it is guessed for friction alone.
        const Real added = (averaged ? params_.added_mass : of_a_sphere) * motion.covers;
        const Vec3 goes_on = averaged ? stage_.falls
                             : before ? Vec3(before->gained.template head<3>())
                                      : Vec3(Vec3::Zero());
        const Vec3 had =
            before ? Vec3(before->q.template head<3>()) : Vec3(body.velocity - dt * stage_.falls);
        Six lead = Six::Zero();
        lead.template head<3>() = added * (had + dt * goes_on);
        Matrix6 heavier = inertia;
        heavier.template topLeftCorner<3, 3>().diagonal().array() += added;
        motion.held = (heavier + drag).ldlt().solve(begun + last + lead + brought);
        motion.by_friction = (brought - drag * motion.held) / dt;
        Six momentum = begun + dt * motion.by_friction;
        if (stage_.pushed) momentum += dt * more * pressure;  // or by the `push` to come
        if (averaged) {
            momentum += lead, motion.lead = lead, motion.added = added;
            // The water has its part at once, but for what the pressure is yet to change.
            motion.owed = params_.added_mass / more * last.template head<3>() + lead.template head<3>() -
                          added * motion.held.template head<3>();
            const Vec3 due = before ? Vec3(motion.owed + before->owed) : motion.owed;
            motion.handed = -due.cwiseQuotient(among.cwiseMax(tiny));
        }
        motion.q = (averaged ? heavier : inertia).ldlt().solve(momentum);
    }

    /// beta / (rho V) [1/s] of one that is averaged, in water that flows with `flow` [m/s].
    Real drag_rate(std::size_t b, const Vec3& flow) const noexcept {
        const FlowBody& body = bodies_[b];
        Real shares = 0, water = 0;
        for (const CoveredFace& f : faces_.of(b))
            if (f.open > 0) shares += f.share, water += f.share * std::min((f.water + f.share) / f.open, 1.0);
        if (shares == 0) return 0;
        const SpreadBody spread{.diameter = body.diameter(),
                                .reach = faces_.cover(b).reach,
                                .slip = (flow - body.velocity).norm(),
                                .viscosity = stage_.viscosity,
                                .porosity = water / shares};
        return spread.drag(drag_) / body.volume;
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
    DragOfSmall drag_;
    std::vector<FlowBody> bodies_;
    std::vector<Motion> motion_;  ///< [body]
    CoveredFaces faces_;
    std::vector<Memory> memory_;     ///< by id
    std::vector<SolidFlux> fluxes_;  ///< as the last step left them
    std::vector<Real> beyond_;       ///< mixture's velocity beyond the water's at these faces [m/s]
    FlowStage stage_;
    Real fastest_ = 0;
};

static_assert(SolidsInFlow<MonolithicSolids<>>);

}  // namespace abrade
