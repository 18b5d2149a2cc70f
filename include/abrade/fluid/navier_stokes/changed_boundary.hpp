#pragma once
// Where water stands after the walls around it have changed.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/vof/volume_of_fluid.hpp>

#include <algorithm>
#include <utility>
#include <vector>

namespace abrade::detail {

/// Liquid of cells, in shares of what walls leave open of them [-] (VolumeOfFluid).
struct WaterShares {
    Field<Real> fraction, volume_defect;
};

/// The same liquid between other walls; none of either: all is open.
///
/// Columns settle at once: what opens below water is filled from the top of the water above it, what closes
/// pushes it up there. A void at the bed would stay, for no pressure fills it. Below a roof, or where nothing
/// presses down, a full cell stays full, and what it has more room for or less is its volume defect, which
/// the next projection asks from beside or drives out; one that opens there amid full cells is full as well,
/// and lacks all of it. A cell at the surface keeps what it holds.
/// Throws InputError where the liquid of a cell that closes finds no room above or beside it, and where it
/// needs more than the room of a box that nothing leaves.
template <int Dim, class Liquid = VolumeOfFluid<Dim>>
class ChangedBoundary {
    static constexpr int vertical = Grid<Dim>::vertical;

public:
    /// Of gravity [m/s2] the sign along the vertical axis counts.
    ChangedBoundary(const Liquid& liquid, const EmbeddedBoundary<Dim>* before,
                    const EmbeddedBoundary<Dim>* after, const Point<Dim>& gravity)
        : liquid_(liquid), grid_(liquid.grid()), before_(before),
          after_(after), shares_{liquid.fraction(), liquid.volume_defect()} {
        const Offset step = grid_.layout().stride[vertical];
        up_ = gravity[vertical] < 0 ? step : gravity[vertical] > 0 ? -step : 0;
    }

    WaterShares run() {
        std::vector<Offset> changed, closed;
        grid_.for_each([&](const CellNumber<Dim>&, Offset c) {
            const Real was = open(before_, c), is = open(after_, c);
            if (was == is) return;
            (is > 0 ? changed : closed).push_back(c);
            if (is > 0) set(c, holds(c) * was / is);
        });
        for (const Offset c : changed) settle(c);
        for (const Offset c : closed) leave(c);
        check_room();
        return std::move(shares_);
    }

private:
    static Real open(const EmbeddedBoundary<Dim>* walls, Offset c) noexcept {
        return walls ? walls->open_fraction()[c] : 1;
    }
    /// What walls leave of a cell now [m3].
    Real room(Offset c) const noexcept { return open(after_, c) * grid_.volume(grid_.layout().number(c)); }
    bool is_inside(Offset c) const noexcept { return (liquid_.marks()[c] & cell_mark::inside) != 0; }
    /// The next cell up, or -1 where a roof is between.
    Offset above(Offset c) const noexcept {
        const Offset n = c + up_;
        if (up_ == 0 || !is_inside(n) || open(after_, n) == 0) return -1;
        return after_ && after_->aperture()[vertical][std::max(c, n)] == 0 ? -1 : n;
    }

    /// What lacks as little as makes no surface.
    bool is_full(Real holds) const noexcept { return holds >= 1 - liquid_.void_inside_water(); }
    bool is_wet(Offset c) const noexcept { return holds(c) > volume_tolerance::round_off; }
    Real holds(Offset c) const noexcept { return shares_.fraction[c] + shares_.volume_defect[c]; }
    void set(Offset c, Real holds) noexcept {
        shares_.fraction[c] = is_full(holds) ? 1 : holds < volume_tolerance::round_off ? 0 : holds;
        shares_.volume_defect[c] = holds - shares_.fraction[c];
    }

    /// A cell of which more or less is open than it was.
    void settle(Offset c) {
        const Real beyond = (holds(c) - 1) * room(c);
        if (beyond > 0) {
            const Real left = push_up(c, beyond);
            shares_.fraction[c] = 1, shares_.volume_defect[c] = left / room(c);
            return;
        }
        const Offset n = above(c);
        if (is_below_roof(c)) {
            if (was_full(c) || opens_in_water(c)) fill(c);
        } else if (is_wet(n)) {
            const Real left = take_down(c, -beyond);
            set(c, 1 - left / room(c));
            if (left > 0 && is_wet(n)) fill(c);  // up to a roof all is full
        }
    }
    bool was_full(Offset c) const noexcept {
        return open(before_, c) > 0 && liquid_.fraction()[c] >= liquid_.full();
    }
    bool is_below_roof(Offset c) const noexcept {
        const Offset n = above(c);
        return n < 0 || opens_in_water(n);  // which only now is one cell higher
    }
    /// Whether a cell was closed and all that it opens to, and was open, was full.
    bool opens_in_water(Offset c) const noexcept {
        if (open(before_, c) > 0) return false;
        bool any = false, all = true;
        for (int a = 0; a < Dim; ++a)
            for (const int side : {0, 1}) {
                const Offset s = grid_.layout().stride[a], away = side == 0 ? -s : s;
                Offset n = c + away;
                if (!is_inside(n)) {
                    if (!liquid_.boundaries().periodic(a)) continue;
                    n -= grid_.cells(a) * away;
                }
                const bool passes = !after_ || after_->aperture()[a][c + side * s] > 0;
                if (!passes || open(before_, n) == 0) continue;
                any = true, all = all && was_full(n);
            }
        return any && all;
    }
    /// Full, and lacks what it does not hold.
    void fill(Offset c) noexcept {
        const Real lacks = holds(c) - 1;
        shares_.fraction[c] = 1, shares_.volume_defect[c] = lacks;
    }

