#pragma once
// Depth-averaged water, what it is made from.

#include <abrade/core/law.hpp>
#include <abrade/fluid/fluid_model.hpp>
#include <abrade/fluid/shallow_water/boundary_conditions.hpp>

#include <functional>

namespace abrade {

/// How the speed of a water column is spread over its height, where stones sample it.
enum class VelocityProfile { logarithmic, uniform };

/// A function of a place in the plane, x and y [m]; y is 0 in one dimension.
using PlaneFunction = std::function<Real(Real x, Real y)>;

/// What depth-averaged water is made from.
template <int Dim>
struct ShallowWaterParams {
    std::array<Real, Dim> low{}, high{};  ///< corners of the plane [m]
    std::array<Index, Dim> cells{};       ///< along x, y
    ShallowBoundaries<Dim> boundaries{};  ///< {{x low, x high}, {y low, y high}}; walls unless told otherwise
    PlaneFunction bed{};                  ///< height z_b [m]; none: flat, at 0
    PlaneFunction surface{};  ///< at the start [m]; dry where it is not above the bed. None: all is dry
    std::array<PlaneFunction, Dim> speed{};  ///< at the start, along x, y [m/s]; none: at rest
    /// Its z presses water on the bed, x and y drive it: a slope that the frame is tilted by [m/s2].
    Vec3 gravity{0, 0, -standard_gravity};
    Real manning = 0;          ///< n [s/m^(1/3)]; 0: no friction
    Real density = 1000;       ///< [kg/m3]
    Real viscosity = 1.31e-3;  ///< dynamic, that stones feel [Pa s]
    VelocityProfile profile = VelocityProfile::logarithmic;
    Real courant = 0.5;         ///< dt sum over axes of (|u| + c)/dx [-]; up to 0.5 depths stay positive
    Real dry_depth = 1e-5;      ///< below it water stands still [m]
    Real velocity_limit = 100;  ///< beyond it a run is wrong [m/s]
    Real start_time = 0;        ///< [s]; before 0: it settles before the solids begin

    void validate() const {
        Real all = 1;
        for (std::size_t a = 0; a < Dim; ++a) validate_axis(a), all *= static_cast<Real>(cells[a]);
        require(all < 1e9, {"ShallowWater.cells", "below 1e9 in all", "cells", "take larger ones"}, all);
        require_finite(gravity, "ShallowWater.gravity", "m/s2");
        require(gravity.z() < 0,
                {"ShallowWater.gravity.z", "below 0", "m/s2",
                 "it presses water on its bed: -9.80665 where z is up"},
                gravity.z());
        require(Dim == 2 || gravity.y() == 0,
                {"ShallowWater.gravity.y", "0 in one dimension", "m/s2", "take ShallowWater<2>"},
                gravity.y());
        require_not_negative(manning, "ShallowWater.manning", "s/m^(1/3)",
                             "concrete has 0.012 to 0.020, 0: none");
        require_positive(density, "ShallowWater.density", "kg/m3", "water has 1000 kg/m3");
        require_positive(viscosity, "ShallowWater.viscosity", "Pa s",
                         "water has 1.31e-3 Pa s at 10 degrees C");
        require(courant > 0 && courant <= 1,
                {"ShallowWater.courant", "in (0, 1]", "", "up to 0.5 depths stay positive; 1 is the limit"},
                courant);
        require_positive(dry_depth, "ShallowWater.dry_depth", "m", "a hundredth of a millimetre is common");
        require_positive(velocity_limit, "ShallowWater.velocity_limit", "m/s",
                         "100 m/s is far beyond any channel");
        require_start_time(start_time, "ShallowWater.start_time");
    }
    void visit(auto&& f) const {
        f("cells_x", static_cast<Real>(cells[0]), "-");
        if constexpr (Dim == 2) f("cells_y", static_cast<Real>(cells[1]), "-");
        f("spacing_x", (high[0] - low[0]) / static_cast<Real>(cells[0]), "m");
        f("manning", manning, "s/m^(1/3)");
        f("courant", courant, "-");
        f("dry_depth", dry_depth, "m");
        f("density", density, "kg/m3");
        f("viscosity", viscosity, "Pa s");
    }

private:
    void validate_axis(std::size_t a) const {
        const std::string axis(1, "xy"[a]);
        require_finite(low[a], "ShallowWater.low." + axis, "m");
        require(high[a] > low[a] && std::isfinite(high[a]),
                {"ShallowWater.high." + axis, "above low." + axis + " (" + to_text(low[a]) + " m)", "m",
                 "swap them or widen the plane"},
                high[a]);
        require(cells[a] > 0, {"ShallowWater.cells." + axis, "at least 1", "cells", "length over spacing"},
                static_cast<Real>(cells[a]));
        require(
            std::abs(low[a]) < 1e6 * (high[a] - low[a]),
            {"ShallowWater.low." + axis, "within a million times the plane's length", "m", "move the origin"},
            low[a]);
        const auto periodic = [&](std::size_t end) {
            return boundaries[a][end].kind == ShallowBoundary::Kind::periodic;
        };
        if (periodic(0) != periodic(1))
            fail({"ShallowWater.boundaries." + axis, "periodic at both ends or at none", "",
                  "water that leaves one end comes in at the other"},
                 periodic(0) ? "only low periodic" : "only high periodic");
        for (std::size_t end = 0; end < 2; ++end) {
            const ShallowBoundary& side = boundaries[a][end];
            const std::string field = "ShallowWater.boundaries." + axis + (end == 0 ? ".low" : ".high");
            const std::string unit = Dim == 2 ? "m3/s" : "m2/s";
            if (side.kind != ShallowBoundary::Kind::inflow) {
                require(side.discharge == 0 && side.depth == 0,
                        {field + ".discharge", "0 but at an inflow", unit,
                         "make it ShallowBoundary::inflow(discharge)"},
                        side.discharge);
                continue;
            }
            require_positive(side.discharge, field + ".discharge", unit,
                             "an end that lets nothing in is a wall");
            require_not_negative(side.depth, field + ".depth", "m",
                                 "leave it 0 for subcritical flow: water before it sets it");
        }
    }
};

static_assert(ParamSet<ShallowWaterParams<1>> && ParamSet<ShallowWaterParams<2>>);

}  // namespace abrade
