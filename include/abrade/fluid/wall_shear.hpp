#pragma once
// Shear of water on walls inside its box and on the box's sides.

#include <abrade/fluid/flow_pressure.hpp>

#include <algorithm>
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
                    body(w,
                         Point<Dim>(wet * face.area * stress_of(w, face, of) * Point<Dim>::Unit(face.axis)));
            }
        }
    }
    /// On what is open of the face of a cell beside a side [N]. A side that moves takes the water along where
    /// it is resolved.
    Point<Dim> on_side(BoxSide side, const Cell& cell, Offset c, Real area) const {
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

private:
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

    const Flow& flow_;
    const FlowCells<Flow>& cells_;
    const Grid<Dim>& grid_;
};

}  // namespace detail
}  // namespace abrade
