#pragma once
// Bodies and the flow that resolves them: out to it, and back with what it did to them.

#include <abrade/fluid/flow_body.hpp>
#include <abrade/sim/state/state.hpp>

#include <algorithm>
#include <limits>
#include <vector>

namespace abrade {

/// Until when a fluid's next step would lead, found once for each of them: solids ask before every step of
/// theirs. Water whose cells bodies cross (`step_of_body`) is due sooner where a body is fast, and twice
/// early as it first meets bodies: the first load includes the start, the second is the load that lasts.
class NextFluidStep {
public:
    Real fastest = 0;  ///< of bodies as they moved last [m/s]
    Index met = 0;     ///< how often fluid and bodies have met

    Real of(const auto& fluid) {
        constexpr Real early = 1.0 / 64;  // of a step
        if (fluid.time() != begins_) begins_ = fluid.time(), takes_ = fluid.stable_step().seconds;
        if constexpr (requires { fluid.step_of_body(fastest); })
            return begins_ + (met < 2 ? early : 1) * std::min(takes_, fluid.step_of_body(fastest));
        else
            return begins_ + takes_;
    }
    static void fields(auto&& field) {
        field("fastest", "m/s", &NextFluidStep::fastest), field("met", &NextFluidStep::met);
    }

private:
    Real begins_ = std::numeric_limits<Real>::quiet_NaN(), takes_ = 0;  ///< [s]
};

/// Stones and grains, and fixed stones, as a flow sees them. Velocities are those of the present.
template <class P>
class FlowBodies {
public:
    explicit FlowBodies(const State<P>& state) {
        const Particles& p = state.particles;
        const SphereStore& store = state.store;
        std::vector<std::size_t> first;
        for (Index b = 0; b < p.bodies(); ++b) {
            const Kind kind = p.kind[at(b)];
            if (p.site[at(b)] >= 0 && kind != Kind::grain) continue;  // it stands: the water has walls
            const auto from = at(p.first_sphere[at(b)]), count = at(p.sphere_count[at(b)]);
            first.push_back(spheres_.size());
            for (std::size_t s = from; s < from + count; ++s) {
                const SpherePlace& place = store.lines.place[at(store.slot_of(static_cast<Index>(s)))];
                spheres_.push_back({place.centre, place.radius});
            }
            FlowBody body{.id = p.id[at(b)], .volume = p.volume[at(b)]};
            body.load = state.in_fluid.load[at(b)];
            const bool free = p.inverse_mass[at(b)] > 0 && !state.sleep.asleep(b);
            if (const Index c = store.clump_of(b); c >= 0) {
                const MovingClump& clump = store.clumps[at(c)];
                body.position = clump.position, body.velocity = clump.velocity;
                body.angular_velocity = clump.angular_velocity(clump.angular_momentum);
                if (free)
                    body.inverse_mass = clump.inverse_mass,
                    body.inverse_inertia =
                        clump.rotation * clump.inverse_inertia.asDiagonal() * clump.rotation.transpose();
            } else {
                const SphereMotion& motion = store.lines.motion[at(store.slot_of(p.first_sphere[at(b)]))];
                body.position = spheres_.back().centre, body.velocity = motion.velocity;
                body.angular_velocity = motion.curvature * motion.surface_velocity;
                if (free)
                    body.inverse_mass = motion.inverse_mass,
                    body.inverse_inertia = p.inverse_inertia[at(b)].x() * Mat3::Identity();
            }
            bodies_.push_back(body), number_.push_back(b);
        }
        first.push_back(spheres_.size());
        for (std::size_t i = 0; i < bodies_.size(); ++i)
            bodies_[i].spheres = std::span(spheres_).subspan(first[i], first[i + 1] - first[i]);
    }

    std::span<FlowBody> bodies() noexcept { return bodies_; }

    /// Gives bodies the velocities and loads that they have come back with; returns the work that this did
    /// [J].
    Real give_back(State<P>& state) const {
        Real work = 0;
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const FlowBody& body = bodies_[i];
            const Index b = number_[i];
            state.in_fluid.load[at(b)] = body.load;
            if (body.inverse_mass == 0) continue;
            const Real mass = state.particles.mass[at(b)];
            if (const Index c = state.store.clump_of(b); c >= 0) {
                MovingClump& clump = state.store.clumps[at(c)];
                const Vec3 before = clump.angular_velocity(clump.angular_momentum);
                const Vec3 spun = body.angular_velocity - before;
                const Vec3 momentum =
                    clump.rotation * (clump.rotation.transpose() * spun).cwiseQuotient(clump.inverse_inertia);
                work += 0.5 * mass * (body.velocity - clump.velocity).dot(body.velocity + clump.velocity) +
                        0.5 * momentum.dot(body.angular_velocity + before);
                clump.velocity = body.velocity, clump.angular_momentum += momentum;
                continue;
            }
            const Index slot = state.store.slot_of(state.particles.first_sphere[at(b)]);
            SphereMotion& motion = state.store.lines.motion[at(slot)];
            const Vec3 surface_velocity = body.angular_velocity / motion.curvature;
            work += 0.5 * mass *
                    ((body.velocity - motion.velocity).dot(body.velocity + motion.velocity) +
                     0.4 * (surface_velocity - motion.surface_velocity)
                               .dot(surface_velocity + motion.surface_velocity));
            motion.velocity = body.velocity, motion.surface_velocity = surface_velocity;
        }
        return work;
    }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

    std::vector<Sphere> spheres_;
    std::vector<FlowBody> bodies_;
    std::vector<Index> number_;  ///< of the body in `particles`
};

}  // namespace abrade
