#pragma once
// Force and moment of water on walls inside its box and on the box's sides, or on a part of them.

#include <abrade/fluid/embedded_boundary/flat_patch.hpp>
#include <abrade/fluid/queries/flow_pressure.hpp>
#include <abrade/fluid/queries/wall_shear.hpp>

#include <string>
#include <vector>

namespace abrade {

/// In two dimensions per metre of width: forces in N/m, moments in N.
template <int Dim>
struct Load {
    Point<Dim> force = Point<Dim>::Zero();  ///< on the wall [N]
    Vec3 moment = Vec3::Zero();             ///< about the given point [N m]; in 2-D about y alone

    Load& operator+=(const Load& other) noexcept {
        force += other.force, moment += other.moment;
        return *this;
    }
};

/// What water does to a wall.
template <int Dim>
struct WallLoad {
    Load<Dim> pressure, shear;
    Real area = 0;    ///< of the wall [m2]; in 2-D [m]
    Real wetted = 0;  ///< of that below water [m2]; in 2-D [m]

    Load<Dim> total() const noexcept { return Load<Dim>(pressure) += shear; }
};

/// All of a wall.
struct Everywhere {
    bool operator()(const auto& /*x*/) const noexcept { return true; }
};
/// The part of a wall between two corners [m].
template <int Dim>
struct WithinBox {
    Point<Dim> low, high;
    bool operator()(const Point<Dim>& x) const noexcept {
        return (x.array() >= low.array()).all() && (x.array() <= high.array()).all();
    }
};
namespace detail {

template <GridFlow Flow>
class WallLoads {
    static constexpr int Dim = dimensions<Flow>;
    using Cell = CellNumber<Dim>;
    using Head = LinearHead<Dim>;

public:
    WallLoads(const Flow& flow, const Point<Dim>& about, std::string_view called)
        : flow_(flow), cells_(flow), shear_(flow, cells_), grid_(flow.grid()), about_(about) {
        for (int a = 0; a < Dim; ++a)
            require_finite(about[a], std::string(called) + ": about." + Grid<Dim>::axis_name(a), "m");
    }

    WallLoad<Dim> on_walls(auto&& part) const {
        if (!cells_.walls())
            fail({"wall_load: GridFluid.wall", "given", "", "the sides of the box have side_load"}, "none");
        WallLoad<Dim> load;
        std::vector<char> counts;
        for (const CutCell<Dim>& w : cells_.walls()->cut_cells()) {
            counts.push_back(part(w.point));
            if (!counts.back()) continue;
            load.area += w.area;
            add_pressure(load, w);
        }
        shear_.on_walls(
            counts, [&](const CutCell<Dim>& w, const Point<Dim>& force) { add(load.shear, w.point, force); });
        return load;
    }

    WallLoad<Dim> on_side(BoxSide side, auto&& part) const {
        require(side.axis >= 0 && side.axis < Dim,
                {"side_load: side.axis", Dim == 3 ? "0 (x), 1 (y) or 2 (z)" : "0 (x) or 1 (z)", "",
                 "it is the axis that the side stands across"},
                side.axis);
        const Boundary kind = cells_.boundaries()[side.axis][side.high];
        if (!is_closed(kind))
            fail({"side_load: side", "closed (wall or slip)", "",
                  "section says what goes through an open one"},
                 boundary_name(kind));
        WallLoad<Dim> load;
        grid_.for_each_beside(side.axis, side.high, [&](const Cell& cell, Offset c) {
            const Offset face = side.high ? c + grid_.layout().stride[side.axis] : c;
            const Real open = cells_.aperture(side.axis, face);
            if (open == 0) return;
            FlatPatch<Dim> patch = open_face(cell, side.axis, side.high, distances(cell, open < 1));
            auto m = patch.moments();
            if (m.area == 0 || !part(m.centre)) return;
            const Real area = open * face_area(side.axis, cell), scale = area / m.area;
            const Point<Dim> outward = (side.high ? 1 : -1) * Point<Dim>::Unit(side.axis);
            load.area += area;
            if (!cells_.has_water(c)) return;
            if (kind == Boundary::wall) add(load.shear, m.centre, shear_.on_side(side, cell, c, area));
            const auto head = cells_.head_about(cell);
            if (!head) return;
            if (!cells_.is_full(c)) {
                patch.keep([&](const Point<Dim>& x) { return cells_.pressure(*head, x); });
                m = patch.moments();
            }
            load.wetted += scale * m.area;
            add(load.pressure, m.centre, scale * m.area * cells_.pressure(*head, m.centre) * outward);
            load.pressure.moment += scale * cross(m.second * cells_.gradient(*head), outward);
        });
        return load;
    }

private:
    static Vec3 cross(const Point<Dim>& x, const Point<Dim>& force) noexcept {
        if constexpr (Dim == 3)
            return x.cross(force);
        else
            return {0, x[1] * force[0] - x[0] * force[1], 0};
    }
    void add(Load<Dim>& load, const Point<Dim>& at, const Point<Dim>& force) const noexcept {
        load.force += force, load.moment += cross(at - about_, force);
    }
    Real face_area(int axis, const Cell& cell) const noexcept {
        return grid_.volume(cell) / grid_.size(axis, cell[axis]);
    }

