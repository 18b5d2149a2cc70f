#pragma once
// Stable time steps: one to begin with, from the scene, and what contacts and bonds allow as they stand.

#include <abrade/dem/contacts/body_stiffness.hpp>
#include <abrade/sim/state/state.hpp>

#include <limits>
#include <string_view>

namespace abrade {

/// A stable time step [s], and what sets it.
struct StableStep {
    Real seconds = std::numeric_limits<Real>::infinity();
    std::string_view limit = "nothing moves";  ///< what sets it
    Index body = -1;                           ///< that sets it, -1: one still to be fed

    void lower(Real candidate, std::string_view reason, Index whose = -1) noexcept {
        if (candidate < seconds) seconds = candidate, limit = reason, body = whose;
    }
};

/// A clump is as stable as a sphere of this mass: its own, or what its smallest inertia amounts to at its
/// farthest point.
inline Real stability_mass(Real mass, Real smallest_inertia, Real bounding_radius) noexcept {
    return std::min(mass, smallest_inertia / (0.4 * square(bounding_radius)));
}

/// Stones that may touch a bonded sphere at once, beside its bonds.
inline constexpr int contacts_of_concrete = 2;

namespace detail {

inline BodyStiffness::Body stiff_body(const Particles& particles, Index b, const Quaternion& orientation) {
    const auto i = static_cast<std::size_t>(b);
    return {particles.inverse_mass[i], particles.inverse_inertia[i], orientation};
}

/// Springs and dashpots of a contact of effective mass m [kg] on a sphere of that radius [m].
inline LinkRigidity link_of(const ContactRigidity& touch, Real mass, Real radius) noexcept {
    LinkRigidity link = LinkRigidity::damped(touch.normal, touch.tangential, touch.damping_ratio, mass);
    link.turning = touch.rolling * square(radius);
    link.turning_dashpot =
        2 * touch.rolling_damping_ratio * std::sqrt(1.4 * mass * touch.rolling) * square(radius);
    return link;
}

/// Farthest point of a body from its centre, and its largest sphere [m].
struct Extent {
    Real reach = 0, largest = 0;
};
inline Extent extent_of(const Particles& particles, Index body) {
    const auto b = static_cast<std::size_t>(body);
    const auto first = static_cast<std::size_t>(particles.first_sphere[b]);
    Extent e;
    for (std::size_t s = first; s < first + static_cast<std::size_t>(particles.sphere_count[b]); ++s) {
        e.reach = std::max(e.reach, particles.offset[s].norm() + particles.radius[s]);
        e.largest = std::max(e.largest, particles.radius[s]);
    }
    return e;
}

/// Where dashpots are set by the mass of what is free: of the heaviest body that moves or is still to be fed,
/// the largest effective mass of a contact with bonded concrete; else 0 [kg].
template <ContactPolicy C>
Real mass_on_concrete(const C& contact, const Particles& particles, const std::optional<FeedParams>& feed) {
    if (!damps_free_mass(contact)) return 0;
    Real heaviest = 0;
    for (std::size_t b = 0; b < particles.mass.size(); ++b)
        if (particles.inverse_mass[b] > 0) heaviest = std::max(heaviest, particles.mass[b]);
    if (feed)
        for (const StoneClass& stones : feed->classes)
            heaviest = std::max(heaviest, feed->density * make_stone(stones.shape, stones.size).volume);
    return heaviest;
}

/// Calls `visit(body, normal, arm, link, partner_moves)` for both ends of each bond.
template <BondLaw B, class Visit>
void each_end(const Network<B>& network, const B& law, const Particles& particles, Visit&& visit) {
    const auto at = [](Index i) { return static_cast<std::size_t>(i); };
    network.each_bond([&](const auto& bond) {
        const Vec3 apart =
            particles.centre[at(bond.spheres.first)] - particles.centre[at(bond.spheres.second)];
        const Vec3 n = apart.normalized();
        const Real lambda = apart.norm() / (particles.radius[at(bond.spheres.first)] +
                                            particles.radius[at(bond.spheres.second)]);
        const BondRigidity k = law.rigidity(bond.radius, bond.rest_length);
        LinkRigidity link =
            LinkRigidity::damped(k.normal, k.tangential, k.damping_ratio, bond.effective_mass);
        if (!bond.broken()) link.turning = std::max(k.bending, k.twisting);
        link.turning_dashpot = 2 * k.damping_ratio * std::sqrt(link.turning * bond.effective_inertia);
        const auto moves = [&](Index body) { return particles.inverse_mass[at(body)] > 0; };
        visit(bond.bodies.first, n, Vec3(-lambda * particles.radius[at(bond.spheres.first)] * n), link,
              moves(bond.bodies.second));
        visit(bond.bodies.second, n, Vec3(lambda * particles.radius[at(bond.spheres.second)] * n), link,
              moves(bond.bodies.first));
    });
}

}  // namespace detail

/// A step to begin with: for stones what the law says of dense surroundings, for bonded spheres what the
/// bonds that they have and two contacts more allow.
template <ContactPolicy C, BondLaw B>
StableStep stable_step(const C& contact, const B& bond, const Particles& particles, const Network<B>& network,
                       const std::optional<FeedParams>& feed) {
    StableStep step;
    const auto at = [](Index i) { return static_cast<std::size_t>(i); };
    std::vector<Index> held(at(particles.bodies()), -1);  // [body] its place among the bonded
    std::vector<BodyStiffness> bonded;
    const Real heaviest = detail::mass_on_concrete(contact, particles, feed);
    detail::each_end(network, bond, particles,
                     [&](Index b, const Vec3& n, const Vec3& arm, const LinkRigidity& link, bool moves) {
                         if (particles.inverse_mass[at(b)] == 0) return;
                         if (held[at(b)] < 0) {
                             held[at(b)] = static_cast<Index>(bonded.size());
                             bonded.emplace_back();
                         }
                         bonded[at(held[at(b)])].add(
                             detail::stiff_body(particles, b, particles.orientation[at(b)]), n, arm, link,
                             moves);
                     });
    for (Index b = 0; b < particles.bodies(); ++b) {
        const auto i = at(b);
        if (particles.inverse_mass[i] == 0) continue;
        const Real mass = particles.mass[i];
        const detail::Extent extent = detail::extent_of(particles, b);
        if (held[i] < 0) {
            step.lower(contact.stable_dt(
                           stability_mass(mass, 1 / particles.inverse_inertia[i].maxCoeff(), extent.reach),
                           extent.reach),
                       "contacts of the lightest stone", b);
            continue;
        }
        const ContactRigidity touch = contact.rigidity(extent.largest);
        BodyStiffness& own = bonded[at(held[i])];
        own.add_anywhere(detail::stiff_body(particles, b, particles.orientation[i]), contacts_of_concrete,
                         detail::link_of(touch, std::max(mass, heaviest), extent.largest));
        step.lower(own.step(step.seconds), "bonded concrete", b);
        step.lower(contact.stable_dt(mass, extent.largest), "contacts of loose concrete", b);
    }
    if (feed)
        for (const StoneClass& stones : feed->classes) {
            const Clump clump = make_stone(stones.shape, stones.size);
            const Real mass =
                stability_mass(feed->density * clump.volume,
                               feed->density * clump.principal_moments.minCoeff(), clump.bounding_radius);
            step.lower(contact.stable_dt(mass, clump.bounding_radius), "contacts of the smallest stone fed");
        }
    return step;
}

/// What contacts and bonds allow as they stand (see BodyStiffness: never more than the true limit, never less
/// than half of it), up to `most` [s]; and what a first touch of each body allows.
template <class P>
class StableStepNow {
public:
    explicit StableStepNow(const State<P>& state) : state_(state), held_(at(state.particles.bodies()), -1) {}

