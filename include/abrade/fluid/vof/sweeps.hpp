#pragma once
// How a VolumeOfFluid carries its liquid: one sweep along each axis, and a light pass over the bulk.

#include <abrade/core/parallel.hpp>
#include <abrade/fluid/vof/surface_reconstruction.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

namespace abrade::detail {

/// Areas of faces [m2] and 1 / volume of cells [1/m3], by level from the first ghost.
template <int Dim>
struct LevelSizes {
    LevelSizes() = default;
    explicit LevelSizes(const LiquidCells<Dim>& liquid) {
        constexpr int g = Layout<Dim>::ghosts;
        for (int k = -g; k < liquid.grid.cells(Grid<Dim>::vertical) + g; ++k) {
            for (int a = 0; a < Dim; ++a) area[a].push_back(liquid.sizes.face(a, k));
            per_volume.push_back(1 / liquid.sizes.volume(k));
        }
        // Packs look beyond the end of a row.
        for (auto& areas : area) areas.resize(areas.size() + pack_lanes, 0);
        per_volume.resize(per_volume.size() + pack_lanes, 0);
    }

    static Real at(const std::vector<Real>& by_level, Index level) noexcept {
        return by_level[static_cast<std::size_t>(level + Layout<Dim>::ghosts)];
    }
    /// The same of a pack, from a cell on.
    static Pack of_pack(const std::vector<Real>& by_level, Index level) noexcept {
        const Real* first = by_level.data() + level + Layout<Dim>::ghosts;
        return Dim == 3 ? Pack(*first) : Pack::load_from_anywhere(first);
    }

    PerAxis<std::vector<Real>, Dim> area;
    std::vector<Real> per_volume;
};

/// One step of a VolumeOfFluid: what goes through each face is `flux` [m3].
template <int Dim>
class Sweeps {
    static constexpr int vertical = Grid<Dim>::vertical, inner = Layout<Dim>::inner,
                         outer = Layout<Dim>::outer;

public:
    struct Step {
        const FaceField<Dim>& velocity;  ///< [m/s]
        Real dt;                         ///< [s]
        FaceField<Dim>& flux;
        bool fit_every_sweep;        ///< see VolumeOfFluid::Params
        Real largest_volume_defect;  ///< likewise
    };

    Sweeps(LiquidCells<Dim>& liquid, SurfaceReconstruction<Dim>& surface, const LevelSizes<Dim>& sizes,
           const Step& step)
        : liquid_(liquid), surface_(surface), layout_(liquid.layout), sizes_(sizes), step_(step),
          swept_per_speed_(sizes.area), filled_(static_cast<std::size_t>(layout_.planes())),
          overfull_(static_cast<std::size_t>(layout_.planes())) {
        for (auto& areas : swept_per_speed_)
            for (Real& area : areas) area *= step.dt;
    }

    /// All of it, axes in the order of the step's number.
    void run(Index number) {
        carry_bulk();
        find_filled();
        const PerAxis<int, Dim> axes = order(number);
        for (int n = 0; n < Dim; ++n) sweep(axes, n);
    }

    /// Cells of the bulk beyond `largest_volume_defect`.
    const CellsOfPlanes& overfull() const noexcept { return overfull_; }

private:
    /// All orders in turn; in 2-D two, in 3-D six.
    static PerAxis<int, Dim> order(Index step) noexcept {
        const int turn = static_cast<int>(step % Dim), way = static_cast<int>(step / Dim % 2);
        PerAxis<int, Dim> axes;
        for (int n = 0; n < Dim; ++n) axes[n] = (Dim == 3 && way == 1 ? 2 * Dim - n + turn : n + turn) % Dim;
        return axes;
    }

    /// Volume that a lower face sweeps in the step, positive upwards [m3].
    Real swept(int axis, Offset c, Index level) const noexcept {
        const Real volume = step_.velocity[axis][c] * sizes_.at(swept_per_speed_[axis], level);
        return liquid_.apertures ? volume * (*liquid_.apertures)[axis][c] : volume;
    }
    Pack swept_of_pack(int axis, Offset c, Index level) const noexcept {
        const Pack volume = Pack::load_from_anywhere(step_.velocity[axis].data() + c) *
                            sizes_.of_pack(swept_per_speed_[axis], level);
        return liquid_.apertures ? volume * Pack::load_from_anywhere((*liquid_.apertures)[axis].data() + c)
                                 : volume;
    }

