#pragma once
// Laminar flow of a viscous liquid between two plates (Poiseuille) and down an incline (Nusselt), with walls
// at sides of the box, off the grid planes and at an angle to them.

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

namespace viscous {

using namespace abrade;

/// Of a computed flow, the fastest exact speed and the width being 1.
struct Errors {
    Real profile = 0;     ///< root mean square over the faces whose centres are in the water
    Real largest = 0;     ///< on one of them
    Real middle = 0;      ///< as profile, over open faces and against the middle of what is open of each
    Real resistance = 0;  ///< what drives the flow, over what should drive that discharge, less 1
};

/// Order from n to 2 n cells.
inline Real order(Real coarse, Real fine) { return std::log2(std::abs(coarse / fine)); }

/// The difference between a velocity and an exact one, face by face.
template <class Flow>
class ProfileErrors {
public:
    explicit ProfileErrors(const Flow& flow) : flow_(&flow) {}
    void add(int axis, const CellNumber<2>& cell, const Point<2>& exact) {
        const Real off = flow_->velocity()[axis][flow_->grid().layout().at(cell)] - exact[axis];
        sum_ += off * off, ++count_;
        largest_ = std::max(largest_, std::abs(off));
    }
    Errors errors() const { return {.profile = std::sqrt(sum_ / std::max(count_, 1)), .largest = largest_}; }

private:
    const Flow* flow_;
    Real sum_ = 0, largest_ = 0;
    int count_ = 0;
};

/// Between the lower and the upper side of a full box, periodic along the flow: u = 4 z (1 - z), driven by
/// g = 8, nu = 1. It starts at rest.
inline Errors between_sides(int cells) {
    const Real h = 1.0 / cells;
    BoundaryConditions<2> boundaries;
    boundaries[0] = {Boundary::periodic, Boundary::periodic};
    GridFluid<2, FullBox> flow({.grid = {.cells = {4, cells}, .spacing = {h, h}},
                                .boundaries = boundaries,
                                .gravity = {8, 0},
                                .density = 1,
                                .viscosity = 1,
                                .tolerance = 1e-11});
    flow.advance(1.5);  // what is left of the start is exp(-1.5 pi^2) = 4e-7
    ProfileErrors off(flow);
    Real discharge = 0;
    for (int k = 0; k < cells; ++k) {
        const Real z = flow.grid().centre(1, k);
        off.add(0, {2, k}, {4 * z * (1 - z), 0});
        discharge += h * flow.velocity()[0][flow.grid().layout().at({2, k})];
    }
    Errors e = off.errors();
    e.middle = e.profile;
    e.resistance = 2.0 / 3 / discharge - 1;
    return e;
}

/// A channel between walls inside a box full of water, which rises at `angle` to the grid: inflow with the
/// exact profile at the left, outflow at the right; gravity of 8 along it, so the pressure should be 0
/// everywhere.
struct Channel {
    int cells = 16;    ///< across
    Real angle = 0;    ///< [rad]
    Real share = 0.7;  ///< open share of the lowest cell at the inflow; if level, of the uppermost one too
    Real end = 1;      ///< [1: width^2 / nu]
    Real length = 4;   ///< along x [1]

    Real size() const { return angle == 0 ? 1 / (cells - 2 + 2 * share) : 1.0 / cells; }
    Point<2> along() const { return {std::cos(angle), std::sin(angle)}; }
    /// From the lower wall [1].
    Real height(const Point<2>& x) const {
        return (x[1] - (2 - share) * size()) * std::cos(angle) - x[0] * std::sin(angle);
    }
    Point<2> exact(const Point<2>& x) const {
        const Real z = std::clamp(height(x), Real(0), Real(1));
        return 4 * z * (1 - z) * along();
    }
    GridFluid<2> flow() const {
        const Real h = size();
        const int columns = static_cast<int>(length / h);
        const int rise = static_cast<int>(std::ceil((1 / along()[0] + length * std::tan(angle)) / h));
        BoundaryConditions<2> boundaries = BoundaryConditions<2>::all(Boundary::free_slip);
        boundaries[0] = {Boundary::inflow, Boundary::outflow};
        const Channel c = *this;
        return GridFluid<2>({.grid = {.cells = {columns, rise + 3}, .spacing = {h, h}},
                             .boundaries = boundaries,
                             .boundary_velocity = [c](const Point<2>& x, Real) { return c.exact(x); },
                             .wall =
                                 [c](const Point<2>& x) {
                                     const Real z = c.height(x);
                                     return std::min(z, 1 - z);
                                 },
                             .water = [](const Point<2>&) { return 1.0; },
                             .inflow_water = [](const Point<2>&) { return 1.0; },
                             .velocity = [c](const Point<2>& x) { return c.exact(x); },
                             .gravity = 8 * along(),
                             .density = 1,
                             .viscosity = 1,
                             .tolerance = 1e-11});
    }

    /// The middle of what is open of a face. The height is linear along the face.
    Point<2> middle(const Grid<2>& grid, int axis, const CellNumber<2>& cell) const {
        Point<2> half = Point<2>::Zero();
        half[1 - axis] = 0.5 * size();
        const Point<2> centre = grid.face_centre(axis, cell);
        const Real low = height(centre - half), rise = height(centre + half) - low;
        const auto [first, last] = std::minmax({-low / rise, (1 - low) / rise});
        return centre + (rise == 0 ? 0 : std::max(first, Real(0)) + std::min(last, Real(1)) - 1) * half;
    }

