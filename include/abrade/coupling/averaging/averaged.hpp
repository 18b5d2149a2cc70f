#pragma once
// What a flow and bodies that are small against its cells do to each other.

#include <abrade/core/fields.hpp>
#include <abrade/coupling/drag/dense_drag.hpp>
#include <abrade/coupling/mapping/covered_faces.hpp>
#include <abrade/coupling/mapping/spread_cloud.hpp>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// Bodies of a SpreadCloud. Upon one acts
///   F = -(1 + C_m) V grad p + C_m rho V (g - dv/dt) + beta (u - v) + C_L rho V (u - v) x curl u,
/// means over its parts, the curl over a cell: pressure; added mass, for which water is accelerated by
/// g - grad p / rho; a law's drag and lift, with the slip that the body itself has made less put back
/// (SpreadBody) and the porosity that other bodies leave. The water has all of it: pressure by the cloud's
/// shares of its faces; friction
///   du/dt = sum of beta / (rho V) sigma (v - u) / (1 - sum of sigma),
/// implicit in u, with v as drag and lift would leave it; lift as an impulse; added mass as the last pressure
/// has it, what the new one changes a step later. Where less than half of what is around a body is water, C_m
/// is less: twice that share of its value, for what little water there is in a dense bed must not answer for
/// all of it. These bodies are not turned. While the pressure is sought the cloud moves on with the velocity
/// that they had before, and yields to the new pressure face by face, by (1 + C_m) / (s + C_m) of what water
/// would, s their density over the water's. The pressure on a body is a mean over its faces, so it moves
/// otherwise than each of them; that difference comes a step later. So ratios of densities from 0.01 to 8 are
/// stable, and beds at 65 % of a box from 0.3 to 8 (tried).
template <DenseDragLaw Drag>
class AveragedBodies {
public:
    AveragedBodies() = default;
    AveragedBodies(Real added_mass, Real lift, typename Drag::Params drag)
        : added_mass_(added_mass), lift_(lift), drag_(drag) {}

    /// Faces of the cloud get the velocity that its bodies have been given, and learn how a pressure is going
    /// to move them. `density`: of the water [kg/m3].
    void begin(FaceColumns& f, const SpreadCloud& cloud, std::span<const FlowBody> bodies, Real density) {
        motion_.assign(cloud.count(), {});
        std::vector<Real> mobility(cloud.count(), 0);
        for (std::size_t n = 0; n < motion_.size(); ++n) {
            const FlowBody& body = bodies[cloud.which()[n]];
            const Real displaced = density * body.volume;
            motion_[n].v = body.velocity;
            if (body.inverse_mass > 0)
                mobility[n] =
                    (1 + added_mass_) * displaced / (1 / body.inverse_mass + added_mass_ * displaced);
        }
        std::ranges::fill(f.mobility, 0);
        for_each_part(cloud, [&](std::size_t n, int, const SpreadPart& part) {
            f.mobility[part.face] += part.share * mobility[n];
        });
        for_each_face(f, [&](std::size_t i) { f.mobility[i] /= f.share[i]; });
        carry(f, cloud);
    }

    /// For lift, of a whole field of the water's velocity. `curl(x)`: of it, at a place [1/s].
    void see(const SpreadCloud& cloud, std::span<const FlowBody> bodies, auto&& curl) {
        if (lift_ == 0) return;
        for_each(cloud, [&](std::size_t n) { motion_[n].curl = curl(bodies[cloud.which()[n]].position); });
    }
    /// Before the pressure is found: what friction, lift and added mass do to faces, whose velocity and mass
    /// are known.
    void force(FaceColumns& f, const SpreadCloud& cloud, std::span<const FlowBody> bodies,
               const Field<Real>& old, const FlowStage& stage) {
        for_each(cloud, [&](std::size_t n) { alone(n, f, cloud, bodies, old, stage); });
        for_each_face(f, [&](std::size_t i) {
            f.last_gradient[i] = f.gradient(old, i), f.rate[i] = f.target[i] = f.given[i] = 0;
        });
        for_each_part(cloud, [&](std::size_t n, int axis, const SpreadPart& part) {
            const std::size_t i = part.face;
            const Real drags = motion_[n].rate * part.share * kept(f.water[i]);
            f.rate[i] += drags, f.target[i] += drags * motion_[n].v[axis];
            if (f.mass[i] > 0) f.given[i] += part.share * f.water[i] * motion_[n].pushed[axis];
        });
        for_each_face(f, [&](std::size_t i) {
            const Real stiff = f.water[i] > 0 ? stage.dt * f.rate[i] / f.water[i] : 0;
            f.held[i] = stiff / (1 + stiff);
            f.target[i] = f.rate[i] > 0 ? f.target[i] / f.rate[i] : 0;
        });
        for_each(cloud, [&](std::size_t n) {
            Motion& m = motion_[n];
            for (int axis = 0; axis < 3; ++axis)
                for (const auto& [i, share] : cloud.parts(n, axis)) {
                    const Real slowed = f.velocity[i] + f.held[i] * (f.target[i] - f.velocity[i]);
                    m.by_slip[axis] += f.mass[i] * share * m.rate * kept(f.water[i]) * (slowed - m.v[axis]);
                }
        });
        carry(f, cloud);
    }

