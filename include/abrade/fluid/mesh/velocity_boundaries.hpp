#pragma once
// Velocities at and beyond the sides of a fluid's box.

#include <abrade/fluid/mesh/ghost_cells.hpp>
#include <abrade/fluid/mesh/grid.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abrade {

/// Velocity at a point of a side at a time [m/s]: of a wall that moves along itself, or of what flows in.
template <int Dim>
using BoundaryVelocity = std::function<Point<Dim>(const Point<Dim>&, Real)>;

/// What an error calls a velocity: "GridFluid.velocity.z at x = 0.1 m, z = 0.2 m, t = 0 s".
template <int Dim>
std::string velocity_at(std::string_view name, int component, const Point<Dim>& x, Real time) {
    return std::string(name) + '.' + Grid<Dim>::axis_name(component) + " at " + place_text<Dim>(x) +
           ", t = " + short_text(time) + " s";
}

namespace detail {

/// Share of its speed [-] that a face hands on to one of which walls leave more open: no more water.
inline Real carried_share(const Field<Real>& open, Offset before, Offset side) noexcept {
    return open[before] < open[side] ? open[before] / open[side] : 1;
}

}  // namespace detail

/// A side of the box, or what of it lies beside rows that are wet, or beside some planes.
template <int Dim>
struct BoundaryPart {
    int axis = 0;
    bool high = false;
    const WetRows<Dim>* rows = nullptr;                                      ///< none: all of it
    RowRange planes{-Layout<Dim>::ghosts, std::numeric_limits<int>::max()};  ///< of a side along them, in 3-D
};

/// Fills ghosts of a staggered velocity, and its normal component on sides that fix it. Tangential ghosts
/// mirror, so that the mean of both sides of a wall is the wall's velocity.
template <int Dim>
class VelocityBoundaries {
public:
    VelocityBoundaries(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries,
                       BoundaryVelocity<Dim> given, Real time = 0)
        : grid_(&grid), boundaries_(boundaries), given_(std::move(given)) {
        boundaries_.validate();
        set_time(time);
    }

    /// Asks for the given velocities as they are at a time [s]. Throws InputError where one within the
    /// box is no number; what a given function throws comes through. Nothing has changed then.
    void set_time(Real time) {
        if (!given_) return;
        changed_ = false;  // what is kept is written over, and takes its turn when it is whole
        for (int b = 0; b < Dim; ++b)
            for (const bool high : {false, true}) {
                const Boundary side = kind(b, high);
                if (side != Boundary::wall && side != Boundary::inflow) continue;
                for (int a = 0; a < Dim; ++a) {
                    std::vector<Real>& values = kept_[number(a, b, high)];
                    values.clear();
                    for_side(b, high, [&](Offset, const CellNumber<Dim>& cell) {
                        Point<Dim> x = grid_->face_centre(a, cell);
                        x[b] = high ? grid_->high(b) : grid_->low(b);
                        const bool through = a == b && side == Boundary::wall;
                        const Real u = given_(x, time)[a];
                        if (!std::isfinite(u) && grid_->has(cell))
                            require_finite(u, velocity_at<Dim>("GridFluid.boundary_velocity", a, x, time),
                                           "m/s");
                        values.push_back(through ? 0 : side == Boundary::inflow ? inflow_scale_ * u : u);
                    });
                }
            }
        std::swap(tables_, kept_);
        changed_ = true;
    }
    /// Multiplies all that is given at inflows, now and later.
    void scale_inflow(Real factor) {
        inflow_scale_ *= factor;
        for_sides(Boundary::inflow, [&](int b, bool high) {
            for (int a = 0; a < Dim; ++a)
                for (Real& u : tables_[number(a, b, high)]) u *= factor;
        });
    }