    /// Pressure on the centre line at x [1], linear between cells.
    Real pressure(const GridFluid<2>& flow, Real x) const {
        const Real h = size(), z = (2 - share) * h + (0.5 + x * along()[1]) / along()[0];
        const int i = static_cast<int>(x / h - 0.5), k = static_cast<int>(z / h - 0.5);
        const Real right = x / h - 0.5 - i, up = z / h - 0.5 - k;
        const auto p = [&](int a, int b) { return flow.pressure()[flow.grid().layout().at({a, b})]; };
        return (1 - right) * ((1 - up) * p(i, k) + up * p(i, k + 1)) +
               right * ((1 - up) * p(i + 1, k) + up * p(i + 1, k + 1));
    }

    /// Between x = 1 and 2. At an angle the outflow turns the flow, by half of its speed at 45 degrees:
    /// that falls as exp(-4.2 s) over a way s, to 2e-4 at x = 2. What comes in is exact.
    Errors errors() const {
        GridFluid<2> water = flow();
        water.advance(end);
        const Grid<2>& grid = water.grid();
        const int first = static_cast<int>(1 / size()), last = 2 * first;
        ProfileErrors off(water), off_middle(water);
        Real discharge = 0;
        grid.for_each([&](const CellNumber<2>& cell, Offset c) {
            if (cell[0] < first || cell[0] >= last) return;
            const auto& open = water.walls()->aperture();
            discharge += open[0][c] * water.velocity()[0][c] * size() / (last - first);
            for (int a = 0; a < 2; ++a) {
                const Point<2> x = grid.face_centre(a, cell);
                const Real z = height(x);
                if (open[a][c] > 0 && z > 0 && z < 1) off.add(a, cell, exact(x));
                if (open[a][c] > 0) off_middle.add(a, cell, exact(middle(grid, a, cell)));
            }
        });
        Errors e = off.errors();
        e.middle = off_middle.errors().profile;
        const Real slope = (pressure(water, 2) - pressure(water, 1)) * along()[0];
        e.resistance = (8 - slope) / 8 / (1.5 * discharge) - 1;
        return e;
    }
};

/// A film of depth 1 down an incline, on the box's lower side or on a wall inside: u = 2 z - z^2, driven by
/// g sin(slope) = 2, nu = 1; inflow with the exact profile and depth, outflow.
struct Film {
    int cells = 16;          ///< in the depth
    Real top = 0;            ///< liquid fraction of the uppermost cell (0: the surface is on a grid plane)
    Real share = 0;          ///< open share of the lowest cell; 0: the bed is the side of the box
    Real slope = 0.25 * pi;  ///< [rad]
    Real end = 2;            ///< [1: depth^2 / nu]

    Real size() const { return 1 / (cells + top + (share > 0 ? share - 1 : 0)); }
    Real bed() const { return share > 0 ? (2 - share) * size() : 0; }
    Point<2> exact(const Point<2>& x) const {
        const Real z = std::clamp(x[1] - bed(), Real(0), Real(1));
        return {2 * z - z * z, 0};
    }
    GridFluid<2> flow() const {
        const Real h = size();
        BoundaryConditions<2> boundaries = BoundaryConditions<2>::all(Boundary::free_slip);
        boundaries[0] = {Boundary::inflow, Boundary::outflow};
        if (share == 0) boundaries[1][0] = Boundary::wall;
        const Film f = *this;
        const auto below = [f](const Point<2>& x) { return f.bed() + 1 - x[1]; };
        GridFluid<2>::Params params{
            .grid = {.cells = {static_cast<int>(std::lround(4 / h)), cells + 4}, .spacing = {h, h}},
            .boundaries = boundaries,
            .boundary_velocity = [f](const Point<2>& x,
                                     Real) { return x[0] > 0 ? Point<2>::Zero().eval() : f.exact(x); },
            .water = below,
            .inflow_water = below,
            .velocity = [f](const Point<2>& x) { return f.exact(x); },
            .gravity = {2, -2 / std::tan(slope)},
            .density = 1,
            .viscosity = 1,
            .tolerance = 1e-11};
        if (share > 0) params.wall = [f](const Point<2>& x) { return x[1] - f.bed(); };
        return GridFluid<2>(params);
    }

    /// In the middle. `resistance` is that of the depth and the slope of the surface that it has come to
    /// there.
    Errors errors() const {
        GridFluid<2> water = flow();
        water.advance(end);
        const Grid<2>& grid = water.grid();
        const auto held = [&](int i, int k) {
            const Offset c = grid.layout().at({i, k});
            return water.liquid().fraction()[c] * (water.walls() ? water.walls()->open_fraction()[c] : 1);
        };
        const auto depth = [&](int i) {
            Real sum = 0;
            for (int k = 0; k < grid.cells(1); ++k) sum += size() * held(i, k);
            return sum;
        };
        const int middle = grid.cells(0) / 2, half = cells / 2;
        ProfileErrors off(water);
        Real discharge = 0;
        for (int k = 0; k < grid.cells(1); ++k) {
            const Point<2> x = grid.face_centre(0, {middle, k});
            if (x[1] > bed() && x[1] < bed() + 1) off.add(0, {middle, k}, exact(x));
            discharge += size() * 0.5 * (held(middle, k) + held(middle - 1, k)) *
                         water.velocity()[0][grid.layout().at({middle, k})];
        }
        Errors e = off.errors();
        const Real deep = 0.5 * (depth(middle) + depth(middle - 1));
        const Real fall = (depth(middle + half) - depth(middle - half)) / (2 * half * size());
        e.resistance = (2 - 2 / std::tan(slope) * fall) * deep * deep * deep / 3 / discharge - 1;
        return e;
    }
};

}  // namespace viscous
