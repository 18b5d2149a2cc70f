#pragma once
// What stands at the sides of a fluid's box.

#include <abrade/core/require.hpp>

#include <array>
#include <string>

namespace abrade {

/// wall: no slip; slip: nothing flows through, nothing holds back; periodic: joined to the opposite side;
/// inflow: velocity is given; outflow: pressure 0, velocity goes on as it is.
enum class Side { wall, slip, periodic, inflow, outflow };

/// Kinds of the sides at the low and high end of each axis.
template <int Dim>
struct Sides {
    std::array<Side, Dim> low{}, high{};

    bool periodic(int axis) const noexcept { return low[static_cast<std::size_t>(axis)] == Side::periodic; }
    std::array<bool, Dim> periodic() const noexcept {
        std::array<bool, Dim> p;
        for (int a = 0; a < Dim; ++a) p[static_cast<std::size_t>(a)] = periodic(a);
        return p;
    }
    static Sides all(Side kind) noexcept {
        Sides s;
        s.low.fill(kind), s.high.fill(kind);
        return s;
    }

    void validate() const {
        for (std::size_t a = 0; a < Dim; ++a)
            if ((low[a] == Side::periodic) != (high[a] == Side::periodic))
                fail({"Sides." + std::string(1, Dim == 3 ? "xyz"[a] : "xz"[a]),
                      "periodic at both ends or at none", "", "set low and high alike"},
                     "one of each");
    }
};

}  // namespace abrade
