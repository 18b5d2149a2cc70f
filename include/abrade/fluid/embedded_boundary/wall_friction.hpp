#pragma once
// What walls do to water that flows along them.

#include <abrade/fluid/embedded_boundary/cut_faces.hpp>
#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/mesh/boundary_conditions.hpp>
#include <abrade/fluid/mesh/row_index.hpp>
#include <abrade/fluid/mesh/wall_law.hpp>

#include <algorithm>

namespace abrade {

namespace detail {

/// At a face along axis a: its own component, and the mean of the four around it of each other one.
template <int Dim, class State>
Real speed_at_face(const Layout<Dim>& layout, const FaceField<Dim, State>& u, int a, Offset face) noexcept {
    Real sum = square(Real(u[a][face]));
    for (int b = 0; b < Dim; ++b) {
        if (b == a) continue;
        const Offset up = layout.stride[b], back = layout.stride[a];
        sum += square(0.25 * Real(u[b][face] + u[b][face + up] + u[b][face - back] + u[b][face + up - back]));
    }
    return std::sqrt(sum);
}

}  // namespace detail

/// Friction of walls inside cells, and at sides of the box where they are logarithmic: the velocity u at
/// distance d from a wall of area A loses
///   du/dt = - C u A / V,   C = nu / d or (kappa / ln(1 + 30 d / k_s))^2 |u|,
/// V the open volume about the face. Taken implicitly, so thin cells do not rule the step. What flows into
/// the wall is 0 anyway, so each component is held alone.
///
/// d is the distance of the centroid of the face's open part. A closes the control volume of the face: half
/// of the wall in each of its two cells, and A_side |n_b| for each side of the volume towards a closed face,
/// n the wall's normal. Away from the sides of the box the areas of a component add up to that of a plane
/// wall. Along a plane wall at any angle a uniform shear, u = s d, then stays as it is, face by face: the
/// neighbours bring nu s A (open_friction_of), and the wall takes it.
template <int Dim>
class WallFriction {
public:
    static constexpr Real karman = WallLaw::karman;
    static constexpr Real least_distance = 0.05;  ///< of a face from a wall [cell]
    static constexpr Real least_volume = 0.01;    ///< about a face [cell]

    /// A face that the wall of one of its cells holds.
    struct HeldFace {
        int axis = 0;
        Offset face = 0;
        Real distance = 0;  ///< of the centroid of its open part from the wall [m]
        Real area = 0;      ///< part of the wall's area that acts on this face [m2]
        Real volume = 0;    ///< about the face, open [m3]
    };
    /// Calls body(HeldFace) for each part of the area of a cell's wall; a face may come more than once.
    static void each_held_face(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries,
                               const EmbeddedBoundary<Dim>& walls, const CutCell<Dim>& wall, auto&& body) {
        const Layout<Dim>& layout = grid.layout();
        const CellNumber<Dim> cell = layout.number(wall.cell);
        Point<Dim> size;
        for (int b = 0; b < Dim; ++b) size[b] = grid.size(b, cell[b]);
        const auto inside = [&](int a, const CellNumber<Dim>& of) {
            for (int b = 0; b < Dim; ++b) {
                // A face at a side of the box is the side's.
                const bool beyond =
                    b == a ? of[b] <= 0 || of[b] >= grid.cells(b) : of[b] < 0 || of[b] >= grid.cells(b);
                if (beyond && !boundaries.periodic(b)) return false;
            }
            return true;
        };
        const Real whole = grid.volume(cell);
        const auto hold = [&](int a, const CellNumber<Dim>& of, Real area) {
            const Offset face = layout.at(of);
            CellNumber<Dim> below = of;
            --below[a];
            const Real open = 0.5 * (walls.open_fraction()[face] * grid.volume(of) +
                                     walls.open_fraction()[layout.at(below)] * grid.volume(below));
            const Point<Dim> from_centre =
                detail::centroid_of_face<Dim>(wall.normal, size, a, walls.aperture()[a][face]);
            const Point<Dim> centroid = grid.face_centre(a, of) + from_centre.cwiseProduct(size);
            const Real distance = wall.normal.dot(centroid - wall.point);
            Offset around = 0;
            for (int b = 0; b < Dim; ++b) {
                if (of[b] < 0) around += grid.cells(b) * layout.stride[b];
                if (of[b] >= grid.cells(b)) around -= grid.cells(b) * layout.stride[b];
            }
            body(HeldFace{a, face + around, std::max(distance, least_distance * size[a]), area,
                          std::max(open, least_volume * whole)});
        };
        for (int a = 0; a < Dim; ++a) {
            const auto& area = walls.aperture()[a];
            for (const bool upper : {false, true}) {
                CellNumber<Dim> of = cell, other = cell;
                ++(upper ? of : other)[a];
                if (!inside(a, of)) continue;
                if (area[layout.at(of)] > 0) {
                    hold(a, of, 0.5 * wall.area);
                    continue;
                }
                // A closed face leaves it to those around.
                if (const Real open = area[layout.at(other)]; open > 0 && inside(a, other))
                    hold(a, other, 0.5 * open * std::abs(wall.normal[a]) * whole / size[a]);
                for (int b = 0; b < Dim; ++b)
                    for (const bool end : {false, true}) {
                        if (b == a) continue;
                        CellNumber<Dim> side = cell, beside = of;
                        side[b] += end, beside[b] += end ? 1 : -1;
                        const Real open = walls.aperture()[b][layout.at(side)];
                        const Real rises = end ? wall.normal[b] : -wall.normal[b];
                        if (open > 0 && rises > 0 && inside(a, beside) && area[layout.at(beside)] > 0)
                            hold(a, beside, 0.5 * open * rises * whole / size[b]);
                    }
            }
        }
    }

