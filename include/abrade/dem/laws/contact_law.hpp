#pragma once
// What a contact law sees, what it answers, and the concept that joins the two.
//
// Sign convention, everywhere: the normal points from j to i, overlap > 0 in contact, compression is
// positive, `force` is the force on i, `velocity` is that of i relative to j at the contact point.

#include <abrade/core/law.hpp>
#include <abrade/core/simd.hpp>

#include <compare>

namespace abrade {

/// One pair of touching (or nearly touching) bodies at time t_n.
template <class Number>
struct ContactKinematics {
    Vec3Of<Number> normal;    ///< unit, from j to i
    Number overlap;           ///< [m], > 0 in contact
    Vec3Of<Number> velocity;  ///< of i relative to j at the contact point [m/s]
    /// 1/m_i + 1/m_j, one over the effective mass [1/kg]; a law that `damps_free_mass`, and the wear law
    /// beside it, see the sum over what is free.
    Number inverse_mass;
    Number curvature;  ///< 1/r_i + 1/r_j, one over the effective radius [1/m]
    Real time_step;    ///< [s]
    /// Of i relative to j at the contact point, over the step that led here [m]: dt times the velocity
    /// halfway, which is what the positions really did. A spring fed with anything else gains or loses
    /// energy.
    Vec3Of<Number> displacement = Vec3Of<Number>::Zero();
    /// 1 where the two touched when last evaluated, 0 where the contact begins. Told of contacts with
    /// concrete alone: wear laws count impacts by it.
    Number touched = Number(1);

    // What laws that resist rolling see beside (`ResistsRolling`); nobody fills it in for the others.
    Vec3Of<Number> spin = Vec3Of<Number>::Zero();      ///< angular velocity of i relative to j [rad/s]
    Vec3Of<Number> rotation = Vec3Of<Number>::Zero();  ///< as `displacement`: dt times the spin halfway [rad]
    Number inverse_turning = Number(0);                ///< 1/(m_i r_i^2) + 1/(m_j r_j^2) [1/(kg m2)]
};

/// The answer. Losses are energies over the step that is centred on t_n, and are never negative.
template <class Number>
struct ContactLoad {
    Vec3Of<Number> force;    ///< on i [N]
    Number stored;           ///< elastic energy, a state function [J]
    Number lost_normal;      ///< [J]
    Number lost_tangential;  ///< [J]

    // Of laws that resist rolling alone.
    Vec3Of<Number> couple = Vec3Of<Number>::Zero();  ///< on i, its opposite on j [N m]
    Number lost_rolling = Number(0);                 ///< [J]

