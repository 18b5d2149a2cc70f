#pragma once
// What VolumeOfFluid does with liquid that found no room at the end of a step.

#include <abrade/fluid/vof/volume_of_fluid_class.hpp>

#include <bit>
#include <unordered_set>

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
                if (!boundaries_.periodic(a)) continue;
                way.cell -= side * length;
                way.twin = way.face - side * length;
                if (a == vertical) way.level -= side * layout_.cells[index(a)];
            }
            if ((marks_[way.cell] & cell_mark::open) == 0) continue;
            if (apertures_ && (*apertures_)[index(a)][way.face] <= 0) continue;
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
            volume_flux_[index(way.axis)][way.face] += way.sign * part;
            if (way.twin >= 0) volume_flux_[index(way.axis)][way.twin] += way.sign * part;
            settled_.push_back(static_cast<Index>(way.cell));
            set_cell(way.cell, fraction_[way.cell] + volume_defect_[way.cell] +
                                   part / open_volume(way.cell, way.level));
        }
        amount -= taken;
        if (amount == 0) break;
    }
    return amount;
}

/// Pushes liquid that a cell has no room for along full cells to the nearest ones that have room, in
/// proportion to that, or draws what it lacks from the nearest ones that hold it; each cell on the way hands
/// on to the next. What finds none among `reach` cells stays.
template <int Dim>
void VolumeOfFluid<Dim>::push_volume_defect(Offset c, Index level, std::size_t reach) {
    struct Way {
        Offset cell;
        std::size_t from;  ///< the cell before, by its number
        Index level;
        int axis = 0, side = 0;
        Offset face = 0, twin = -1;  ///< twin: the same face at the other end of a periodic axis, or none
        Real room = 0;               ///< [m3]
    };
    const Real sign = volume_defect_[c] > 0 ? 1 : -1;
    std::vector<Way> ways{{c, 0, level}};
    std::unordered_set<Offset> seen{c};
    const auto look_beside = [&](std::size_t at) {
        for (int a = 0; a < Dim; ++a)
            for (const int side : {-1, 1}) {
                const Way here = ways[at];
                const Offset step = layout_.stride[index(a)], around = side * layout_.cells[index(a)] * step;
                Way way{here.cell + side * step,
                        at,
                        here.level,
                        a,
                        side,
                        side > 0 ? here.cell + step : here.cell};
                if (a == vertical) way.level += side;
                if ((marks_[way.cell] & cell_mark::inside) == 0) {
                    if (!boundaries_.periodic(a)) continue;
                    way.cell -= around, way.twin = way.face - around;
                    if (a == vertical) way.level -= side * layout_.cells[index(a)];
                }
                if ((marks_[way.cell] & cell_mark::open) == 0 ||
                    (apertures_ && (*apertures_)[index(a)][way.face] <= 0) || !seen.insert(way.cell).second)
                    continue;
                // A full cell may lack what the next projection draws in: that much is no room.
                const Real holds = fraction_[way.cell] + volume_defect_[way.cell];
                const Real room = sign > 0 ? 1 - holds : fraction_[way.cell] < 1 ? holds : holds - 1;
                if (fraction_[way.cell] < 1 || room > params_.largest_volume_defect)
                    way.room = std::max(room, Real(0)) * open_volume(way.cell, way.level);
                ways.push_back(way);
            }
    };
    const auto give = [&](const Way& to, Real part) {
        for (const Way* w = &to; w->side != 0; w = &ways[w->from]) {
            volume_flux_[index(w->axis)][w->face] += w->side * part;
            if (w->twin >= 0) volume_flux_[index(w->axis)][w->twin] += w->side * part;
        }
        const Real share = part / open_volume(to.cell, to.level);
        settled_.push_back(static_cast<Index>(to.cell));
        if (fraction_[to.cell] == 1)
            volume_defect_[to.cell] += share;
        else
            set_cell(to.cell, fraction_[to.cell] + volume_defect_[to.cell] + share);
    };
    // Layer by layer: cells as far away have the same right.
    for (std::size_t first = 0, last = 1; first < last && last < reach && sign * volume_defect_[c] > wisp;) {
        for (; first < last; ++first) look_beside(first);  // which are full by now
        Real room = 0;
        for (std::size_t k = last; k < ways.size(); ++k) room += ways[k].room;
        const Real amount = sign * std::min(sign * volume_defect_[c] * open_volume(c, level), room);
        if (amount != 0) {
            for (std::size_t k = last; k < ways.size(); ++k)
                if (ways[k].room > 0) give(ways[k], amount * (ways[k].room / room));
            volume_defect_[c] -= amount / open_volume(c, level);
        }
        last = ways.size();
    }
}

