#pragma once
// Bodies that left periodic space at one end come in at the other.

#include <abrade/sim/state/state.hpp>

namespace abrade {

/// Brings bodies that crossed a periodic edge back in; what that does to their potential energy is booked
/// as if they had been fed there.
template <class P>
void wrap(State<P>& state) {
    const Periodic space = state.scene.periodic();
    if (space.period.isZero()) return;
    SphereStore& store = state.store;
    const auto at = [](Index i) { return static_cast<std::size_t>(i); };
    const auto back = [&](Vec3& x, Index body) {
        const Vec3 shift = space.way_back(x);
        if (shift.isZero(0)) return shift;
        state.accounts.sum.fed_potential -= state.potential_energy(body, x);
        x += shift;
        state.accounts.sum.fed_potential += state.potential_energy(body, x);
        return shift;
    };
    std::vector<char> outside(at(store.spheres()));
    parallel_for(store.spheres(), [&](Index slot) {
        outside[at(slot)] = !space.way_back(store.lines.place[at(slot)].centre).isZero(0);
    });
    for (Index slot = 0; slot < store.spheres(); ++slot) {
        if (!outside[at(slot)]) continue;
        const Index body = state.particles.body[at(store.sphere_of(slot))];
        if (store.clump_of(body) < 0) back(store.lines.place[at(slot)].centre, body);
    }
    for (MovingClump& clump : store.clumps) {
        const Vec3 shift = back(clump.position, clump.body);
        for (Index m = 0; m < clump.count; ++m) store.lines.place[at(clump.first_slot + m)].centre += shift;
    }
}

}  // namespace abrade