    // Of laws that act before surfaces touch alone.
    Vec3Of<Number> film = Vec3Of<Number>::Zero();  ///< what is in `force` of the film between them [N]
    Number lost_film = Number(0);                  ///< [J]
};

/// What a law answers: the load, and what it wants to remember.
template <class Number, class Memory>
struct ContactResponse {
    ContactLoad<Number> load;
    Memory memory;  ///< to be handed back at the next step; committed by the engine
};

/// How stiff a contact of a sphere is at most, for what has to be sized beforehand.
struct ContactRigidity {
    Real normal = 0, tangential = 0;  ///< [N/m]
    Real damping_ratio = 0;           ///< share of critical damping [-]
    Real rolling = 0;                 ///< of a rolling spring, over radius^2 [N/m]
    Real rolling_damping_ratio = 0;   ///< share of critical damping [-]
};

/// A step [s] to begin with for a sphere that may come into the midst of twelve others, the most that can
/// touch it. With k_n, k_t the springs, m the mass and dashpots c = 2 zeta sqrt(k m/2):
///   dt = 2 / (sqrt(omega^2 + c^2) + c),
///   omega^2 = max(8 (k_n + 2 k_t), 40 (k_t + k_r)) / m,  c = max(2 (c_n + 2 c_t), 10 (c_t + c_r)) / m.
/// omega^2: twice the stiffness of twelve contacts, of which four point along any axis (8 k_n) while all
/// twelve hold it from turning, against the inertia 0.4 m r^2; k_r, c_r of a rolling spring, over r^2, with
/// c_r = 2 zeta sqrt(1.4 m k_r) as on a plane. c is that of three contacts: collisions, not pressed beds.
/// What contacts allow as they stand is for the engine to see (sim/guards/stability.hpp).
inline Real stable_dt_among_twelve(const ContactRigidity& contact, Real mass) noexcept {
    const Real kn = contact.normal, kt = contact.tangential;
    const Real root = 2 * contact.damping_ratio * std::sqrt(0.5 * mass);
    const Real cn = root * std::sqrt(kn), ct = root * std::sqrt(kt);
    const Real kr = contact.rolling, cr = 2 * contact.rolling_damping_ratio * std::sqrt(1.4 * mass * kr);
    const Real omega2 = std::max(8 * (kn + 2 * kt), 40 * (kt + kr)) / mass;
    const Real c = std::max(2 * (cn + 2 * ct), 10 * (ct + cr)) / mass;
    return 2 / (std::sqrt(omega2 + c * c) + c);
}

// clang-format off
/// Has a `Memory<Number>` that value-initialises to "no contact yet".
template <class L>
concept RemembersContacts = requires { typename L::template Memory<Real>; } &&
    std::default_initializable<typename L::template Memory<Real>>;

/// A contact law is a pure function of kinematics and memory.
/// - `respond` handles overlap <= 0 too: no force, the memory cleared, what it still stored booked as lost;
/// - `stable_dt(mass, radius)` is a time step [s] to begin with, for a sphere of that mass and radius in
///   dense surroundings;
/// - `rigidity(radius)` lets the engine sum up what acts on one body. A law whose contacts stiffen also
///   offers `rigidity(contact)`, of a contact as it stands.
template <class L>
concept ContactLaw = Law<L> && RemembersContacts<L> && requires(const L& law, const ContactKinematics<Real>& contact,
                                        const typename L::template Memory<Real>& memory) {
    { law.respond(contact, memory) } noexcept -> std::same_as<ContactResponse<Real, typename L::template Memory<Real>>>;
    { law.stable_dt(Real{}, Real{}) } -> std::same_as<Real>;
    { law.rigidity(Real{}) } -> std::same_as<ContactRigidity>;
};

/// Tells the rigidity of a contact as it stands, where that changes with the overlap.
template <class L>
concept KnowsRigidityAsItStands = requires(const L& law, const ContactKinematics<Real>& contact) {
    { law.rigidity(contact) } -> std::same_as<ContactRigidity>;
};
// clang-format on

namespace detail {
template <class L>
struct PairLawOf {
    using type = L;
};
template <class L>
requires requires { typename L::OfPair; }
struct PairLawOf<L> {
    using type = typename L::OfPair;
};
}  // namespace detail

/// The law that answers one contact: of a table of laws (dem/laws/material_pairs.hpp) what it holds, of any
/// other that law itself.
template <class L>
using PairLaw = typename detail::PairLawOf<L>::type;

/// What may stand in the contact slot: a contact law, or a table of them by materials.
// clang-format off
template <class L>
concept ContactPolicy = Law<L> && ContactLaw<PairLaw<L>> && requires(const L& laws) {
    { laws.stable_dt(Real{}, Real{}) } -> std::same_as<Real>;
    { laws.rigidity(Real{}) } -> std::same_as<ContactRigidity>;
};
// clang-format on

/// What the two of a contact are made of: numbers into a table of laws, the smaller first.
struct MaterialPair {
    Index low = 0, high = 0;
    static constexpr MaterialPair of(Index a, Index b) noexcept {
        return a < b ? MaterialPair{a, b} : MaterialPair{b, a};
    }
    auto operator<=>(const MaterialPair&) const = default;
};

/// The one law that is meant.
template <class L>
const PairLaw<L>& law_between(const L& laws, [[maybe_unused]] MaterialPair materials) noexcept {
    if constexpr (std::same_as<PairLaw<L>, L>)
        return laws;
    else
        return laws.between(materials);
}

/// Asks for the spin of its contacts and answers with a couple. `resists_rolling` may be left out.
template <class L>
concept ResistsRolling = L::resists_rolling;

// clang-format off
/// Acts on surfaces that are nearer than `range()` [m] already. May be left out.
template <class L>
concept ActsBeforeTouch = requires(const L& law) {
    { law.range() } noexcept -> std::same_as<Real>;
};
// clang-format on

/// The gap from which on a law, or one of a table, acts [m]; 0: surfaces must touch.
template <class L>
Real range_of(const L& law) noexcept {
    if constexpr (ActsBeforeTouch<L>)
        return law.range();
    else
        return 0;
}

// clang-format off
/// Can be told to set its dashpots by the mass of what is free (`DampingMass::free`). `damps_free_mass()` may
/// be left out.
template <class L>
concept MayDampFreeMass = requires(const L& law) {
    { law.damps_free_mass() } noexcept -> std::same_as<bool>;
};
// clang-format on

/// Whether a law, or one of a table, sets its dashpots by the mass of what is free.
template <class L>
bool damps_free_mass(const L& law) noexcept {
    if constexpr (MayDampFreeMass<L>)
        return law.damps_free_mass();
    else
        return false;
}

// --- pieces that contact and bond laws share -------------------------------------------------------

/// A tangential spring carried along with the contact: laid into the present tangent plane without
/// changing its length, so that the rotation of the frame neither makes nor loses energy. Then a share of it.
template <class Number>
Vec3Of<Number> turn_into_plane(const Vec3Of<Number>& spring, const Vec3Of<Number>& normal,
                               Number share = Number(1)) noexcept {
    // |flat| = L sqrt(1 - q), q = (s . n)^2 / L^2: tiny from step to step, so a series serves.
    const Number along = spring.dot(normal), length2 = spring.dot(spring), along2 = along * along;
    const Number q = along2 * rough_reciprocal(max(length2, Number(tiny<Number>)));
    const Vec3Of<Number> flat = spring - along * normal;
    const Number scale = Number(1) + q * (Number(0.5) + Number(0.375) * q);
    const auto turns_far = q > Number(1e-6);
    // `unlikely` keeps the numbers of the longer way in registers: g++ lays code out for it, which a bed
    // that relaxes is 5 to 8 % faster for, and others not slower.
    if (!any(turns_far)) [[unlikely]]
        return (scale * share) * flat;
    const Number product = length2 * flat.dot(flat), least = Number(tiny<Number>);
    const Number exact = select(product > least, length2 * rsqrt(max(product, least)), Number(0));
    return (select(turns_far, exact, scale) * share) * flat;
}

/// How much of the step that led to t_n a contact has lasted: 1, but for the step in which it begins, tau =
/// overlap / approach before t_n. Springs count the way since then only; dashpots, whose step is centred on
/// t_n, act for tau + dt/2. Without this, restitution is of first order in dt.
template <class Number>
Number begun_share(Number overlap, Number approach, Real dt) noexcept {
    const Number way = approach * Number(dt);
    const auto begins = overlap < way;
    if (!any(begins)) return Number(1);
    return select(begins, overlap / max(way, Number(tiny<Number>)), Number(1));
}

/// A spring that pushes with `push` and holds `stored`, and a dashpot beside it, along the normal.
template <class Number>
struct NormalSpring {
    Number force;   ///< [N]
    Number stored;  ///< [J]
    Number lost;    ///< over the step [J], >= 0

