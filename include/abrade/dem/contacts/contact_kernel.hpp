#pragma once
// One pack of contacts: lines in, the law's answer, lines out. The hottest code of the library.

#include <abrade/dem/contacts/contact_observer.hpp>
#include <abrade/dem/laws/contact_law.hpp>
#include <abrade/dem/store/hot_arrays.hpp>
#include <abrade/geometry/surfaces.hpp>

#include <cstring>
#include <new>
#include <span>

namespace abrade {

/// What all contacts of one evaluation share.
struct ContactStep {
    Real time_step = 0;  ///< that led here [s]
    /// How far dashpots look ahead of the velocities that the lines hold, as a share of the last change: 0.5
    /// where these are half a step old and the ones before were a whole step older.
    Real ahead = 0.5;
};

/// Which of the two are held by bonds, though they have a mass.
enum class HeldSides : std::uint8_t { none, first, second, both };
constexpr HeldSides held_sides(bool first, bool second) noexcept {
    return static_cast<HeldSides>((first ? 1 : 0) + (second ? 2 : 0));
}

/// A law that answers whole packs at once. Others are asked lane by lane.
template <class L>
concept AnswersPacks = requires(const L& law, const ContactKinematics<Pack>& contact,
                                const typename L::template Memory<Pack>& memory) {
    {
        law.respond(contact, memory)
        } -> std::same_as<ContactResponse<Pack, typename L::template Memory<Pack>>>;
};

namespace detail {

template <class Law>
struct PackMemoryOf {
    using type = std::array<typename Law::template Memory<Real>, pack_lanes>;
};
template <AnswersPacks Law>
struct PackMemoryOf<Law> {
    using type = typename Law::template Memory<Pack>;
};

}  // namespace detail

/// How the two of a contact moved when last seen: what dashpots look ahead from.
template <class Law, class Number>
struct SeenMotion {
    Vec3Of<Number> velocity = Vec3Of<Number>::Zero();  ///< at the contact point [m/s]
};
/// The same for a law that resists rolling, whose dashpots see spins too.
template <ResistsRolling Law, class Number>
struct SeenMotion<Law, Number> {
    Vec3Of<Number> velocity = Vec3Of<Number>::Zero();  ///< at the contact point [m/s]
    Vec3Of<Number> spin = Vec3Of<Number>::Zero();      ///< [rad/s]
};

/// `pack_lanes` pairs of spheres, or spheres on one plane, and what their contacts remember.
template <class Law>
struct alignas(64) ContactPack {
    /// Lines of the two, phantoms in lanes that are left over.
    std::array<LineOffset, pack_lanes> first{}, second{};
    typename detail::PackMemoryOf<Law>::type memory{};
    SeenMotion<Law, Pack> before{};
    PackMask touched{};  ///< when last seen
};

/// Sums over packs, lane by lane.
struct PackSums {
    Pack lost_normal = 0, lost_tangential = 0, stored = 0;      ///< [J]
    Pack lost_rolling = 0, lost_film = 0;                       ///< [J]
    Pack watched_lost_normal = 0, watched_lost_tangential = 0;  ///< once for each watched side [J]
    /// Overlap times (1/r_i + 1/r_j), planes as an equal sphere: at least 1 + r_small/r_large times overlap
    /// over the smaller radius [-].
    Pack deepest = 0;
    Pack wall_power = 0;  ///< [W]