    /// Distances from the wall at the corners of a cell, all 1 where it cuts none of what is asked [m].
    Corners<Dim> distances(const Cell& cell, bool cut) const {
        Corners<Dim> distance;
        distance.fill(1);
        if (!cut) return distance;
        for (std::size_t k = 0; k < distance.size(); ++k) {
            Point<Dim> x;
            for (int a = 0; a < Dim; ++a) x[a] = grid_.face(a, cell[a] + static_cast<int>(k >> a & 1));
            distance[k] = flow_.params().wall(x);
        }
        return distance;
    }
    /// The open part of a cell's face, the same for both of its cells; all of it where corners miss that.
    FlatPatch<Dim> open_face(const Cell& cell, int axis, bool upper, const Corners<Dim>& distance) const {
        const std::size_t end = upper ? 1 : 0;
        const auto corners = corners_of_face<Dim>(distance, axis, end);
        const auto patch = FlatPatch<Dim>::open_face(grid_, cell, axis, end, corners);
        if (!patch.empty()) return patch;
        Corners<Dim - 1> all;
        all.fill(1);
        return FlatPatch<Dim>::open_face(grid_, cell, axis, end, all);
    }

    /// Pressure on the wall of one cell, and of what there is of it below water.
    void add_pressure(WallLoad<Dim>& load, const CutCell<Dim>& w) const {
        if (!cells_.has_water(w.cell)) return;
        const Cell cell = grid_.layout().number(w.cell);
        const auto head = cells_.head_about(cell);
        if (!head) return;
        const auto pressure = [&](const Point<Dim>& x) { return cells_.pressure(*head, x); };
        Point<Dim> low, high;
        for (int a = 0; a < Dim; ++a) low[a] = grid_.face(a, cell[a]), high[a] = grid_.face(a, cell[a] + 1);
        auto patch = FlatPatch<Dim>::in_box(w.point, w.normal, low, high);
        auto m = patch.moments();
        if (m.area == 0) m.centre = w.point;
        Real scale = m.area > 0 ? w.area / m.area : 0;
        Point<Dim> force;
        if (cells_.is_full(w.cell)) {
            force = closing_force(cell, w.cell, *head);
            load.wetted += w.area;
        } else {
            patch.keep(pressure);
            m = patch.moments();
            force = -scale * m.area * pressure(m.centre) * w.normal;
            load.wetted += scale * m.area;
        }
        add(load.pressure, m.centre, force);
        load.pressure.moment -= scale * cross(m.second * cells_.gradient(*head), w.normal);
    }

    /// On the wall of a cell full of water, what its open faces leave over of the gradient's integral: faces
    /// have the same for both of their cells, so of water at rest sums are the weight of what is displaced.
    Point<Dim> closing_force(const Cell& cell, Offset c, const Head& head) const {
        const Corners<Dim> distance = distances(cell, true);
        Point<Dim> force = cells_.open_fraction(c) * grid_.volume(cell) * cells_.gradient(head);
        for (int a = 0; a < Dim; ++a)
            for (const bool upper : {false, true}) {
                const Real open = cells_.aperture(a, upper ? c + grid_.layout().stride[a] : c);
                if (open == 0) continue;
                const Real pressure =
                    cells_.pressure(head, open_face(cell, a, upper, distance).moments().centre);
                force[a] -= (upper ? 1 : -1) * open * face_area(a, cell) * pressure;
            }
        return force;
    }

    const Flow& flow_;
    FlowCells<Flow> cells_;
    WallShear<Flow> shear_;
    const Grid<Dim>& grid_;
    Point<Dim> about_;
};

}  // namespace detail

/// Force and moment of the water on the walls inside the box (`GridFluidParams::wall`).
///   F = sum p A m + sum tau A,   M = sum (x - about) x dF,
///   p    pressure of `pressure_on_wall`, linear over each cell's wall [Pa]
///   A    area of the wall in a cell [m2]
///   m    into the solid [-]
///   tau  shear of the WallLaw, as the solver takes it from the water [Pa]; slip: 0. Where walls leave less
///        than half of a control volume open also what the solver's bounds take there
/// The pressure's part closes: with V what walls leave open of a cell, A_a and p_a its open faces and the
/// mean pressures there, F_a = V dp/dx_a - (A_a p_a above - A_a p_a below), and neighbours have the same
/// A_a p_a. So at rest the force on a solid under water is the weight of the volume that the grid has of it;
/// where the surface cuts its wall, of second order.
/// `part(x)` says which of the wall counts, by the point of each cell's wall: all of a cell's or nothing, so
/// parts that make up the wall add up to its load. `WithinBox` is one.
/// Takes one pass over the cells that walls cut; asks the wall's function at the corners of each.
/// Throws InputError where no wall was given or `about` is not finite, and what the wall's function throws.
template <GridFlow Flow, class Part = Everywhere>
requires std::predicate < const Part&, const Point<dimensions<Flow>>
& > WallLoad<dimensions<Flow>> wall_load(const Flow& flow, const Point<dimensions<Flow>>& about,
                                         const Part& part = {}) {
    return detail::WallLoads<Flow>(flow, about, "wall_load").on_walls(part);
}

/// The same for a closed side of the box, by faces of cells; `part(x)` is asked at their middles. Of water at
/// rest the sides and the walls carry its weight. With a logarithmic law shear is that of `Boundary::wall`.
/// Throws InputError for a side that does not exist or is open, and an `about` that is not finite.
template <GridFlow Flow, class Part = Everywhere>
requires std::predicate < const Part&, const Point<dimensions<Flow>>
& > WallLoad<dimensions<Flow>> side_load(const Flow& flow, BoxSide side, const Point<dimensions<Flow>>& about,
                                         const Part& part = {}) {
    return detail::WallLoads<Flow>(flow, about, "side_load").on_side(side, part);
}

}  // namespace abrade