    /// Without tension: f = max(push + c v, 0), v the speed of approach. What the clamp holds back of the
    /// spring's push while it relaxes is lost, like what the dashpot takes.
    static NormalSpring pushing(Number push, Number stored, Number dashpot, Number approach,
                                Real dt) noexcept {
        const Number force = max(push + dashpot * approach, Number(0));
        return {force, stored, max((force - push) * approach, Number(0)) * Number(dt)};
    }
    /// With tension: f = push + c v.
    static NormalSpring pulling(Number push, Number stored, Number dashpot, Number approach,
                                Real dt) noexcept {
        const Number damping = dashpot * approach;
        return {push + damping, stored, damping * approach * Number(dt)};
    }
};

/// How far a contact had been pressed before this step [m], of laws that lose by yielding: the largest
/// overlap that it remembers. A contact that remembers none has come as far as the way of this step; what
/// overlaps more was found pressed, at the start of a run or as a bond broke, and its dent cost nobody any
/// work.
template <class Number>
Number pressed_before(const ContactKinematics<Number>& contact, Number deepest) noexcept {
    const Number came = max(-contact.displacement.dot(contact.normal), Number(0));
    return select(deepest > Number(0), deepest, max(contact.overlap - came, Number(0)));
}

/// The normal force of laws that lose by yielding, with the dashpot for rest beside it. `push` is the force
/// of the branch, `loading` that of the virgin line at the largest overlap so far: they are equal on that
/// line. Below it, while the contact is loaded again, the dashpot adds f_v = min(c v, push, loading - push),
/// v > 0 the speed of approach. Nothing is added on the virgin line nor while the contact unloads, so an
/// impact never meets the dashpot; at both ends of the branch the force is continuous.
template <class Number>
struct Reloading {
    Number force;  ///< [N]
    Number lost;   ///< to the dashpot, over the step [J], >= 0