    void carry_bulk();
    void carry_row(Offset start, Index level, const RowRange& range, bool cells,
                   std::vector<CellAtLevel>& overfull);
    void find_filled();
    void sweep(const PerAxis<int, Dim>& axes, int number);
    void fluxes_of_band(int axis);
    void fluxes_of_planes(int axis);
    void join_periodic(int axis);
    bool is_detached_film(int axis, Offset c, int way) const noexcept;
    void even_out_rims(int axis);

    LiquidCells<Dim>& liquid_;
    SurfaceReconstruction<Dim>& surface_;
    const Layout<Dim>& layout_;
    const LevelSizes<Dim>& sizes_;
    Step step_;
    PerAxis<std::vector<Real>, Dim>
        swept_per_speed_;  ///< dt times area, by level from the first ghost [m2 s]
    /// [plane] c of Weymouth and Yue, 0 or 1, of the cells of its band packs.
    std::vector<std::vector<std::array<std::uint8_t, pack_lanes>>> filled_;
    CellsOfPlanes overfull_;
};

/// Liquid through faces between cells that are full or dry, for good outside of the band; and what
/// divergence leaves in the bulk.
template <int Dim>
void Sweeps<Dim>::carry_bulk() {
    const int rows = layout_.rows_per_plane(), planes = layout_.planes(), n = layout_.row_length();
    surface_.touched().for_each_row([&](int p, int r, const RowRange& range) {
        const Offset start = layout_.row_start(p, r);
        std::vector<CellAtLevel>& overfull = overfull_[static_cast<std::size_t>(p)];
        // Whole packs: what lies before and behind the range is dry, and faces of ghosts that follow are
        // those of the upper side.
        RowRange all{range.begin / pack_lanes * pack_lanes, range.end + (range.end == n)};
        all.end = (all.end + pack_lanes - 1) / pack_lanes * pack_lanes;
        carry_row(start, r, all, true, overfull);
        if (p == planes - 1) carry_row(start + layout_.stride[0], r, all, false, overfull);
        if (Dim == 3 && r == rows - 1) carry_row(start + layout_.stride[Dim - 1], r, all, false, overfull);
    });
}

/// One row of it. Rows of ghosts have faces (of the upper sides), but no cells.
template <int Dim>
void Sweeps<Dim>::carry_row(Offset start, Index level, const RowRange& range, bool cells,
                            std::vector<CellAtLevel>& overfull) {
    const Real* f = liquid_.fraction.data() + start;
    Real* volume_defect = liquid_.volume_defect.data() + start;
    const std::uint8_t* band = surface_.band().data() + start;
    const Field<Real>* const room = liquid_.room();
    const bool walls = liquid_.apertures != nullptr;
    const Real most = step_.largest_volume_defect;
    PerAxis<const Real*, Dim> u, open{};
    PerAxis<Real*, Dim> out;
    for (int a = 0; a < Dim; ++a) {
        u[a] = step_.velocity[a].data() + start;
        out[a] = step_.flux[a].data() + start;
        if (walls) open[a] = (*liquid_.apertures)[a].data() + start;
    }
    const auto level_of = [&](int i) { return Dim == 3 ? level : Index{i}; };
    const PerAxis<Offset, Dim> step = layout_.stride;
    for (int i = range.begin; i < range.end; i += pack_lanes) {
        const Pack own = Pack::load(f + i);
        Pack gone = Pack(0);
        for (int a = 0; a < Dim; ++a) {
            const Pack speed = Pack::load(u[a] + i), area = sizes_.of_pack(swept_per_speed_[a], level_of(i));
            Pack low = speed * area, high = Pack::load_from_anywhere(u[a] + i + step[a]) * area;
            if (walls) {
                low *= Pack::load(open[a] + i);
                high *= Pack::load_from_anywhere(open[a] + i + step[a]);
            }
            const Pack donor = select(speed > Pack(0), Pack::load_from_anywhere(f + i - step[a]), own);
            select(donor > Pack(0), low * donor, Pack(0)).store(out[a] + i);
            gone += high - low;
        }
        const unsigned full = lanes_of(own == Pack(1));
        if (!cells || full == 0) continue;
        std::array<std::uint8_t, pack_lanes> in_band;
        std::memcpy(in_band.data(), band + i, pack_lanes);
        const bool deep = in_band == std::array<std::uint8_t, pack_lanes>{};
        Pack lost = gone * sizes_.of_pack(sizes_.per_volume, level_of(i));
        if (room) lost /= Pack::load(room->data() + start + i);
        const auto is_deep = [&](int lane) {
            return in_band[static_cast<std::size_t>(lane)] == 0 && (full >> lane & 1) != 0;
        };
        if (deep && full == (1u << pack_lanes) - 1) {
            const Pack left = Pack::load(volume_defect + i) - lost;
            left.store(volume_defect + i);
            if (!any((left > Pack(most)) | (left < Pack(-most)))) continue;
        } else {
            for (int lane = 0; lane < pack_lanes; ++lane)
                if (is_deep(lane)) volume_defect[i + lane] -= lost[lane];
        }
        for (int lane = 0; lane < pack_lanes; ++lane)
            if (const Offset c = start + i + lane; is_deep(lane) &&
                                                   std::abs(volume_defect[i + lane]) > most &&
                                                   liquid_.is_inside(c) && !liquid_.solids.has(c))
                overfull.push_back({c, Dim == 3 ? level : Index{i + lane}});
    }
}

template <int Dim>
void Sweeps<Dim>::find_filled() {
    surface_.for_band_packs([&](const BandPack& pack) {
        auto& filled = filled_[static_cast<std::size_t>(pack.plane)].emplace_back();
        for (int lane = 0; lane < pack_lanes; ++lane)
            filled[static_cast<std::size_t>(lane)] = liquid_.fraction[pack.first + lane] > 0.5;
    });
}

template <int Dim>
void Sweeps<Dim>::sweep(const PerAxis<int, Dim>& axes, int number) {
    const int axis = axes[number];
    if (number > 0) {
        surface_.reconstruct(liquid_, !step_.fit_every_sweep);
        fluxes_of_band(axis);
    }
    fluxes_of_planes(axis);
    join_periodic(axis);
    even_out_rims(axis);

    const auto dilatation = [&](int a, Offset c, Index level) {
        return swept_of_pack(a, c + layout_.stride[a], level) - swept_of_pack(a, c, level);
    };
    const Real* const moved = step_.flux[axis].data();
    const Field<Real>* const room = liquid_.room();
    const bool last = number == Dim - 1;
    surface_.for_band_packs([&](const BandPack& pack) {
        const Offset c = pack.first;
        const PackMask filled = flags_at(filled_[static_cast<std::size_t>(pack.plane)][pack.number].data());
        Pack left = Pack::load_from_anywhere(moved + c + layout_.stride[axis]) - Pack::load(moved + c);
        if (any(filled)) {
            Pack added = Pack(0);
            if (!last)
                added = dilatation(axis, c, pack.level);
            else
                for (int n = 0; n < number; ++n) added -= dilatation(axes[n], c, pack.level);
            left -= select(filled, added, Pack(0));
        }
        Pack change = left * sizes_.of_pack(sizes_.per_volume, pack.level);
        if (room) change /= Pack::load(room->data() + c);
        const Pack f = Pack::load(liquid_.fraction.data() + c);
        select(pack.in_band, f - change, f).store(liquid_.fraction.data() + c);
    });
    if (!last) fill_periodic(liquid_.fraction, layout_, liquid_.boundaries);
}

/// Faces of the band whose donor is full or dry, or a ghost: what is swept times its fraction. Whole packs
/// are written: faces with a cut donor are overwritten by `fluxes_of_planes`, those out of the band get again
/// what `carry_bulk` gave.
template <int Dim>
void Sweeps<Dim>::fluxes_of_band(int axis) {
    const Offset step = layout_.stride[axis];
    const bool is_outer = axis == outer, is_inner = axis == inner;
    const WetRows<Dim>& active = surface_.active();
    const Real* const fraction = liquid_.fraction.data();
    const int planes = layout_.planes(), rows = layout_.rows_per_plane() + !(is_outer || is_inner);
    const auto fluxes_of_plane = [&](int p) {
        for (int r = 0; r < rows; ++r) {
            // Upper faces of cells as well as lower ones.
            RowRange range = active.range(p, r);
            const int plane_below = p - is_outer, row_below = r - !(is_outer || is_inner);
            if (is_inner)
                range.end += !range.empty();
            else if (plane_below >= 0 && row_below >= 0)
                range = hull(range, active.range(plane_below, row_below));
            const Offset start = layout_.row_start(p, r);
            for (int i = range.begin / pack_lanes * pack_lanes; i < range.end; i += pack_lanes) {
                const Offset c = start + i;
                const std::uint8_t* const band = surface_.band().data() + c;
                if (!any(flags_at(band) | flags_at(band - step))) continue;
                const Pack speed = Pack::load(step_.velocity[axis].data() + c);
                const Pack f = select(speed > Pack(0), Pack::load_from_anywhere(fraction + c - step),
                                      Pack::load(fraction + c));
                const Pack share = select(f > Pack(1 - volume_tolerance::round_off), Pack(1), f);
                const Pack flux = swept_of_pack(axis, c, Dim == 3 ? Index{r} : Index{i}) * share;
                select(f < Pack(volume_tolerance::round_off), Pack(0), flux)
                    .store(step_.flux[axis].data() + c);
            }
        }
    };
    active.for_each_plane([&](int p) {
        fluxes_of_plane(p);
        if (is_outer && p + 1 == planes) fluxes_of_plane(planes);
    });
}

/// Faces through which cells that the surface cuts give liquid.
template <int Dim>
void Sweeps<Dim>::fluxes_of_planes(int axis) {
    constexpr Real next_to_nothing = 0.01;  // what round-off of a normal makes of nothing is far below it
    const Offset step = layout_.stride[axis];
    const SurfacePlanes<Dim>& planes = surface_.planes();
    const auto& u = step_.velocity[axis];
    auto& moved = step_.flux[axis];
    parallel_blocks(planes.count(), [&](Index, Index first, Index last) {
        for (Index i = first; i < last; i += pack_lanes) {
            const int lanes = std::min<int>(pack_lanes, last - i);
            PackCells item;
            for (int l = 0; l < pack_lanes; ++l)
                item[static_cast<std::size_t>(l)] = i + std::min(l, lanes - 1);
            CellPlane<Dim, Pack> plane;
            for (std::size_t a = 0; a < Dim; ++a) plane.normal[a] = values_at(planes.normal[a].data(), item);
            plane.distance = values_at(planes.distance.data(), item);
            Pack up{}, down{}, room{};
            for (int l = 0; l < pack_lanes; ++l) {
                const auto k = static_cast<std::size_t>(item[static_cast<std::size_t>(l)]);
                const Offset c = planes.cell[k];
                const Index level = planes.level[k];
                up.set(l, u[c + step] > 0 ? swept(axis, c + step, level) : 0);
                down.set(l, u[c] < 0 ? -swept(axis, c, level) : 0);
                room.set(l, liquid_.open_volume(c, level));
            }
            const auto given = [&](Pack volume, Pack side) {
                return volume * slab_fraction(plane, axis, side, min(volume / room, Pack(1)));
            };
            // Most cells give through one face, so both are seldom looked at.
            const PackMask through_upper = up > Pack(0);
            const Pack once =
                given(select(through_upper, up, down), select(through_upper, Pack(1), Pack(-1)));
            Pack again{};
            const bool both = any(through_upper & (down > Pack(0)));
            if (both) again = given(down, Pack(-1));
            for (int l = 0; l < lanes; ++l) {
                const Offset c = planes.cell[static_cast<std::size_t>(item[static_cast<std::size_t>(l)])];
                const auto or_detached = [&](Real from_slab, int way, Real volume) {
                    const Real even = liquid_.fraction[c] * std::min(volume, room[l]);
                    return from_slab < next_to_nothing * even && is_detached_film(axis, c, way) ? even
                                                                                                : from_slab;
                };
                if (up[l] > 0) moved[c + step] = or_detached(once[l], 1, up[l]);
                if (u[c] < 0) moved[c] = -or_detached(up[l] > 0 ? again[l] : once[l], -1, down[l]);
            }
        }
    });
}

/// The first and the last face of a periodic axis are one: what its donor found holds for both.
template <int Dim>
void Sweeps<Dim>::join_periodic(int axis) {
    if (!liquid_.boundaries.periodic(axis)) return;
    const auto& u = step_.velocity[axis];
    auto& moved = step_.flux[axis];
    const Offset length = layout_.cells[axis] * layout_.stride[axis];
    const auto join = [&](Offset face) {
        (u[face] > 0 ? moved[face] : moved[face + length]) = moved[u[face] > 0 ? face + length : face];
    };
    surface_.active().for_each_row([&](int p, int r, const RowRange& range) {
        const Offset start = layout_.row_start(p, r);
        if (axis == inner) {
            if (range.begin == 0) join(start);
        } else if (axis == outer ? p == 0 : r == 0) {
            for (int i = range.begin; i < range.end; ++i) join(start + i);
        }
    });
}

/// A film or a drop whose plane lies at the end that it comes from: a slab of the other end would find next
/// to nothing, for ever, while its weight makes it faster. Unless the cell behind
/// is at least as full, a closed face that gravity does not pull it off holds it, or it is part of a surface
/// that its neighbours tell, it leaves as if it filled the cell evenly; where it fills half of it or more, if
/// it is alone: what belongs to a bore's roller stays with it. A wall that cuts the cell holds nothing back:
/// what moves there moves along it.
template <int Dim>
bool Sweeps<Dim>::is_detached_film(int axis, Offset c, int way) const noexcept {
    if (surface_.planes().reconstructed[static_cast<std::size_t>(surface_.plane_of(c))] != 0) return false;
    const Field<Real>& f = liquid_.fraction;
    const bool whole = !liquid_.room() || (*liquid_.room())[c] == 1;
    const Offset behind = c - way * layout_.stride[axis];
    const bool open_behind =
        liquid_.is_open(behind) && (liquid_.is_inside(behind) || liquid_.boundaries.periodic(axis));
    if (f[c] >= 0.5)
        for (int a = 0; a < Dim; ++a)
            for (const Offset s : {-layout_.stride[a], layout_.stride[a]})
                if (f[c + s] >= 0.5) return false;
    return open_behind ? f[behind] < f[c] : !whole || liquid_.gravity[axis] * way > 0;
}

/// Full cells beyond the band took it that what flows through their faces is all liquid. Where a cell of the
/// band beside them holds a trace of air in this sweep, too little to be a surface, they have a trace less.
template <int Dim>
void Sweeps<Dim>::even_out_rims(int axis) {
    const auto& moved = step_.flux[axis];
    const SurfacePlanes<Dim>& planes = surface_.planes();
    const SurfaceBand<Dim>& band = surface_.band();
    for (const int side : {-1, 1})  // a cell is the neighbour of one: threads do not meet
        parallel_for(planes.count(), [&](Index i) {
            const auto k = static_cast<std::size_t>(i);
            const Offset c = planes.cell[k];
            if (band.has_air(c)) return;  // all its neighbours are in the band
            const Index face_level = planes.level[k] + (axis == vertical && side > 0 ? 1 : 0);
            const auto n = liquid_.beside(c, planes.level[k], axis, side);
            if (!n || band.holds(n->cell) || liquid_.fraction[n->cell] != 1) return;
            liquid_.volume_defect[n->cell] += side * (moved[n->face] - swept(axis, n->face, face_level)) /
                                              liquid_.open_volume(n->cell, n->level);
        });
}

}  // namespace abrade::detail