    PackSums& operator+=(const PackSums& other) noexcept {
        lost_normal += other.lost_normal, lost_tangential += other.lost_tangential, stored += other.stored;
        lost_rolling += other.lost_rolling, lost_film += other.lost_film;
        watched_lost_normal += other.watched_lost_normal;
        watched_lost_tangential += other.watched_lost_tangential;
        deepest = max(deepest, other.deepest), wall_power += other.wall_power;
        return *this;
    }
};

namespace detail {

/// Of a Memory<Number>, which is made of Numbers and vectors of them alone, or empty.
template <class Memory, class PackedMemory>
inline constexpr std::size_t numbers_in = [] {
    constexpr std::size_t numbers = std::is_empty_v<Memory> ? 0 : sizeof(PackedMemory) / sizeof(Pack);
    static_assert(std::is_empty_v<Memory> || sizeof(Memory) == numbers * sizeof(Real),
                  "a contact's memory must be made of its Number");
    return numbers;
}();

/// Lane k of a pack's memory.
template <class Memory, class PackedMemory>
Memory memory_of_lane(const PackedMemory& all, int lane) noexcept {
    constexpr std::size_t numbers = numbers_in<Memory, PackedMemory>;
    Memory one;
    for (std::size_t n = 0; n < numbers; ++n)
        std::memcpy(reinterpret_cast<std::byte*>(&one) + n * sizeof(Real),
                    reinterpret_cast<const std::byte*>(&all) + n * sizeof(Pack) +
                        static_cast<std::size_t>(lane) * sizeof(Real),
                    sizeof(Real));
    return one;
}

template <class PackedMemory, class Memory>
void set_memory_of_lane(PackedMemory& all, int lane, const Memory& one) noexcept {
    constexpr std::size_t numbers = numbers_in<Memory, PackedMemory>;
    for (std::size_t n = 0; n < numbers; ++n)
        std::memcpy(reinterpret_cast<std::byte*>(&all) + n * sizeof(Pack) +
                        static_cast<std::size_t>(lane) * sizeof(Real),
                    reinterpret_cast<const std::byte*>(&one) + n * sizeof(Real), sizeof(Real));
}

template <class Memory>
Memory memory_of_lane(const std::array<Memory, pack_lanes>& all, int lane) noexcept {
    return all[static_cast<std::size_t>(lane)];
}
template <class Memory>
void set_memory_of_lane(std::array<Memory, pack_lanes>& all, int lane, const Memory& one) noexcept {
    all[static_cast<std::size_t>(lane)] = one;
}

inline Vec3 lane_of(const Vec3Of<Pack>& v, int lane) noexcept {
    return {v.x()[lane], v.y()[lane], v.z()[lane]};
}
inline ContactKinematics<Real> lane_of(const ContactKinematics<Pack>& c, int lane) noexcept {
    return {lane_of(c.normal, lane),       c.overlap[lane],        lane_of(c.velocity, lane),
            c.inverse_mass[lane],          c.curvature[lane],      c.time_step,
            lane_of(c.displacement, lane), c.touched[lane],        lane_of(c.spin, lane),
            lane_of(c.rotation, lane),     c.inverse_turning[lane]};
}
inline ContactLoad<Real> lane_of(const ContactLoad<Pack>& l, int lane) noexcept {
    return {lane_of(l.force, lane),  l.stored[lane],       l.lost_normal[lane],   l.lost_tangential[lane],
            lane_of(l.couple, lane), l.lost_rolling[lane], lane_of(l.film, lane), l.lost_film[lane]};
}

/// The law's answer to a pack; commits the memory of the lanes that touch or did.
template <class Law>
ContactLoad<Pack> answer(const Law& law, const ContactKinematics<Pack>& contact, ContactPack<Law>& pack,
                         PackMask touching) noexcept {
    if constexpr (AnswersPacks<Law>) {
        const auto [load, memory] = law.respond(contact, pack.memory);
        pack.memory = memory;
        return load;
    } else {
        ContactLoad<Pack> all{Vec3Of<Pack>::Constant(Pack(0)), 0, 0, 0};
        for (int lane = 0; lane < pack_lanes; ++lane) {
            if (!touching[lane] && !pack.touched[lane]) continue;
            auto& remembered = pack.memory[static_cast<std::size_t>(lane)];
            const auto [load, memory] = law.respond(lane_of(contact, lane), remembered);
            remembered = memory;
            for (int a = 0; a < 3; ++a) all.force[a].set(lane, load.force[a]);
            all.stored.set(lane, load.stored);
            all.lost_normal.set(lane, load.lost_normal), all.lost_tangential.set(lane, load.lost_tangential);
            if constexpr (ResistsRolling<Law>) {
                for (int a = 0; a < 3; ++a) all.couple[a].set(lane, load.couple[a]);
                all.lost_rolling.set(lane, load.lost_rolling);
            }
            if constexpr (ActsBeforeTouch<Law>) {
                for (int a = 0; a < 3; ++a) all.film[a].set(lane, load.film[a]);
                all.lost_film.set(lane, load.lost_film);
            }
        }
        return all;
    }
}

template <ContactObserver Observer>
Pack observed(const Observer& observer, const ContactKinematics<Pack>& contact,
              const ContactLoad<Pack>& load) noexcept {
    if constexpr (requires { observer.observe(contact, load); }) {
        return observer.observe(contact, load);
    } else {
        Pack all = 0;
        for (int lane = 0; lane < pack_lanes; ++lane)
            all.set(lane, observer.observe(lane_of(contact, lane), lane_of(load, lane)));
        return all;
    }
}

/// Up to about here lists and lines stay in a third cache of 32 MiB.
inline constexpr std::size_t spheres_in_cache = 30'000;

/// Asks for the pack eight further on and for the lines of the next: scenes larger than the caches would
/// wait for them (docs/benchmarks.md, size). First partners come nearly in order, so
/// the machine sees them coming by itself.
template <class Law>
void fetch_ahead(std::span<ContactPack<Law>> packs, std::size_t p, const LineReader& at) noexcept {
    constexpr std::size_t cache_line = 64;
    const std::size_t last = packs.size() - 1;
    const auto* far = reinterpret_cast<const std::byte*>(&packs[std::min(p + 8, last)]);
    for (std::size_t n = 0; n < sizeof(ContactPack<Law>); n += cache_line) __builtin_prefetch(far + n, 1);
    for (const LineOffset second : packs[std::min(p + 1, last)].second) at.fetch(second);
}

/// 1/m_i + 1/m_j over the free bodies of each lane, where there is one; elsewhere `all`, the sum over both.
template <class Lanes>
Pack free_inverse_mass(const Lanes& pack, const HeldSides* held, const LineReader& at, Pack all) noexcept {
    for (std::size_t k = 0; k < pack_lanes; ++k) {
        if (held[k] == HeldSides::none || held[k] == HeldSides::both) continue;
        const LineOffset other = held[k] == HeldSides::first ? pack.second[k] : pack.first[k];
        const Real inverse_mass = at.motion(other)[0].value[3];
        if (inverse_mass > 0) all.set(static_cast<int>(k), inverse_mass);
    }
    return all;
}

/// combine(first, second) of the lines of each lane, as columns.
template <class Lanes, class Combine>
QuadColumns gather(const Lanes& pack, const Combine& combine) noexcept {
    QuadRows row;
#pragma GCC unroll 8
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = combine(pack.first[k], pack.second[k]);
    return columns(row);
}

inline Vec3Of<Pack> packs_of(const Vec3& v) noexcept { return {Pack(v.x()), Pack(v.y()), Pack(v.z())}; }

/// Angular velocity of i relative to j [rad/s], and 1/(m_i r_i^2) + 1/(m_j r_j^2) [1/(kg m2)].
template <bool on_plane, class Lanes>
QuadColumns gather_spins(const Lanes& pack, const LineReader& at) noexcept {
    const auto turning = [&](LineOffset sphere) {
        const Quad* motion = at.motion(sphere);  // of the surface, and 1/r
        const Real curvature = motion[1].value[3];
        return motion[1] * Quad{{curvature, curvature, curvature, curvature * motion[0].value[3]}};
    };
    return gather(pack, [&](LineOffset i, LineOffset j) {
        return on_plane ? turning(i) : turning(i) + Quad{{-1, -1, -1, 1}} * turning(j);
    });
}

/// Loads hold torques over radii: a couple counts over each sphere's own radius.
template <bool on_plane, class Lanes>
void add_couples(const Vec3Of<Pack>& couple, const Lanes& pack, const LineReader& at) noexcept {
    const QuadRows couples = rows({couple.x(), couple.y(), couple.z(), Pack(0)});
    const auto over_radius = [&](LineOffset sphere, Real sign) {
        const Real x = sign * at.motion(sphere)[1].value[3];
        return Quad{{x, x, x, 0}};
    };
    for (std::size_t k = 0; k < couples.size(); ++k) {
        at.add_torque_over_radius(pack.first[k], over_radius(pack.first[k], 1) * couples[k]);
        if (!on_plane)
            at.add_torque_over_radius(pack.second[k], over_radius(pack.second[k], -1) * couples[k]);
    }
}

}  // namespace detail

/// What sets packs apart when the program is compiled, so that none has to ask.
struct KernelKind {
    bool on_plane = false;  ///< spheres on one plane, which feels nothing
    bool watched = false;   ///< spheres that an observer watches are among them
};

/// What the packs of one run share beside the step.
struct PackRun {
    const Plane* plane = nullptr;                 ///< for kinds on a plane, where lambda = 1 - overlap / 2r
    const std::uint8_t* watched_sides = nullptr;  ///< [pack x lane] of the two, for kinds that are watched
    const HeldSides* held_sides = nullptr;        ///< [pack x lane] the same, for a law that damps free mass
};

/// Evaluates the law for packs of contacts, commits their memory and adds the answers to the spheres' loads.
/// The loop stands inside so that the law's constants stay in registers.
///
/// Dashpots see a velocity extrapolated to the present from the two half steps before, which is of second
/// order and needs no acceleration.
template <KernelKind kind, ContactLaw Law, ContactObserver Observer>
[[gnu::flatten]] PackSums respond(const Law& law, const Observer observer, std::span<ContactPack<Law>> packs,
                                  const PackRun& run, HotArrays& lines, const ContactStep step) noexcept {
    LineReader at(lines);
    constexpr Quad difference{{-1, -1, -1, 1}}, reaction{{-1, -1, -1, 1}};
    [[maybe_unused]] const Plane plane = kind.on_plane ? *run.plane : Plane{};

    const Real range = range_of(law);  // what touches, or nearly so
    const bool large = lines.place.size() > detail::spheres_in_cache;
    PackSums sums;
    for (std::size_t p = 0; p < packs.size(); ++p) {
        if (large) detail::fetch_ahead(packs, p, at);
        ContactPack<Law>& pack = packs[p];
        ContactKinematics<Pack> contact;
        Vec3Of<Pack> arm;  // lambda n: times a radius, from the contact point to the centre
        PackMask touching;
        const auto [x, y, z, reach] = detail::gather(pack, [&](LineOffset i, LineOffset j) {
            return kind.on_plane ? at.place(i) : at.place(i) + difference * at.place(j);
        });
        Pack distance2 = 0;
        if constexpr (kind.on_plane) {
            contact.normal = {plane.normal.x(), plane.normal.y(), plane.normal.z()};
            const Pack height = (x - Pack(plane.point.x())) * contact.normal.x() +
                                (y - Pack(plane.point.y())) * contact.normal.y() +
                                (z - Pack(plane.point.z())) * contact.normal.z();
            contact.overlap = reach - height;
            touching = contact.overlap > Pack(-range);
        } else {
            distance2 = x * x + y * y + z * z;
            const Pack acts = reach + Pack(range);
            touching = distance2 < acts * acts;
        }
        if (!any(touching | pack.touched)) continue;

        const auto [vx, vy, vz, inverse_mass] = detail::gather(pack, [&](LineOffset i, LineOffset j) {
            return kind.on_plane ? at.motion(i)[0] : at.motion(i)[0] + difference * at.motion(j)[0];
        });
        const auto [surface_velocity_x, surface_velocity_y, surface_velocity_z, curvature] =
            detail::gather(pack, [&](LineOffset i, LineOffset j) {
                return kind.on_plane ? at.motion(i)[1] : at.motion(i)[1] + at.motion(j)[1];
            });
        if constexpr (kind.on_plane) {
            arm = (Pack(1) - Pack(0.5) * contact.overlap * curvature) * contact.normal;
        } else {
            const Pack inverse_distance = rsqrt(max(distance2, Pack(tiny<Pack>)));
            // The divider is idle, the multipliers are what the kernel waits for.
            const Pack distance = distance2 * inverse_distance, inverse_reach = Pack(1) / reach;
            arm = {x * inverse_reach, y * inverse_reach, z * inverse_reach};
            contact.normal = {x * inverse_distance, y * inverse_distance, z * inverse_distance};
            contact.overlap = reach - distance;
        }
        contact.inverse_mass = inverse_mass;
        if constexpr (kind.watched && !kind.on_plane && MayDampFreeMass<Law>)
            if (law.damps_free_mass())
                contact.inverse_mass = detail::free_inverse_mass(
                    pack, run.held_sides + p * static_cast<std::size_t>(pack_lanes), at, inverse_mass);
        contact.curvature = curvature;
        contact.time_step = step.time_step;
        const Vec3Of<Pack> surface_velocity(surface_velocity_x, surface_velocity_y, surface_velocity_z);
        Vec3Of<Pack> velocity = Vec3Of<Pack>(vx, vy, vz) - surface_velocity.cross(arm);
        Vec3Of<Pack> on_wall;  // from the wall's point to the contact point
        if constexpr (kind.on_plane)
            if (plane.moves) {
                on_wall = Vec3Of<Pack>(x, y, z) - detail::packs_of(plane.point) - reach * arm;
                velocity -=
                    detail::packs_of(plane.last.velocity) + detail::packs_of(plane.last.spin).cross(on_wall);
            }
        const Pack ahead = select(pack.touched, Pack(step.ahead), Pack(0));
        contact.displacement = Pack(step.time_step) * velocity;
        contact.velocity = velocity + ahead * (velocity - pack.before.velocity);
        if constexpr (ResistsRolling<Law>) {
            const auto [sx, sy, sz, inverse_turning] = detail::gather_spins<kind.on_plane>(pack, at);
            Vec3Of<Pack> spin(sx, sy, sz);
            if constexpr (kind.on_plane)
                if (plane.moves) spin -= detail::packs_of(plane.last.spin);
            contact.rotation = Pack(step.time_step) * spin;
            contact.spin = spin + ahead * (spin - pack.before.spin);
            contact.inverse_turning = inverse_turning;
            pack.before.spin = spin;
        }
        if constexpr (kind.watched) {
            PackMask touched = pack.touched;
            if constexpr (ActsBeforeTouch<Law>)  // seen last, perhaps, while there was still a gap
                touched = touched & (contact.overlap + contact.displacement.dot(contact.normal) > Pack(0));
            contact.touched = select(touched, Pack(1), Pack(0));
        }
        pack.before.velocity = velocity;  // at once, so that it need not be kept
        const ContactLoad<Pack> answer = detail::answer(law, contact, pack, touching);
        pack.touched = touching;
        sums.lost_normal += answer.lost_normal;
        sums.lost_tangential += answer.lost_tangential;
        sums.stored += answer.stored;
        if constexpr (ResistsRolling<Law>) sums.lost_rolling += answer.lost_rolling;
        if constexpr (ActsBeforeTouch<Law>) sums.lost_film += answer.lost_film;
        sums.deepest =
            max(sums.deepest, contact.overlap * (kind.on_plane ? curvature + curvature : curvature));
        if constexpr (kind.on_plane)
            if (plane.moves) {
                const Vec3Of<Pack> spin = detail::packs_of(plane.now.spin);
                sums.wall_power +=
                    answer.force.dot(detail::packs_of(plane.now.velocity) + spin.cross(on_wall));
                if constexpr (ResistsRolling<Law>) sums.wall_power += answer.couple.dot(spin);
            }
        Pack seen = 0;
        if constexpr (kind.watched) {
            Pack sides = 0;
            for (int k = 0; k < pack_lanes; ++k)
                sides.set(k, run.watched_sides[p * pack_lanes + static_cast<std::size_t>(k)]);
            ContactLoad<Pack> of_surfaces = answer;
            if constexpr (ActsBeforeTouch<Law>) of_surfaces.force -= answer.film;
            seen = detail::observed(observer, contact, of_surfaces);
            sums.watched_lost_normal += sides * answer.lost_normal;
            sums.watched_lost_tangential += sides * answer.lost_tangential;
        }

        const Vec3Of<Pack> torque_over_radius = answer.force.cross(arm);
        const QuadRows forces = rows({answer.force.x(), answer.force.y(), answer.force.z(), seen});
        const QuadRows torques_over_radius =
            rows({torque_over_radius.x(), torque_over_radius.y(), torque_over_radius.z(), Pack(0)});
        // Read again: kept from above, sixteen offsets would crowd out the numbers.
        const ContactPack<Law>& again = *std::launder(&pack);
#pragma GCC unroll 8
        for (std::size_t k = 0; k < forces.size(); ++k)
            at.add(again.first[k], forces[k], torques_over_radius[k]);
        if constexpr (!kind.on_plane)
#pragma GCC unroll 8
            for (std::size_t k = 0; k < forces.size(); ++k)
                at.add(again.second[k], reaction * forces[k], torques_over_radius[k]);
        if constexpr (ResistsRolling<Law>) detail::add_couples<kind.on_plane>(answer.couple, again, at);
    }
    return sums;
}

}  // namespace abrade
