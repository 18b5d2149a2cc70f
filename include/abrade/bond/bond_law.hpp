#pragma once
// What a bond law sees and answers, its concept, and the null policy.

#include <abrade/dem/laws/contact_law.hpp>

namespace abrade {

enum class FailureMode : std::uint8_t { intact, tension, shear };

/// The failure modes of a pack of bonds.
struct PackFailureMode {
    PackMask tension{}, shear{};
};

/// Two bonded spheres at time t_n. Signs as in contacts: the normal points from j to i.
template <class Number>
struct BondKinematicsOf {
    Vec3Of<Number> normal{Number(0), Number(0), Number(1)};  ///< unit, from j to i
    Number compression = Number(0);  ///< rest length - length [m]; negative in tension
    /// Of i relative to j at the contact point [m/s]: the arms share the distance of the centres in
    /// proportion to the radii.
    Vec3Of<Number> velocity = Vec3Of<Number>::Zero();
    Number radius = Number(0);          ///< of the bonded spheres (the smaller) [m]
    Number length = Number(0);          ///< between their centres, unloaded [m]
    Number effective_mass = Number(0);  ///< [kg]
    Real time_step = 0;                 ///< [s]
    Vec3Of<Number> displacement =
        Vec3Of<Number>::Zero();  ///< of i relative to j, over the step that led here [m]

    // What laws that carry moments see beside (`CarriesMoments`); nobody fills it in for the others.
    Vec3Of<Number> spin = Vec3Of<Number>::Zero();      ///< angular velocity of i relative to j [rad/s]
    Vec3Of<Number> rotation = Vec3Of<Number>::Zero();  ///< over the step that led here [rad]
    Number effective_inertia = Number(0);              ///< 1/(1/I_i + 1/I_j) [kg m2]
};
using BondKinematics = BondKinematicsOf<Real>;

/// How stiff a bond is.
template <class Number>
struct BondRigidityOf {
    Number normal = Number(0), tangential = Number(0);  ///< [N/m]
    Real damping_ratio = 0;                             ///< share of critical damping [-]
    Number bending = Number(0), twisting = Number(0);   ///< of laws that carry moments [N m]
};
using BondRigidity = BondRigidityOf<Real>;

/// The answer. Losses are energies over the step centred on t_n, never negative.
template <class Number>
struct BondLoadOf {
    Vec3Of<Number> force = Vec3Of<Number>::Zero();  ///< on i [N]
    Number stored = Number(0);                      ///< [J]
    Number lost_bond = Number(0);    ///< damping while intact, and what is released as the bond breaks [J]
    Number lost_normal = Number(0);  ///< by a broken bond, which is a contact [J]
    Number lost_tangential = Number(0);  ///< by a broken bond, which is a contact [J]
    Vec3Of<Number> couple =
        Vec3Of<Number>::Zero();  ///< on i, its opposite on j; of laws that carry moments [N m]
};
using BondLoad = BondLoadOf<Real>;

template <class Number, class Memory>
struct BondResponseOf {
    BondLoadOf<Number> load;
    Memory memory;
    /// Other than intact in the step in which the bond breaks.
    std::conditional_t<std::same_as<Number, Pack>, PackFailureMode, FailureMode> failure{};
};
template <class Memory>
using BondResponse = BondResponseOf<Real, Memory>;

/// A bond law is a pure function of kinematics, what is left of the strength (1 sound, 0 gone), and memory.
/// - `Memory` value-initialises to "sound, unloaded"; `memory.broken` tells what became of it. Laws that are
///   templates on their number type have a `MemoryOf<Number>`, made of Numbers, and broken is 0 or 1;
/// - `strength(left_i, left_j)` joins what is left of the strength of the two spheres;
/// - `rigidity(radius, length)` lets the engine find the stable step of the network.
// clang-format off
template <class B>
concept BondLaw = Law<B> &&
    requires(const B& law, const BondKinematics& bond, const typename B::Memory& memory) {
    requires std::default_initializable<typename B::Memory>;
    { memory.broken } -> std::convertible_to<bool>;
    { law.respond(bond, Real{}, memory) } noexcept -> std::same_as<BondResponse<typename B::Memory>>;
    { law.strength(Real{}, Real{}) } noexcept -> std::same_as<Real>;
    { law.rigidity(Real{}, Real{}) } noexcept -> std::same_as<BondRigidity>;
};
// clang-format on

/// Asks for the spin of its two spheres and answers with a couple. `carries_moments` may be left out.
template <class B>
concept CarriesMoments = B::carries_moments;

/// Its memory is a template on the number type, so that it may answer whole packs of bonds at once.
template <class B>
concept AnswersBondPacks = requires(const B& law, const BondKinematicsOf<Pack>& bond,
                                    const typename B::template MemoryOf<Pack>& memory) {
    { law.respond(bond, Pack{}, memory) }
    noexcept->std::same_as<BondResponseOf<Pack, typename B::template MemoryOf<Pack>>>;
};

/// Nothing is bonded: no memory, no work, no code.
struct NoBond {
    static constexpr std::string_view name = "NoBond";
    using Params = NoParams;
    struct Memory {
        bool broken = false;
    };

    NoBond() = default;
    explicit NoBond(Params) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
    BondResponse<Memory> respond(const BondKinematics&, Real, const Memory&) const noexcept { return {}; }
    Real strength(Real, Real) const noexcept { return 0; }
    BondRigidity rigidity(Real, Real) const noexcept { return {}; }
};

static_assert(BondLaw<NoBond>);
static_assert(!BondLaw<NoParams>);

}  // namespace abrade