    static Reloading at(Number push, Number loading, Number dashpot, Number approach, Real dt) noexcept {
        const Number speed = max(approach, Number(0)), room = max(min(push, loading - push), Number(0));
        const Number damping = min(dashpot * speed, room);
        return {push + damping, damping * speed * Number(dt)};
    }
};

/// A spring whose stiffness k follows the contact and which makes no energy: while k grows the spring
/// shortens so that its force stays, and the way adds to it at the mean k of the step (for an overlap that
/// grows evenly); while k falls the spring stays.
template <class Number>
struct FollowingStiffness {
    Number before, now;  ///< k of the step before, of this one [N/m]
    Number grown;        ///< 1 - k_before / k_now while k grows, else 0 [-]
    Number mean;         ///< k over the step, over k_now [-]

    static FollowingStiffness of(Number before, Number now, Number one_over_now) noexcept {
        const Number grown = max(Number(1) - before * one_over_now, Number(0));
        return {before, now, grown, Number(1) - grown * (Number(0.5) - grown * Number(1.0 / 6))};
    }
    static FollowingStiffness constant(Number k) noexcept { return {k, k, Number(0), Number(1)}; }

    /// What the spring gives up [J]: 1/2 k s^2 before, plus the work of the mean force over the way, less 1/2
    /// k s^2 now and what the slider booked. `length2` is s^2 before; `carried` the spring shortened and
    /// turned, `left` what the slider left of it, `begun` as in `begun_share`. As k grows or falls, one of
    /// the two is 0.
    Number given_up(Number length2, const Vec3Of<Number>& carried, const Vec3Of<Number>& left,
                    const Vec3Of<Number>& way, Number begun) const noexcept {
        const Number stiffened = now * (Number(1) - mean), softened = max(before - now, Number(0));
        const Number work = (stiffened + softened) * carried.dot(way) + stiffened * left.dot(way);
        return Number(0.5) * ((before * grown + softened) * length2 + begun * work);
    }
};

/// A tangential spring and dashpot held under a limit by a slider (Coulomb).
template <class Number>
struct SlidingSpring {
    Vec3Of<Number> force;   ///< on i [N]
    Vec3Of<Number> spring;  ///< what is left in the spring at t_n [m]
    Number stored;          ///< [J]
    Number lost;            ///< by dashpot and slider together, over the step [J], >= 0

    /// Elastic, perfectly plastic: the spring gives way at |k s| = limit; what slips, trial - s, does so
    /// against the mean of the spring's force `before` the step and after it, which books sliding and
    /// release by a falling limit alike to second order. The dashpot acts only as far as the limit leaves it
    /// room. Unlike the usual form, which stretches the spring backwards to make room for the dashpot, this
    /// never books a negative loss.
    static SlidingSpring at(const Vec3Of<Number>& before, const Vec3Of<Number>& trial,
                            const Vec3Of<Number>& slip, Number limit, Number k, Number dashpot,
                            Real dt) noexcept {
        const Number trial2 = trial.dot(trial), slip2 = slip.dot(slip), least = Number(tiny<Number>);
        // |k s + c v|^2 = elastic2 + 2 both + damping2.
        const Number elastic2 = k * k * trial2, damping2 = dashpot * dashpot * slip2;
        const Number both = k * dashpot * trial.dot(slip), limit2 = limit * limit;
        const auto slides = (elastic2 + (both + both) + damping2 > limit2) | (elastic2 > limit2);

        // With the share of the spring that is kept, and that of the dashpot that acts.
        const auto answer = [&](Number kept, Number acting, Number slipped) -> SlidingSpring {
            const Vec3Of<Number> left = kept * trial;
            const Number damping = acting * dashpot;
            return {-k * left - damping * slip, left, Number(0.5) * k * kept * kept * trial2,
                    slipped + damping * slip2 * Number(dt)};
        };
        if (!any(slides)) [[unlikely]]  // as in `turn_into_plane`
            return answer(Number(1), Number(1), Number(0));

        // Roots and divisions of the machine: their unit is idle, and this waits for them.
        const Number kept = select(slides, min(Number(1), limit / sqrt(max(elastic2, least))), Number(1));
        const Number slipped =
            max(Number(0.5) * k * (Number(1) - kept) * (before.dot(trial) + kept * trial2), Number(0));
        // The largest share g <= 1 with |k s + g c v| <= limit: a quadratic in g. Either the spring is kept
        // whole or it leaves no room, so the root need not wait for the share that is kept.
        const Number room = max(limit2 - elastic2, Number(0));
        const Number most =
            kept * (max(sqrt(both * both + damping2 * room) - both, Number(0)) / max(damping2, least));
        const Number acting = select(damping2 > least, min(Number(1), most), Number(0));
        return answer(kept, select(slides, acting, Number(1)), slipped);
    }
};

}  // namespace abrade
