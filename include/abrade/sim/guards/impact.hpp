#pragma once
// Two bodies that press each other too far: how fast they met, and which step, springs or speed would have
// kept them apart.

#include <abrade/dem/laws/contact_law.hpp>

#include <algorithm>

namespace abrade {

/// A pair as it stood when its overlap was found too deep.
struct DeepContact {
    Real reach = 0, smaller_radius = 0;  ///< sum of the radii; a plane adds nothing [m]
    Vec3 apart = Vec3::Zero();           ///< from the second centre, or from the plane, to the first [m]
    bool on_plane = false;
    Vec3 velocity = Vec3::Zero();          ///< of the first, over the step that led here, likewise [m/s]
    Real slowing = 0;                      ///< what the approach falls by under all that acts [m/s2]
    Real inverse_mass = 0, curvature = 0;  ///< as the law sees them [1/kg], [1/m]
    Real inverse_mass_along = 0;           ///< along the normal, with the turning that a lever allows [1/kg]
    MaterialPair materials{};
};

/// What would have been enough, for the two alone.
struct ImpactRemedy {
    Real met_at = 0;          ///< [m/s]; 0: no impact, something presses them together
    Real deepest = 0;         ///< overlap over the smaller radius when integrated exactly [-]
    Real time_step = 0;       ///< the largest found to stay below the limit [s]; 0: none does
    Real speed = 0;           ///< up to which the step taken stays below the limit [m/s]
    Real times_as_stiff = 1;  ///< springs that do, with a step shorter by the root of this
};

/// The pair integrated alone and head-on, as the engine does it: leapfrog, dashpots at the predicted
/// velocity. Under any law whose forces are proportional to its stiffness and whose restitution is given, a
/// stiffness s times as large acts like a speed sqrt(s) times smaller, with time running sqrt(s) times
/// faster. So the speed that stays below a limit also tells the stiffness that does.
template <ContactLaw Law>
class ImpactInquiry {
public:
    ImpactInquiry(const Law& law, const DeepContact& pair, Real time_step, Real limit)
        : law_(law), pair_(pair), dt_(time_step), limit_(limit) {}

    ImpactRemedy remedy() const {
        ImpactRemedy found;
        // What slows an impact down is the contact itself; what is merely pressed, others hold in place.
        Memory none{};
        const Real approach = -pair_.velocity.dot(pair_.apart.normalized());
        const Real own =
            pair_.inverse_mass_along * force(pair_.reach - pair_.apart.norm(), approach, 0, none);
        if (!(pair_.slowing > 0.5 * own)) return found;
        const Real speed = speed_at_touch();
        // A thousandth of the time in which the limit is reached at full speed.
        const Real fine = 1e-3 * limit_ * pair_.smaller_radius / speed;
        const Real exactly = deepest(speed, fine, 0.5);
        if (!(exactly > 0) || stays_below(speed, dt_)) return found;  // alone they would have been well
        found.met_at = speed, found.deepest = exactly;
        if (exactly < 0.99 * limit_) {
            // From below: some coarse steps do, by luck, where finer ones do not.
            constexpr Real longer = 1.05;
            found.time_step = fine;
            while (found.time_step < dt_ && stays_below(speed, longer * found.time_step))
                found.time_step *= longer;
            return found;
        }
        Real high = speed;
        while (found.speed < 0.999 * high) {
            const Real middle = 0.5 * (found.speed + high);
            (stays_below(middle, dt_) ? found.speed : high) = middle;
        }
        found.times_as_stiff = square(speed / found.speed);
        return found;
    }

private:
    using Memory = typename Law::template Memory<Real>;
    static constexpr int most_steps = 1'000'000;

    /// Along the normal [N].
    Real force(Real overlap, Real approach, Real dt, Memory& memory) const noexcept {
        ContactKinematics<Real> contact{};
        contact.normal = Vec3::UnitX();
        contact.overlap = overlap;
        contact.velocity = -approach * Vec3::UnitX();
        contact.inverse_mass = pair_.inverse_mass;
        contact.curvature = pair_.curvature;
        contact.time_step = dt;
        contact.displacement = dt * contact.velocity;
        const auto answer = law_.respond(contact, memory);
        memory = answer.memory;
        return answer.load.force.x();
    }

    /// The way back through the steps taken, to where there was no overlap; of the last one only what was
    /// left to the touch.
    Real speed_at_touch() const noexcept {
        Vec3 apart = pair_.apart, velocity = pair_.velocity;
        const Vec3 up = apart.normalized();
        const auto normal = [&] { return pair_.on_plane ? up : Vec3(apart.normalized()); };
        const auto overlap = [&] { return pair_.reach - apart.dot(normal()); };
        for (int n = 0; n < most_steps; ++n) {
            const Real deep = overlap();
            apart -= dt_ * velocity;
            if (!(overlap() > 0)) {
                // Bisection: where on this step's way did they touch?
                Real low = 0, high = 1;  // shares of the way back
                const Vec3 end = apart + dt_ * velocity;
                for (int k = 0; k < 60 && deep > 0; ++k) {
                    const Real middle = 0.5 * (low + high);
                    apart = end - middle * dt_ * velocity;
                    (overlap() > 0 ? low : high) = middle;
                }
                break;
            }
            Memory none{};
            velocity -= dt_ * pair_.inverse_mass_along *
                        force(overlap(), -velocity.dot(normal()), dt_, none) * normal();
        }
        return -velocity.dot(normal());
    }

    /// Over the smaller radius [-]; the first step that touches does so by `phase` of its way.
    Real deepest(Real speed, Real dt, Real phase) const noexcept {
        Real overlap = phase * speed * dt, before = speed, most = overlap;
        Memory memory{};
        for (int n = 0; n < most_steps && speed > 0; ++n) {
            const Real ahead = speed + 0.5 * (speed - before);
            before = speed;
            speed -= dt * pair_.inverse_mass_along * force(overlap, ahead, dt, memory);
            overlap += speed * dt;
            most = std::max(most, overlap);
        }
        return most / pair_.smaller_radius;
    }
    /// With a margin for phases between those tried.
    bool stays_below(Real speed, Real dt) const noexcept {
        constexpr int phases = 16;
        for (int n = 1; n <= phases; ++n)
            if (!(deepest(speed, dt, static_cast<Real>(n) / phases) < 0.995 * limit_)) return false;
        return true;
    }

    const Law& law_;
    DeepContact pair_;
    Real dt_, limit_;
};

}  // namespace abrade
