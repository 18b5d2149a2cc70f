#pragma once
// What a user asks water on a grid: pressure at a point and on a wall, flow through a section, water level.

#include <abrade/fluid/queries/flow_pressure.hpp>

#include <algorithm>
#include <string>

namespace abrade {

/// Pressure at a point of the box [Pa], against the void above the surface.
///   p(x) = rho (H(x) + g . x),  H = p / rho - g . x,
///   rho  density [kg/m3]
///   g    gravity and body force at the flow's time [m/s2]
///   H    what flow changes of it [m2/s2]: linear between the centres of wet cells; beside walls, sides and
///        the surface linear by least squares over the wet cells around
/// Exact in water at rest up to the surface, of second order where it moves. 0 above the surface, in cells
/// that walls close, and in drops that hold the centre of no cell. In a full box it is known but for a
/// constant, unless a side is an outflow.
/// Throws InputError for a point that is not finite or not in the box; along periodic axes it may be beyond.
template <GridFlow Flow>
Real pressure_at(const Flow& flow, const Point<dimensions<Flow>>& x) {
    const detail::FlowCells<Flow> cells(flow);
    const auto at = detail::inside_box(flow.grid(), cells.boundaries(), x, "pressure_at: x");
    const Offset c = flow.grid().layout().at(cells.holding(at));
    if (!cells.has_water(c)) return 0;
    const Real found = cells.pressure_at(at).value_or(0);
    return cells.is_full(c) ? found : std::max(found, Real(0));
}

/// Pressure at a point of a wall inside the box or of a closed side [Pa]: the linear H of `pressure_at`, of
/// the cell that holds the point or, where walls close it, of the one that the wall's normal leads to.
/// Exact in water at rest, of second order where it moves. 0 where the wall is dry.
/// Throws InputError for a point that is not finite, not in the box, or farther than a cell from a wall.
template <GridFlow Flow>
Real pressure_on_wall(const Flow& flow, const Point<dimensions<Flow>>& x) {
    constexpr int Dim = dimensions<Flow>;
    const detail::FlowCells<Flow> cells(flow);
    const Grid<Dim>& grid = flow.grid();
    const auto at = detail::inside_box(grid, cells.boundaries(), x, "pressure_on_wall: x");
    CellNumber<Dim> cell = cells.holding(at);
    Real size = grid.size(0, 0), nearest = std::numeric_limits<Real>::infinity();
    for (int a = 0; a < Dim; ++a) size = std::min(size, grid.size(a, cell[a]));
    Point<Dim> normal = Point<Dim>::Zero();
    if (const auto& wall = flow.params().wall; cells.walls() && wall) {
        const Real step = 1e-3 * size;
        for (int a = 0; a < Dim; ++a)
            normal[a] =
                (wall(at + step * Point<Dim>::Unit(a)) - wall(at - step * Point<Dim>::Unit(a))) / (2 * step);
        const Real slope = normal.norm();
        if (slope > 0) nearest = std::abs(wall(at)) / slope, normal /= slope;
    }
    for (int a = 0; a < Dim; ++a)
        for (const int end : {0, 1}) {
            const Real apart = end == 0 ? at[a] - grid.low(a) : grid.high(a) - at[a];
            if (!is_closed(cells.boundaries()[a][end]) || apart >= nearest) continue;
            nearest = apart, normal = (end == 0 ? 1 : -1) * Point<Dim>::Unit(a);
        }
    Real reach = 0;
    for (int a = 0; a < Dim; ++a) reach = std::max(reach, grid.size(a, cell[a]));
    require(nearest <= reach,
            {"pressure_on_wall: distance of x from a wall",
             "at most that of a cell (" + short_text(reach) + " m)", "m", "pressure_at answers in the water"},
            nearest);
    if (cells.open_fraction(grid.layout().at(cell)) == 0) {
        Point<Dim> off = at + 0.5 * size * normal;
        for (int a = 0; a < Dim; ++a) off[a] = std::clamp(off[a], grid.low(a), grid.high(a));
        cell = cells.holding(off);
    }
    const Offset c = grid.layout().at(cell);
    const auto head = cells.head_about(cell);
    if (!head || (cells.open_fraction(c) > 0 && !cells.has_water(c))) return 0;
    const Real found = cells.pressure(*head, at);
    return cells.is_full(c) ? found : std::max(found, Real(0));
}

/// What goes through a plane across the grid, upwards along its axis; in two dimensions per metre of width.
struct FlowSection {
    Real discharge = 0;  ///< Q = int u dA [m3/s]; in 2-D [m2/s]
    Real mass = 0;       ///< rho Q [kg/s]; in 2-D [kg/(m s)]
    /// rho int u (|u|^2 / 2 + p / rho - g . x) dA [W]; in 2-D [W/m]: kinetic energy, work of the pressure,
    /// and potential energy from the origin of the box's coordinates.
    Real energy = 0;
    Real area = 0;   ///< A, wetted [m2]; in 2-D [m]
    Real width = 0;  ///< T of the water in plan [m]; in 2-D [-], 1 where there is water; 0: plane is level

