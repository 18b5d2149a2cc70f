#pragma once
// A handful of gravel shapes, each a clump of overlapping spheres without gaps.

#include <abrade/core/require.hpp>
#include <abrade/geometry/sphere_union.hpp>

#include <array>
#include <string_view>
#include <utility>

namespace abrade {

enum class StoneShape { sphere, ellipsoid, angular };

inline constexpr std::array<std::string_view, 3> stone_shape_names{"sphere", "ellipsoid", "angular"};

/// A stone of the given nominal size: its solid volume is that of a sphere of diameter `size` [m],
/// so that 1 m3 of sediment holds the same number of stones whatever their shape.
///  - sphere: one sphere;
///  - ellipsoid: seven spheres inside axes of about 1.4 : 1 : 0.75, a rounded river pebble;
///  - angular: a core and eight corners of a box 1.3 : 1.1 : 0.9, a blocky crushed stone.
/// Throws InputError when `size` is not > 0.
inline Clump make_stone(StoneShape shape, Real size) {
    require_positive(size, "make_stone.size", "m");
    std::vector<Sphere> members;
    switch (shape) {
        case StoneShape::sphere:
            members = {{Vec3::Zero(), 1.0}};
            break;
        case StoneShape::ellipsoid:
            members = {{{0, 0, 0}, 0.75},    {{0.55, 0, 0}, 0.68},  {{-0.55, 0, 0}, 0.68},
                       {{0.95, 0, 0}, 0.45}, {{-0.95, 0, 0}, 0.45}, {{0, 0.38, 0}, 0.62},
                       {{0, -0.38, 0}, 0.62}};
            break;
        case StoneShape::angular:
            members = {{{0, 0, 0}, 0.80}};
            for (const Real x : {-1.0, 1.0})
                for (const Real y : {-1.0, 1.0})
                    for (const Real z : {-1.0, 1.0})
                        members.push_back({{0.60 * x, 0.48 * y, 0.36 * z}, 0.42});
            break;
    }
    const Real scale = size * std::cbrt(pi / 6 / union_moments(members).volume);
    for (Sphere& s : members) {
        s.centre *= scale;
        s.radius *= scale;
    }
    return make_clump(std::string(stone_shape_names[static_cast<std::size_t>(shape)]), std::move(members));
}

}  // namespace abrade
