#pragma once
// Shear of water on walls inside its box and on the box's sides.

#include <abrade/fluid/embedded_boundary/cut_faces.hpp>
#include <abrade/fluid/embedded_boundary/wall_friction.hpp>
#include <abrade/fluid/queries/flow_pressure.hpp>

#include <algorithm>
#include <span>
#include <tuple>
#include <vector>

namespace abrade {

/// A side of the box: `{.axis = 0, .high = true}` is the one at the largest x.
struct BoxSide {
    int axis = 0;
    bool high = false;
};

namespace detail {

/// What the friction of walls takes from the water of a flow, as a force on them.
template <GridFlow Flow>
class WallShear {
    static constexpr int Dim = dimensions<Flow>;
    using Cell = CellNumber<Dim>;
    using HeldFace = typename WallFriction<Dim>::HeldFace;

public:
    /// `cells` must outlive this.
    WallShear(const Flow& flow, const FlowCells<Flow>& cells)
        : flow_(flow), cells_(cells), grid_(flow.grid()) {}

    /// Shear as WallFriction has it: each face is held by the nearest wall of its cells. Calls
    /// body(wall cell, force [N]) where `counts`, which has all wall cells in their order, says so.
    void on_walls(const std::vector<char>& counts, auto&& body) const {
        if (flow_.params().wall_law.kind == WallLaw::Kind::slip) return;
        struct Held {
            HeldFace face;
            std::size_t wall;
        };
        std::vector<Held> all;
        const auto cut_cells = cells_.walls()->cut_cells();
        for (std::size_t n = 0; n < cut_cells.size(); ++n)
            WallFriction<Dim>::each_held_face(grid_, cells_.boundaries(), *cells_.walls(), cut_cells[n],
                                              [&](const HeldFace& face) {
                                                  all.push_back({face, n});
                                              });
        const auto key = [](const Held& h) { return std::tuple(h.face.axis, h.face.face); };
        std::ranges::stable_sort(all, {}, key);
        for (auto first = all.begin(); first != all.end();) {
            const auto end =
                std::find_if(first, all.end(), [&](const Held& h) { return key(h) != key(*first); });
            Real nearest = first->face.distance, area = 0;
            for (auto h = first; h != end; ++h)
                nearest = std::min(nearest, h->face.distance), area += h->face.area;
            const auto [axis, face] = key(*first);
            const Cell of = grid_.layout().number(face);
            const Real open = about(of, axis, false);
            const Real wet = open > 0 ? about(of, axis, true) / open : 0;
            if (wet == 0) {
                first = end;
                continue;
            }
            Real taken = stress(flow_.params().wall_law, axis, face, nearest, 0);
            if (open < 0.5) {
                const Real given = force_on(of, axis, face) / area;
                if (std::abs(given) > std::abs(taken)) taken = given;
            }
            for (; first != end; ++first)
                if (counts[first->wall])
                    body(cut_cells[first->wall],
                         Point<Dim>(wet * first->face.area * taken * Point<Dim>::Unit(axis)));
        }
    }
    /// On what is open of the face of a cell beside a side [N]. A side that moves takes the water along where
    /// it is resolved.
    Point<Dim> on_side(BoxSide side, const Cell& cell, Offset c, Real area) const {
        const WallLaw& law = flow_.params().wall_law;
        Point<Dim> force = Point<Dim>::Zero();
        if (law.kind == WallLaw::Kind::slip) return force;
        const auto& moves = flow_.params().boundary_velocity;
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

private:
    /// Share of a face's control volume that walls leave open, or that is liquid [-].
    Real about(const Cell& face, int axis, bool liquid) const {
        Cell below = face;
        --below[axis];
        Real sum = 0;
        for (const auto& cell : {below, face})
            if (const auto c = cells_.offset(cell))
                sum += cells_.open_fraction(*c) * (liquid ? cells_.liquid(*c) : 1);
        return 0.5 * sum;
    }
    /// Area vector of the walls of both cells of a face [m2].
    Point<Dim> wall_about(const Cell& face, int axis) const {
        Cell below = face;
        --below[axis];
        Point<Dim> area = Point<Dim>::Zero();
        for (const auto& cell : {below, face})
            if (const auto c = cells_.offset(cell))
                for (const CutCell<Dim>& wall : cells_.walls()->cut_cells(*c, 1))
                    area += wall.area * wall.normal;
        return area;
    }
    /// What friction with the water beside it, gravity and the pressure do to the control volume of a face
    /// along its axis [N]. Where walls leave less than half of it open the solver bounds what changes its
    /// velocity in a step: what they give beyond that the law takes is lost to the wall as well.
    Real force_on(const Cell& face, int axis, Offset f) const {
        Cell below = face;
        --below[axis];
        const auto back = cells_.offset(below);
        if (!back) return 0;
        const Real volume = grid_.volume(face);
        Point<Dim> size;
        for (int b = 0; b < Dim; ++b) size[b] = grid_.size(b, face[b]);
        Real force = 0;
        for (int b = 0; b < Dim; ++b)
            for (const int end : {0, 1}) {
                Cell beside = face, side = face;  // the side is the lower one of its cell
                beside[b] += end == 0 ? -1 : 1, side[b] += end;
                Cell side_below = side;
                --side_below[axis];
                const auto off = cells_.offset(beside), at = cells_.offset(side),
                           at_below = cells_.offset(side_below);
                if (!off || !at || !at_below || cells_.aperture(axis, *off) == 0) continue;
                const Real open = 0.5 * (cells_.aperture(b, *at) + cells_.aperture(b, *at_below));
                if (open == 0) continue;
                const Cell& lower = end == 0 ? beside : face;
                const Cell& upper = end == 0 ? face : beside;
                const auto of = [&](const Cell& c) { return cells_.aperture(axis, *cells_.offset(c)); };
                const Real per_gap = open_over_distance<Dim>(
                    size, {axis, b}, {wall_about(lower, axis), wall_about(upper, axis)},
                    {of(lower), of(upper)}, open);
                force += viscosity(*at, *at_below, axis, b) * per_gap * volume / size[b] *
                         (cells_.velocity(axis, *off) - cells_.velocity(axis, f)) /
                         (b == axis ? grid_.size(b, side_below[b]) : grid_.gap(b, side[b]));
            }
        if (cells_.is_wet(f) && cells_.is_wet(*back))
            force += cells_.density() * about(face, axis, false) * volume *
                     (cells_.head(below, *back) - cells_.head(face, f)) / grid_.gap(axis, face[axis]);
        return force;
    }
    /// Of the friction along `axis` between two faces next to each other along b: at the edge between four
    /// cells, c and d above it, or in the cell d between the faces [Pa s].
    Real viscosity([[maybe_unused]] Offset c, [[maybe_unused]] Offset d, [[maybe_unused]] int axis,
                   [[maybe_unused]] int b) const {
        Real sum = flow_.params().viscosity;
        if constexpr (requires { flow_.eddy_viscosity(); }) {
            const auto eddy = [&](Offset e) {
                return cells_.density() * static_cast<Real>(flow_.eddy_viscosity()[e]);
            };
            const Offset down = grid_.layout().stride[b];
            sum += b == axis ? eddy(d) : 0.25 * (eddy(c) + eddy(d) + eddy(c - down) + eddy(d - down));
        }
        return sum;
    }
    /// Of a face at a distance from a wall that moves along its axis [N/m2].
    Real stress(const WallLaw& law, int axis, Offset face, Real distance, Real wall_velocity) const {
        const Real per_speed =
            law.kind == WallLaw::Kind::logarithmic
                ? cells_.density() * speed_at_face(grid_.layout(), flow_.velocity(), axis, face)
                : flow_.params().viscosity;
        return per_speed * law.drag(distance) * (cells_.velocity(axis, face) - wall_velocity);
    }

    const Flow& flow_;
    const FlowCells<Flow>& cells_;
    const Grid<Dim>& grid_;
};

}  // namespace detail
}  // namespace abrade