    Real mean_velocity() const noexcept { return area > 0 ? discharge / area : 0; }  ///< Q / A [m/s]
    Real mean_depth() const noexcept { return width > 0 ? area / width : 0; }        ///< A / T [m]
    /// Energy over weight that goes through, under gravity g [m/s2]: the energy head [m]; 0 without flow.
    Real energy_head(Real g = standard_gravity) const noexcept { return mass != 0 ? energy / (mass * g) : 0; }
};

namespace detail {

/// Through the lower faces of the cells of one number along an axis.
template <GridFlow Flow>
class FaceSection {
    static constexpr int Dim = dimensions<Flow>, vertical = Dim - 1;

public:
    FaceSection(const FlowCells<Flow>& cells, int axis, int number) : cells_(cells), axis_(axis) {
        const Grid<Dim>& grid = cells.grid();
        grid.for_each_beside(axis, false, [&](CellNumber<Dim> cell, Offset) {
            cell[axis] = number;
            add(cell);
        });
        if (axis == vertical) return;
        for (const Real w : width_) sum.width += w;
    }
    FlowSection sum;

private:
    void add(const CellNumber<Dim>& upper) {
        const Grid<Dim>& grid = cells_.grid();
        CellNumber<Dim> lower = upper;
        --lower[axis_];
        const auto low = cells_.offset(lower), high = cells_.offset(upper);
        const Offset face = high ? *high : grid.layout().at(upper);
        const Real wet = liquid(low, high, face), open = cells_.aperture(axis_, face) * wet;
        if (open == 0) return;
        Real area = open;
        for (int b = 0; b < Dim; ++b)
            if (b != axis_) area *= grid.size(b, upper[b]);
        const Real flux = cells_.velocity(axis_, face) * area, rho = cells_.density();
        Real squares = square(cells_.velocity(axis_, face));
        for (int b = 0; b < Dim; ++b)
            if (b != axis_) squares += square(across(b, low, high));
        sum.discharge += flux, sum.mass += rho * flux, sum.area += area;
        if (flux != 0) sum.energy += rho * flux * (0.5 * squares + head(lower, upper));
        if (axis_ == vertical) return;
        const int across_axis = 1 - axis_;
        const auto column = static_cast<std::size_t>(Dim == 3 ? upper[across_axis] : 0);
        if (column >= width_.size()) width_.resize(column + 1, 0);
        Real plan = 0, cells = 0;
        for (const auto& c : {low, high})
            if (c) {
                const Offset up = *c + grid.layout().stride[vertical];
                plan += std::max(cells_.aperture(vertical, *c), cells_.aperture(vertical, up)), cells += 1;
            }
        plan *= (Dim == 3 ? grid.size(across_axis, 0) : 1) / cells;
        width_[column] = std::max(width_[column], plan);
    }

