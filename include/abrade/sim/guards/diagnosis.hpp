#pragma once
// Which body is the reason of a failure: looked for once the sums of a step tell that there is one.

#include <abrade/sim/guards/failure.hpp>
#include <abrade/sim/motion/advance.hpp>

namespace abrade {

/// Each of these looks through all bodies or contacts, so none is called while sums tell that all is well.
template <class P>
class Diagnosis {
public:
    static constexpr Real fastest_of_this_field = 1e4;  ///< [m/s]

    explicit Diagnosis(const State<P>& state) : state_(state) {}

    /// The contact of the deepest overlap beyond `limit` times the smaller radius, as forces were evaluated:
    /// the lines have made `last` since then.
    Failure deepest(const Move& last, Real limit) const {
        Failure found;
        HotArrays then = state_.store.lines;
        for (std::size_t slot = 0; slot < then.place.size(); ++slot)
            if (then.motion[slot].inverse_mass > 0)
                then.place[slot].centre -= last.drift * then.motion[slot].velocity;
        state_.contacts.each_touching([&](const auto& touching) {
            const SlotPair& pair = touching.pair;
            const auto contact = contact_seen_by(law_between(state_.policies.contact, touching.materials),
                                                 then, state_.scene.walls, touching, 0);
            const Real first = then.place[at(pair.first)].radius,
                       second = pair.second < 0 ? 0 : then.place[at(pair.second)].radius;
            DeepContact deep{.reach = first + second,
                             .smaller_radius = pair.second < 0 ? first : std::min(first, second),
                             .on_plane = pair.second < 0,
                             .inverse_mass = contact.inverse_mass,
                             .curvature = contact.curvature};
            const Real share = contact.overlap / deep.smaller_radius;
            if (!(share > std::max(limit, found.measure))) return;
            const Vec3& n = contact.normal;
            deep.materials = touching.materials;
            deep.apart = (deep.reach - contact.overlap) * n;
            const Real slower = (contact.velocity - touching.before.velocity).dot(n);
            if (last.kick > 0) deep.slowing = slower / last.kick;
            deep.velocity = then.motion[at(pair.first)].velocity - slower * n;
            deep.inverse_mass_along = mobility(then, pair.first, -n);
            if (!deep.on_plane) {
                deep.velocity -= then.motion[at(pair.second)].velocity;
                deep.inverse_mass_along += mobility(then, pair.second, n);
            }
            found = {Failure::Cause::overlap, body_in(pair.first), body_in(pair.second), share, false, deep};
        });
        return found;
    }

    Failure crushed_bond(const BondSums& sums) const {
        const auto& bond = state_.network.bond(sums.deepest_bond);
        return {Failure::Cause::overlap, bond.bodies.first, bond.bodies.second, sums.deepest, true, {}};
    }

    /// Who would outrun any list that the period of space has room for.
    Failure fastest() const {
        Failure found{Failure::Cause::outran_period, 0};
        for (Index b = 1; b < state_.particles.bodies(); ++b)
            if (speed(b) > speed(found.body)) found.body = b;
        return found;
    }

    /// The sphere that moves furthest for its radius in a step of dt, if that is further than its radius: two
    /// such could pass through each other between two looks. One that is alone has nothing to meet.
    Failure longest_stride(Real dt) const {
        Failure found;
        const HotArrays& lines = state_.store.lines;
        if (state_.particles.bodies() == 1 && state_.scene.walls.empty()) return found;
        for (Index slot = 0; slot < state_.store.spheres(); ++slot) {
            if (!(lines.motion[at(slot)].inverse_mass > 0)) continue;
            const Real share = dt * lines.motion[at(slot)].velocity.norm() / lines.place[at(slot)].radius;
            if (share > std::max(1.0, found.measure))
                found = {Failure::Cause::long_stride, body_in(slot), -1, share};
        }
        return found;
    }

    Failure unsound_or_lost() const {
        Failure found;
        const Box space = state_.scene.open_bounds();
        for (Index b = 0; b < state_.particles.bodies(); ++b) {
            if (!(speed(b) < fastest_of_this_field) || !state_.store.turns_soundly(state_.particles, b))
                return {Failure::Cause::not_finite, b};
            if (found.cause == Failure::Cause::none &&
                !space.contains(state_.store.position_of(state_.particles, b)))
                found = {Failure::Cause::lost, b};
        }
        return found;
    }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }
    Index body_in(Index slot) const noexcept { return slot < 0 ? slot : state_.body_in(slot); }
    Real speed(Index body) const { return state_.store.velocity_of(state_.particles, body).norm(); }

    /// How much a force at a sphere's rim along the normal n accelerates that rim [1/kg].
    Real mobility(const HotArrays& lines, Index slot, const Vec3& n) const {
        const Index own = state_.store.owner_of(slot);
        const Index clump = state_.store.clump_of(body_in(slot));
        if (clump < 0) return lines.motion[at(slot)].inverse_mass;
        const MovingClump& c = state_.store.clumps[at(clump)];
        const Vec3 lever = (state_.store.lines.place[at(own)].centre - c.position).cross(n);
        const Vec3 in_body = c.rotation.transpose() * lever;
        return c.inverse_mass + in_body.dot(Vec3(c.inverse_inertia.cwiseProduct(in_body)));
    }

    const State<P>& state_;
};

}  // namespace abrade