    /// Of all bodies, where that is less than `most`.
    StableStep of_all(Real most = std::numeric_limits<Real>::infinity()) {
        const StableStep step = first_touch(most);
        hold_doubtful(most);
        const Particles& p = state_.particles;
        const Real heaviest = detail::mass_on_concrete(state_.policies.contact, p, state_.scene.feed);
        for (Index b = 0; b < p.bodies(); ++b) {
            if (p.site[at(b)] < 0 || p.inverse_mass[at(b)] == 0) continue;
            hold(b);
            if (p.kind[at(b)] != Kind::concrete) continue;  // loose, yet it may have bonds
            const Real radius = detail::extent_of(p, b).largest;
            const ContactRigidity touch = state_.policies.contact.rigidity(radius);
            own_[at(held_[at(b)])].add_anywhere(
                body_of(b), contacts_of_concrete,
                detail::link_of(touch, std::max(p.mass[at(b)], heaviest), radius));
        }
        return lowered(step);
    }
    /// Of bodies that touch others, where that is less than `most`.
    StableStep of_touching(Real most) {
        hold_doubtful(most);
        const StableStep step{most, "the step taken"};
        return own_.empty() ? step : lowered(step);
    }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

    /// One body's side of a contact.
    struct End {
        Index body;
        Vec3 normal, arm;
        LinkRigidity link;
        bool partner_moves, single;          ///< the latter: a body of one sphere
        Real inverse_mass, inverse_inertia;  ///< the latter the largest
        /// Bounds the largest eigenvalue of the link's share of K or C. On a single sphere what acts along
        /// the normal does not turn it, so the two springs act in directions of their own.
        Real most(Real along, Real across, Real rolling) const noexcept {
            const Real lever = single ? 0 : arm.cross(normal).squaredNorm() * inverse_inertia;
            const Real pushing = along * (inverse_mass + lever),
                       sliding = across * (inverse_mass + arm.squaredNorm() * inverse_inertia);
            return (partner_moves ? 2 : 1) *
                   ((single ? std::max(pushing, sliding) : pushing + sliding) + rolling * inverse_inertia);
        }
    };

