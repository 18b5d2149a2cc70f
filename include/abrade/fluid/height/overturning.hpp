#pragma once
// What a height cannot be: slopes that would grow beyond the steepest one are held back.

#include <abrade/fluid/height/water_columns.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace abrade {

/// What wanted to overturn.
struct Overturning {
    Real share = 0;  ///< of the wet area, mean of about the last ten steps [-]
    Real most = 0;   ///< largest of all steps [-]
    Real lost = 0;   ///< potential energy over density, summed over steps [m5/s2]; in two dimensions [m4/s2]
    static void fields(auto&& field) {
        field("share", &Overturning::share), field("most", &Overturning::most),
            field("lost", "m5/s2", &Overturning::lost);
    }
};

namespace detail {

/// Columns within two cells of solids that pierce the surface, closed sides of the box among them: there it
/// is no error that water wants to overturn.
template <int Dim>
std::vector<std::uint8_t> columns_near_solids(const WaterColumns<Dim>& water) {
    const HeightColumns<Dim>& shape = water.shape;
    std::vector<std::uint8_t> near(shape.count(), 0);
    const auto beside_side = [&](int axis, int i) {
        return (i < 2 && is_closed(water.boundaries[axis][0])) ||
               (i >= water.grid.cells(axis) - 2 && is_closed(water.boundaries[axis][1]));
    };
    shape.for_each([&](int plane, int j, Index n) {
        const auto own = static_cast<std::size_t>(n);
        near[own] = beside_side(0, plane) || (Dim == 3 && beside_side(1, j));
        for (int dp = -2; dp <= 2; ++dp)
            for (int dj = Dim == 3 ? -2 : 0; dj <= (Dim == 3 ? 2 : 0); ++dj) {
                const int p = plane + dp, q = j + dj;
                if (p < 0 || q < 0 || p >= water.grid.cells(0) || q >= shape.across()) continue;
                const Index other = shape.column(p, q);
                if (shape.closed(other) || shape.whole_from(other) == shape.levels()) near[own] = 1;
            }
    });
    return near;
}

/// What of the surface may be how steep.
struct SlopeLimits {
    Real steepest = 0, most_overturning = 0;     ///< see HeightOfFluid::Params
    Real weight = 0;                             ///< gravity, positive downwards [m/s2]
    std::span<const std::uint8_t> near_solid{};  ///< [column] where steeper ones are no error
};

/// Where two columns differ by more than the steepest slope allows, after the step and by more than before
/// it, half of the growth flows back, in three dimensions a quarter: the surface steepens that much less. All
/// of it would make a dam's front on a thin film slower than it is. `next` [m3]: volumes after the step;
/// `flux` [m3]: what goes through faces. Throws InputError where too much of the surface is held so.
template <int Dim>
void hold_slopes(const WaterColumns<Dim>& water, const SlopeLimits& limits, std::vector<Real>& next,
                 FaceField<Dim>& flux, Overturning& overturning) {
    if (!(limits.weight > 0)) return;
    const auto at = [](auto i) { return static_cast<std::size_t>(i); };
    const HeightColumns<Dim>& shape = water.shape;
    constexpr Real late = 0.1;  // about ten steps: a front that enters a box is steep for a few
    overturning.share *= 1 - late;
    const Real plan = shape.plan(), share = 0.5 / (Dim - 1);
    struct Held {
        Index from, to;
        int axis, plane, j;
        bool down;  // from the column to the one below it
        Real amount, rise;
        bool counts;
    };
    std::vector<Held> all;
    const auto height = [&](Index n) {
        return water.height[at(n)] + (next[at(n)] - water.volume[at(n)]) / plan;
    };
    shape.for_each([&](int plane, int j, Index n) {
        if (!water.is_wet(n)) return;
        for (int a = 0; a < Dim - 1; ++a) {
            if ((a == 0 ? plane : j) == 0) continue;  // a pair across a periodic end is left alone
            const Index below = n - shape.step(a);
            if (!water.is_wet(below)) continue;
            const Real was = std::abs(water.height[at(n)] - water.height[at(below)]);
            const Real most = std::max(was, limits.steepest * water.grid.size(a, 0));
            const Real rise = height(n) - height(below), beyond = std::abs(rise) - most;
            if (!(beyond > 0)) continue;
            const bool down = rise > 0;
            const Index from = down ? n : below;
            const Real amount =
                std::min(share * 0.5 * beyond * plan, 0.1 * std::max(next[at(from)], Real(0)));
            all.push_back({from, down ? below : n, a, plane, j, down, amount, std::abs(rise),
                           !limits.near_solid[at(n)] && !limits.near_solid[at(below)]});
        }
    });
    if (all.empty()) return;
    std::vector<Index> held;  // the surface between two columns, by the upper one
    for (const Held& h : all) {
        next[at(h.from)] -= h.amount, next[at(h.to)] += h.amount;
        overturning.lost += limits.weight * h.amount * (h.rise - h.amount / plan);
        if (h.counts) held.push_back(h.down ? h.from : h.to);
    }
    for (const Held& h : all) {  // through the topmost face
        const int plane = h.down || h.axis != 0 ? h.plane : h.plane - 1;
        const int j = h.down || h.axis == 0 ? h.j : h.j - 1;
        const int level = water.surface_of(plane, j, next[at(h.from)], water.top[at(h.from)]).level;
        flux[h.axis][shape.cell(h.plane, h.j, level)] += h.down ? -h.amount : h.amount;
    }
    if (held.empty()) return;
    held.erase(std::unique(held.begin(), held.end()), held.end());  // columns come one after the other
    Index wet = 0, open = 0;
    shape.for_each([&](int, int, Index n) { wet += water.is_wet(n), open += !shape.closed(n); });
    // A front that runs into a dry box is steep, and for a while most of what is wet.
    const Real area = std::max(static_cast<Real>(wet), 0.25 * static_cast<Real>(open));
    overturning.share += late * static_cast<Real>(held.size()) / area;
    overturning.most = std::max(overturning.most, overturning.share);
    if (overturning.share > limits.most_overturning)
        fail({"HeightSurface: share of the wet area that wants to overturn",
              "at most most_overturning, " + short_text(limits.most_overturning), "",
              "take FreeSurface, which knows crests that break, or a finer grid"},
             short_text(overturning.share));
}

}  // namespace detail
}  // namespace abrade
