#pragma once
// What water on a grid begins with, and what only shows once its grid and its walls are there.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/mesh/velocity_boundaries.hpp>
#include <abrade/fluid/setup/grid_fluid_params.hpp>
#include <abrade/fluid/vof/liquid_in_cut_cells.hpp>
#include <abrade/fluid/vof/volume_of_fluid.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

namespace abrade::detail {

/// Velocities of the start on faces [m/s]. Throws InputError where one is no number or too fast.
template <int Dim, class State>
void give_velocity(const Grid<Dim>& grid, const GridFluidParams<Dim>& params, FaceField<Dim, State>& u) {
    if (!params.velocity) return;
    grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
        for (int a = 0; a < Dim; ++a) {
            const Point<Dim> x = grid.face_centre(a, cell);
            const Real value = params.velocity(x)[a];
            if (!std::isfinite(value))
                require_finite(value, velocity_at<Dim>("GridFluid.velocity", a, x, params.start_time), "m/s");
            const auto holds_water = [&] {
                return (!params.wall || params.wall(x) > 0) && (!params.water || params.water(x) > 0);
            };
            if (std::abs(value) > params.velocity_limit && holds_water())
                fail({velocity_at<Dim>("GridFluid.velocity", a, x, params.start_time),
                      "at most GridFluid.velocity_limit, " + short_text(params.velocity_limit), "m/s",
                      "raise velocity_limit if it is meant"},
                     short_text(value));
            u[a][c] = static_cast<State>(value);
        }
    });
}

/// Throws InputError for what needs a surface.
template <int Dim>
void refuse_in_full_box(const GridFluidParams<Dim>& params) {
    if (params.wall || params.inflow_water || params.outflow_water)
        fail({params.wall           ? "GridFluid.wall"
              : params.inflow_water ? "GridFluid.inflow_water"
                                    : "GridFluid.outflow_water",
              "left out of a FullBox", "", "take a FreeSurface with water everywhere"},
             "given");
}

/// Walls inside the box, none where none are given. In cells that are longer than high a sliver
/// takes in, by its large faces, many times what its small ones let out: of such cells more are closed, up to
/// a tenth of those of 10:1. Throws as `EmbeddedBoundary` does.
template <int Dim>
std::shared_ptr<const EmbeddedBoundary<Dim>> walls_inside(const Grid<Dim>& grid,
                                                          const GridFluidParams<Dim>& params) {
    if (!params.wall) return nullptr;
    Real longest = 0, shortest = std::numeric_limits<Real>::infinity();
    for (int a = 0; a < Dim; ++a)
        longest = std::max(longest, grid.largest(a)), shortest = std::min(shortest, grid.smallest(a));
    const Real closed_below = std::min(1e-3 * square(longest / shortest), 0.1);
    const typename EmbeddedBoundary<Dim>::Params how{.closed_below = closed_below,
                                                     .called = "GridFluid.wall"};
    const auto walls = std::make_shared<EmbeddedBoundary<Dim>>(grid, params.wall, how);
    walls->repeat(params.boundaries, params.wall);
    return walls;
}

/// What `water` tells at a place of a cell, 0 to 1 along each axis. Within the wall there may be other water,
/// or none: there goes on, linearly, what it tells at the corner farthest in the open.
template <int Dim>
Real water_in_the_open(const Grid<Dim>& grid, const CellNumber<Dim>& cell, const Point<Dim>& unit,
                       const PlaceFunction<Dim>& wall, const PlaceFunction<Dim>& water) {
    const auto place = [&](const Point<Dim>& at) {
        Point<Dim> x;
        for (int a = 0; a < Dim; ++a) x[a] = grid.face(a, cell[a]) + grid.size(a, cell[a]) * at[a];
        return x;
    };
    const Point<Dim> x = place(unit);
    if (wall(x) >= 0) return water(x);
    Point<Dim> open = x;
    for (int n = 0; n < 1 << Dim; ++n) {
        Point<Dim> corner;
        for (int a = 0; a < Dim; ++a) corner[a] = n >> a & 1;
        if (wall(place(corner)) > wall(open)) open = place(corner);
    }
    Real value = water(open);
    for (int a = 0; a < Dim; ++a) {
        Point<Dim> step = Point<Dim>::Zero();
        step[a] = 1e-3 * grid.size(a, cell[a]);
        value += (x[a] - open[a]) * (water(open + step) - water(open - step)) / (2 * step[a]);
    }
    return value;
}

