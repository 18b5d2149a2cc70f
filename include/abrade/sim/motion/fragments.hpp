#pragma once
// Pieces of concrete that came loose, handed on as rigid clumps.

#include <abrade/geometry/sphere_union.hpp>
#include <abrade/sim/motion/advance.hpp>

namespace abrade {

/// A piece as it is to go on: its spheres joined, with their mass, momentum and angular momentum.
struct Fragment {
    Clump clump;
    BodyState state;
    Vec3 angular_momentum = Vec3::Zero();  ///< about the centroid [kg m2/s]
    Real kinetic = 0;                      ///< of its spheres before [J]
};

/// Joins the spheres of the given bodies, single spheres of one density [kg/m3], as the lines have them.
/// The clump's inertia is the sum of the spheres': where they overlap, both count, as they did before.
template <class P>
Fragment join(const State<P>& state, std::span<const Index> bodies, Real density) {
    const Particles& p = state.particles;
    Fragment all;
    Vec3 momentum = Vec3::Zero(), centroid = Vec3::Zero();
    Real mass = 0;
    const auto each = [&](auto&& visit) {
        for (const Index b : bodies) {
            const auto slot = static_cast<std::size_t>(state.first_slot_of(b));
            visit(p.mass[static_cast<std::size_t>(b)], state.store.lines.place[slot],
                  state.store.lines.motion[slot]);
        }
    };
    each([&](Real m, const SpherePlace& at, const SphereMotion& moves) {
        mass += m, centroid += m * at.centre, momentum += m * moves.velocity;
        all.kinetic +=
            0.5 * m * moves.velocity.squaredNorm() + 0.2 * m * moves.surface_velocity.squaredNorm();
    });
    centroid /= mass;
    const Vec3 velocity = momentum / mass;
    Mat3 inertia = Mat3::Zero();
    each([&](Real m, const SpherePlace& at, const SphereMotion& moves) {
        const Vec3 arm = at.centre - centroid;
        inertia +=
            m * ((0.4 * square(at.radius) + arm.squaredNorm()) * Mat3::Identity() - arm * arm.transpose());
        all.angular_momentum +=
            m * arm.cross(moves.velocity - velocity) + 0.4 * m * at.radius * moves.surface_velocity;
    });
    const PrincipalFrame frame = principal_frame(inertia);
    all.clump.name = "fragment";
    all.clump.volume = mass / density, all.clump.principal_moments = frame.moments / density;
    each([&](Real, const SpherePlace& at, const SphereMotion&) {
        const Vec3 arm = frame.axes.transpose() * (at.centre - centroid);
        all.clump.members.push_back({arm, at.radius});
        all.clump.bounding_radius = std::max(all.clump.bounding_radius, arm.norm() + at.radius);
    });
    all.state.position = centroid, all.state.velocity = velocity;
    all.state.orientation = Quaternion(frame.axes).normalized();
    return all;
}

/// Joins the pieces that wait and have come free of everything: what a pressed contact or broken bond stores
/// cannot be handed over to a contact of the clump without a jump. Marks their bodies in `gone` [body].
template <class P>
std::vector<Fragment> join_pieces(State<P>& state, std::vector<char>& gone) {
    const auto at = [](Index i) { return static_cast<std::size_t>(i); };
    std::vector<char> pressed(state.sites.body_of.size(), 0);
    state.network.each_bond([&](const auto& bond) {
        if (bond.broken()) pressed[at(bond.members.first)] = pressed[at(bond.members.second)] = 1;
    });
    state.contacts.each_touching(
        [](const auto&) {},
        [&](const SlotPair& pair) {
            for (const Index slot : {pair.first, pair.second})
                if (slot >= 0)
                    if (const Index site = state.particles.site[at(state.body_in(slot))]; site >= 0)
                        pressed[at(site)] = 1;
            return false;
        });
    std::vector<Fragment> fragments;
    const auto waits = [&](Index site) { return pressed[at(site)] != 0; };
    std::erase_if(state.events.components, [&](const BondGraph::Component& component) {
        if (std::any_of(component.begin(), component.end(), waits)) return false;
        for (const BondGraph::Component& part : state.network.graph().parts(component)) {
            std::vector<Index> bodies;
            for (const Index site : part)
                if (const Index body = state.sites.body_of[at(site)]; body >= 0 && !gone[at(body)])
                    bodies.push_back(body);
            if (bodies.size() < 2) continue;
            fragments.push_back(join(state, bodies, state.scene.concrete->density));
            for (const Index body : bodies) gone[at(body)] = 1;
        }
        return true;
    });
    return fragments;
}

/// Makes a fragment a body. What its spheres moved with against each other is lost.
template <class P>
void add_fragment(State<P>& state, const Fragment& fragment) {
    Particles& p = state.particles;
    const Index body = p.add(fragment.clump, state.scene.concrete->density, fragment.state, Kind::grain);
    p.angular_momentum[static_cast<std::size_t>(body)] = fragment.angular_momentum;
    p.material.back() = state.scene.concrete->material;
    state.accounts.sum.lost_asleep += fragment.kinetic - p.kinetic_energy(body);
}

}  // namespace abrade