    /// Share of the open face that is wet: the mean of both cells; what an inflow brings, what leaves the
    /// box.
    Real liquid(const std::optional<Offset>& low, const std::optional<Offset>& high, Offset face) const {
        const Offset below = face - cells_.grid().layout().stride[axis_];
        if (low && high) return 0.5 * (cells_.liquid(*low) + cells_.liquid(*high));
        const bool enters = cells_.boundaries()[axis_][low ? 1 : 0] == Boundary::inflow;
        return cells_.liquid(enters == !low ? below : face);
    }
    /// Component b at the face: mean of those around it that walls leave open [m/s].
    Real across(int b, const std::optional<Offset>& low, const std::optional<Offset>& high) const {
        Real sum_of = 0, count = 0;
        for (const auto& c : {low, high})
            for (const int end : {0, 1}) {
                if (!c) continue;
                const Offset at = *c + end * cells_.grid().layout().stride[b];
                if (cells_.aperture(b, at) > 0) sum_of += cells_.velocity(b, at), count += 1;
            }
        return count > 0 ? sum_of / count : 0;
    }
    /// p / rho - g . x in the middle of the face [m2/s2]
    Real head(const CellNumber<Dim>& lower, const CellNumber<Dim>& upper) const {
        const Point<Dim> x = cells_.grid().face_centre(axis_, upper);
        Real total = 0, count = 0;
        for (const auto& cell : {lower, upper}) {
            if (!cells_.offset(cell)) continue;
            if (const auto found = cells_.head_about(cell)) total += found->at(x), count += 1;
        }
        return count > 0 ? total / count : -cells_.acceleration().dot(x);  // a film or a drop: pressure 0
    }

    const FlowCells<Flow>& cells_;
    int axis_;
    std::vector<Real> width_;  ///< [column]
};

}  // namespace detail

/// What goes through the plane at coordinate x along an axis (0: x; the last: z), upwards along it.
///   Q = sum u A f   over the open faces of the grid's planes beside x, linear between the two,
///   u  velocity of the face [m/s],  A  its open area [m2],  f  its liquid share: mean of its cells [-]
/// The discharge of a steady flow is the same at every x but for what f says of a surface that is not level;
/// through grid planes of a full flow exactly so. Energy is of second order.
/// Throws InputError for an axis that does not exist, and an x that is not finite or not in the box.
template <GridFlow Flow>
FlowSection section(const Flow& flow, int axis, Real x) {
    constexpr int Dim = dimensions<Flow>;
    require(axis >= 0 && axis < Dim,
            {"section: axis", Dim == 3 ? "0 (x), 1 (y) or 2 (z)" : "0 (x) or 1 (z)", "",
             "it is the axis that the plane stands across"},
            axis);
    const detail::FlowCells<Flow> cells(flow);
    Point<Dim> at;
    for (int a = 0; a < Dim; ++a) at[a] = flow.grid().centre(a, 0);
    at[axis] = x;
    at = detail::inside_box(flow.grid(), cells.boundaries(), at, "section: at");
    const GridPlace place = place_among_faces(flow.grid(), axis, at[axis], false);
    const FlowSection low = detail::FaceSection<Flow>(cells, axis, place.low).sum;
    if (place.weight == 0) return low;
    const FlowSection high = detail::FaceSection<Flow>(cells, axis, place.low + 1).sum;
    const auto between = [&](Real FlowSection::*of) {
        return (1 - place.weight) * low.*of + place.weight * high.*of;
    };
    return {between(&FlowSection::discharge), between(&FlowSection::mass), between(&FlowSection::energy),
            between(&FlowSection::area), between(&FlowSection::width)};
}

/// Water level at a place in plan [m]: the height of the floor and of all water above it, linear between the
/// middles of columns. In two dimensions x alone; in three x and y. Under a jet or an overhang it is the
/// level that its column would come to.
/// Throws InputError for a place that is not finite or not in the box.
template <GridFlow Flow>
requires(dimensions<Flow> == 2) Real gauge(const Flow& flow, Real x)
requires requires(const Point<2>& at) { flow.surface_at(at); }
{
    const Point<2> at{x, flow.grid().low(1)};
    return flow.surface_at(detail::inside_box(flow.grid(), flow.params().boundaries, at, "gauge"));
}
template <GridFlow Flow>
requires(dimensions<Flow> == 3) Real gauge(const Flow& flow, Real x, Real y)
requires requires(const Point<3>& at) { flow.surface_at(at); }
{
    const Point<3> at{x, y, flow.grid().low(2)};
    return flow.surface_at(detail::inside_box(flow.grid(), flow.params().boundaries, at, "gauge"));
}

}  // namespace abrade
