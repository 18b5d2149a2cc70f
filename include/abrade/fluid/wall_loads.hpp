#pragma once
// Force and moment of water on walls inside its box and on the box's sides, or on a part of them.

#include <abrade/fluid/flat_patch.hpp>
#include <abrade/fluid/flow_pressure.hpp>

#include <algorithm>
#include <string>
#include <tuple>
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
/// A side of the box: `{.axis = 0, .high = true}` is the one at the largest x.
struct BoxSide {
    int axis = 0;
    bool high = false;
};

namespace detail {

template <GridFlow Flow>
class WallLoads {
    static constexpr int Dim = dimensions<Flow>;
    using Cell = CellNumber<Dim>;
    using Head = LinearHead<Dim>;
    using HeldFace = typename WallFriction<Dim>::HeldFace;

public:
    WallLoads(const Flow& flow, const Point<Dim>& about, std::string_view called)
        : flow_(flow), cells_(flow), grid_(flow.grid()), about_(about) {
        for (int a = 0; a < Dim; ++a)
            require_finite(about[a], std::string(called) + ": about." + Grid<Dim>::axis_name(a), "m");
    }

    WallLoad<Dim> on_walls(auto&& part) const {
        if (!cells_.walls())
            fail({"wall_load: GridFluid.wall", "given", "", "the sides of the box have side_load"}, "none");
        WallLoad<Dim> load;
        std::vector<char> counts;
        for (const WallCell<Dim>& w : cells_.walls()->wall_cells()) {
            counts.push_back(part(w.point));
            if (!counts.back()) continue;
            load.area += w.area;
            push(load, w);
        }
        drag(load, counts);
        return load;
    }

