#pragma once
// Water on a grid: what it is made from.

#include <abrade/fluid/fluid_model.hpp>
#include <abrade/fluid/mesh/velocity_boundaries.hpp>
#include <abrade/fluid/mesh/wall_law.hpp>

#include <functional>

namespace abrade {

/// A function of a place [m].
template <int Dim>
using PlaceFunction = std::function<Real(const Point<Dim>&)>;

/// What acts on a unit mass at a time [s], beside gravity [m/s2].
template <int Dim>
using BodyForce = std::function<Point<Dim>(Real)>;

/// What water on a grid is made from.
template <int Dim>
struct GridFluidParams {
    typename Grid<Dim>::Params grid{};
    BoundaryConditions<Dim> boundaries{};       ///< walls unless told otherwise
    BoundaryVelocity<Dim> boundary_velocity{};  ///< of walls and of what flows in; none: at rest
    bool steady_boundaries = true;              ///< boundary_velocity does not depend on time
    /// What flows in at the start [m3/s]; in two dimensions [m2/s]: boundary_velocity is multiplied by what
    /// makes the open, wet part of the faces carry it. 0: as boundary_velocity says.
    Real inflow_discharge = 0;
    /// Distance from walls inside the box, > 0 in the water (WallShape); none: no walls. Steeper functions
    /// are found out, but for one that levels off near the wall: divide it by its steepest slope. Called from
    /// many threads, as `water` is.
    PlaceFunction<Dim> wall{};
    WallLaw wall_law{};  ///< friction of walls inside, and of sides that are walls
    /// > 0 where there is water at the start, such as the depth below a surface; none: dry. Linear functions
    /// are met exactly. Not asked of a box that is full.
    PlaceFunction<Dim> water{};
    PlaceFunction<Dim> inflow_water{};  ///< the same beyond sides where water flows in
    /// Depth below the level that water beyond outflows holds, < 0 above it [m]. Flow slower than its waves
    /// asks for it; none: it leaves freely, which is for faster flow. Waves leave; what stays meets the
    /// level, after a change in some times 4 lengths of the box over sqrt(g h).
    PlaceFunction<Dim> outflow_water{};
    std::function<Point<Dim>(const Point<Dim>&)> velocity{};  ///< at the start; none: at rest
    Point<Dim> gravity = Point<Dim>::Zero();                  ///< [m/s2]
    /// In a tank that moves: minus its acceleration. Steps are so short that it turns within none of them;
    /// none: gravity alone.
    BodyForce<Dim> body_force{};
    Real density = 1000;       ///< [kg/m3]
    Real viscosity = 1.31e-3;  ///< dynamic [Pa s]
    /// Limit of dt (sum |u_a| / h_a + 2 nu sum 1 / h_a^2) [-]. A channel's depth and speed are the same at
    /// 0.9 to four digits; waves, jumps and walls that cut cells lose up to a percent more there.
    Real courant = 0.5;
    Real largest_step = 0;  ///< [s]; 0: none
    /// Root mean square of the share of its volume that a cell may gain or lose in a step [-]. Where there is
    /// a surface the next step takes it back: no volume is lost, whatever the tolerance.
    Real tolerance = 1e-6;
    Real velocity_limit = 100;  ///< beyond it a run is wrong [m/s]
    /// Of a HeightSurface: the slope beyond which it is held back from steepening, for there water wants to
    /// overturn [-]; and the share of the wet area that may be held back, mean of about ten steps [-].
    Real steepest_surface = 2, most_overturning = 0.25;
    Real start_time = 0;  ///< [s]; before 0: it settles before the solids begin

    /// Gravity and body force at a time [m/s2]. Throws InputError where that is no number.
    Point<Dim> acceleration(Real time) const {
        Point<Dim> sum = gravity;
        if (!body_force) return sum;
        sum += body_force(time);
        for (int a = 0; a < Dim; ++a)
            if (!std::isfinite(sum[a]))
                require_finite(sum[a],
                               std::string("GridFluid.body_force.") + Grid<Dim>::axis_name(a) +
                                   " at t = " + short_text(time) + " s",
                               "m/s2");
        return sum;
    }

    void validate() const {
        grid.validate();
        boundaries.validate();
        wall_law.validate();
        for (int a = 0; a < Dim; ++a)
            require_finite(gravity[a], std::string("GridFluid.gravity.") + Grid<Dim>::axis_name(a), "m/s2");
        require_start_time(start_time, "GridFluid.start_time");
        if (body_force)
            for (int a = 0; a < Dim; ++a)
                require_finite(body_force(start_time)[a],
                               std::string("GridFluid.body_force.") + Grid<Dim>::axis_name(a), "m/s2");
        require_positive(density, "GridFluid.density", "kg/m3", "water has 1000 kg/m3");
        require_not_negative(viscosity, "GridFluid.viscosity", "Pa s",
                             "water has 1.31e-3 Pa s at 10 degrees C");
        require(courant > 0 && courant <= 1,
                {"GridFluid.courant", "in (0, 1]", "", "0.5 is usual; beyond 1 steps are not stable"},
                courant);
        require_not_negative(largest_step, "GridFluid.largest_step", "s", "0: none");
        require(tolerance > 0 && tolerance <= 0.01,
                {"GridFluid.tolerance", "in (0, 0.01]", "", "1e-6 is usual, 1e-4 is fast"}, tolerance);
        require_positive(velocity_limit, "GridFluid.velocity_limit", "m/s",
                         "100 m/s is far beyond any channel");
        require_positive(steepest_surface, "GridFluid.steepest_surface", "");
        require(most_overturning >= 0 && most_overturning <= 1,
                {"GridFluid.most_overturning", "from 0 to 1", "", "0.25 is usual"}, most_overturning);
        bool in = false, out = false;
        for (int a = 0; a < Dim; ++a)
            for (const Boundary side : boundaries[a])
                in = in || side == Boundary::inflow, out = out || side == Boundary::outflow;
        if (in && !boundary_velocity)
            fail({"GridFluid.boundary_velocity", "given where a side is an inflow", "m/s",
                  "give the velocity there"},
                 "none");
        require_not_negative(inflow_discharge, "GridFluid.inflow_discharge", Dim == 3 ? "m3/s" : "m2/s",
                             "0: what boundary_velocity carries");
        if (inflow_discharge > 0 && !inflow_water)
            fail({"GridFluid.inflow_discharge", "given together with inflow_water", "",
                  "say where the water that flows in is"},
                 short_text(inflow_discharge));
        if (inflow_water && !in)
            fail({"GridFluid.inflow_water", "left out where no side is an inflow", "",
                  "make a side an inflow"},
                 "given");
        if (outflow_water && !out)
            fail({"GridFluid.outflow_water", "left out where no side is an outflow", "",
                  "make a side an outflow"},
                 "given");
        if (in && !out && !water && !inflow_water)
            fail({"GridFluid.boundaries", "with an outflow where there is an inflow", "",
                  "what flows in must leave, or the pressure has no bound"},
                 "none");
    }
    void visit(auto&& f) const {
        for (int a = 0; a < Dim; ++a)
            f(std::string("cells_") + Grid<Dim>::axis_name(a),
              static_cast<Real>(grid.cells[static_cast<std::size_t>(a)]), "-");
        f("density", density, "kg/m3");
        f("viscosity", viscosity, "Pa s");
        f("courant", courant, "-");
        f("tolerance", tolerance, "-");
    }
};

}  // namespace abrade
