#pragma once
// The largest stable time step of a scene, from its masses and springs.

#include <abrade/bond/network.hpp>
#include <abrade/sim/feed.hpp>

#include <limits>
#include <string_view>

namespace abrade {

struct StableStep {
    Real seconds = std::numeric_limits<Real>::infinity();
    std::string_view limit = "nothing moves";  ///< what sets it

    void lower(Real candidate, std::string_view reason) noexcept {
        if (candidate < seconds) seconds = candidate, limit = reason;
    }
};

namespace detail {

/// Stiffness and damping that act on one sphere, as a matrix over (displacement, rotation x radius) divided
/// by (mass, inertia / radius^2). Twice the largest row sum bounds omega^2 of the whole system: a spring
/// 1/2 k |a_i - a_j|^2 is at most k (|a_i|^2 + |a_j|^2), and no eigenvalue exceeds the largest row sum
/// (S. Gerschgorin, 1931).
class SphereStiffness {
public:
    explicit SphereStiffness(Real mass) noexcept : per_mass_(1 / mass), per_inertia_(1 / (0.4 * mass)) {}

    /// A link along the unit vector n, at one radius from the centre.
    void add(const Vec3& n, Real normal, Real tangential) noexcept {
        const Mat3 along = n * n.transpose();
        const Mat3 across = Mat3::Identity() - along;
        translation_ += normal * along + tangential * across;
        rotation_ += tangential * across;
        lever_ += tangential * n;
    }
    /// `count` links from anywhere.
    void add_anywhere(int count, Real normal, Real tangential) noexcept {
        translation_.diagonal().array() += count * std::max(normal, tangential);
        rotation_.diagonal().array() += count * tangential;
    }

    Real bound() const noexcept {
        const Real coupling = lever_.cwiseAbs().sum() * std::sqrt(per_mass_ * per_inertia_);
        const Real moving = translation_.cwiseAbs().rowwise().sum().maxCoeff() * per_mass_;
        const Real turning = rotation_.cwiseAbs().rowwise().sum().maxCoeff() * per_inertia_;
        return 2 * (std::max(moving, turning) + coupling);
    }

private:
    Real per_mass_, per_inertia_;
    Mat3 translation_ = Mat3::Zero(), rotation_ = Mat3::Zero();
    Vec3 lever_ = Vec3::Zero();
};

/// 2 / (sqrt(omega^2 + c^2) + c) for omega^2 and c bounded as above. c counts in full, not by half: dashpots
/// see a velocity predicted from the last acceleration.
inline Real damped_step(Real omega2, Real c) noexcept { return 2 / (std::sqrt(omega2 + c * c) + c); }

}  // namespace detail

/// A clump is as stable as a sphere of this mass: its own, or what its smallest inertia amounts to at its
/// farthest point.
inline Real stability_mass(Real mass, Real smallest_inertia, Real bounding_radius) noexcept {
    return std::min(mass, smallest_inertia / (0.4 * square(bounding_radius)));
}

/// Stable step of bodies under a contact law, and of bonded spheres under the bonds that they really have
/// and up to two contacts more.
template <ContactPolicy C, BondLaw B>
StableStep stable_step(const C& contact, const B& bond, const Particles& particles, const Network<B>& network,
                       const std::optional<FeedParams>& feed) {
    StableStep step;
    const auto at = [](Index i) { return static_cast<std::size_t>(i); };
    const auto dashpot = [](Real ratio, Real k, Real mass) { return 2 * ratio * std::sqrt(k * mass); };
    std::vector<Index> held(at(particles.bodies()), -1);  // [body] its place among those below
    std::vector<detail::SphereStiffness> stiffness, damping;
    for (const auto& bonded : network.bonds()) {
        const Vec3 n =
            (particles.centre[at(bonded.spheres.first)] - particles.centre[at(bonded.spheres.second)])
                .normalized();
        for (const Index body : {bonded.bodies.first, bonded.bodies.second}) {
            if (particles.inverse_mass[at(body)] == 0) continue;
            if (held[at(body)] < 0) {
                held[at(body)] = static_cast<Index>(stiffness.size());
                stiffness.emplace_back(particles.mass[at(body)]),
                    damping.emplace_back(particles.mass[at(body)]);
            }
            stiffness[at(held[at(body)])].add(n, bond.stiffness(), bond.tangential_stiffness());
            damping[at(held[at(body)])].add(
                n, dashpot(bond.damping_ratio(), bond.stiffness(), bonded.effective_mass),
                dashpot(bond.damping_ratio(), bond.tangential_stiffness(), bonded.effective_mass));
        }
    }
    for (Index b = 0; b < particles.bodies(); ++b) {
        const auto i = at(b);
        if (particles.inverse_mass[i] == 0) continue;
        const Real mass = particles.mass[i];
        if (held[i] < 0) {
            Real reach = 0;
            for (Index s = particles.first_sphere[i];
                 s < particles.first_sphere[i] + particles.sphere_count[i]; ++s)
                reach = std::max(reach, particles.offset[at(s)].norm() + particles.radius[at(s)]);
            step.lower(contact.stable_dt(
                           stability_mass(mass, 1 / particles.inverse_inertia[i].maxCoeff(), reach), reach),
                       "contacts of the lightest stone");
            continue;
        }
        const Real radius = particles.radius[at(particles.first_sphere[i])];
        const ContactRigidity touch = contact.rigidity(radius);
        detail::SphereStiffness &k = stiffness[at(held[i])], &c = damping[at(held[i])];
        k.add_anywhere(2, touch.normal, touch.tangential + touch.rolling);
        c.add_anywhere(2, dashpot(touch.damping_ratio, touch.normal, mass),
                       dashpot(touch.damping_ratio, touch.tangential, mass));
        step.lower(detail::damped_step(k.bound(), c.bound()), "bonded concrete");
        step.lower(contact.stable_dt(mass, radius), "contacts of loose concrete");
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

}  // namespace abrade
