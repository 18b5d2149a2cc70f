#pragma once
// What a step reads and writes of each sphere, in whole cache lines: a contact touches one line of place, one
// of motion and one of load on either side, and packs of contacts load them whole.

#include <abrade/core/fields.hpp>
#include <abrade/core/simd.hpp>

#include <cstddef>
#include <vector>

namespace abrade {

/// Where a sphere is.
struct alignas(32) SpherePlace {
    Vec3 centre = Vec3::Zero();  ///< [m]
    Real radius = 0;             ///< [m]
    static void fields(auto&& field) {
        field("centre", "m", &SpherePlace::centre), field("radius", "m", &SpherePlace::radius);
    }
};

/// How it moves, halfway through the step that led to its place.
struct alignas(64) SphereMotion {
    Vec3 velocity = Vec3::Zero();          ///< of the centre [m/s]
    Real inverse_mass = 0;                 ///< of its body, 0 where that is fixed [1/kg]
    Vec3 surface_velocity = Vec3::Zero();  ///< radius times angular velocity [m/s]
    Real curvature = 0;                    ///< 1/radius [1/m]
    static void fields(auto&& field) {
        field("velocity", "m/s", &SphereMotion::velocity),
            field("inverse_mass", "1/kg", &SphereMotion::inverse_mass),
            field("surface_velocity", "m/s", &SphereMotion::surface_velocity),
            field("curvature", "1/m", &SphereMotion::curvature);
    }
};

/// What acts on it. Contact points lie at arms that share the distance of the centres in proportion to the
/// radii, arm = lambda r, lambda = distance / (r_i + r_j): both spheres of a contact feel the same lever.
struct alignas(64) SphereLoad {
    Vec3 force = Vec3::Zero();  ///< [N]
    Real observed = 0;          ///< what an observer of contacts has found in this step [its unit]
    /// Sum of lambda f x n, and of couples over the radius; times that: the torque about the centre [N].
    Vec3 torque_over_radius = Vec3::Zero();
    Real mass = 0;  ///< of its body: no load, but its place is free [kg]
    static void fields(auto&& field) {
        field("force", "N", &SphereLoad::force), field("observed", &SphereLoad::observed),
            field("torque_over_radius", "N", &SphereLoad::torque_over_radius),
            field("mass", "kg", &SphereLoad::mass);
    }
};

/// The lines of all spheres, in slots: first every sphere, then images of some of them (of periodic
/// boundaries, of the slab next door), at the end three phantoms that fill up packs: two that are far from
/// each other and one that no plane touches.
struct HotArrays {
    std::vector<SpherePlace> place;
    std::vector<SphereMotion> motion;
    std::vector<SphereLoad> load;

    static void fields(auto&& field) {
        field("place", &HotArrays::place), field("motion", &HotArrays::motion),
            field("load", &HotArrays::load);
    }

    void resize(std::size_t slots) { place.resize(slots), motion.resize(slots), load.resize(slots); }

    /// Adds the phantoms; returns the slot of the first.
    Index add_phantoms() {
        const std::size_t first = place.size();
        resize(first + 3);
        // Far, yet so near that squares of distances stay finite.
        place[first] = {Vec3::Constant(1e100), 1}, place[first + 1] = {Vec3::Constant(-1e100), 1};
        place[first + 2] = {Vec3::Zero(), -1e100};
        for (std::size_t s = first; s < first + 3; ++s) motion[s].inverse_mass = motion[s].curvature = 1;
        return static_cast<Index>(first);
    }
};

/// A pair of spheres in slots, or a sphere near plane -1 - second.
struct SlotPair {
    Index first = 0, second = 0;
};

namespace detail {

static_assert(sizeof(SpherePlace) == sizeof(Quad) && sizeof(SphereMotion) == 2 * sizeof(Quad) &&
              sizeof(SphereLoad) == 2 * sizeof(Quad));

inline constexpr Quad three_ones{{1, 1, 1, 0}};
inline Quad quad(const Vec3& v) noexcept { return {Quad::Native{v.x(), v.y(), v.z(), 0}}; }
inline Quad same(Real x) noexcept { return {Quad::Native{x, x, x, x}}; }
inline Vec3 first_three(const Quad& q) noexcept { return {q.value[0], q.value[1], q.value[2]}; }

inline Quad& quad(SpherePlace& line) noexcept { return reinterpret_cast<Quad&>(line); }
inline const Quad& quad(const SpherePlace& line) noexcept { return reinterpret_cast<const Quad&>(line); }
inline Quad& quad(SphereMotion& line, std::size_t half) noexcept {
    return reinterpret_cast<Quad*>(&line)[half];
}
inline const Quad& quad(const SphereMotion& line, std::size_t half) noexcept {
    return reinterpret_cast<const Quad*>(&line)[half];
}
inline Quad& quad(SphereLoad& line, std::size_t half) noexcept {
    return reinterpret_cast<Quad*>(&line)[half];
}
inline const Quad& quad(const SphereLoad& line, std::size_t half) noexcept {
    return reinterpret_cast<const Quad*>(&line)[half];
}

}  // namespace detail

/// Where a slot's place is, in bytes: saves the hot loop a multiplication. Motion and load lie twice as far.
using LineOffset = std::uint32_t;
inline LineOffset line_offset(Index slot) noexcept {
    return static_cast<LineOffset>(slot) * static_cast<LineOffset>(sizeof(SpherePlace));
}

/// Lines as quads, by their offsets.
class LineReader {
public:
    explicit LineReader(HotArrays& lines) noexcept
        : place_(reinterpret_cast<std::byte*>(lines.place.data())),
          motion_(reinterpret_cast<std::byte*>(lines.motion.data())),
          load_(reinterpret_cast<std::byte*>(lines.load.data())) {}

    const Quad& place(std::size_t at) const noexcept { return *reinterpret_cast<const Quad*>(place_ + at); }
    const Quad* motion(std::size_t at) const noexcept {
        return reinterpret_cast<const Quad*>(motion_ + 2 * at);
    }
    /// Asks for a sphere's lines: they are needed soon.
    void fetch(std::size_t at) const noexcept {
        __builtin_prefetch(place_ + at), __builtin_prefetch(motion_ + 2 * at),
            __builtin_prefetch(load_ + 2 * at, 1);
    }
    void add(std::size_t at, const Quad& force, const Quad& torque_over_radius) const noexcept {
        Quad* load = reinterpret_cast<Quad*>(load_ + 2 * at);
        load[0] = load[0] + force, load[1] = load[1] + torque_over_radius;
    }
    void add_torque_over_radius(std::size_t at, const Quad& torque_over_radius) const noexcept {
        Quad* load = reinterpret_cast<Quad*>(load_ + 2 * at);
        load[1] = load[1] + torque_over_radius;
    }

private:
    std::byte *place_, *motion_, *load_;
};

}  // namespace abrade
