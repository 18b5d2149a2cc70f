#pragma once
// How VolumeOfFluid carries liquid: the bulk and the sweeps of the band. What finds no room is settled by
// volume_settling.hpp.

#include <abrade/fluid/volume_of_fluid_class.hpp>

#include <limits>

namespace abrade {

/// Rows at an inflow count as active where water stands beyond.
template <int Dim>
void VolumeOfFluid<Dim>::include_inflows() {
    const int planes = layout_.planes(), rows = layout_.rows_per_plane(), n = layout_.row_length();
    for (int a = 0; a < Dim; ++a)
        for (const int end : {0, 1}) {
            if (sides_[a][index(end)] != Side::inflow) continue;
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
    const auto cells = band_.cells();
    const auto levels = band_.levels();
    const auto count = static_cast<Index>(cells.size());
    const bool keep = within_step && !params_.fit_every_sweep;
    const auto partly = [&](Index c) { return fraction_[c] > wisp && fraction_[c] < 1 - wisp; };
    const auto cut = [&](Index c) {
        return partly(c) ||
               (!keep && open_volumes_ && at_walls_.is_dry_beside_water(c, fraction_.data(), marks_.data()));
    };
    std::vector<Index> first(static_cast<std::size_t>(block_count(count)) + 1, 0);
    parallel_blocks(count, [&](Index block, Index begin, Index end) {
        Index number = 0;
        for (Index i = begin; i < end; ++i) number += cut(cells[static_cast<std::size_t>(i)]);
        first[static_cast<std::size_t>(block) + 1] = number;
    });
    for (std::size_t b = 1; b < first.size(); ++b) first[b] += first[b - 1];
    std::swap(planes_, planes_before_);
    planes_.resize(static_cast<std::size_t>(first.back()));
    parallel_blocks(count, [&](Index block, Index begin, Index end) {
        auto next = static_cast<std::size_t>(first[static_cast<std::size_t>(block)]);
        for (Index i = begin; i < end; ++i) {
            const auto k = static_cast<std::size_t>(i);
            if (!cut(cells[k])) continue;
            const Index before = keep ? plane_of_[cells[k]] : -1;
            planes_.cell[next] = cells[k];
            planes_.level[next] = levels[k];
            planes_.has_normal[next] = before >= 0 || !partly(cells[k]), planes_.told[next] = 0;
            if (planes_.has_normal[next])
                for (std::size_t a = 0; a < Dim; ++a)
                    planes_.normal[a][next] =
                        before >= 0 ? planes_before_.normal[a][static_cast<std::size_t>(before)] : 0;
            ++next;
        }
    });
    for (const Index c : planes_before_.cell) plane_of_[c] = -1;
    for (Index i = 0; i < planes_.count(); ++i) plane_of_[planes_.cell[static_cast<std::size_t>(i)]] = i;
    fill_periodic(plane_of_, layout_, sides_);
    normals_.find(planes_, fraction_.data(), marks_.data(), !keep);
    if (open_volumes_ && !keep) at_walls_.find(planes_, fraction_.data(), marks_.data(), plane_of_.data());
}

template <int Dim>
Real VolumeOfFluid<Dim>::outflow_rate(const FaceField<Dim>& velocity) const {
    const auto cells = band_.cells();
    const auto count = static_cast<Index>(cells.size());
    std::vector<Real> most(static_cast<std::size_t>(block_count(count)), 0);
    parallel_blocks(count, [&](Index block, Index first, Index last) {
        Real largest = 0;
        for (Index i = first; i < last; ++i) {
            const Real rate = rate_of(velocity, i);
            if (!(rate <= largest)) largest = rate;  // keeps what is not a number
        }
        most[static_cast<std::size_t>(block)] = largest;
    });
    Real largest = 0;
    for (const Real rate : most)
        if (!(rate <= largest)) largest = rate;
    return largest;
}

/// One pass over all rows: liquid through faces between cells that are full or dry, for good outside of the
/// band; and what divergence leaves in the bulk.
template <int Dim>
void VolumeOfFluid<Dim>::carry_bulk() {
    const int rows = layout_.rows_per_plane(), planes = layout_.planes(), n = layout_.row_length();
    touched_.for_each_row([&](int p, int r, const RowRange& range) {
        const Offset start = layout_.row_start(p, r);
        // Whole packs: what lies before and behind the range is dry, and faces of ghosts that follow are
        // those of the upper side.
        RowRange all{range.begin / pack_lanes * pack_lanes, range.end + (range.end == n)};
        all.end = (all.end + pack_lanes - 1) / pack_lanes * pack_lanes;
        carry_row(start, r, all, true);
        if (p == planes - 1) carry_row(start + layout_.stride[0], r, all, false);
        if (Dim == 3 && r == rows - 1) carry_row(start + layout_.stride[Dim - 1], r, all, false);
    });
}

/// One row of it. Rows of ghosts have faces (of the upper sides), but no cells.
template <int Dim>
void VolumeOfFluid<Dim>::carry_row(Offset start, Index level, const RowRange& range, bool cells) {
    const Real* f = fraction_.data() + start;
    Real* surplus = surplus_.data() + start;
    const std::uint8_t* band = band_.data() + start;
    std::array<const Real*, Dim> u, open{};
    std::array<Real*, Dim> out;
    for (std::size_t a = 0; a < Dim; ++a) {
        u[a] = (*velocity_)[a].data() + start;
        out[a] = moved_[a].data() + start;
        if (open_faces_) open[a] = (*open_faces_)[a].data() + start;
    }
    const auto at_level = [&](const std::vector<Real>& table, int i) {
        const Real* first = table.data() + Layout<Dim>::ghosts;
        return Dim == 3 ? Pack(first[level]) : Pack::load_from_anywhere(first + i);
    };
    const PerAxis<Offset, Dim> step = layout_.stride;
    for (int i = range.begin; i < range.end; i += pack_lanes) {
        const Pack own = Pack::load(f + i);
        Pack gone = Pack(0);
        for (std::size_t a = 0; a < Dim; ++a) {
            const Pack speed = Pack::load(u[a] + i), area = at_level(swept_per_speed_[a], i);
            Pack low = speed * area, high = Pack::load_from_anywhere(u[a] + i + step[a]) * area;
            if (open_faces_) {
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
        Pack lost = gone * at_level(per_volume_, i);
        if (open_volumes_) lost /= Pack::load(open_volumes_->data() + start + i);
        if (deep && full == (1u << pack_lanes) - 1)
            (Pack::load(surplus + i) - lost).store(surplus + i);
        else
            for (int lane = 0; lane < pack_lanes; ++lane)
                if (in_band[index(lane)] == 0 && (full >> lane & 1) != 0) surplus[i + lane] -= lost[lane];
    }
}

template <int Dim>
void VolumeOfFluid<Dim>::sweep(int number) {
    const auto cells = band_.cells();
    const auto levels = band_.levels();
    const auto count = static_cast<Index>(cells.size());
    // All orders in turn; in 2-D two, in 3-D six.
    const auto axis_of = [&](int n) {
        const int turn = static_cast<int>(steps_ % Dim), way = static_cast<int>(steps_ / Dim % 2);
        return (Dim == 3 && way == 1 ? 2 * Dim - n + turn : n + turn) % Dim;
    };
    const int axis = axis_of(number);
    if (number == 0) {
        filled_.resize(cells.size());
        parallel_for(count, [&](Index i) {
            const auto k = static_cast<std::size_t>(i);
            filled_[k] = fraction_[cells[k]] > 0.5;
        });
    } else {
        reconstruct(true);
        fluxes_of_band(axis);
    }
    fluxes_of_planes(axis);
    even_out_rims(axis);
    join_periodic(axis);

    const auto dilatation = [&](int a, Offset c, Index level) {
        return swept(a, c + layout_.stride[index(a)], level) - swept(a, c, level);
    };
    const auto& moved = moved_[index(axis)];
    const bool last = number == Dim - 1;
    parallel_for(count, [&](Index i) {
        const auto k = static_cast<std::size_t>(i);
        const Offset c = cells[k];
        const Index level = levels[k];
        Real added = 0;
        if (filled_[k]) {
            if (!last)
                added = dilatation(axis, c, level);
            else
                for (int n = 0; n < number; ++n) added -= dilatation(axis_of(n), c, level);
        }
        const Real left = (moved[c + layout_.stride[index(axis)]] - moved[c]) - added;
        fraction_[c] -= left * per_open_volume(c, level);
    });
    if (!last) fill_periodic(fraction_, layout_, sides_);
}

/// Faces whose donor is full or dry, or a ghost: what is swept times its fraction.
template <int Dim>
void VolumeOfFluid<Dim>::fluxes_of_band(int axis) {
    const auto cells = band_.cells();
    const auto levels = band_.levels();
    const Offset step = layout_.stride[index(axis)];
    auto& moved = moved_[index(axis)];
    const auto& u = (*velocity_)[index(axis)];
    const auto one = [&](Offset face, Index level) {
        const Real f = fraction_[u[face] > 0 ? face - step : face];
        moved[face] = f < wisp ? 0 : swept(axis, face, level) * (f > 1 - wisp ? 1 : f);
    };
    parallel_for(static_cast<Index>(cells.size()), [&](Index i) {
        const auto k = static_cast<std::size_t>(i);
        const Offset c = cells[k];
        one(c, levels[k]);
        if (!band_.holds(c + step)) one(c + step, levels[k]);
    });
}

/// Faces through which cells that the surface cuts give liquid.
template <int Dim>
void VolumeOfFluid<Dim>::fluxes_of_planes(int axis) {
    const Offset step = layout_.stride[index(axis)];
    const auto& u = (*velocity_)[index(axis)];
    auto& moved = moved_[index(axis)];
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
                    return from_slab == 0 && volume > 0 ? stray(axis, c, way, std::min(volume, room[l]))
                                                        : from_slab;
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
    if (!sides_.periodic(axis)) return;
    const auto& u = (*velocity_)[index(axis)];
    auto& moved = moved_[index(axis)];
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

/// A film thinner than its cell whose plane lies at the end that it comes from, with nothing there to hold
/// it: a slab of the other end would find nothing, for ever. It leaves as if it filled the cell evenly. At a
/// side it is held, but where gravity pulls it off.
template <int Dim>
Real VolumeOfFluid<Dim>::stray(int axis, Offset c, int way, Real volume) const noexcept {
    if (fraction_[c] >= 0.5 || open_volumes_) return 0;
    const Offset behind = c - way * layout_.stride[index(axis)];
    constexpr std::uint8_t room = cell_mark::inside | cell_mark::open;
    const bool held = (marks_[behind] & room) == room || sides_.periodic(axis) ? fraction_[behind] > wisp
                                                                               : !(gravity_[axis] * way > 0);
    return held ? 0 : fraction_[c] * volume;
}

}  // namespace abrade