    /// What `back` leads to: the time, if one is set since, and what leaves through upper sides, faces of no
    /// cell inside. Neither asks the given function.
    template <class State>
    void keep(const FaceField<Dim, State>& u) {
        changed_ = false;
        leaving_.clear();
        for_upper_outflows([&](int a, Offset face) { leaving_.push_back(static_cast<Real>(u[a][face])); });
    }
    template <class State>
    void back(FaceField<Dim, State>& u) {
        if (std::exchange(changed_, false)) std::swap(tables_, kept_);
        auto next = leaving_.begin();
        for_upper_outflows([&](int a, Offset face) { u[a][face] = static_cast<State>(*next++); });
    }

    /// Lets nothing through the sides along an axis, but for outflows and what goes around.
    template <class State>
    void close(Field<State>& u, int axis) const {
        for (const bool high : {false, true}) {
            const Boundary side = kind(axis, high);
            if (side == Boundary::periodic || side == Boundary::outflow) continue;
            along_side({axis, high}, [&](Offset c, std::size_t) { u[high ? c + step(axis) : c] = 0; });
        }
    }

    /// `rows`: where water is and what it may reach; none: everywhere.
    template <class State>
    void fill(FaceField<Dim, State>& u, const WetRows<Dim>* rows = nullptr) const {
        // Axis by axis, ghosts of the former ones included: so corners get theirs.
        for (int b = 0; b < Dim; ++b) {
            if (boundaries_.periodic(b)) {
                parallel_tasks(Dim, [&](Index a) { wrap_axis(u[a], grid_->layout(), b); });
                continue;
            }
            for_planes_along(b, [&](const RowRange& planes) {
                for (int a = 0; a < Dim; ++a)
                    for (const bool high : {false, true}) {
                        const BoundaryPart<Dim> side{b, high, rows, planes};
                        a == b ? normal(u[a], side) : tangential(u[a], a, side);
                    }
            });
        }
    }

    /// All that `fill` does not find: what lies in `rows` (none: everything) and what leaves through upper
    /// sides.
    template <class State>
    void copy(const FaceField<Dim, State>& from, FaceField<Dim, State>& to, const WetRows<Dim>* rows) const {
        if (!rows) return parallel_tasks(Dim, [&](Index a) { to[a] = from[a]; });
        rows->copy(from, to);
        for_upper_outflows([&](int a, Offset face) { to[a][face] = from[a][face]; });
    }

    /// Faces through which water leaves go on as the ones before them; where walls leave more of them `open`,
    /// with no more water: as much of a jet from a gap would come back as what widens it asks for.
    template <class State>
    void leave(FaceField<Dim, State>& u, const FaceField<Dim>* open = nullptr) const {
        for_sides(Boundary::outflow, [&](int a, bool high) {
            along_side({a, high}, [&](Offset c, std::size_t) {
                const Offset upper = c + step(a), side = high ? upper : c, before = high ? c : upper;
                u[a][side] = u[a][before];
                if (open) u[a][side] *= static_cast<State>(detail::carried_share((*open)[a], before, side));
            });
        });
    }

    /// What is given where water comes in, through it.
    template <class State>
    void enter(FaceField<Dim, State>& u) const {
        for_sides(Boundary::inflow, [&](int a, bool high) {
            const std::vector<Real>& values = table(a, a, high);
            along_side({a, high}, [&](Offset c, std::size_t k) {
                u[a][high ? c + step(a) : c] = values.empty() ? State(0) : static_cast<State>(values[k]);
            });
        });
    }

    /// Largest |u| / h of what is given at sides [1/s]: it counts before the water inside has its speed.
    template <class State>
    Real rate_of_inflow(const FaceField<Dim, State>& u) const {
        Real most = 0;
        for_sides(Boundary::inflow, [&](int a, bool high) {
            along_side({a, high}, [&](Offset c, std::size_t) {
                const State through = u[a][high ? c + step(a) : c];
                most = std::max(most, std::abs(static_cast<Real>(through)) / grid_->size(a, 0));
            });
        });
        return most;
    }

    /// Calls body(axis, high) for each side of a kind.
    void for_sides(Boundary wanted, auto&& body) const {
        for (int a = 0; a < Dim; ++a)
            for (const bool high : {false, true})
                if (kind(a, high) == wanted) body(a, high);
    }

