#pragma once
// How VolumeOfFluid carries liquid: the bulk and the sweeps of the band. What finds no room is settled by
// redistribution.hpp.

#include <abrade/fluid/vof/volume_of_fluid_class.hpp>

#include <bit>
#include <limits>

namespace abrade {

/// Rows at an inflow count as active where water stands beyond.
template <int Dim>
void VolumeOfFluid<Dim>::include_inflows() {
    const int planes = layout_.planes(), rows = layout_.rows_per_plane(), n = layout_.row_length();
    for (int a = 0; a < Dim; ++a)
        for (const int end : {0, 1}) {
            if (boundaries_[a][index(end)] != Boundary::inflow) continue;
            for (int p = 0; p < planes; ++p)
                for (int r = 0; r < rows; ++r) {
                    if (a == Layout<Dim>::outer && p != (end == 0 ? 0 : planes - 1)) continue;
                    if (Dim == 3 && a == Dim - 1 && r != (end == 0 ? 0 : rows - 1)) continue;
                    const Real* own = fraction_.data() + layout_.row_start(p, r);
                    RowRange wet{};
                    if (a == inner) {
                        if (own[end == 0 ? -1 : n] > 0) wet = end == 0 ? RowRange{0, 2} : RowRange{n - 2, n};
                    } else {
                        const Real* given = own + (end == 0 ? -1 : 1) * layout_.stride[index(a)];
                        for (int i = 0; i < n; ++i)
                            if (given[i] > 0) wet = hull(wet, {i - 1, i + 2});
                    }
                    wet = {std::max(wet.begin, 0), std::min(wet.end, n)};
                    active_.row(p, r) = hull(active_.row(p, r), wet);
                }
        }
}

/// Planes of all cells of the band that are neither full nor dry. Within a step they keep the normals that
/// they had at its beginning.
template <int Dim>
void VolumeOfFluid<Dim>::reconstruct(bool within_step) {
    const bool keep = within_step && !params_.fit_every_sweep;
    const bool walls = open_fractions_ && !keep;
    // Lanes of a pack that get a plane, and those of them that hold liquid and air.
    const auto cut = [&](Offset c, const PackMask& band) {
        const Pack f = Pack::load(fraction_.data() + c);
        const unsigned partly = lanes_of(band & (f > Pack(wisp)) & (f < Pack(1 - wisp)));
        unsigned all = partly;
        if (walls)
            for (unsigned dry = lanes_of(band & !(f > Pack(0))); dry != 0; dry &= dry - 1) {
                const int lane = std::countr_zero(dry);
                const auto cell = static_cast<Index>(c + lane);
                if (at_walls_.is_dry_beside_water(cell, fraction_.data(), marks_.data())) all |= 1u << lane;
            }
        return std::pair(all, partly);
    };
    std::vector<Index> first(static_cast<std::size_t>(layout_.planes()) + 1, 0);
    for_band_packs([&](int plane, Offset c, Index, const PackMask& band) {
        first[index(plane) + 1] += std::popcount(cut(c, band).first);
    });
    for (std::size_t p = 1; p < first.size(); ++p) first[p] += first[p - 1];
    std::swap(planes_, planes_before_);
    planes_.resize(static_cast<std::size_t>(first.back()));
    for_band_packs([&](int plane, Offset c, Index level, const PackMask& band) {
        const auto [all, partly] = cut(c, band);
        for (unsigned left = all; left != 0; left &= left - 1) {
            const int lane = std::countr_zero(left);
            const auto next = static_cast<std::size_t>(first[index(plane)]++);
            const bool holds = (partly >> lane & 1) != 0;
            const Index before = keep ? plane_of_[c + lane] : -1;
            planes_.cell[next] = static_cast<Index>(c + lane);
            planes_.level[next] = Dim == 3 ? level : level + lane;
            planes_.has_normal[next] = before >= 0 || !holds;
            planes_.reconstructed[next] =
                before >= 0 ? planes_before_.reconstructed[static_cast<std::size_t>(before)] : 0;
            if (planes_.has_normal[next])
                for (std::size_t a = 0; a < Dim; ++a)
                    planes_.normal[a][next] =
                        before >= 0 ? planes_before_.normal[a][static_cast<std::size_t>(before)] : 0;
        }
    });
    for (const Index c : planes_before_.cell) plane_of_[c] = -1;
    for (Index i = 0; i < planes_.count(); ++i) plane_of_[planes_.cell[static_cast<std::size_t>(i)]] = i;
    fill_periodic(plane_of_, layout_, boundaries_);
    normals_.find(planes_, fraction_.data(), marks_.data(), !keep);
    if (open_fractions_ && !keep) at_walls_.find(planes_, fraction_.data(), marks_.data(), plane_of_.data());
}

template <int Dim>
Real VolumeOfFluid<Dim>::outflow_rate(const FaceField<Dim>& velocity) const {
    std::vector<Pack> most(static_cast<std::size_t>(layout_.planes()), Pack(0));
    for_band_packs([&](int plane, Offset c, Index level, const PackMask& band) {
        const PackMask holds = band & !(Pack::load(fraction_.data() + c) == Pack(0));
        if (!any(holds)) return;
        Pack rate = Pack(0);
        for (int a = 0; a < Dim; ++a) {
            const Offset up = c + layout_.stride[index(a)];
            const Real* const u = velocity[index(a)].data();
            Pack low = max(-Pack::load(u + c), Pack(0)),
                 high = max(Pack::load_from_anywhere(u + up), Pack(0));
            if (apertures_) {
                const Real* const open = (*apertures_)[index(a)].data();
                low *= Pack::load(open + c), high *= Pack::load_from_anywhere(open + up);
            }
            rate += (low + high) * at_level(areas_[index(a)], level);
        }
        rate *= at_level(per_volume_, level);
        // Cells that are mostly wall do not rule the step: what is too much for them is moved aside.
        if (room()) rate /= max(Pack::load(room()->data() + c), Pack(0.5));
        Pack& largest = most[index(plane)];
        largest = select(holds & !(rate <= largest), rate, largest);  // keeps what is not a number
    });
    Real largest = 0;
    for (const Pack& rates : most)
        for (int lane = 0; lane < pack_lanes; ++lane)
            if (!(rates[lane] <= largest)) largest = rates[lane];
    return largest;
}

template <int Dim>
Real VolumeOfFluid<Dim>::rate_of(const FaceField<Dim>& velocity, Index i) const noexcept {
    const auto k = static_cast<std::size_t>(i);
    const Offset c = band_.cells()[k];
    if (fraction_[c] == 0) return 0;
    const Index level = band_.levels()[k];
    Real rate = 0;
    for (int a = 0; a < Dim; ++a) {
        const auto& u = velocity[index(a)];
        const Offset up = c + layout_.stride[index(a)];
        const Real low = apertures_ ? (*apertures_)[index(a)][c] : 1;
        const Real high = apertures_ ? (*apertures_)[index(a)][up] : 1;
        rate += (high * std::max(u[up], Real(0)) + low * std::max(-u[c], Real(0))) / sizes_.edge(a, level);
    }
    return rate / (room() ? std::max((*room())[c], Real(0.5)) : 1);
}

/// One pass over all rows: liquid through faces between cells that are full or dry, for good outside of the
/// band; and what divergence leaves in the bulk.
template <int Dim>
void VolumeOfFluid<Dim>::carry_bulk() {
    const int rows = layout_.rows_per_plane(), planes = layout_.planes(), n = layout_.row_length();
    for (auto& overfull : overfull_) overfull.clear();
    touched_.for_each_row([&](int p, int r, const RowRange& range) {
        const Offset start = layout_.row_start(p, r);
        std::vector<CellAt>& overfull = overfull_[index(p)];
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
void VolumeOfFluid<Dim>::carry_row(Offset start, Index level, const RowRange& range, bool cells,
                                   std::vector<CellAt>& overfull) {
    const Real* f = fraction_.data() + start;
    Real* volume_defect = volume_defect_.data() + start;
    const std::uint8_t* band = band_.data() + start;
    std::array<const Real*, Dim> u, open{};
    std::array<Real*, Dim> out;
    for (std::size_t a = 0; a < Dim; ++a) {
        u[a] = (*velocity_)[a].data() + start;
        out[a] = volume_flux_[a].data() + start;
        if (apertures_) open[a] = (*apertures_)[a].data() + start;
    }
    const auto level_of = [&](int i) { return Dim == 3 ? level : Index{i}; };
    const PerAxis<Offset, Dim> step = layout_.stride;
    for (int i = range.begin; i < range.end; i += pack_lanes) {
        const Pack own = Pack::load(f + i);
        Pack gone = Pack(0);
        for (std::size_t a = 0; a < Dim; ++a) {
            const Pack speed = Pack::load(u[a] + i), area = at_level(swept_per_speed_[a], level_of(i));
            Pack low = speed * area, high = Pack::load_from_anywhere(u[a] + i + step[a]) * area;
            if (apertures_) {
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
        Pack lost = gone * at_level(per_volume_, level_of(i));
        if (room()) lost /= Pack::load(room()->data() + start + i);
        if (deep && full == (1u << pack_lanes) - 1) {
            const Pack left = Pack::load(volume_defect + i) - lost;
            left.store(volume_defect + i);
            if (!any((left > Pack(params_.largest_volume_defect)) |
                     (left < Pack(-params_.largest_volume_defect))))
                continue;
        } else {
            for (int lane = 0; lane < pack_lanes; ++lane)
                if (in_band[index(lane)] == 0 && (full >> lane & 1) != 0)
                    volume_defect[i + lane] -= lost[lane];
        }
        for (int lane = 0; lane < pack_lanes; ++lane)
            if (in_band[index(lane)] == 0 && (full >> lane & 1) != 0 &&
                std::abs(volume_defect[i + lane]) > params_.largest_volume_defect &&
                (marks_[start + i + lane] & cell_mark::inside) != 0 && !solids_.has(start + i + lane))
                overfull.push_back({start + i + lane, Dim == 3 ? level : Index{i + lane}});
    }
}

template <int Dim>
void VolumeOfFluid<Dim>::for_band_packs(auto&& body) const {
    Pack lane;
    for (int l = 0; l < pack_lanes; ++l) lane.set(l, l);
    active_.for_each_row([&](int p, int r, const RowRange& range) {
        const Offset start = layout_.row_start(p, r);
        for (int i = range.begin / pack_lanes * pack_lanes; i < range.end; i += pack_lanes) {
            PackMask band = detail::flags_at(band_.data() + start + i);
            if (!any(band)) continue;
            if (i < range.begin || i + pack_lanes > range.end)
                band = band & (lane >= Pack(range.begin - i)) & (lane < Pack(range.end - i));
            body(p, start + i, Dim == 3 ? Index{r} : Index{i}, band);
        }
    });
}

template <int Dim>
void VolumeOfFluid<Dim>::sweep(int number) {
    // All orders in turn; in 2-D two, in 3-D six.
    const auto axis_of = [&](int n) {
        const int turn = static_cast<int>(steps_ % Dim), way = static_cast<int>(steps_ / Dim % 2);
        return (Dim == 3 && way == 1 ? 2 * Dim - n + turn : n + turn) % Dim;
    };
    const int axis = axis_of(number);
    if (number == 0) {
        for_band_packs([&](int, Offset c, Index, const PackMask&) {
            for (int lane = 0; lane < pack_lanes; ++lane) filled_[c + lane] = fraction_[c + lane] > 0.5;
        });
    } else {
        reconstruct(true);
        fluxes_of_band(axis);
    }
    fluxes_of_planes(axis);
    join_periodic(axis);
    even_out_rims(axis);

    const auto dilatation = [&](int a, Offset c, Index level) {
        return swept_of_pack(a, c + layout_.stride[index(a)], level) - swept_of_pack(a, c, level);
    };
    const Real* const moved = volume_flux_[index(axis)].data();
    const bool last = number == Dim - 1;
    for_band_packs([&](int, Offset c, Index level, const PackMask& band) {
        const PackMask filled = detail::flags_at(filled_.data() + c);
        Pack left = Pack::load_from_anywhere(moved + c + layout_.stride[index(axis)]) - Pack::load(moved + c);
        if (any(filled)) {
            Pack added = Pack(0);
            if (!last)
                added = dilatation(axis, c, level);
            else
                for (int n = 0; n < number; ++n) added -= dilatation(axis_of(n), c, level);
            left -= select(filled, added, Pack(0));
        }
        Pack change = left * at_level(per_volume_, level);
        if (room()) change /= Pack::load(room()->data() + c);
        const Pack f = Pack::load(fraction_.data() + c);
        select(band, f - change, f).store(fraction_.data() + c);
    });
    if (!last) fill_periodic(fraction_, layout_, boundaries_);
}

/// Faces of the band whose donor is full or dry, or a ghost: what is swept times its fraction. Whole packs:
/// of others those with a cut donor get theirs from `fluxes_of_planes`, the rest again what `carry_bulk`
/// gave.
template <int Dim>
void VolumeOfFluid<Dim>::fluxes_of_band(int axis) {
    const Offset step = layout_.stride[index(axis)];
    const bool is_outer = axis == Layout<Dim>::outer, is_inner = axis == inner;
    const int planes = layout_.planes(), rows = layout_.rows_per_plane() + !(is_outer || is_inner);
    const auto fluxes_of_plane = [&](int p) {
        for (int r = 0; r < rows; ++r) {
            // Upper faces of cells as well as lower ones.
            RowRange range = active_.range(p, r);
            const int plane_below = p - is_outer, row_below = r - !(is_outer || is_inner);
            if (is_inner)
                range.end += !range.empty();
            else if (plane_below >= 0 && row_below >= 0)
                range = hull(range, active_.range(plane_below, row_below));
            const Offset start = layout_.row_start(p, r);
            for (int i = range.begin / pack_lanes * pack_lanes; i < range.end; i += pack_lanes) {
                const Offset c = start + i;
                const std::uint8_t* const band = band_.data() + c;
                if (!any(detail::flags_at(band) | detail::flags_at(band - step))) continue;
                const Pack speed = Pack::load((*velocity_)[index(axis)].data() + c);
                const Pack f = select(speed > Pack(0), Pack::load_from_anywhere(fraction_.data() + c - step),
                                      Pack::load(fraction_.data() + c));
                const Pack share = select(f > Pack(1 - wisp), Pack(1), f);
                const Pack flux = swept_of_pack(axis, c, Dim == 3 ? Index{r} : Index{i}) * share;
                select(f < Pack(wisp), Pack(0), flux).store(volume_flux_[index(axis)].data() + c);
            }
        }
    };
    active_.for_each_plane([&](int p) {
        fluxes_of_plane(p);
        if (is_outer && p + 1 == planes) fluxes_of_plane(planes);
    });
}

/// Faces through which cells that the surface cuts give liquid.
template <int Dim>
void VolumeOfFluid<Dim>::fluxes_of_planes(int axis) {
    constexpr Real next_to_nothing = 0.01;  // what round-off of a normal makes of nothing is far below it
    const Offset step = layout_.stride[index(axis)];
    const auto& u = (*velocity_)[index(axis)];
    auto& moved = volume_flux_[index(axis)];
    parallel_blocks(planes_.count(), [&](Index, Index first, Index last) {
        for (Index i = first; i < last; i += pack_lanes) {
            const int lanes = std::min<int>(pack_lanes, last - i);
            std::array<Index, pack_lanes> item;
            for (int l = 0; l < pack_lanes; ++l) item[index(l)] = i + std::min(l, lanes - 1);
            CellPlane<Dim, Pack> plane;
            for (std::size_t a = 0; a < Dim; ++a)
                plane.normal[a] = detail::values_at(planes_.normal[a].data(), item);
            plane.distance = detail::values_at(planes_.distance.data(), item);
            Pack up{}, down{}, room{};
            for (int l = 0; l < pack_lanes; ++l) {
                const auto k = static_cast<std::size_t>(item[index(l)]);
                const Offset c = planes_.cell[k];
                const Index level = planes_.level[k];
                up.set(l, u[c + step] > 0 ? swept(axis, c + step, level) : 0);
                down.set(l, u[c] < 0 ? -swept(axis, c, level) : 0);
                room.set(l, open_volume(c, level));
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
                const Offset c = planes_.cell[static_cast<std::size_t>(item[index(l)])];
                const auto or_stray = [&](Real from_slab, int way, Real volume) {
                    const Real even = fraction_[c] * std::min(volume, room[l]);
                    return from_slab < next_to_nothing * even && is_stray(axis, c, way) ? even : from_slab;
                };
                if (up[l] > 0) moved[c + step] = or_stray(once[l], 1, up[l]);
                if (u[c] < 0) moved[c] = -or_stray(up[l] > 0 ? again[l] : once[l], -1, down[l]);
            }
        }
    });
}

/// The first and the last face of a periodic axis are one: what its donor found holds for both.
template <int Dim>
void VolumeOfFluid<Dim>::join_periodic(int axis) {
    if (!boundaries_.periodic(axis)) return;
    const auto& u = (*velocity_)[index(axis)];
    auto& moved = volume_flux_[index(axis)];
    const Offset length = layout_.cells[index(axis)] * layout_.stride[index(axis)];
    const auto join = [&](Offset face) {
        (u[face] > 0 ? moved[face] : moved[face + length]) = moved[u[face] > 0 ? face + length : face];
    };
    active_.for_each_row([&](int p, int r, const RowRange& range) {
        const Offset start = layout_.row_start(p, r);
        if (axis == inner) {
            if (range.begin == 0) join(start);
        } else if (axis == Layout<Dim>::outer ? p == 0 : r == 0) {
            for (int i = range.begin; i < range.end; ++i) join(start + i);
        }
    });
}

/// A film or a drop whose plane lies at the end that it comes from: a slab of the
/// other end would find next to nothing, for ever, while its weight makes it faster. Unless the cell behind
/// is at least as full, a closed face that gravity does not pull it off holds it, or it is part of a surface
/// that its neighbours tell, it leaves as if it filled the cell evenly; where it fills half of it or more, if
/// it is alone: what belongs to a bore's roller stays with it. A wall that cuts the cell holds nothing back:
/// what moves there moves along it.
template <int Dim>
bool VolumeOfFluid<Dim>::is_stray(int axis, Offset c, int way) const noexcept {
    if (planes_.reconstructed[index(plane_of_[c])] != 0) return false;
    const bool whole = !room() || (*room())[c] == 1;
    const Offset behind = c - way * layout_.stride[index(axis)];
    const bool open_behind = (marks_[behind] & cell_mark::open) != 0 &&
                             ((marks_[behind] & cell_mark::inside) != 0 || boundaries_.periodic(axis));
    if (fraction_[c] >= 0.5)
        for (int a = 0; a < Dim; ++a)
            for (const Offset s : {-layout_.stride[index(a)], layout_.stride[index(a)]})
                if (fraction_[c + s] >= 0.5) return false;
    return open_behind ? fraction_[behind] < fraction_[c] : !whole || gravity_[axis] * way > 0;
}

}  // namespace abrade
