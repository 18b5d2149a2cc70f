#pragma once
// Where water stands after the walls around it have changed.

#include <abrade/fluid/volume_of_fluid.hpp>
#include <abrade/fluid/walls.hpp>

#include <utility>

namespace abrade::detail {

/// Liquid of cells, in shares of what walls leave open of them [-] (VolumeOfFluid).
struct WaterShares {
    Field<Real> fraction, surplus;
};

/// The same liquid between other walls; none of either: all is open.
///
/// A full cell stays full: what it has more room for or less is its surplus, which the next projection asks
/// from beside or drives out. What opens amid full cells is full, and lacks all of it. Elsewhere liquid stays
/// as it is, as far as there is room. The liquid of a cell that closes goes to those beside it.
/// Throws InputError where all of those are closed as well.
template <int Dim>
class ChangedWalls {
public:
    ChangedWalls(const VolumeOfFluid<Dim>& liquid, const Walls<Dim>* before, const Walls<Dim>* after)
        : liquid_(liquid), before_(before), after_(after), shares_{liquid.fraction(), liquid.surplus()} {}

    WaterShares run() {
        const Grid<Dim>& grid = liquid_.grid();
        grid.for_each([&](const CellNumber<Dim>&, Offset c) {
            const Real was = open(before_, c), is = open(after_, c);
            if (was == is || is == 0) return;
            if (was == 0)
                set(c, amid_full(c), 0);
            else
                set(c, is_full(c), (liquid_.fraction()[c] + liquid_.surplus()[c]) * was / is);
        });
        grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            if (open(after_, c) == 0) push_aside(cell, c);
        });
        return std::move(shares_);
    }

private:
    static Real open(const Walls<Dim>* walls, Offset c) noexcept {
        return walls ? walls->open_volume()[c] : 1;
    }
    bool is_inside(Offset c) const noexcept { return (liquid_.marks()[c] & cell_mark::inside) != 0; }
    bool is_full(Offset c) const noexcept { return liquid_.fraction()[c] >= liquid_.full(); }
    bool amid_full(Offset c) const noexcept {
        bool any = false;
        for (const Offset s : liquid_.grid().layout().stride)
            for (const Offset n : {c - s, c + s}) {
                if (!is_inside(n) || open(before_, n) == 0) continue;
                if (!is_full(n)) return false;
                any = true;
            }
        return any;
    }
    /// `holds`: liquid over the open volume of now.
    void set(Offset c, bool full, Real holds) noexcept {
        constexpr Real wisp = VolumeOfFluid<Dim>::wisp;
        // What lacks as little as makes no surface is full.
        const bool fills = full || holds >= 1 - 10 * (1 - liquid_.full());
        shares_.fraction[c] = fills ? 1 : holds < wisp ? 0 : holds;
        shares_.surplus[c] = holds - shares_.fraction[c];
    }
    void push_aside(const CellNumber<Dim>& cell, Offset c) {
        const Grid<Dim>& grid = liquid_.grid();
        const Real amount =
            (liquid_.fraction()[c] + liquid_.surplus()[c]) * open(before_, c) * grid.volume(cell);
        shares_.fraction[c] = shares_.surplus[c] = 0;
        if (amount == 0) return;
        Real room = 0;
        const auto each_beside = [&](auto&& body) {
            for (const Offset s : grid.layout().stride)
                for (const Offset n : {c - s, c + s})
                    if (is_inside(n) && open(after_, n) > 0) body(n);
        };
        each_beside([&](Offset n) { room += open(after_, n) * grid.volume(grid.layout().number(n)); });
        if (!(room > 0))
            fail({"GridFluid.set_wall: wall at " + place_text<Dim>(grid.centre(cell)),
                  "open beside a cell whose water it takes the place of", "",
                  "change it by less than a cell at a time"},
                 "closed");
        each_beside([&](Offset n) {
            set(n, shares_.fraction[n] >= liquid_.full(),
                shares_.fraction[n] + shares_.surplus[n] + amount / room);
        });
    }

    const VolumeOfFluid<Dim>& liquid_;
    const Walls<Dim>* before_;
    const Walls<Dim>* after_;
    WaterShares shares_;
};

}  // namespace abrade::detail
