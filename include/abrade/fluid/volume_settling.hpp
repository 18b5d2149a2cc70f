#pragma once
// What VolumeOfFluid does with liquid that found no room at the end of a step.

#include <abrade/fluid/volume_of_fluid_class.hpp>

namespace abrade {

/// Gives liquid (or, below 0, the lack of it) to the neighbours of a cell; answers what they could not take.
template <int Dim>
Real VolumeOfFluid<Dim>::share_out(Offset c, Index level, Real amount) {
    struct Way {
        int axis;
        Offset cell, face, twin;  ///< twin: the same face at the other end of a periodic axis, or none
        Real sign, room;
        bool cut;
        Index level;
    };
    std::array<Way, 2 * Dim> ways;
    int count = 0;
    for (int a = 0; a < Dim; ++a)
        for (const int side : {-1, 1}) {
            const Offset step = layout_.stride[index(a)], length = layout_.cells[index(a)] * step;
            Way way{a, c + side * step, side > 0 ? c + step : c, -1, Real(side), 0, false, level};
            if (a == vertical) way.level = level + side;
            if ((marks_[way.cell] & cell_mark::inside) == 0) {
                if (!sides_.periodic(a)) continue;
                way.cell -= side * length;
                way.twin = way.face - side * length;
                if (a == vertical) way.level -= side * layout_.cells[index(a)];
            }
            if ((marks_[way.cell] & cell_mark::open) == 0) continue;
            if (open_faces_ && (*open_faces_)[index(a)][way.face] <= 0) continue;
            const Real f = fraction_[way.cell];
            way.room = (amount > 0 ? 1 - f : f) * open_volume(way.cell, way.level);
            way.cut = f > 0 && f < 1;
            if (way.room > 0) ways[index(count++)] = way;
        }
    // First those that the surface cuts: water stays together.
    for (const bool cut : {true, false}) {
        Real room = 0;
        for (int w = 0; w < count; ++w)
            if (ways[index(w)].cut == cut) room += ways[index(w)].room;
        if (!(room > 0)) continue;
        const Real taken = std::clamp(amount, -room, room);
        for (int w = 0; w < count; ++w) {
            const Way& way = ways[index(w)];
            if (way.cut != cut) continue;
            const Real part = taken * (way.room / room);
            moved_[index(way.axis)][way.face] += way.sign * part;
            if (way.twin >= 0) moved_[index(way.axis)][way.twin] += way.sign * part;
            settled_.push_back(static_cast<Index>(way.cell));
            set_cell(way.cell,
                     fraction_[way.cell] + surplus_[way.cell] + part / open_volume(way.cell, way.level));
        }
        amount -= taken;
        if (amount == 0) break;
    }
    return amount;
}

/// Full cells beyond the band took it that what flows through their faces is all liquid. Where a cell of the
/// band beside them holds a trace of air in this sweep, too little to be a surface, they have a trace less.
template <int Dim>
void VolumeOfFluid<Dim>::even_out_rims(int axis) {
    const Offset s = layout_.stride[index(axis)];
    const auto& moved = moved_[index(axis)];
    for (Index i = 0; i < planes_.count(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        const Offset c = planes_.cell[k];
        if (band_.airy(c)) continue;  // all its neighbours are in the band
        for (const int side : {-1, 1}) {
            const Offset face = side > 0 ? c + s : c;
            const Index face_level = planes_.level[k] + (axis == vertical && side > 0 ? 1 : 0);
            Offset n = c + side * s;
            Index level = planes_.level[k] + (axis == vertical ? side : 0);
            if ((marks_[n] & cell_mark::inside) == 0) {
                if (!sides_.periodic(axis)) continue;
                n -= side * layout_.cells[index(axis)] * s;
                if (axis == vertical) level -= side * layout_.cells[vertical];
            }
            if (band_.holds(n) || fraction_[n] != 1) continue;
            surplus_[n] += side * (moved[face] - swept(axis, face, face_level)) / open_volume(n, level);
        }
    }
}

/// Brings the fractions of the band within their bounds.
template <int Dim>
void VolumeOfFluid<Dim>::settle(VolumeStep& step) {
    fill_periodic(fraction_, layout_, sides_);
    const auto cells = band_.cells();
    const auto levels = band_.levels();
    const auto count = static_cast<Index>(cells.size());
    const Real full = this->full();
    bulk_.resize(cells.size());
    parallel_for(count, [&](Index i) {
        const auto k = static_cast<std::size_t>(i);
        const Offset c = cells[k];
        bool bulk = fraction_[c] >= full;
        for (const Offset s : layout_.stride)
            for (const Offset n : {c - s, c + s})
                bulk = bulk && (fraction_[n] >= full || (marks_[n] & cell_mark::open) == 0);
        bulk_[k] = bulk;
    });
    std::vector<std::vector<Index>> wrong(static_cast<std::size_t>(block_count(count)));
    parallel_blocks(count, [&](Index block, Index first, Index last) {
        for (Index i = first; i < last; ++i) {
            const auto k = static_cast<std::size_t>(i);
            const Offset c = cells[k];
            const Real liquid = fraction_[c] + surplus_[c];
            if (bulk_[k]) {
                fraction_[c] = 1;
                surplus_[c] = liquid - 1;
                continue;
            }
            set_cell(c, liquid);
            if (std::abs(surplus_[c]) > wisp) wrong[static_cast<std::size_t>(block)].push_back(i);
        }
    });
    // One after the other, in order: few, and the same for any number of threads.
    for (const auto& block : wrong)
        for (const Index i : block) {
            const auto k = static_cast<std::size_t>(i);
            const Offset c = cells[k];
            const Real room = open_volume(c, levels[k]), amount = surplus_[c] * room;
            if (std::abs(surplus_[c]) <= wisp) continue;  // a neighbour has evened it out
            const Real left = share_out(c, levels[k], amount);
            surplus_[c] = left / room;
            step.moved_aside += std::abs(amount - left);
            step.left_over += std::abs(surplus_[c]) > wisp;
        }
}

}  // namespace abrade