/// Shares of the open volume that lie in the water of the start, and beyond inflows. Throws InputError where
/// a function answers no number, and what it throws.
template <int Dim, class Liquid>
void give_water(const GridFluidParams<Dim>& params, const EmbeddedBoundary<Dim>* walls, Liquid& liquid) {
    const Grid<Dim>& grid = liquid.grid();
    Field<Real>& f = liquid.fraction();
    const auto shares = [&](const PlaceFunction<Dim>& water, const char* called, auto&& wanted) {
        if (!water) return;
        const typename EmbeddedBoundary<Dim>::Params how{
            .closed_below = 0, .may_close_all = true, .bounded_slope = false, .called = called};
        const EmbeddedBoundary<Dim> filled(grid, water, how);
        grid.for_each(
            [&](const CellNumber<Dim>& cell, Offset c) {
                if (!wanted(cell) || (walls && walls->open_fraction()[c] == 0)) return;
                const Real share = filled.open_fraction()[c];
                const bool cut = walls && (liquid.marks()[c] & cell_mark::whole) == 0;
                const auto at = [&](const Point<Dim>& unit) {
                    return water_in_the_open(grid, cell, unit, params.wall, water);
                };
                f[c] = cut && share > 0 && share < 1
                           ? WaterAmongWalls<Dim>::share(walls->aperture(), grid.layout().stride, c,
                                                         walls->open_fraction()[c], at)
                           : share;
            },
            Layout<Dim>::ghosts);
    };
    shares(params.water, "GridFluid.water", [&](const CellNumber<Dim>& cell) { return grid.has(cell); });
    shares(params.inflow_water, "GridFluid.inflow_water", [&](const CellNumber<Dim>& cell) {
        for (int a = 0; a < Dim; ++a)
            if ((cell[a] < 0 && params.boundaries[a][0] == Boundary::inflow) ||
                (cell[a] >= grid.cells(a) && params.boundaries[a][1] == Boundary::inflow))
                return true;
        return false;
    });
}

/// Throws InputError where walls close an inflow, or leave nothing of it open that its water reaches.
template <int Dim, class Liquid>
void check_inflows(const GridFluidParams<Dim>& params, const Liquid& liquid,
                   const EmbeddedBoundary<Dim>* walls) {
    const Grid<Dim>& grid = liquid.grid();
    for (int a = 0; a < Dim; ++a)
        for (const bool high : {false, true}) {
            if (params.boundaries[a][high] != Boundary::inflow) continue;
            Index faces = 0, open = 0, wet = 0;
            grid.for_each_beside(a, high, [&](const CellNumber<Dim>&, Offset c) {
                const Offset s = grid.layout().stride[a];
                ++faces;
                if (walls && !(walls->aperture()[a][high ? c + s : c] > 0)) return;
                ++open;
                wet += liquid.fraction()[high ? c + s : c - s] > 0;
            });
            std::string side = high ? "upper" : "lower";
            side.append(" side along ").push_back(Grid<Dim>::axis_name(a));
            const std::string of = " of " + std::to_string(faces) + " faces";
            if (open == 0)
                fail({"GridFluid.wall", "open somewhere at the inflow (" + side + ")", "",
                      "move the wall or the box; is the distance above 0 in the water?"},
                     "0" + of);
            if (params.inflow_water && wet == 0)
                fail({"GridFluid.inflow_water", "> 0 somewhere at the inflow (" + side + ")", "",
                      "what is open of that side lies above its surface: move the surface or the box"},
                     "water beyond 0" + of);
        }
}

/// What flows in with a velocity [m3/s], of the liquid beyond inflows.
template <int Dim, class Liquid>
Real inflow_of(const FaceField<Dim>& u, const BoundaryConditions<Dim>& boundaries, const Liquid& liquid,
               const EmbeddedBoundary<Dim>* walls) {
    const Grid<Dim>& grid = liquid.grid();
    Real sum = 0;
    for (int a = 0; a < Dim; ++a)
        for (const bool high : {false, true}) {
            if (boundaries[a][high] != Boundary::inflow) continue;
            grid.for_each_beside(a, high, [&](const CellNumber<Dim>& cell, Offset c) {
                const Offset s = grid.layout().stride[a], face = high ? c + s : c;
                const Real open = walls ? walls->aperture()[a][face] : 1;
                const Real area = open * grid.volume(cell) / grid.size(a, cell[a]);
                sum += (high ? -1 : 1) * u[a][face] * area * liquid.fraction()[high ? c + s : c - s];
            });
        }
    return sum;
}

}  // namespace abrade::detail