    /// Puts liquid [m3] on top of the column above a cell, into one dry cell at most: a narrow one would rise
    /// far above what is beside it. Answers what finds no room.
    Real push_up(Offset c, Real amount) {
        bool dry = false;
        for (Offset n = above(c); n >= 0 && amount > 0 && !dry; n = above(n)) {
            dry = !is_wet(n);
            const Real part = std::clamp((1 - holds(n)) * room(n), Real(0), amount);
            if (shares_.fraction[n] == 1)  // and lacks it: no void
                shares_.volume_defect[n] += part / room(n);
            else if (part > 0)
                set(n, holds(n) + part / room(n));
            amount -= part;
        }
        return amount;
    }

    /// Takes liquid [m3] from the top of the column above a cell; answers what is not to be had. Of a column
    /// that is full up to a roof nothing is: its top would be a void.
    Real take_down(Offset c, Real amount) {
        column_.clear();
        for (Offset n = above(c); n >= 0 && is_wet(n); n = above(n)) column_.push_back(n);
        const Offset top = column_.back();
        if (is_below_roof(top) && (is_full(holds(top)) || was_full(top))) return amount;
        for (; !column_.empty() && amount > 0; column_.pop_back()) {
            const Offset n = column_.back();
            const Real part = std::clamp(holds(n) * room(n), Real(0), amount);
            set(n, holds(n) - part / room(n));
            amount -= part;
        }
        return amount;
    }

    /// The liquid of a cell that closes: up, or to what is beside it.
    void leave(Offset c) {
        const CellNumber<Dim> cell = grid_.layout().number(c);
        const Real amount = holds(c) * open(before_, c) * grid_.volume(cell);
        shares_.fraction[c] = shares_.volume_defect[c] = 0;
        if (up_ != 0 && is_inside(c + up_) && open(after_, c + up_) > 0 && amount > 0) {
            const Offset n = c + up_;
            set(n, holds(n) + amount / room(n));
            settle(n);
            return;
        }
        if (amount == 0) return;
        Real beside = 0;
        const auto each_beside = [&](auto&& body) {
            for (const Offset s : grid_.layout().stride)
                for (const Offset n : {c - s, c + s})
                    if (is_inside(n) && open(after_, n) > 0) body(n);
        };
        each_beside([&](Offset n) { beside += room(n); });
        if (!(beside > 0))
            fail({"GridFluid.set_wall: wall at " + place_text<Dim>(grid_.centre(cell)),
                  "open above or beside a cell whose water it takes the place of", "",
                  "change it by less than a cell at a time"},
                 "closed");
        each_beside([&](Offset n) {
            set(n, holds(n) + amount / beside);
            settle(n);
        });
    }

    void check_room() const {
        for (const auto& ends : liquid_.boundaries().kind)
            if (ends[0] == Boundary::outflow || ends[1] == Boundary::outflow) return;
        Real liquid = 0, all = 0;
        grid_.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            const Real volume = open(after_, c) * grid_.volume(cell);
            all += volume, liquid += holds(c) * volume;
        });
        constexpr Real round_off = 1e-9;
        if (liquid > (1 + round_off) * all)
            fail({"GridFluid.set_wall: room that the wall leaves",
                  "at least that of the water, for nothing leaves the box (" + short_text(liquid) + ")",
                  Dim == 3 ? "m3" : "m2", "make a side an outflow, or leave the wall"},
                 short_text(all));
    }

    const Liquid& liquid_;
    const Grid<Dim>& grid_;
    const EmbeddedBoundary<Dim>* before_;
    const EmbeddedBoundary<Dim>* after_;
    Offset up_ = 0;  ///< to the next cell against gravity; 0: nothing presses down
    WaterShares shares_;
    std::vector<Offset> column_;
};

}  // namespace abrade::detail
