#pragma once
// Liquid that found no room at the end of a step of VolumeOfFluid, and where it goes.

#include <abrade/fluid/vof/surface_reconstruction.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_set>
#include <vector>

namespace abrade::detail {

/// Brings fractions within their bounds; what is moved for that goes through faces and adds to `flux` [m3].
template <int Dim>
class Redistribution {
    using Beside = typename LiquidCells<Dim>::Beside;

public:
    Redistribution(LiquidCells<Dim>& liquid, SurfaceReconstruction<Dim>& surface, Real largest_volume_defect,
                   FaceField<Dim>& flux)
        : liquid_(liquid), surface_(surface), layout_(liquid.layout), most_(largest_volume_defect),
          flux_(flux) {}

    struct Result {
        Real redistributed = 0;     ///< [m3]
        int not_redistributed = 0;  ///< cells
    };
    /// Those of the band, and `overfull` ones of the bulk.
    Result run(const CellsOfPlanes& overfull);

    /// Hands on what all full cells hold beyond their volume, as far as there is a way.
    void make_room() {
        liquid_.grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            if (liquid_.volume_defect[c] > most_)
                push_volume_defect(c, cell[Grid<Dim>::vertical], static_cast<std::size_t>(layout_.total));
        });
    }

private:
    static std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }
    void send(const Beside& to, Real volume) {
        flux_[to.axis][to.face] += volume;
        if (to.twin >= 0) flux_[to.axis][to.twin] += volume;
    }
    CellsOfPlanes bound_band();
    Real share_out(Offset c, Index level, Real amount);
    void push_volume_defect(Offset c, Index level, std::size_t reach);

    LiquidCells<Dim>& liquid_;
    SurfaceReconstruction<Dim>& surface_;
    const Layout<Dim>& layout_;
    Real most_;
    FaceField<Dim>& flux_;
};

template <int Dim>
typename Redistribution<Dim>::Result Redistribution<Dim>::run(const CellsOfPlanes& overfull) {
    fill_periodic(liquid_.fraction, layout_, liquid_.boundaries);
    // One after the other, in order: few, and the same for any number of threads.
    constexpr std::size_t reach = Dim == 3 ? 2000 : 200;
    Result done;
    for (const auto& plane : bound_band())
        for (const auto& [c, level] : plane) {
            Real& defect = liquid_.volume_defect[c];
            const Real room = liquid_.open_volume(c, level), amount = defect * room;
            if (std::abs(defect) <= volume_tolerance::round_off) continue;  // a neighbour has evened it out
            defect = share_out(c, level, amount) / room;
            if (defect > volume_tolerance::round_off) push_volume_defect(c, level, reach);
            done.redistributed += std::abs(amount - defect * room);
            done.not_redistributed += std::abs(defect) > volume_tolerance::round_off;
        }
    for (const auto& plane : overfull)
        for (const auto& [c, level] : plane)
            if (std::abs(liquid_.volume_defect[c]) > most_) push_volume_defect(c, level, reach);
    return done;
}

/// Bounds the fractions of the band; answers the cells that hold, or lack, what is more than a volume
/// defect.
template <int Dim>
CellsOfPlanes Redistribution<Dim>::bound_band() {
    const Pack full = Pack(surface_.full());
    Real* const fraction = liquid_.fraction.data();
    Real* const defects = liquid_.volume_defect.data();
    using Flags = std::array<std::uint8_t, pack_lanes>;
    std::vector<std::vector<Flags>> bulk(index(layout_.planes()));  // of the packs of each plane
    surface_.for_band_packs([&](const BandPack& pack) {
        const Offset c = pack.first;
        PackMask all = pack.in_band & (Pack::load(fraction + c) >= full);
        for (int a = 0; a < Dim && any(all); ++a)
            for (const Offset n : {c - layout_.stride[a], c + layout_.stride[a]}) {
                Flags closed;
                for (int lane = 0; lane < pack_lanes; ++lane)
                    closed[index(lane)] = !liquid_.is_open(n + lane);
                all = all & (flags_at(closed.data()) | (Pack::load_from_anywhere(fraction + n) >= full));
            }
        const unsigned lanes = lanes_of(all);
        Flags& flags = bulk[index(pack.plane)].emplace_back();
        for (int lane = 0; lane < pack_lanes; ++lane) flags[index(lane)] = lanes >> lane & 1;
    });
    const Pack most = Pack(1 + most_);
    CellsOfPlanes wrong(index(layout_.planes()));
    surface_.for_band_packs([&](const BandPack& pack) {
        const Offset c = pack.first;
        const PackMask in_bulk = flags_at(bulk[index(pack.plane)][pack.number].data());
        const Pack f = Pack::load(fraction + c), defect = Pack::load(defects + c);
        const Pack liquid = f + defect;  // bounded as `LiquidCells::set` does
        const Pack bounded = select(liquid < Pack(volume_tolerance::round_off), Pack(0),
                                    select(liquid > Pack(1 - volume_tolerance::round_off), Pack(1), liquid));
        const Pack now = select(in_bulk, Pack(1), bounded);
        select(pack.in_band, now, f).store(fraction + c);
        select(pack.in_band, liquid - now, defect).store(defects + c);
        const Pack beyond = liquid - bounded;
        const PackMask found = pack.in_band & ((!in_bulk & ((beyond > Pack(volume_tolerance::round_off)) |
                                                            (beyond < Pack(-volume_tolerance::round_off)))) |
                                               (liquid > most));
        for (unsigned lanes = lanes_of(found); lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            wrong[index(pack.plane)].push_back({c + lane, pack.level_of(lane, Dim)});
        }
    });
    return wrong;
}