    /// Once the pressure is known: how the cloud has moved while it was sought.
    void yield(FaceColumns& f, const Field<Real>& pressure, Real dt) const {
        for_each_face(f, [&](std::size_t i) {
            f.solid[i] -= dt * f.yields(i) * (f.gradient(pressure, i) - f.last_gradient[i]);
        });
    }

    /// Once the pressure is known: velocities and loads of the bodies. Told ones keep their velocity, those
    /// that have left the box their load.
    void settle(const FaceColumns& f, const SpreadCloud& cloud, std::span<FlowBody> bodies,
                std::span<const SolidCover> covers, const Field<Real>& pressure, const FlowStage& stage) {
        for_each(cloud, [&](std::size_t n) {
            FlowBody& body = bodies[cloud.which()[n]];
            Motion& m = motion_[n];
            const Vec3 pressed = pressed_by(n, f, cloud, pressure, stage.density);
            if (body.inverse_mass > 0)
                m.v = (m.begun + m.added_momentum + stage.dt * (m.by_slip + (1 + m.coefficient) * pressed)) /
                      (1 / body.inverse_mass + m.added);
            const Vec3 by_added = m.coefficient * pressed + (m.added_momentum - m.added * m.v) / stage.dt;
            body.velocity = m.v;
            const Vec3 after_blow = m.struck.taken_by(m.added, body, stage.dt);
            const Memory* const before = with_id(memory_, body.id);
            const Real lasts = before ? stage.lasts() : 1;
            if (!covers[cloud.which()[n]].cut) {
                const Vec3 load = pressed + m.by_slip + by_added + after_blow;
                body.load.force += lasts * (load - body.load.force), body.load.torque.setZero();
                m.struck.hand_out(body, m.added, stage.dt);
            }
            m.pressed = pressed;
            if (before) m.pressed = before->pressed + lasts * (pressed - before->pressed);
            m.reaction = stage.dt * by_added - m.reaction;
        });
        memory_.clear();
        for (std::size_t n = 0; n < motion_.size(); ++n)
            memory_.push_back({bodies[cloud.which()[n]].id, motion_[n].v, motion_[n].pressed,
                               motion_[n].reaction, motion_[n].struck.velocity});
        std::ranges::sort(memory_, {}, &Memory::id);
    }

    static void fields(auto&& field) { field("memory", &AveragedBodies::memory_); }

private:
    struct Motion {
        Vec3 v = Vec3::Zero();               ///< [m/s]
        Vec3 begun = Vec3::Zero();           ///< momentum by all but the water [kg m/s]
        Vec3 added_momentum = Vec3::Zero();  ///< of the added mass, with its weight [kg m/s]
        Vec3 by_slip = Vec3::Zero();         ///< drag and lift [N]
        Vec3 pressed = Vec3::Zero();         ///< by the pressure, without added mass [N]
        Vec3 reaction = Vec3::Zero();        ///< of the added mass on the water, an impulse [kg m/s]
        Vec3 curl = Vec3::Zero();            ///< of the water's velocity [1/s]
        Vec3 pushed = Vec3::Zero();          ///< of the water by that impulse, over both their shares [m/s]
        Real rate = 0;                       ///< beta / (rho V) [1/s]
        Real coefficient = 0;                ///< C_m [-]
        Real added = 0;                      ///< C_m rho V, as far as there is water [kg]
        ContactVelocity struck;              ///< by contacts
    };
    /// What is known of a body from the last step.
    struct Memory {
        Index id = 0;
        Vec3 v = Vec3::Zero(), pressed = Vec3::Zero(), reaction = Vec3::Zero();
        Vec3 struck = Vec3::Zero();  ///< velocity by contacts [m/s]
        static void fields(auto&& field) {
            field("id", &Memory::id), field.bytes("v", &Memory::v), field.bytes("pressed", &Memory::pressed);
            field.bytes("reaction", &Memory::reaction), field.bytes("struck", &Memory::struck);
        }
    };
    static constexpr Real least_water = 0.1;  ///< of a face: what less there is feels less [-]

    static Real kept(Real water) noexcept { return std::min(water / least_water, 1.0); }

