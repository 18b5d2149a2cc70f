#pragma once
// One pack of bonds: lines in, the law's answer, lines out.

#include <abrade/bond/bond_law.hpp>
#include <abrade/dem/contacts/contact_kernel.hpp>

namespace abrade {

namespace detail {

template <class Law>
struct PackBondMemory {
    using type = std::array<typename Law::Memory, pack_lanes>;
};
template <AnswersBondPacks Law>
struct PackBondMemory<Law> {
    using type = typename Law::template MemoryOf<Pack>;
};

inline BondKinematics lane_of(const BondKinematicsOf<Pack>& b, int lane) noexcept {
    return {lane_of(b.normal, lane),
            b.compression[lane],
            lane_of(b.velocity, lane),
            b.radius[lane],
            b.length[lane],
            b.effective_mass[lane],
            b.time_step,
            lane_of(b.displacement, lane),
            lane_of(b.spin, lane),
            lane_of(b.rotation, lane),
            b.effective_inertia[lane]};
}

}  // namespace detail

/// How the two of a bond moved when last seen, the first relative to the second.
template <class Law, class Number>
struct SeenEnds {
    Vec3Of<Number> velocity = Vec3Of<Number>::Zero();  ///< at the contact point [m/s]
};
template <CarriesMoments Law, class Number>
struct SeenEnds<Law, Number> {
    Vec3Of<Number> velocity = Vec3Of<Number>::Zero();  ///< [m/s]
    Vec3Of<Number> spin = Vec3Of<Number>::Zero();      ///< [rad/s]
};

/// `pack_lanes` bonds and what they remember. Lanes that are left over hold broken bonds between phantoms.
template <class Law>
struct alignas(64) BondPack {
    std::array<LineOffset, pack_lanes> first{}, second{};
    Pack rest_length = 1, radius = 1, effective_mass = 1, effective_inertia = 1;
    Pack stored = 0;  ///< when last evaluated [J]
    SeenEnds<Law, Pack> before{};
    typename detail::PackBondMemory<Law>::type memory{};
    std::array<Index, pack_lanes> bond{};  ///< number in the network, -1: none
    bool has_broken = false;               ///< some bond is a contact
};

/// What a law answers to a pack, but for the memory.
struct BondAnswer {
    BondLoadOf<Pack> load;
    PackFailureMode failure;
};

namespace detail {

/// Left-over lanes answer nothing, whatever the law makes of them.
inline void keep_only(PackMask used, BondAnswer& all) noexcept {
    const Vec3Of<Pack> none = Vec3Of<Pack>::Zero();
    all.load.force = select(used, all.load.force, none);
    all.load.couple = select(used, all.load.couple, none);
    for (Pack* energy :
         {&all.load.stored, &all.load.lost_bond, &all.load.lost_normal, &all.load.lost_tangential})
        *energy = select(used, *energy, Pack(0));
    all.failure.tension = all.failure.tension & used, all.failure.shear = all.failure.shear & used;
}

}  // namespace detail

/// The law's answer to a pack, its memory committed.
template <class Law>
BondAnswer answer(const Law& law, const BondKinematicsOf<Pack>& bond, const Pack& strength_left,
                  BondPack<Law>& pack) noexcept {
    if constexpr (AnswersBondPacks<Law>) {
        const auto [load, memory, failure] = law.respond(bond, strength_left, pack.memory);
        pack.memory = memory;
        BondAnswer all{load, failure};
        if (pack.bond.back() < 0) {
            PackMask used{};
            for (int lane = 0; lane < pack_lanes; ++lane)
                if (pack.bond[static_cast<std::size_t>(lane)] >= 0) used.set(lane);
            detail::keep_only(used, all);
        }
        return all;
    } else {
        BondAnswer all{};
        for (int lane = 0; lane < pack_lanes; ++lane) {
            if (pack.bond[static_cast<std::size_t>(lane)] < 0) continue;
            auto& remembered = pack.memory[static_cast<std::size_t>(lane)];
            const auto [load, memory, failure] =
                law.respond(detail::lane_of(bond, lane), strength_left[lane], remembered);
            remembered = memory;
            for (int a = 0; a < 3; ++a)
                all.load.force[a].set(lane, load.force[a]), all.load.couple[a].set(lane, load.couple[a]);
            all.load.stored.set(lane, load.stored), all.load.lost_bond.set(lane, load.lost_bond);
            all.load.lost_normal.set(lane, load.lost_normal);
            all.load.lost_tangential.set(lane, load.lost_tangential);
            if (failure == FailureMode::tension) all.failure.tension.set(lane);
            if (failure == FailureMode::shear) all.failure.shear.set(lane);
        }
        return all;
    }
}

/// Where the two of each bond are and how they move, as the lines have it.
template <class Law>
BondKinematicsOf<Pack> bonds_between(const LineReader& at, BondPack<Law>& pack, const ContactStep& step,
                                     Vec3Of<Pack>& arm) noexcept {
    constexpr Quad difference{{-1, -1, -1, 1}};
    const auto [x, y, z, reach] = detail::gather(
        pack, [&](LineOffset i, LineOffset j) { return at.place(i) + difference * at.place(j); });
    const auto [vx, vy, vz, masses] = detail::gather(
        pack, [&](LineOffset i, LineOffset j) { return at.motion(i)[0] + difference * at.motion(j)[0]; });
    const auto [rim_x, rim_y, rim_z, curvature] =
        detail::gather(pack, [&](LineOffset i, LineOffset j) { return at.motion(i)[1] + at.motion(j)[1]; });
    const Pack length = sqrt(x * x + y * y + z * z), per_length = Pack(1) / length, lambda = length / reach;
    BondKinematicsOf<Pack> bond;
    bond.normal = {x * per_length, y * per_length, z * per_length};
    bond.compression = pack.rest_length - length;
    arm = lambda * bond.normal;
    const Vec3Of<Pack> velocity = Vec3Of<Pack>(vx, vy, vz) - Vec3Of<Pack>(rim_x, rim_y, rim_z).cross(arm);
    const Pack ahead(step.ahead), dt(step.time_step);
    bond.velocity = velocity + ahead * (velocity - pack.before.velocity);
    bond.displacement = dt * velocity;
    pack.before.velocity = velocity;
    if constexpr (CarriesMoments<Law>) {
        const auto [sx, sy, sz, turning] = detail::gather_spins<false>(pack, at);
        const Vec3Of<Pack> spin(sx, sy, sz);
        bond.spin = spin + ahead * (spin - pack.before.spin);
        bond.rotation = dt * spin;
        pack.before.spin = spin;
        bond.effective_inertia = pack.effective_inertia;
    }
    bond.radius = pack.radius, bond.length = pack.rest_length, bond.effective_mass = pack.effective_mass;
    bond.time_step = step.time_step;
    return bond;
}

/// Adds the answers to the loads of the two of each bond.
template <class Law>
void add_loads(const LineReader& at, const BondPack<Law>& pack, const BondLoadOf<Pack>& load,
               const Vec3Of<Pack>& arm, const Pack& worn) noexcept {
    constexpr Quad reaction{{-1, -1, -1, 1}};
    const Vec3Of<Pack> torque_over_radius = load.force.cross(arm);
    const QuadRows forces = rows({load.force.x(), load.force.y(), load.force.z(), worn});
    const QuadRows torques_over_radius =
        rows({torque_over_radius.x(), torque_over_radius.y(), torque_over_radius.z(), Pack(0)});
    for (std::size_t k = 0; k < forces.size(); ++k) {
        at.add(pack.first[k], forces[k], torques_over_radius[k]);
        at.add(pack.second[k], reaction * forces[k], torques_over_radius[k]);
    }
    if constexpr (CarriesMoments<Law>) detail::add_couples<false>(load.couple, pack, at);
}

}  // namespace abrade
