#pragma once
// What stands at the sides of a box of fluid.

#include <abrade/fluid/grid.hpp>

#include <array>
#include <string>
#include <string_view>

namespace abrade {

/// Kind of a side of the box.
enum class Side {
    wall,      ///< closed; fluid sticks to it
    slip,      ///< closed; fluid glides along it
    periodic,  ///< what leaves here comes back at the opposite side
    inflow,    ///< velocity and liquid fraction of the ghosts are given and stay
    outflow    ///< zero gradient
};

constexpr std::string_view side_name(Side side) noexcept {
    constexpr std::array<std::string_view, 5> names{"wall", "slip", "periodic", "inflow", "outflow"};
    return names[static_cast<std::size_t>(side)];
}

/// Whether nothing passes.
constexpr bool is_closed(Side side) noexcept { return side == Side::wall || side == Side::slip; }

/// The kinds of all sides.
template <int Dim>
struct Sides {
    /// [axis][0: low, 1: high]
    PerAxis<PerAxis<Side, 2>, Dim> kind{};

    static Sides all(Side side) noexcept {
        Sides sides;
        for (auto& ends : sides.kind) ends = {side, side};
        return sides;
    }
    const PerAxis<Side, 2>& operator[](int axis) const noexcept { return kind[axis]; }
    PerAxis<Side, 2>& operator[](int axis) noexcept { return kind[axis]; }
    bool periodic(int axis) const noexcept { return (*this)[axis][0] == Side::periodic; }
    PerAxis<bool, Dim> periodic_axes() const noexcept {
        PerAxis<bool, Dim> axes{};
        for (int a = 0; a < Dim; ++a) axes[a] = periodic(a);
        return axes;
    }

    /// Throws InputError where one end of an axis is periodic and the other is not.
    void validate() const {
        for (int a = 0; a < Dim; ++a) {
            const auto& [low, high] = (*this)[a].values;
            if ((low == Side::periodic) == (high == Side::periodic)) continue;
            fail({std::string("Sides.") + Grid<Dim>::axis_name(a), "periodic at both ends or at none", "",
                  "what leaves at one end must come back at the other"},
                 std::string(side_name(low)) + " and " + std::string(side_name(high)));
        }
    }
};

}  // namespace abrade