    void hold(Index body) {
        if (held_[at(body)] >= 0 || state_.particles.inverse_mass[at(body)] == 0) return;
        held_[at(body)] = static_cast<Index>(own_.size());
        own_.emplace_back();
    }
    /// Those that a cheap bound on their matrix does not show to be stable at the step `most` [s]: the sum
    /// over their contacts. It leaves out bonds, so concrete is held with its first contact.
    void hold_doubtful(Real most) {
        std::vector<Real> sum(at(state_.particles.bodies()), 0);
        each_contact_end([&](const End& end) {
            sum[at(end.body)] +=
                square(most) * end.most(end.link.normal, end.link.tangential, end.link.turning) +
                4 * most *
                    end.most(end.link.normal_dashpot, end.link.tangential_dashpot, end.link.turning_dashpot);
        });
        for (Index b = 0; b < state_.particles.bodies(); ++b)
            if (!(sum[at(b)] <= (state_.particles.site[at(b)] >= 0 ? 0 : 4))) hold(b);
    }
    BodyStiffness::Body body_of(Index b) const {
        const Index clump = state_.store.clump_of(b);
        return detail::stiff_body(
            state_.particles, b,
            clump < 0 ? Quaternion(Quaternion::Identity()) : state_.store.clumps[at(clump)].orientation);
    }

    StableStep lowered(StableStep step) {
        const auto add = [&](Index b, const Vec3& n, const Vec3& arm, const LinkRigidity& link, bool moves) {
            const Index own = held_[at(b)];
            if (own >= 0) own_[at(own)].add(body_of(b), n, arm, link, moves);
        };
        each_contact_end([&](const End& e) { add(e.body, e.normal, e.arm, e.link, e.partner_moves); });
        detail::each_end(state_.network, state_.policies.bond, state_.particles, add);
        for (Index b = 0; b < state_.particles.bodies(); ++b) {
            if (held_[at(b)] < 0) continue;
            const bool bonded = state_.particles.kind[at(b)] == Kind::concrete;
            step.lower(own_[at(held_[at(b)])].step(step.seconds),
                       bonded ? "bonds and contacts as they stand" : "contacts as they stand", b);
        }
        return step;
    }

