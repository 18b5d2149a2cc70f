#pragma once
// What a contact law sees, what it answers, and the concept that joins the two.
//
// Sign convention, everywhere: the normal points from j to i, overlap > 0 in contact, compression is
// positive, `force` is the force on i, `velocity` is that of i relative to j at the contact point.

#include <abrade/core/law.hpp>
#include <abrade/core/pack.hpp>

namespace abrade {

/// One pair of touching (or nearly touching) bodies at time t_n.
template <class Number>
struct ContactKinematics {
    Vec3Of<Number> normal;    ///< unit, from j to i
    Number overlap;           ///< [m], > 0 in contact
    Vec3Of<Number> velocity;  ///< of i relative to j at the contact point [m/s]
    Number effective_mass;    ///< m_i m_j / (m_i + m_j) [kg]
    Number effective_radius;  ///< r_i r_j / (r_i + r_j) [m]
    Real time_step;           ///< [s]
    /// Of i relative to j at the contact point, over the step that led here [m]: dt times the velocity
    /// halfway, which is what the positions really did. A spring fed with anything else gains or loses
    /// energy.
    Vec3Of<Number> travel = Vec3Of<Number>::Zero();
};

/// The answer. Losses are energies over the step that is centred on t_n, and are never negative.
template <class Number>
struct ContactLoad {
    Vec3Of<Number> force;    ///< on i [N]
    Number stored;           ///< elastic energy, a state function [J]
    Number lost_normal;      ///< [J]
    Number lost_tangential;  ///< [J]
};

template <class Number, class Memory>
struct ContactResponse {
    ContactLoad<Number> load;
    Memory memory;  ///< to be handed back at the next step; committed by the engine
};

/// A contact law is a pure function of kinematics and memory.
/// - `Memory<Number>` value-initialises to "no contact yet";
/// - `respond` handles overlap <= 0 too: no force, the memory cleared, what it still stored booked as lost;
/// - `stable_dt(mass, radius)` is a time step [s] that is safe for a sphere of that mass and radius in the
///   densest surroundings;
/// - `stiffness()`, `tangential_stiffness()` [N/m] and `damping_ratio()` [-] let the engine sum up what acts
/// on
///   one body.
// clang-format off
template <class L>
concept RemembersContacts = requires { typename L::template Memory<Real>; } &&
    std::default_initializable<typename L::template Memory<Real>>;

template <class L>
concept ContactLaw = Law<L> && RemembersContacts<L> && requires(const L& law, const ContactKinematics<Real>& contact,
                                        const typename L::template Memory<Real>& memory) {
    { law.respond(contact, memory) } noexcept -> std::same_as<ContactResponse<Real, typename L::template Memory<Real>>>;
    { law.stable_dt(Real{}, Real{}) } -> std::same_as<Real>;
    { law.stiffness() } -> std::same_as<Real>;
    { law.tangential_stiffness() } -> std::same_as<Real>;
    { law.damping_ratio() } -> std::same_as<Real>;
};
// clang-format on

// --- pieces that contact and bond laws share -------------------------------------------------------

/// A tangential spring carried along with the contact: laid into the present tangent plane without
/// changing its length, so that the rotation of the frame neither makes nor loses energy.
template <class Number>
Vec3Of<Number> turn_into_plane(const Vec3Of<Number>& spring, const Vec3Of<Number>& normal) noexcept {
    const Number length2 = spring.dot(spring);
    const Vec3Of<Number> flat = spring - spring.dot(normal) * normal;
    const Number flat2 = flat.dot(flat);
    const Number scale = select(flat2 > tiny<Number>, sqrt(length2 / max(flat2, tiny<Number>)), Number(0));
    return scale * flat;
}

/// How much of the step that led to t_n a contact has lasted: 1, but for the step in which it begins, tau =
/// overlap / approach before t_n. Springs count the way since then only; dashpots, whose step is centred on
/// t_n, act for tau + dt/2. Without this, restitution is of first order in dt.
template <class Number>
Number begun_share(Number overlap, Number approach, Real dt) noexcept {
    const Number way = approach * Number(dt);
    return select(overlap < way, overlap / max(way, tiny<Number>), Number(1));
}

/// Spring and dashpot along the normal, without tension.
template <class Number>
struct NormalSpring {
    Number force;   ///< >= 0 [N]
    Number stored;  ///< [J]
    Number lost;    ///< over the step [J]

    /// f = max(k overlap + c v, 0), v the speed of approach; what the clamp holds back of the spring's
    /// push while it relaxes is lost, like what the dashpot takes.
    static NormalSpring at(Number overlap, Number approach, Number stiffness, Number dashpot,
                           Real dt) noexcept {
        const Number push = stiffness * overlap;
        const Number force = max(push + dashpot * approach, Number(0));
        return {force, Number(0.5) * push * overlap, max((force - push) * approach, Number(0)) * Number(dt)};
    }
};

/// A tangential spring and dashpot held under a limit by a slider (Coulomb).
template <class Number>
struct SlidingSpring {
    Vec3Of<Number> force;   ///< on i [N]
    Vec3Of<Number> spring;  ///< what is left in the spring at t_n [m]
    Number stored;          ///< [J]
    Number lost;            ///< by dashpot and slider together, over the step [J], >= 0

    /// Elastic, perfectly plastic: the spring gives way at |k s| = limit; what slips, |trial| - |s|, does so
    /// against the mean of the spring's force `before` the step and after it, which books sliding and
    /// release by a falling limit alike to second order. The dashpot acts only as far as the limit leaves it
    /// room. Unlike the usual form, which stretches the spring backwards to make room for the dashpot, this
    /// never books a negative loss.
    static SlidingSpring at(const Vec3Of<Number>& before, const Vec3Of<Number>& trial,
                            const Vec3Of<Number>& slip, Number limit, Number stiffness, Number dashpot,
                            Real dt) noexcept {
        const Number length = sqrt(trial.dot(trial)), kept = min(length, limit / stiffness);
        const Vec3Of<Number> spring = (kept / max(length, tiny<Number>)) * trial;
        const Number start = sqrt(before.dot(before));
        // Largest share c <= 1 of the dashpot with |k s + c g v| <= limit: a quadratic in c.
        const Number a = dashpot * dashpot * slip.dot(slip);
        const Number b = stiffness * dashpot * spring.dot(slip);
        const Number room = max(limit * limit - stiffness * stiffness * kept * kept, Number(0));
        const Number share = select(
            a > tiny<Number>, min(Number(1), (sqrt(b * b + a * room) - b) / max(a, tiny<Number>)), Number(0));
        return {-stiffness * spring - share * dashpot * slip, spring, Number(0.5) * stiffness * kept * kept,
                Number(0.5) * stiffness * (start + kept) * (length - kept) +
                    share * dashpot * slip.dot(slip) * Number(dt)};
    }
};

}  // namespace abrade
