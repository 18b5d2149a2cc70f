#pragma once
// Velocities at and beyond the sides of a fluid's box.

#include <abrade/fluid/grid.hpp>
#include <abrade/fluid/sides.hpp>

#include <functional>

namespace abrade {

/// Velocity at a point of a side at a time [m/s]: of a wall that moves along itself, or of what flows in.
template <int Dim>
using SideVelocity = std::function<Point<Dim>(const Point<Dim>&, Real)>;

/// Fills ghosts of a staggered velocity, and its normal component on sides that fix it. Tangential ghosts
/// mirror, so that the mean of both sides of a wall is the wall's velocity.
template <int Dim>
class VelocitySides {
public:
    VelocitySides(const Grid<Dim>& grid, const Sides<Dim>& sides, SideVelocity<Dim> given)
        : grid_(&grid), sides_(sides), given_(std::move(given)) {}

    template <class State>
    void fill(FaceField<Dim, State>& u, Real time) const {
        // Axis by axis, ghosts of the former ones included: so corners get theirs.
        for (int b = 0; b < Dim; ++b)
            for (int a = 0; a < Dim; ++a)
                if (sides_.periodic(b))
                    copy_around(u[a], b);
                else if (a == b)
                    normal(u[a], b, time);
                else
                    tangential(u[a], a, b, time);
    }

    /// Fills ghosts of a cell field with what is around (periodic) or beside.
    template <class State>
    void fill_cells(Field<State>& x) const {
        for (int b = 0; b < Dim; ++b)
            if (sides_.periodic(b))
                copy_around(x, b);
            else
                for (const bool high : {false, true}) {
                    const Offset out = high ? step(b) : -step(b);
                    for_side(b, high,
                             [&](Offset c, const CellNumber<Dim>&) { x[c + out] = x[c + 2 * out] = x[c]; });
                }
    }

private:
    Offset step(int axis) const noexcept { return grid_->layout().stride[axis]; }
    int cells(int axis) const noexcept { return grid_->cells(axis); }
    Side kind(int axis, bool high) const noexcept {
        return (high ? sides_.high : sides_.low)[static_cast<std::size_t>(axis)];
    }

    /// Calls body(offset, number) for the cells beside a side, ghosts of the other axes included.
    void for_side(int axis, bool high, auto&& body) const {
        const Layout<Dim>& l = grid_->layout();
        CellNumber<Dim> cell;
        cell[axis] = high ? cells(axis) - 1 : 0;
        std::array<int, Dim - 1> other{};
        for (int a = 0, k = 0; a < Dim; ++a)
            if (a != axis) other[k++] = a;
        // The inner axis last, where there is a choice.
        if constexpr (Dim == 3)
            if (other[0] == Layout<Dim>::inner) std::swap(other[0], other[1]);
        const auto along = [&](int a, auto&& each) {
            for (cell[a] = -Layout<Dim>::ghosts; cell[a] < cells(a) + Layout<Dim>::ghosts; ++cell[a]) each();
        };
        if constexpr (Dim == 3)
            along(other[0], [&] { along(other[1], [&] { body(l.at(cell), cell); }); });
        else
            along(other[0], [&] { body(l.at(cell), cell); });
    }

    template <class State>
    void copy_around(Field<State>& x, int b) const {
        const Offset s = step(b), around = cells(b) * s;
        for_side(b, false, [&](Offset c, const CellNumber<Dim>&) {
            x[c - 2 * s] = x[c - 2 * s + around];
            x[c - s] = x[c - s + around];
            x[c + around] = x[c];
            x[c + around + s] = x[c + s];
        });
    }

    Real given(int component, const Point<Dim>& x, Real time) const {
        return given_ ? given_(x, time)[component] : 0;
    }

    template <class State>
    void normal(Field<State>& u, int b, Real time) const {
        const Offset s = step(b);
        for (const bool high : {false, true}) {
            const Side side = kind(b, high);
            for_side(b, high, [&](Offset c, CellNumber<Dim> cell) {
                const Offset face = high ? c + s : c, in = high ? -s : s;
                if (side == Side::wall || side == Side::slip) {
                    u[face] = 0;
                } else if (side == Side::inflow) {
                    if (high) ++cell[b];
                    u[face] = static_cast<State>(given(b, grid_->face_centre(b, cell), time));
                }
                // Beyond: straight on where the side fixes the flow, as at the face where it leaves.
                const State beyond = side == Side::outflow ? u[face] : 2 * u[face] - u[face + in];
                u[face - in] = beyond;
                if (!high) u[face - 2 * in] = side == Side::outflow ? u[face] : 2 * beyond - u[face];
            });
        }
    }

    template <class State>
    void tangential(Field<State>& u, int a, int b, Real time) const {
        const Offset s = step(b);
        for (const bool high : {false, true}) {
            const Side side = kind(b, high);
            const Offset out = high ? s : -s;
            const bool held = side == Side::wall || side == Side::inflow;
            for_side(b, high, [&](Offset c, const CellNumber<Dim>& cell) {
                if (!held) {
                    u[c + out] = u[c];
                    u[c + 2 * out] = side == Side::slip ? u[c - out] : u[c];
                    return;
                }
                State wall = 0;
                if (given_) {
                    Point<Dim> x = grid_->face_centre(a, cell);
                    x[b] = high ? grid_->high(b) : grid_->low(b);
                    wall = static_cast<State>(given(a, x, time));
                }
                u[c + out] = 2 * wall - u[c];
                u[c + 2 * out] = 2 * wall - u[c - out];
            });
        }
    }

    const Grid<Dim>* grid_;
    Sides<Dim> sides_;
    SideVelocity<Dim> given_;
};

}  // namespace abrade