    /// One contact of each body with one like it, at any point of its surface; of a stone with a sphere that
    /// bonds hold, where that makes the dashpot stronger.
    StableStep first_touch(Real most) const {
        StableStep step{most, "nothing moves"};
        const Particles& p = state_.particles;
        for (Index b = 0; b < p.bodies(); ++b) {
            const auto i = at(b);
            if (p.inverse_mass[i] == 0) continue;
            const detail::Extent extent = detail::extent_of(p, b);
            const ContactRigidity touch = state_.policies.contact.rigidity(extent.largest);
            const Real share = damps_free_mass(state_.policies.contact) && p.site[i] < 0 ? 1 : 0.5;
            const LinkRigidity link = detail::link_of(touch, share * p.mass[i], extent.largest);
            const Real inverse_inertia = p.inverse_inertia[i].maxCoeff();
            const bool sphere = p.sphere_count[i] == 1;
            const Real turning = p.inverse_mass[i] + square(extent.reach) * inverse_inertia;
            const auto strongest = [&](Real along, Real across, Real rolling) {
                return 2 * (std::max(along * (sphere ? p.inverse_mass[i] : turning), across * turning) +
                            rolling * inverse_inertia);
            };
            step.lower(
                damped_step(strongest(link.normal, link.tangential, link.turning),
                            strongest(link.normal_dashpot, link.tangential_dashpot, link.turning_dashpot)),
                "first touch of the lightest stone", b);
        }
        return step;
    }

    template <class Visit>
    void each_contact_end(Visit&& visit) const {
        const HotArrays& lines = state_.store.lines;
        state_.contacts.each_touching([&](const auto& touching) {
            const SlotPair& pair = touching.pair;
            const auto& law = law_between(state_.policies.contact, touching.materials);
            const auto contact = contact_seen_by(law, lines, state_.scene.walls, touching, 0);
            if (!(contact.inverse_mass > 0)) return;
            const ContactRigidity touch = rigidity_of(law, contact, lines.place[at(pair.first)].radius);
            const auto link = detail::link_of(touch, 1 / contact.inverse_mass, 1 / contact.curvature);
            const Real first_mass = lines.motion[at(pair.first)].inverse_mass;
            const Real second_mass = pair.second < 0 ? 0 : lines.motion[at(pair.second)].inverse_mass;
            const auto end = [&](Index slot, Real sign, bool partner_moves) {
                const Index owner = state_.store.owner_of(slot);
                const Index body = state_.particles.body[at(state_.store.sphere_of(owner))];
                const SpherePlace& place = lines.place[at(owner)];
                const Vec3 from_centre = place.centre - state_.store.position_of(state_.particles, body);
                visit(End{body, contact.normal, Vec3(from_centre + sign * place.radius * contact.normal),
                          link, partner_moves, state_.particles.sphere_count[at(body)] == 1,
                          state_.particles.inverse_mass[at(body)],
                          state_.particles.inverse_inertia[at(body)].maxCoeff()});
            };
            if (first_mass > 0) end(pair.first, -1, second_mass > 0);
            if (second_mass > 0) end(pair.second, 1, first_mass > 0);
        });
    }
    template <class Law>
    static ContactRigidity rigidity_of(const Law& law, const ContactKinematics<Real>& contact, Real radius) {
        if constexpr (KnowsRigidityAsItStands<Law>)
            return law.rigidity(contact);
        else
            return law.rigidity(radius);
    }

    const State<P>& state_;
    std::vector<Index> held_;         ///< [body] its place in own_, -1: not looked at
    std::vector<BodyStiffness> own_;  ///< of the bodies looked at
};

}  // namespace abrade