    void for_each(const SpreadCloud& cloud, auto&& body) const {
        parallel_for(
            static_cast<Index>(cloud.count()), [&](Index n) { body(static_cast<std::size_t>(n)); },
            block_of_bodies);
    }
    static void for_each_face(const FaceColumns& f, auto&& visit) {
        parallel_for(static_cast<Index>(f.cloud), [&](Index i) { visit(static_cast<std::size_t>(i)); });
    }
    /// Bodies share faces, axes do not.
    static void for_each_part(const SpreadCloud& cloud, auto&& visit) {
        parallel_tasks(3, [&](Index task) {
            const int axis = static_cast<int>(task);
            for (std::size_t n = 0; n < cloud.count(); ++n)
                for (const SpreadPart& part : cloud.parts(n, axis)) visit(n, axis, part);
        });
    }
    void carry(FaceColumns& f, const SpreadCloud& cloud) const {
        for_each_face(f, [&](std::size_t i) { f.solid[i] = 0; });
        for_each_part(cloud, [&](std::size_t n, int axis, const SpreadPart& part) {
            f.solid[part.face] += part.share * motion_[n].v[axis];
        });
        for_each_face(f, [&](std::size_t i) { f.solid[i] /= f.share[i]; });
    }
    static Vec3 pressed_by(std::size_t n, const FaceColumns& f, const SpreadCloud& cloud,
                           const Field<Real>& pressure, Real density) noexcept {
        Vec3 sum = Vec3::Zero();
        for (int axis = 0; axis < 3; ++axis)
            for (const auto& [i, share] : cloud.parts(n, axis))
                sum[axis] -= density * share * f.volume[i] * f.gradient(pressure, i);
        return sum;
    }

    /// The body's velocity with drag and lift in the water as it is.
    void alone(std::size_t n, const FaceColumns& f, const SpreadCloud& cloud,
               std::span<const FlowBody> bodies, const Field<Real>& old, const FlowStage& stage) {
        const FlowBody& body = bodies[cloud.which()[n]];
        Motion& m = motion_[n];
        Vec3 weight = Vec3::Zero(), open = Vec3::Zero(), among = Vec3::Zero(), flow = Vec3::Zero();
        Real shares = 0, others = 0;
        for (int axis = 0; axis < 3; ++axis)
            for (const auto& [i, share] : cloud.parts(n, axis)) {
                const Real covers = f.mass[i] * share;
                weight[axis] += covers, open[axis] += covers * f.water[i];
                among[axis] += covers * square(f.water[i]), flow[axis] += covers * f.velocity[i];
                if (f.open[i] == 0) continue;
                shares += share;
                others += share * std::clamp(1 - (f.water[i] + share) / f.open[i], 0.0, 1.0);
            }
        flow = flow.cwiseQuotient(weight.cwiseMax(tiny<Real>));
        const SpreadBody spread{.diameter = body.diameter(),
                                .reach = cloud.reach(n),
                                .slip = (flow - body.velocity).norm(),
                                .viscosity = stage.viscosity,
                                .porosity = shares > 0 ? 1 - others / shares : 1};
        const Real drag = weight.norm() > 0 ? spread.drag(drag_) : 0, put_back = spread.put_back(drag);
        m.rate = drag * put_back / body.volume;
        if (lift_ != 0) m.by_slip = lift_ * weight.mean() * put_back * (flow - body.velocity).cross(m.curl);
        const Memory* const before = with_id(memory_, body.id);
        const Real dt = stage.dt;
        m.coefficient = added_mass_ * std::min(2 * open.sum() / std::max(weight.sum(), tiny<Real>), 1.0);
        m.added = m.coefficient * weight.mean();
        const bool falls = body.inverse_mass > 0;  // or it moves as it is told
        const Vec3 had = before ? before->v : Vec3(body.velocity - (falls ? dt : 0) * stage.falls);
        m.added_momentum = m.added * (had + dt * stage.falls);
        const Vec3 last = before ? before->pressed : pressed_by(n, f, cloud, old, stage.density);
        if (falls) {
            if (before) m.struck = {body, before->v, before->struck, stage.falls, dt};
            m.begun = body.velocity / body.inverse_mass - dt * (body.load.force + body.load.shared) +
                      body.load.added_mass * m.struck.velocity;
            const Vec3 drags = dt * m.rate * weight;
            const Vec3 heavy = Vec3::Constant(1 / body.inverse_mass + m.added) + drags;
            const Vec3 gains = dt * ((1 + m.coefficient) * last + m.by_slip) + drags.cwiseProduct(flow);
            m.v = (m.begun + m.added_momentum + gains).cwiseQuotient(heavy);
        }
        m.reaction = dt * m.coefficient * last + m.added_momentum - m.added * m.v;
        Vec3 due = m.reaction + dt * m.by_slip;
        if (before) due += before->reaction;
        // What is left of the water around a body that has come out of it is not shot about.
        const Real least = least_water * stage.density * body.volume;
        m.pushed = -due.cwiseQuotient(among.cwiseMax(least));
    }

    Real added_mass_ = 0.5, lift_ = 0;
    Drag drag_;
    std::vector<Motion> motion_;  ///< [body of the cloud]
    std::vector<Memory> memory_;  ///< by id
};

}  // namespace abrade