    /// Ghosts beyond periodic sides, of a cell field or of all components.
    void join(auto& x) const { fill_periodic(x, grid_->layout(), boundaries_); }

    /// Fills ghosts of a cell field with what is around (periodic) or beside; with `rows`, beside wet ones.
    template <class State>
    void fill_cells(Field<State>& x, const WetRows<Dim>* rows = nullptr) const {
        for (int b = 0; b < Dim; ++b)
            if (boundaries_.periodic(b))
                wrap_axis(x, grid_->layout(), b);
            else
                for (const bool high : {false, true}) {
                    const Offset out = high ? step(b) : -step(b);
                    along_side({b, high, rows},
                               [&](Offset c, std::size_t) { x[c + out] = x[c + 2 * out] = x[c]; });
                }
    }

    /// Calls body(offset, k) for the cells beside a side, ghosts of the other axes included; k counts them.
    void along_side(const BoundaryPart<Dim>& side, auto&& body) const {
        constexpr int g = Layout<Dim>::ghosts, inner = Layout<Dim>::inner;
        const int axis = side.axis, last = cells(inner);
        const bool high = side.high;
        const Plane p = plane_of(axis);
        CellNumber<Dim> corner;
        corner.fill(-g);
        corner[axis] = high ? cells(axis) - 1 : 0;
        const int first = p.first == axis ? 1 : cells(p.first) + 2 * g, second = cells(p.second) + 2 * g;
        const Offset from = grid_->layout().at(corner);
        // What is wet of the row that cell `number` stands in, or of the nearest one inside.
        const auto wet = [&](const CellNumber<Dim>& number) {
            const auto inside = [&](int a) { return std::clamp(number[a], 0, cells(a) - 1); };
            return side.rows->row(inside(0), Dim == 3 ? inside(Dim - 1) : 0);
        };
        CellNumber<Dim> number = corner;
        const bool by_planes = Dim == 3 && axis != Layout<Dim>::outer;  // a line in each
        const int begin = by_planes ? side.planes.begin + g : 0;
        const int end = by_planes && side.planes.end < first - g ? side.planes.end + g : first;
        for (int i = begin; i < end; ++i) {
            const Offset line = from + i * step(p.first);
            const auto count = static_cast<std::size_t>(i) * static_cast<std::size_t>(second);
            RowRange part{0, second};
            if (p.first != axis) number[p.first] = i - g;
            if (side.rows && axis != inner) {  // lines are rows
                const RowRange r = wet(number);
                part = r.empty() ? RowRange{} : RowRange{r.begin, r.end + 2 * g};
            }
            for (int j = part.begin; j < part.end; ++j) {
                if (side.rows && axis == inner) {  // lines go from row to row
                    number[p.second] = j - g;
                    const RowRange r = wet(number);
                    if (r.empty() || (high ? r.end < last : r.begin > 0)) continue;
                }
                body(line + j * step(p.second), count + static_cast<std::size_t>(j));
            }
        }
    }

    static void fields(auto&& field) {
        field("tables", "m/s", &VelocityBoundaries::tables_),
            field("kept", "m/s", &VelocityBoundaries::kept_),
            field("leaving", "m/s", &VelocityBoundaries::leaving_),
            field("inflow_scale", &VelocityBoundaries::inflow_scale_),
            field("changed", &VelocityBoundaries::changed_);
    }

private:
    /// Calls body(planes) for parts of a side, in parallel.
    void for_planes_along(int axis, auto&& body) const {
        constexpr int g = Layout<Dim>::ghosts;
        if (Dim == 2 || axis == Layout<Dim>::outer) return body(BoundaryPart<Dim>{}.planes);
        const int planes = grid_->layout().planes() + 2 * g;
        parallel_blocks(
            planes,
            [&](Index, Index first, Index last) {
                body(RowRange{static_cast<int>(first) - g, static_cast<int>(last) - g});
            },
            block_of_planes);
    }
    void for_upper_outflows(auto&& body) const {
        for_sides(Boundary::outflow, [&](int a, bool high) {
            if (high) along_side({a, high}, [&](Offset c, std::size_t) { body(a, c + step(a)); });
        });
    }
    Offset step(int axis) const noexcept { return grid_->layout().stride[axis]; }
    int cells(int axis) const noexcept { return grid_->cells(axis); }
    Boundary kind(int axis, bool high) const noexcept { return boundaries_[axis][high]; }
    static std::size_t number(int a, int b, bool high) noexcept {
        return static_cast<std::size_t>((a * Dim + b) * 2 + high);
    }
    const std::vector<Real>& table(int a, int b, bool high) const noexcept {
        return tables_[number(a, b, high)];
    }

