#pragma once
// Boundary conditions on the sides of a box of fluid.

#include <abrade/fluid/mesh/grid.hpp>

#include <array>
#include <string>
#include <string_view>

namespace abrade {

/// Boundary condition on a side of the box.
enum class Boundary {
    wall,       ///< closed; the wall law (WallLaw) says how it holds the water, no slip unless told otherwise
    free_slip,  ///< closed; no shear
    periodic,   ///< what leaves here comes back at the opposite side
    inflow,     ///< velocity and liquid fraction of the ghost cells are given
    outflow     ///< zero gradient
};

constexpr std::string_view boundary_name(Boundary side) noexcept {
    constexpr std::array<std::string_view, 5> names{"wall", "free_slip", "periodic", "inflow", "outflow"};
    return names[static_cast<std::size_t>(side)];
}

/// Whether nothing passes.
constexpr bool is_closed(Boundary side) noexcept {
    return side == Boundary::wall || side == Boundary::free_slip;
}

/// The boundary conditions on all sides of the box.
template <int Dim>
struct BoundaryConditions {
    /// [axis][0: low, 1: high]
    PerAxis<PerAxis<Boundary, 2>, Dim> kind{};

    static BoundaryConditions all(Boundary side) noexcept {
        BoundaryConditions boundaries;
        for (auto& ends : boundaries.kind) ends = {side, side};
        return boundaries;
    }
    const PerAxis<Boundary, 2>& operator[](int axis) const noexcept { return kind[axis]; }
    PerAxis<Boundary, 2>& operator[](int axis) noexcept { return kind[axis]; }
    bool periodic(int axis) const noexcept { return (*this)[axis][0] == Boundary::periodic; }
    PerAxis<bool, Dim> periodic_axes() const noexcept {
        PerAxis<bool, Dim> axes{};
        for (int a = 0; a < Dim; ++a) axes[a] = periodic(a);
        return axes;
    }

    /// Throws InputError where one end of an axis is periodic and the other is not.
    void validate() const {
        for (int a = 0; a < Dim; ++a) {
            const auto& [low, high] = (*this)[a].values;
            if ((low == Boundary::periodic) == (high == Boundary::periodic)) continue;
            fail({std::string("BoundaryConditions.") + Grid<Dim>::axis_name(a),
                  "periodic at both ends or at none", "",
                  "what leaves at one end must come back at the other"},
                 std::string(boundary_name(low)) + " and " + std::string(boundary_name(high)));
        }
    }
};

}  // namespace abrade