/// Full cells beyond the band took it that what flows through their faces is all liquid. Where a cell of the
/// band beside them holds a trace of air in this sweep, too little to be a surface, they have a trace less.
template <int Dim>
void VolumeOfFluid<Dim>::even_out_rims(int axis) {
    const Offset s = layout_.stride[index(axis)];
    const auto& moved = volume_flux_[index(axis)];
    for (const int side : {-1, 1})  // a cell is the neighbour of one: threads do not meet
        parallel_for(planes_.count(), [&](Index i) {
            const auto k = static_cast<std::size_t>(i);
            const Offset c = planes_.cell[k];
            if (band_.airy(c)) return;  // all its neighbours are in the band
            const Offset face = side > 0 ? c + s : c;
            const Index face_level = planes_.level[k] + (axis == vertical && side > 0 ? 1 : 0);
            Offset n = c + side * s;
            Index level = planes_.level[k] + (axis == vertical ? side : 0);
            if ((marks_[n] & cell_mark::inside) == 0) {
                if (!boundaries_.periodic(axis)) return;
                n -= side * layout_.cells[index(axis)] * s;
                if (axis == vertical) level -= side * layout_.cells[vertical];
            }
            if (band_.holds(n) || fraction_[n] != 1) return;
            volume_defect_[n] += side * (moved[face] - swept(axis, face, face_level)) / open_volume(n, level);
        });
}

/// Brings the fractions of the band within their bounds.
template <int Dim>
void VolumeOfFluid<Dim>::settle(VolumeStep& step) {
    fill_periodic(fraction_, layout_, boundaries_);
    const Pack full = Pack(this->full());
    Field<std::uint8_t>& bulk = filled_;  // which is for the sweeps only
    for_band_packs([&](int, Offset c, Index, const PackMask& band) {
        PackMask all = band & (Pack::load(fraction_.data() + c) >= full);
        for (int a = 0; a < Dim && any(all); ++a)
            for (const Offset n : {c - layout_.stride[a], c + layout_.stride[a]}) {
                std::array<std::uint8_t, pack_lanes> closed;
                for (int lane = 0; lane < pack_lanes; ++lane)
                    closed[index(lane)] = (marks_[n + lane] & cell_mark::open) == 0;
                all = all & (detail::flags_at(closed.data()) |
                             (Pack::load_from_anywhere(fraction_.data() + n) >= full));
            }
        const unsigned lanes = lanes_of(all);
        for (int lane = 0; lane < pack_lanes; ++lane) bulk[c + lane] = lanes >> lane & 1;
    });
    const Pack most = Pack(1 + params_.largest_volume_defect);
    std::vector<std::vector<CellAt>> wrong(static_cast<std::size_t>(layout_.planes()));
    for_band_packs([&](int plane, Offset c, Index level, const PackMask& band) {
        const PackMask in_bulk = detail::flags_at(bulk.data() + c);
        const Pack f = Pack::load(fraction_.data() + c),
                   volume_defect = Pack::load(volume_defect_.data() + c);
        const Pack liquid = f + volume_defect;  // bounded as `set_cell` does
        const Pack bounded =
            select(liquid < Pack(wisp), Pack(0), select(liquid > Pack(1 - wisp), Pack(1), liquid));
        const Pack now = select(in_bulk, Pack(1), bounded);
        select(band, now, f).store(fraction_.data() + c);
        select(band, liquid - now, volume_defect).store(volume_defect_.data() + c);
        const Pack beyond = liquid - bounded;
        const PackMask found =
            band & ((!in_bulk & ((beyond > Pack(wisp)) | (beyond < Pack(-wisp)))) | (liquid > most));
        for (unsigned lanes = lanes_of(found); lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            wrong[index(plane)].push_back({c + lane, Dim == 3 ? level : level + lane});
        }
    });
    // One after the other, in order: few, and the same for any number of threads.
    constexpr std::size_t reach = Dim == 3 ? 2000 : 200;
    for (const auto& plane : wrong)
        for (const auto& [c, level] : plane) {
            const Real room = open_volume(c, level), amount = volume_defect_[c] * room;
            if (std::abs(volume_defect_[c]) <= wisp) continue;  // a neighbour has evened it out
            volume_defect_[c] = share_out(c, level, amount) / room;
            if (volume_defect_[c] > wisp) push_volume_defect(c, level, reach);
            const Real left = volume_defect_[c] * room;
            step.moved_aside += std::abs(amount - left);
            step.left_over += std::abs(volume_defect_[c]) > wisp;
        }
    for (const auto& plane : overfull_)
        for (const auto& [c, level] : plane)
            if (std::abs(volume_defect_[c]) > params_.largest_volume_defect)
                push_volume_defect(c, level, reach);
}

