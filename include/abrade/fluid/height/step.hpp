#pragma once
// How HeightOfFluid ends a step: slopes that may not grow, columns filled to their new volumes.

#include <abrade/fluid/height/height_of_fluid_class.hpp>

namespace abrade {

/// Where two columns differ by more than the steepest slope allows, after the step and by more than before
/// it, half of the growth flows back, in three dimensions a quarter: the surface steepens that much less. All
/// of it would make a dam's front on a thin film slower than it is.
template <int Dim>
void HeightOfFluid<Dim>::hold_slopes(Real dt) {
    const Real weight = -gravity_[vertical];
    if (!(weight > 0) || dt == 0) return;
    constexpr Real late = 0.1;  // about ten steps: a front that enters a box is steep for a few
    overturning_.share *= 1 - late;
    const Real plan = columns_.plan(), share = 0.5 / (Dim - 1);
    struct Held {
        Index from, to;
        int axis, plane, j;
        bool down;  // from the column to the one below it
        Real amount, rise;
        bool counts;
    };
    std::vector<Held> all;
    const auto height = [&](Index n) { return height_[at(n)] + (next_[at(n)] - volume_[at(n)]) / plan; };
    columns_.for_each([&](int plane, int j, Index n) {
        if (!is_wet(n)) return;
        for (int a = 0; a < Dim - 1; ++a) {
            if ((a == 0 ? plane : j) == 0) continue;  // a pair across a periodic end is left alone
            const Index below = n - columns_.step(a);
            if (!is_wet(below)) continue;
            const Real was = std::abs(height_[at(n)] - height_[at(below)]);
            const Real most = std::max(was, params_.steepest * grid_.size(a, 0));
            const Real rise = height(n) - height(below), beyond = std::abs(rise) - most;
            if (!(beyond > 0)) continue;
            const bool down = rise > 0;
            const Index from = down ? n : below;
            const Real amount =
                std::min(share * 0.5 * beyond * plan, 0.1 * std::max(next_[at(from)], Real(0)));
            all.push_back({from, down ? below : n, a, plane, j, down, amount, std::abs(rise),
                           !near_solid_[at(n)] && !near_solid_[at(below)]});
        }
    });
    if (all.empty()) return;
    std::vector<Index> held;  // the surface between two columns, by the upper one
    for (const Held& h : all) {
        next_[at(h.from)] -= h.amount, next_[at(h.to)] += h.amount;
        overturning_.lost += weight * h.amount * (h.rise - h.amount / plan);
        if (h.counts) held.push_back(h.down ? h.from : h.to);
    }
    for (const Held& h : all) {  // through the topmost face
        const int plane = h.down || h.axis != 0 ? h.plane : h.plane - 1;
        const int j = h.down || h.axis == 0 ? h.j : h.j - 1;
        const int level = surface_of(plane, j, next_[at(h.from)], top_[at(h.from)]).level;
        volume_flux_[h.axis][columns_.cell(h.plane, h.j, level)] += h.down ? -h.amount : h.amount;
    }
    if (held.empty()) return;
    held.erase(std::unique(held.begin(), held.end()), held.end());  // columns come one after the other
    Index wet = 0, open = 0;
    columns_.for_each([&](int, int, Index n) { wet += is_wet(n), open += !columns_.closed(n); });
    // A front that runs into a dry box is steep, and for a while most of what is wet.
    const Real area = std::max(static_cast<Real>(wet), 0.25 * static_cast<Real>(open));
    overturning_.share += late * static_cast<Real>(held.size()) / area;
    overturning_.most = std::max(overturning_.most, overturning_.share);
    if (overturning_.share > params_.most_overturning)
        fail({"HeightSurface: share of the wet area that wants to overturn",
              "at most most_overturning, " + short_text(params_.most_overturning), "",
              "take FreeSurface, which knows crests that break, or a finer grid"},
             short_text(overturning_.share));
}

template <int Dim>
void HeightOfFluid<Dim>::take_sources(std::span<CellSource> sources, Real dt) {
    for (CellSource& s : sources) {
        const CellNumber<Dim> cell = layout_.number(s.cell);
        const Index n = columns_.column(cell);
        const Real holds = fraction_[s.cell] * columns_.open(s.cell) * columns_.volume(cell[vertical]);
        s.volume = std::max(s.rate * dt * holds, -next_[at(n)]);
        next_[at(n)] += s.volume;
    }
}

template <int Dim>
void HeightOfFluid<Dim>::raise_by(std::span<const CellSource> sources) {
    for (const CellSource& s : sources) {
        if (s.volume == 0) continue;
        const CellNumber<Dim> cell = layout_.number(s.cell);
        const Offset up = layout_.stride[vertical];
        Offset face = s.cell;
        // As far as `renew` has counted: what it filled the column by above, it took for gone.
        const auto counted = [&](int k) {
            const RowRange r = touched_.row(cell[0], Dim == 3 ? k : 0);
            const int i = Dim == 3 ? cell[1] : k;
            return k <= top_[at(columns_.column(cell))] || (i >= r.begin && i < r.end);
        };
        for (int k = cell[vertical] + 1; k < columns_.levels() && counted(k); ++k)
            volume_flux_[vertical][face += up] += s.volume;
    }
}

template <int Dim>
void HeightOfFluid<Dim>::renew() {
    if (brim_) volume_defect_.fill(0);
    brim_ = false;
    std::vector<std::uint8_t> far(static_cast<std::size_t>(grid_.cells(0)), 0);
    touched_.for_each_plane([&](int plane) {
        for (int j = 0; j < columns_.across(); ++j) {
            const Index n = columns_.column(plane, j);
            rises_[at(n)] = 0;
            if (boundaries_[vertical][1] == Boundary::outflow) {  // over the top
                const Real beyond = std::max(next_[at(n)] + solid_in(n) - columns_.capacity(n), Real(0));
                volume_flux_[vertical][columns_.cell(plane, j, columns_.levels())] = beyond;
                next_[at(n)] -= beyond;
            }
            if (changes(n)) risen_[at(n)] = surface_of(plane, j, next_[at(n)], top_[at(n)]);
        }
    });
    touched_.for_each_plane([&](int plane) {
        renew_plane(plane);
        for (int j = 0; j < columns_.across(); ++j) {
            const Index n = columns_.column(plane, j);
            if (changes(n) && risen_[at(n)].level > top_[at(n)] + 1) far[at(plane)] = 1;
        }
    });
    columns_.parallel_for_each([&](int plane, int j, Index n) {
        if (changes(n)) put(plane, j, n, next_[at(n)], risen_[at(n)]);
    });
    rose_far_ = std::ranges::any_of(far, [](std::uint8_t f) { return f != 0; });
}

/// From the bed up: what comes in sideways and finds no room in a cell goes up.
template <int Dim>
void HeightOfFluid<Dim>::renew_plane(int plane) {
    const Offset across = layout_.stride[0];
    struct Change {
        typename detail::HeightColumns<Dim>::Surface surface;
        int low, high;
    };
    std::vector<Change> change(static_cast<std::size_t>(columns_.across()));
    int low = columns_.levels(), high = -1;
    for (int j = 0; j < columns_.across(); ++j) {
        const Index n = columns_.column(plane, j);
        Change& c = change[at(j)];
        c.surface = {top_[at(n)], 0, height_[at(n)]}, c.low = columns_.levels(), c.high = -1;
        if (!changes(n) || columns_.closed(n)) continue;
        c.surface = risen_[at(n)];
        c.low = std::min(c.surface.level, top_[at(n)]), c.high = std::max(c.surface.level, top_[at(n)]);
        low = std::min(low, c.low), high = std::max(high, c.high);
    }
    const auto fill = [&](int j, int k, Offset c) {
        const Change& of = change[at(j)];
        if (k < of.low || k > of.high) return Real(0);
        const Real now = k < of.surface.level ? 1 : k == of.surface.level ? of.surface.share : 0;
        return (now - std::exchange(fraction_[c], now)) * columns_.open(c) * columns_.volume(k);
    };
    if constexpr (Dim == 3) {
        Real* const __restrict rise = rises_.data() + columns_.column(plane, 0);
        for (int k = 0; k < columns_.levels(); ++k) {
            RowRange r = touched_.row(plane, k);
            if (k >= low && k <= high) r = {0, columns_.across()};
            if (r.empty()) continue;
            const Offset start = layout_.row_start(plane, k);
            const Real* const __restrict x = volume_flux_[0].data() + start;
            const Real* const __restrict x_above = x + across;
            const Real* const __restrict y = volume_flux_[1].data() + start;
            Real* const __restrict z = volume_flux_[2].data() + start;
            if (k >= low && k <= high) {
                for (int j = r.begin; j < r.end; ++j) {
                    z[j] = rise[j];
                    rise[j] += x[j] - x_above[j] + y[j] - y[j + 1] - fill(j, k, start + j);
                }
                continue;
            }
#pragma omp simd
            for (int j = r.begin; j < r.end; ++j) {
                z[j] = rise[j];
                rise[j] += x[j] - x_above[j] + y[j] - y[j + 1];
            }
        }
    } else {
        RowRange r = touched_.row(plane, 0);
        if (low <= high) r = hull(r, {low, high + 1});
        Real rise = 0;
        for (int k = r.begin; k < r.end; ++k) {
            const Offset c = layout_.row_start(plane, 0) + k;
            volume_flux_[vertical][c] = rise;
            rise += volume_flux_[0][c] - volume_flux_[0][c + across] - fill(0, k, c);
        }
    }
}

template <int Dim>
void HeightOfFluid<Dim>::begin(const auto& water) {
    columns_.for_each([&](int plane, int j, Index n) {
        int air = -1;
        for (int k = columns_.first(n); k < columns_.levels(); ++k) {
            const Real f = fraction_[columns_.cell(plane, j, k)];
            if (air >= 0 && f > fraction_[columns_.cell(plane, j, air)] + 0.5) fail_air(plane, j, k);
            if (air < 0 || f < fraction_[columns_.cell(plane, j, air)]) air = k;
        }
        const int whole = columns_.whole_from(n);
        if (!water || columns_.closed(n) || whole == columns_.first(n)) return;
        Point<Dim> x = grid_.centre(number(plane, j, 0));
        const auto depth = [&](Real z) { return x[vertical] = z, water(x); };
        // A tilted surface reaches down into a cut cell from the whole one above it.
        Real low = grid_.face(vertical, columns_.first(n));
        Real high = grid_.face(vertical, std::min(whole + 1, columns_.levels()));
        if (depth(high) > 0) return;
        if (!(depth(low) > 0)) {  // dry but for a corner
            Real corner = 0;
            for (int k = columns_.first(n); k < columns_.levels(); ++k) {
                const Offset c = columns_.cell(plane, j, k);
                corner += fraction_[c] * columns_.open(c) * columns_.volume(k);
            }
            if (corner < 0.5 * columns_.volume(0)) set_fractions(plane, j, n, 0);
            return;
        }
        for (int step = 0; step < 60; ++step) {
            const Real z = 0.5 * (low + high);
            (depth(z) > 0 ? low : high) = z;
        }
        set_fractions(plane, j, n, columns_.volume_below(plane, j, low));
    });
}

template <int Dim>
Real HeightOfFluid<Dim>::outflow_rate(const FaceField<Dim>& u) const {
    return columns_.parallel_max_of([&](int plane, int j, Index n) {
        if (!is_wet(n)) return Real(0);
        const Offset c = columns_.cell(plane, j, top_[at(n)]);
        Real rate = 0;
        for (int a = 0; a < Dim - 1; ++a) {
            const Offset s = layout_.stride[a];
            const Real low = apertures_ ? (*apertures_)[a][c] : 1;
            const Real high = apertures_ ? (*apertures_)[a][c + s] : 1;
            rate += (high * std::max(u[a][c + s], Real(0)) + low * std::max(-u[a][c], Real(0))) /
                    grid_.size(a, 0);
        }
        return rate / std::max(columns_.open(c), Real(0.5));
    });
}

template <int Dim>
void HeightOfFluid<Dim>::begin_columns() {
    const std::size_t count = columns_.count();
    volume_.assign(count, 0), next_.assign(count, 0), height_.assign(count, 0), top_.assign(count, 0);
    rises_.assign(count, 0), risen_.assign(count, {});
    near_solid_.assign(count, 0);
    // Solids that pierce the surface, closed sides of the box among them: within two cells of them it is
    // no error that water wants to overturn.
    const auto beside_side = [&](int axis, int i) {
        return (i < 2 && is_closed(boundaries_[axis][0])) ||
               (i >= grid_.cells(axis) - 2 && is_closed(boundaries_[axis][1]));
    };
    columns_.for_each([&](int plane, int j, Index n) {
        near_solid_[at(n)] = beside_side(0, plane) || (Dim == 3 && beside_side(1, j));
        for (int dp = -2; dp <= 2; ++dp)
            for (int dj = Dim == 3 ? -2 : 0; dj <= (Dim == 3 ? 2 : 0); ++dj) {
                const int p = plane + dp, q = j + dj;
                if (p < 0 || q < 0 || p >= grid_.cells(0) || q >= columns_.across()) continue;
                const Index other = columns_.column(p, q);
                if (columns_.closed(other) || columns_.whole_from(other) == columns_.levels())
                    near_solid_[at(columns_.column(plane, j))] = 1;
            }
    });
}

}  // namespace abrade
