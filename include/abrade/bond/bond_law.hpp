#pragma once
// What a bond law sees and answers, its concept, and the null policy.

#include <abrade/dem/contact_law.hpp>

namespace abrade {

enum class Fate : std::uint8_t { intact, tension, shear };

/// Two bonded spheres at time t_n. Signs as in contacts: the normal points from j to i.
struct BondKinematics {
    Vec3 normal = Vec3::UnitZ();   ///< unit, from j to i
    Real compression = 0;          ///< rest length - length [m]; negative in tension
    Vec3 velocity = Vec3::Zero();  ///< of i relative to j, halfway between the spheres [m/s]
    Real radius = 0;               ///< of the bonded spheres (the smaller) [m]
    Real length = 0;               ///< between their centres, unloaded [m]
    Real effective_mass = 0;       ///< [kg]
    Real time_step = 0;            ///< [s]
    Vec3 travel = Vec3::Zero();    ///< of i relative to j, over the step that led here [m]

    // What laws that carry moments see beside (`CarriesMoments`); nobody fills it in for the others.
    Vec3 spin = Vec3::Zero();    ///< angular velocity of i relative to j [rad/s]
    Vec3 turn = Vec3::Zero();    ///< over the step that led here [rad]
    Real effective_inertia = 0;  ///< 1/(1/I_i + 1/I_j) [kg m2]
};

/// How stiff a bond is.
struct BondRigidity {
    Real normal = 0, tangential = 0;  ///< [N/m]
    Real damping_ratio = 0;           ///< share of critical damping [-]
    Real bending = 0, twisting = 0;   ///< of laws that carry moments [N m]
};

/// The answer. Losses are energies over the step centred on t_n, never negative.
struct BondLoad {
    Vec3 force = Vec3::Zero();   ///< on i [N]
    Real stored = 0;             ///< [J]
    Real lost_bond = 0;          ///< damping while intact, and what is released as the bond breaks [J]
    Real lost_normal = 0;        ///< by a broken bond, which is a contact [J]
    Real lost_tangential = 0;    ///< by a broken bond, which is a contact [J]
    Vec3 couple = Vec3::Zero();  ///< on i, its opposite on j; of laws that carry moments alone [N m]
};

template <class Memory>
struct BondResponse {
    BondLoad load;
    Memory memory;
    Fate fate = Fate::intact;  ///< other than intact in the step in which the bond breaks
};

/// A bond law is a pure function of kinematics, what is left of the strength (1 sound, 0 gone), and memory.
/// - `Memory` value-initialises to "sound, unloaded"; `memory.broken` tells what became of it;
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