/// Liquid in the room that solids leave it now; what of them is below the surface carries momentum, too.
template <int Dim>
void VolumeOfFluid<Dim>::move_solids(Real dt) {
    solid_moved_.clear();
    for (const SolidFlux& f : std::exchange(solid_fluxes_, {})) {
        CellNumber<Dim> number = layout_.number(f.face);
        const Real open = apertures_ ? (*apertures_)[index(f.axis)][f.face] : 1;
        solid_moved_.push_back({f.face, f.axis, f.speed * open * dt * sizes_.face(f.axis, number[vertical])});
    }
    std::vector<Real> below;
    for (const SolidVolume& s : solid_moved_)
        below.push_back(std::clamp(fraction_[s.volume > 0 ? s.face - layout_.stride[index(s.axis)] : s.face],
                                   Real(0), Real(1)));
    // No faster than water falls through a cell, however short the step.
    constexpr Real most = 0.05;
    const Real falls = gravity_.norm() > 0 ? dt * std::sqrt(gravity_.norm() / grid_.smallest()) : most;
    solids_.move(grid_, boundaries_, fraction_, volume_defect_, solid_moved_, std::min(falls, most),
                 1 - void_inside_water());
    for (std::size_t n = 0; n < below.size(); ++n) {
        SolidVolume& s = solid_moved_[n];
        s.volume *= below[n], volume_flux_[index(s.axis)][s.face] += s.volume;
    }
}

/// A plane that cuts a cell leaves the centre of one of the cells around it dry. A cell that is not full and
/// has no such neighbour holds a void that nothing can fill, for its pressure is that of water: it is full,
/// and lacks what the pressure is to draw in.
template <int Dim>
void VolumeOfFluid<Dim>::close_voids() {
    constexpr Real wet = 0.5;
    std::vector<Offset> around{0};
    for (const Offset stride : layout_.stride)
        for (std::size_t n = around.size(); n-- > 0;)
            around.push_back(around[n] - stride), around.push_back(around[n] + stride);
    std::vector<std::vector<Offset>> voids(index(layout_.planes()));
    for_band_packs([&](int plane, Offset c, Index, const PackMask& band) {
        const Pack f = Pack::load(fraction_.data() + c);
        for (unsigned lanes = lanes_of(band & (f >= Pack(wet)) & (f < Pack(1))); lanes != 0;
             lanes &= lanes - 1) {
            const Offset cell = c + std::countr_zero(lanes);
            if (std::ranges::all_of(around, [&](Offset s) {
                    return fraction_[cell + s] >= wet || (marks_[cell + s] & cell_mark::open) == 0;
                }))
                voids[index(plane)].push_back(cell);
        }
    });
    for (const auto& plane : voids)
        for (const Offset c : plane) solids_.lag_by(c, (fraction_[c] - 1) * (*room())[c]), fraction_[c] = 1;
    solids_.keep_volume_defect(fraction_, volume_defect_);
}

template <int Dim>
void VolumeOfFluid<Dim>::take_sources(Real dt) {
    for (CellSource& s : std::exchange(sources_, {})) {
        const Real holds = fraction_[s.cell] + volume_defect_[s.cell];
        if (!(fraction_[s.cell] > 0)) continue;
        const Real share = std::max(s.rate * dt, -holds);
        s.volume = share * open_volume(s.cell, layout_.number(s.cell)[vertical]);
        if (fraction_[s.cell] == 1)
            volume_defect_[s.cell] += share;
        else
            set_cell(s.cell, holds + share), settled_.push_back(static_cast<Index>(s.cell));
    }
}

template <int Dim>
void VolumeOfFluid<Dim>::make_room() {
    grid_.for_each([&](const CellNumber<Dim>& cell, Offset c) {
        if (volume_defect_[c] > params_.largest_volume_defect)
            push_volume_defect(c, cell[vertical], static_cast<std::size_t>(layout_.total));
    });
    wet_.find(fraction_);
    locate();
}

template <int Dim>
void VolumeOfFluid<Dim>::locate() {
    touched_ = active_;
    active_ = wet_.dilated(2, boundaries_.periodic_axes());
    include_inflows();
    touched_.include(active_);
    fill_ghosts(fraction_, touched_, boundaries_);
    const std::vector<Index> band_before(band_.cells().begin(), band_.cells().end());
    band_.find(fraction_, marks_, active_, boundaries_);
    // What has left the band with less air than makes a surface is full from now on; the rest is its volume
    // defect.
    const auto close = [&](Index c) {
        if (fraction_[c] < 1 - void_inside_water() || band_.holds(c)) return;
        volume_defect_[c] += fraction_[c] - 1;
        fraction_[c] = 1;
    };
    parallel_for(static_cast<Index>(band_before.size()), [&](Index i) { close(band_before[index(i)]); });
    for (const Index c : settled_) close(c);
    settled_.clear();
    reconstruct(false);
}

template <int Dim>
void VolumeOfFluid<Dim>::fail_courant(const FaceField<Dim>& velocity, Real dt) const {
    Index worst = 0;
    Real most = -1;  // or not a number, which counts as the most
    const auto count = static_cast<Index>(band_.cells().size());
    for (Index i = 0; i < count && !std::isnan(most); ++i)
        if (const Real rate = rate_of(velocity, i); !(rate <= most)) worst = i, most = rate;
    fail(
        {"VolumeOfFluid.advance: dt",
         "small enough that no more than all of a cell at the surface leaves it, " + short_text(dt * most) +
             " times cell " + text(layout_.number(band_.cells()[static_cast<std::size_t>(worst)])) + " would",
         "s", "take at most stable_step()"},
        short_text(dt));
}

}  // namespace abrade