    WallFriction(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries, const WallLaw& law,
                 const EmbeddedBoundary<Dim>* walls)
        : layout_(grid.layout()), law_(law) {
        law_.validate();
        if (law_.kind == WallLaw::Kind::slip) return;
        if (walls)
            for (const CutCell<Dim>& w : walls->cut_cells()) add(grid, boundaries, *walls, w);
        if (law_.kind == WallLaw::Kind::logarithmic) add_sides(grid, boundaries, walls);
        for (int a = 0; a < Dim; ++a) {
            auto& list = held_[a];
            merge(list);
            starts_[a] = {layout_, list.size(), [&](std::size_t k) { return list[k].face; }};
            for (Held& h : list) h.per_speed = law_.drag(h.distance);
        }
    }

    bool empty() const noexcept {
        return std::all_of(held_.begin(), held_.end(), [](const auto& list) { return list.empty(); });
    }

    /// Of each face that walls hold, 0 in dry rows.
    using PerFace = PerAxis<std::vector<Real>, Dim>;

    /// Slows `u` down over a step [s], by the velocity that it comes to; `viscosity` is kinematic [m2/s].
    /// Only in rows that are wet, or none given: in all. Returns what it took.
    template <class State>
    PerFace apply(FaceField<Dim, State>& u, const WetRows<Dim>* rows, Real step, Real viscosity) const {
        PerFace taken;  // of what they are now, all components
        for (int a = 0; a < Dim; ++a) {
            taken[a].resize(held_[a].size());
            starts_[a].for_each(rows, [&](std::size_t k) {
                const Held& h = held_[a][k];
                taken[a][k] = static_cast<Real>(u[a][h.face]) * taken_share(u, a, h, step, viscosity);
            });
        }
        take(u, rows, taken, 1);
        return taken;
    }
    /// Takes a share of the same again.
    template <class State>
    void take(FaceField<Dim, State>& u, const WetRows<Dim>* rows, const PerFace& taken, Real share) const {
        for (int a = 0; a < Dim; ++a)
            starts_[a].for_each(rows, [&](std::size_t k) {
                u[a][held_[a][k].face] -= static_cast<State>(share * taken[a][k]);
            });
    }

    /// Calls body(axis, face, velocity taken [m/s]) for all that `apply` took, one after the other.
    void for_each(const PerFace& taken, auto&& body) const {
        for (int a = 0; a < Dim; ++a)
            for (std::size_t k = 0; k < taken[a].size(); ++k) body(a, held_[a][k].face, taken[a][k]);
    }

private:
    struct Held {
        Offset face = 0;
        Real distance = 0;    ///< as in HeldFace [m]
        Real per_volume = 0;  ///< wall area over open volume [1/m]
        Real per_speed = 0;   ///< C over viscosity [1/m], or over |u| [-]
    };

    template <class State>
    Real taken_share(const FaceField<Dim, State>& u, int a, const Held& h, Real step,
                     Real viscosity) const noexcept {
        if (law_.kind == WallLaw::Kind::no_slip) {
            const Real z = step * h.per_volume * viscosity * h.per_speed;
            return z / (1 + z);
        }
        // The root of v (1 + z v / u) = u.
        const Real z = step * h.per_volume * detail::speed_at_face(layout_, u, a, h.face) * h.per_speed;
        return 1 - 2 / (1 + std::sqrt(1 + 4 * z));
    }

    void add(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries,
             const EmbeddedBoundary<Dim>& walls, const CutCell<Dim>& wall) {
        each_held_face(grid, boundaries, walls, wall, [&](const HeldFace& f) {
            held_[f.axis].push_back({f.face, f.distance, f.area / f.volume});
        });
    }

    void add_sides(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries,
                   const EmbeddedBoundary<Dim>* walls) {
        for (int b = 0; b < Dim; ++b)
            for (const int end : {0, 1}) {
                if (boundaries[b][end] != Boundary::wall) continue;
                grid.for_each_beside(b, end == 1, [&](const CellNumber<Dim>& cell, Offset c) {
                    for (int a = 0; a < Dim; ++a)
                        if (a != b && (cell[a] > 0 || boundaries.periodic(a)) &&
                            (!walls || walls->aperture()[a][c] > 0))
                            held_[a].push_back({c, 0.5 * grid.size(b, cell[b]), 1 / grid.size(b, cell[b])});
                });
            }
    }

    /// One entry per face: areas add up, the nearest wall counts.
    static void merge(std::vector<Held>& list) {
        std::stable_sort(list.begin(), list.end(),
                         [](const Held& x, const Held& y) { return x.face < y.face; });
        std::size_t last = 0;
        for (std::size_t k = 1; k < list.size(); ++k)
            if (list[k].face == list[last].face) {
                list[last].per_volume += list[k].per_volume;
                list[last].distance = std::min(list[last].distance, list[k].distance);
            } else {
                list[++last] = list[k];
            }
        if (!list.empty()) list.resize(last + 1);
    }

    Layout<Dim> layout_;
    WallLaw law_;
    PerAxis<std::vector<Held>, Dim> held_;
    PerAxis<detail::RowStarts<Dim>, Dim> starts_;
};

}  // namespace abrade