/// Gives liquid (or, below 0, the lack of it) to the neighbours of a cell; answers what they could not take.
template <int Dim>
Real Redistribution<Dim>::share_out(Offset c, Index level, Real amount) {
    struct Way {
        Beside to;
        Real room;
        bool cut;
    };
    std::array<Way, 2 * Dim> ways;
    int count = 0;
    liquid_.for_each_beside(c, level, [&](const Beside& to) {
        const Real f = liquid_.fraction[to.cell];
        const Real room = (amount > 0 ? 1 - f : f) * liquid_.open_volume(to.cell, to.level);
        if (room > 0) ways[index(count++)] = {to, room, f > 0 && f < 1};
    });
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
            send(way.to, way.to.side * part);
            surface_.look_again_at(way.to.cell);
            liquid_.set(way.to.cell,
                        liquid_.held(way.to.cell) + part / liquid_.open_volume(way.to.cell, way.to.level));
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
void Redistribution<Dim>::push_volume_defect(Offset c, Index level, std::size_t reach) {
    Field<Real>&fraction = liquid_.fraction, &defect = liquid_.volume_defect;
    struct Way {
        Beside to;
        std::size_t from = 0;  ///< the way to the cell before, by its number; the first has none
        Real room = 0;         ///< [m3]
    };
    const Real sign = defect[c] > 0 ? 1 : -1;
    std::vector<Way> ways{{Beside{c, -1, -1, level, 0, 0}}};
    std::unordered_set<Offset> seen{c};
    const auto look_beside = [&](std::size_t at) {
        const Beside here = ways[at].to;
        liquid_.for_each_beside(here.cell, here.level, [&](const Beside& to) {
            if (!seen.insert(to.cell).second) return;
            Way& way = ways.emplace_back(Way{to, at});
            // A full cell may lack what the next projection draws in: that much is no room.
            const Real holds = liquid_.held(to.cell);
            const Real room = sign > 0 ? 1 - holds : fraction[to.cell] < 1 ? holds : holds - 1;
            if (fraction[to.cell] < 1 || room > most_)
                way.room = std::max(room, Real(0)) * liquid_.open_volume(to.cell, to.level);
        });
    };
    const auto give = [&](std::size_t way, Real part) {
        for (std::size_t w = way; w != 0; w = ways[w].from) send(ways[w].to, ways[w].to.side * part);
        const Offset cell = ways[way].to.cell;
        const Real share = part / liquid_.open_volume(cell, ways[way].to.level);
        surface_.look_again_at(cell);
        if (fraction[cell] == 1)
            defect[cell] += share;
        else
            liquid_.set(cell, liquid_.held(cell) + share);
    };
    // Layer by layer: cells as far away have the same right.
    for (std::size_t first = 0, last = 1;
         first < last && last < reach && sign * defect[c] > volume_tolerance::round_off;) {
        for (; first < last; ++first) look_beside(first);  // which are full by now
        Real room = 0;
        for (std::size_t k = last; k < ways.size(); ++k) room += ways[k].room;
        const Real amount = sign * std::min(sign * defect[c] * liquid_.open_volume(c, level), room);
        if (amount != 0) {
            for (std::size_t k = last; k < ways.size(); ++k)
                if (ways[k].room > 0) give(k, amount * (ways[k].room / room));
            defect[c] -= amount / liquid_.open_volume(c, level);
        }
        last = ways.size();
    }
}

}  // namespace abrade::detail
