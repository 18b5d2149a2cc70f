#pragma once
// What flows into water on a grid, from a discharge and a depth.

#include <abrade/fluid/setup/grid_fluid_params.hpp>
#include <abrade/geometry/invert.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace abrade {

/// How the speed grows from the bed to the surface.
enum class InflowProfile {
    uniform,     ///< it does not
    logarithmic  ///< C ln(1 + (z - z_bed) / z_0), z_0 = roughness / 30, over a rough bed
};

/// A stream of given discharge and depth, which enters through the lower side along x. Its section is that of
/// an invert, or with `Dim` 2 a metre's width of a wide channel; the speed is such that the section carries
/// the discharge, along x everywhere. Faster than its own waves (Froude number > 1) it keeps its depth;
/// slower, the flow behind it decides, and the side is where it comes to terms with what was given.
template <int Dim>
class Inflow {
    static constexpr int vertical = Grid<Dim>::vertical;

public:
    struct Params {
        Real discharge = 0;  ///< Q [m3/s]; with Dim 2 [m2/s], of a metre's width
        Real depth = 0;      ///< where it is deepest [m]
        Real bed = 0;        ///< height of the bed there [m]
        Invert section{};    ///< its bed and its walls; with Dim 2 not asked
        InflowProfile profile = InflowProfile::uniform;
        Real roughness = 0;  ///< height k_s of a sand-grain roughness [m]; where logarithmic

        void validate() const {
            const std::string_view unit = Dim == 3 ? "m3/s" : "m2/s";
            require_positive(discharge, "Inflow.discharge", unit,
                             "a side through which nothing comes is a wall");
            require_positive(depth, "Inflow.depth", "m", "give the depth at the deepest point");
            require_finite(bed, "Inflow.bed", "m");
            if constexpr (Dim == 3) section.validate();
            if (profile != InflowProfile::logarithmic) return;
            require(roughness > 0 && roughness < 30 * depth,
                    {"Inflow.roughness", "> 0 and below 30 depths (" + short_text(30 * depth) + " m)", "m",
                     "Strickler's height is (26 n)^6, 3.5 mm at n = 0.015; or take a uniform profile"},
                    roughness);
        }
    };

    /// Throws InputError where parameters make no stream.
    explicit Inflow(const Params& params) : params_((params.validate(), params)) {
        scale_ = params_.discharge / carried_at_unit_scale();
    }
    const Params& params() const noexcept { return params_; }

    /// Wetted area of the section [m2]; with Dim 2 [m].
    Real area() const noexcept { return Dim == 3 ? params_.section.flow_area(params_.depth) : params_.depth; }
    Real mean_velocity() const noexcept { return params_.discharge / area(); }  ///< [m/s]
    /// With the hydraulic depth, area over width of the surface, under gravity g [m/s2] across the bed [-].
    Real froude(Real g = standard_gravity) const noexcept {
        return mean_velocity() / std::sqrt(g * area() / surface_width());
    }

    Point<Dim> velocity(const Point<Dim>& x) const noexcept {  ///< [m/s]
        Point<Dim> u = Point<Dim>::Zero();
        // Above the surface as at it: steps ask for the fastest.
        const Real above =
            std::min(x[vertical] - params_.bed, params_.depth) - bed_height(Dim == 3 ? x[1] : 0);
        u[0] = scale_ * shape(std::max(above, Real(0)));
        return u;
    }
    /// Depth below its surface, > 0 in the water [m].
    Real depth_at(const Point<Dim>& x) const noexcept { return params_.bed + params_.depth - x[vertical]; }

    /// Makes the lower side along x an inflow of it.
    void give_to(GridFluidParams<Dim>& water) const {
        water.grid.validate();
        const auto& g = water.grid;
        const Real top =
            g.levels.empty() ? g.low[vertical] + g.cells[vertical] * g.spacing[vertical] : g.levels.back();
        require(params_.bed + params_.depth < top,
                {"Inflow.depth",
                 "such that its surface lies below the top of the box (" + short_text(top) + " m)", "m",
                 "give the box more cells upwards"},
                params_.depth);
        const Real floor = g.levels.empty() ? g.low[vertical] : g.levels.front();
        require(params_.bed >= floor - 1e-9 * params_.depth,
                {"Inflow.bed", "no lower than the floor of the box (" + short_text(floor) + " m)", "m",
                 "what flows below it would not enter: give the box more cells downwards"},
                params_.bed);
        const Real inside = g.low[0] + 0.5 * g.spacing[0];
        const Inflow stream = *this;
        water.boundaries[0][0] = Boundary::inflow;
        water.boundary_velocity = [stream, inside](const Point<Dim>& x, Real) -> Point<Dim> {
            return x[0] < inside ? stream.velocity(x) : Point<Dim>::Zero();
        };
        water.inflow_discharge = params_.discharge;
        water.inflow_water = [stream](const Point<Dim>& x) { return stream.depth_at(x); };
    }

private:
    Real bed_height(Real y) const noexcept { return Dim == 3 ? params_.section.bed_height(y) : 0; }
    Real width() const noexcept { return Dim == 3 ? params_.section.width : 1; }
    Real roughness_length() const noexcept { return params_.roughness / 30; }
    Real shape(Real above_bed) const noexcept {
        return params_.profile == InflowProfile::uniform ? 1 : std::log1p(above_bed / roughness_length());
    }
    Real surface_width() const noexcept {
        if constexpr (Dim == 2) return 1;
        const Invert& s = params_.section;
        if (params_.depth >= s.bed_height(0.5 * s.width)) return s.width;
        return 2 * std::sqrt(square(s.arc_radius) - square(s.arc_radius - params_.depth));
    }
    /// Integral of the profile from the bed upwards.
    Real carried_below(Real h) const noexcept {
        const Real z0 = roughness_length();
        return params_.profile == InflowProfile::uniform ? h : (h + z0) * std::log1p(h / z0) - h;
    }
    /// Integral over the wetted area of the profile: in closed form along each vertical, midpoints across.
    Real carried_at_unit_scale() const noexcept {
        if (params_.profile == InflowProfile::uniform) return area();
        const int strips = Dim == 3 ? 2000 : 1;
        const Real dy = width() / strips;
        Real sum = 0;
        for (int i = 0; i < strips; ++i) {
            const Real h = params_.depth - bed_height((i + 0.5) * dy - 0.5 * width());
            if (h > 0) sum += dy * carried_below(h);
        }
        return sum;
    }

    Params params_;
    Real scale_ = 0;
};

}  // namespace abrade