    /// Axes along a side: first, then the one nearer in memory; in 2-D the first is the side's own, once.
    struct Plane {
        int first, second;
    };
    static constexpr Plane plane_of(int axis) noexcept {
        constexpr int inner = Layout<Dim>::inner, outer = Layout<Dim>::outer;
        if constexpr (Dim == 2) return {axis, 1 - axis};
        if (axis == outer) return {2, inner};
        return axis == inner ? Plane{outer, 2} : Plane{outer, inner};
    }
    /// The same with the cell's number.
    void for_side(int axis, bool high, auto&& body) const {
        constexpr int g = Layout<Dim>::ghosts;
        const Plane p = plane_of(axis);
        const auto second = static_cast<std::size_t>(cells(p.second) + 2 * g);
        along_side({axis, high}, [&](Offset c, std::size_t k) {
            CellNumber<Dim> cell;
            cell[p.first] = static_cast<int>(k / second) - g;
            cell[p.second] = static_cast<int>(k % second) - g;
            cell[axis] = high ? cells(axis) - 1 : 0;
            body(c, cell);
        });
    }

    template <class State>
    void normal(Field<State>& u, const BoundaryPart<Dim>& part) const {
        const int b = part.axis;
        const bool high = part.high;
        const Offset s = step(b), to_face = high ? s : 0, in = high ? -s : s;
        const Boundary side = kind(b, high);
        if (side == Boundary::outflow) {  // as it leaves, so beyond
            along_side(part, [&](Offset c, std::size_t) {
                const Offset face = c + to_face;
                u[face - in] = u[face];
                if (!high) u[face - 2 * in] = u[face];
            });
            return;
        }
        const std::vector<Real>& values = table(b, b, high);
        along_side(part, [&](Offset c, std::size_t k) {
            const Offset face = c + to_face;
            u[face] = values.empty() ? State(0) : static_cast<State>(values[k]);
            u[face - in] = 2 * u[face] - u[face + in];
            if (!high) u[face - 2 * in] = 2 * u[face] - u[face + 2 * in];
        });
    }

    template <class State>
    void tangential(Field<State>& u, int a, const BoundaryPart<Dim>& part) const {
        const int b = part.axis;
        const bool high = part.high;
        const Offset out = high ? step(b) : -step(b);
        const Boundary side = kind(b, high);
        if (side == Boundary::free_slip || side == Boundary::outflow) {
            along_side(part, [&](Offset c, std::size_t) {
                u[c + out] = u[c];
                u[c + 2 * out] = side == Boundary::free_slip ? u[c - out] : u[c];
            });
            return;
        }
        const std::vector<Real>& values = table(a, b, high);
        along_side(part, [&](Offset c, std::size_t k) {
            const State twice = values.empty() ? State(0) : static_cast<State>(2 * values[k]);
            u[c + out] = twice - u[c];
            u[c + 2 * out] = twice - u[c - out];
        });
    }

    const Grid<Dim>* grid_;
    BoundaryConditions<Dim> boundaries_;
    BoundaryVelocity<Dim> given_;
    std::array<std::vector<Real>, static_cast<std::size_t>(2 * Dim * Dim)> tables_, kept_;
    std::vector<Real> leaving_;
    Real inflow_scale_ = 1;
    bool changed_ = false;
};

}  // namespace abrade