    WallLoad<Dim> on_side(BoxSide side, auto&& part) const {
        require(side.axis >= 0 && side.axis < Dim,
                {"side_load: side.axis", Dim == 3 ? "0 (x), 1 (y) or 2 (z)" : "0 (x) or 1 (z)", "",
                 "it is the axis that the side stands across"},
                side.axis);
        const Side kind = cells_.sides()[side.axis][side.high];
        if (!is_closed(kind))
            fail({"side_load: side", "closed (wall or slip)", "",
                  "section says what goes through an open one"},
                 side_name(kind));
        WallLoad<Dim> load;
        grid_.for_each_beside(side.axis, side.high, [&](const Cell& cell, Offset c) {
            const Offset face = side.high ? c + grid_.layout().stride[side.axis] : c;
            const Real open = cells_.open_area(side.axis, face);
            if (open == 0) return;
            FlatPatch<Dim> patch = open_face(cell, side.axis, side.high);
            auto m = patch.moments();
            if (m.area == 0 || !part(m.centre)) return;
            const Real area = open * face_area(side.axis, cell), scale = area / m.area;
            const Point<Dim> outward = (side.high ? 1 : -1) * Point<Dim>::Unit(side.axis);
            load.area += area;
            if (!cells_.has_water(c)) return;
            if (kind == Side::wall) add(load.shear, m.centre, drag_of_side(side, cell, c, area));
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

    /// The open part of a cell's face, the same for both of its cells.
    FlatPatch<Dim> open_face(const Cell& cell, int axis, bool upper) const {
        Corners<Dim> distance;
        distance.fill(1);
        if (const Walls<Dim>* walls = cells_.walls()) {
            const Offset c = grid_.layout().at(cell);
            if (walls->open_area()[axis][upper ? c + grid_.layout().stride[axis] : c] < 1)
                for (std::size_t k = 0; k < distance.size(); ++k) {
                    Point<Dim> x;
                    for (int a = 0; a < Dim; ++a)
                        x[a] = grid_.face(a, cell[a] + static_cast<int>(k >> a & 1));
                    distance[k] = flow_.params().wall(x);
                }
        }
        const std::size_t end = upper ? 1 : 0;
        const auto corners = corners_of_face<Dim>(distance, axis, end);
        const auto patch = FlatPatch<Dim>::open_face(grid_, cell, axis, end, corners);
        if (!patch.empty()) return patch;
        Corners<Dim - 1> all;  // corners miss what is open
        all.fill(1);
        return FlatPatch<Dim>::open_face(grid_, cell, axis, end, all);
    }

    /// Pressure on the wall of one cell, and of what there is of it below water.
    void push(WallLoad<Dim>& load, const WallCell<Dim>& w) const {
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
        Point<Dim> force = cells_.open_volume(c) * grid_.volume(cell) * cells_.gradient(head);
        for (int a = 0; a < Dim; ++a)
            for (const bool upper : {false, true}) {
                const Real open = cells_.open_area(a, upper ? c + grid_.layout().stride[a] : c);
                if (open == 0) continue;
                const Real pressure = cells_.pressure(head, open_face(cell, a, upper).moments().centre);
                force[a] -= (upper ? 1 : -1) * open * face_area(a, cell) * pressure;
            }
        return force;
    }

    /// Shear as WallFriction has it: each face is held by the nearest wall of its cells.
    void drag(WallLoad<Dim>& load, const std::vector<char>& counts) const {
        if (flow_.params().wall_law.kind == WallLaw::Kind::slip) return;
        struct Held {
            HeldFace face;
            std::size_t wall;
        };
        std::vector<Held> all;
        const auto wall_cells = cells_.walls()->wall_cells();
        for (std::size_t n = 0; n < wall_cells.size(); ++n)
            WallFriction<Dim>::each_held_face(grid_, cells_.sides(), *cells_.walls(), wall_cells[n],
                                              [&](const HeldFace& face) {
                                                  all.push_back({face, n});
                                              });
        const auto key = [](const Held& h) { return std::tuple(h.face.axis, h.face.face); };
        std::ranges::stable_sort(all, {}, key);
        for (auto first = all.begin(); first != all.end();) {
            const auto end =
                std::find_if(first, all.end(), [&](const Held& h) { return key(h) != key(*first); });
            Real nearest = first->face.distance;
            for (auto h = first; h != end; ++h) nearest = std::min(nearest, h->face.distance);
            for (; first != end; ++first) {
                if (!counts[first->wall]) continue;
                HeldFace face = first->face;
                face.distance = nearest;
                const WallCell<Dim>& w = wall_cells[first->wall];
                const Cell of = grid_.layout().number(face.face);
                const Real wet = about(of, face.axis, true) / about(of, face.axis, false);
                if (wet > 0)
                    add(load.shear, w.point,
                        wet * face.area * stress_of(w, face, of) * Point<Dim>::Unit(face.axis));
            }
        }
    }
    /// Share of a face's control volume that walls leave open, or that is liquid [-].
    Real about(const Cell& face, int axis, bool liquid) const {
        Cell below = face;
        --below[axis];
        Real sum = 0;
        for (const auto& cell : {below, face})
            if (const auto c = cells_.offset(cell))
                sum += cells_.open_volume(*c) * (liquid ? cells_.liquid(*c) : 1);
        return 0.5 * sum;
    }
    /// The middle of what a wall leaves open about a face [m].
    Point<Dim> middle(const WallCell<Dim>& w, const Cell& face, int axis) const {
        Point<Dim> x = grid_.face_centre(axis, face);
        const Real closed = 1 - about(face, axis, false);
        for (int b = 0; b < Dim; ++b) x[b] += 0.5 * closed * w.normal[b] * grid_.size(b, face[b]);
        return x;
    }
    /// On a wall, along the axis of a face that it holds [N/m2]. Where walls leave less than half of the
    /// control volume open the solver bounds what changes its velocity in a step. What the friction of the
    /// next face off the wall, gravity and the pressure give it beyond what the law takes goes to the wall.
    Real stress_of(const WallCell<Dim>& w, const HeldFace& f, const Cell& face) const {
        const Real taken = stress(flow_.params().wall_law, f.axis, f.face, f.distance, 0);
        int across = 0;
        w.normal.cwiseAbs().maxCoeff(&across);
        Cell next = face, below = face;
        next[across] += w.normal[across] > 0 ? 1 : -1;
        --below[f.axis];
        const auto off = cells_.offset(next), back = cells_.offset(below);
        if (about(face, f.axis, false) >= 0.5 || across == f.axis || !off || !back ||
            cells_.open_area(f.axis, *off) == 0)
            return taken;
        Real viscosity = flow_.params().viscosity;
        if constexpr (requires { flow_.eddy_viscosity(); }) {
            const Offset apart = *off - f.face;
            Real sum = 0;
            for (const Offset c : {f.face, *back, f.face + apart, *back + apart})
                sum += static_cast<Real>(flow_.eddy_viscosity()[c]);
            viscosity += 0.25 * cells_.density() * sum;
        }
        const Real gap = w.normal.dot(middle(w, next, f.axis) - middle(w, face, f.axis));
        Real given = viscosity * (cells_.velocity(f.axis, *off) - cells_.velocity(f.axis, f.face)) / gap;
        if (cells_.is_wet(f.face) && cells_.is_wet(*back))
            given += cells_.density() * (cells_.head(below, *back) - cells_.head(face, f.face)) /
                     grid_.gap(f.axis, face[f.axis]) * f.volume / w.area;
        return std::abs(given) > std::abs(taken) ? given : taken;
    }
    /// Of a face at a distance from a wall that moves along its axis [N/m2].
    Real stress(const WallLaw& law, int axis, Offset face, Real distance, Real wall_velocity) const {
        const Real per_speed =
            law.kind == WallLaw::Kind::logarithmic
                ? cells_.density() * speed_at_face(grid_.layout(), flow_.velocity(), axis, face)
                : flow_.params().viscosity;
        return per_speed * law.drag(distance) * (cells_.velocity(axis, face) - wall_velocity);
    }

    /// A side that moves takes the water along where it is resolved.
    Point<Dim> drag_of_side(BoxSide side, const Cell& cell, Offset c, Real area) const {
        const WallLaw& law = flow_.params().wall_law;
        Point<Dim> force = Point<Dim>::Zero();
        if (law.kind == WallLaw::Kind::slip) return force;
        const auto& moves = flow_.params().side_velocity;
        for (int a = 0; a < Dim; ++a)
            for (const int end : {0, 1}) {
                if (a == side.axis) continue;
                Cell of = cell;
                of[a] += end;
                Point<Dim> x = grid_.face_centre(a, of);
                x[side.axis] = side.high ? grid_.high(side.axis) : grid_.low(side.axis);
                const bool taken_along = moves && law.kind == WallLaw::Kind::no_slip;
                const Real wall = taken_along ? moves(x, flow_.time())[a] : 0;
                const Offset face = c + end * grid_.layout().stride[a];
                force[a] += 0.5 * area * cells_.liquid(c) *
                            stress(law, a, face, 0.5 * grid_.size(side.axis, cell[side.axis]), wall);
            }
        return force;
    }

    const Flow& flow_;
    FlowCells<Flow> cells_;
    const Grid<Dim>& grid_;
    Point<Dim> about_;
};

}  // namespace detail

/// Force and moment of the water on the walls inside the box (`GridFluidParams::wall`).
///   F = sum p A m + sum tau A,   M = sum (x - about) x dF,
///   p    pressure of `pressure_on_wall`, linear over each cell's wall [Pa]
///   A    area of the wall in a cell [m2]
///   m    into the solid [-]
///   tau  shear of the WallLaw, as the solver takes it from the water [Pa]; slip: 0. At faces of which walls
///        leave less than half open also what their neighbours give them and the solver's bounds drop
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
/// rest the sides and the walls carry its weight. With a logarithmic law shear is that of `Side::wall`.
/// Throws InputError for a side that does not exist or is open, and an `about` that is not finite.
template <GridFlow Flow, class Part = Everywhere>
requires std::predicate < const Part&, const Point<dimensions<Flow>>
& > WallLoad<dimensions<Flow>> side_load(const Flow& flow, BoxSide side, const Point<dimensions<Flow>>& about,
                                         const Part& part = {}) {
    return detail::WallLoads<Flow>(flow, about, "side_load").on_side(side, part);
}

}  // namespace abrade
