#pragma once
// Columns of HeightOfFluid that solids stand in: where their surface is, and what they hold too much.

#include <abrade/fluid/height/height_of_fluid_class.hpp>

#include <atomic>

namespace abrade {

template <int Dim>
void HeightOfFluid<Dim>::gather() {
    brim_ = false;
    columns_.for_each([&](int plane, int j, Index n) {
        Real sum = 0;
        for (int k = columns_.first(n); k < columns_.levels(); ++k) {
            const Offset c = columns_.cell(plane, j, k);
            const Real solid = solids_.empty() ? 0 : solids_.volume(n, k);
            sum += fraction_[c] * std::max(columns_.open(c) * columns_.volume(k) - solid, Real(0));
            sum += volume_defect_[c] * columns_.open(c) * columns_.volume(k);
        }
        for (int k = 0; k < columns_.levels(); ++k) fraction_[columns_.cell(plane, j, k)] = 0;
        for (int k = 0; k < columns_.levels(); ++k) volume_defect_[columns_.cell(plane, j, k)] = 0;
        set_fractions(plane, j, n, sum);
    });
    wet_.find(fraction_);
    locate();
}

template <int Dim>
void HeightOfFluid<Dim>::put(int plane, int j, Index n, Real liquid, const Surface& surface) {
    volume_[at(n)] = liquid, height_[at(n)] = surface.height, top_[at(n)] = surface.level;
    const Real beyond = liquid + solid_in(n) - columns_.capacity(n);
    if (beyond > 0 && !columns_.closed(n))  // a lid of the box
        owe(columns_.cell(plane, j, columns_.levels() - 1), columns_.levels() - 1, beyond);
    else if (surface.beyond != 0)
        owe_below(plane, j, surface);
}

template <int Dim>
void HeightOfFluid<Dim>::owe(Offset cell, int level, Real beyond) {
    std::atomic_ref(brim_).store(true, std::memory_order_relaxed);
    volume_defect_[cell] = beyond / (columns_.open(cell) * columns_.volume(level));
}

/// Below a surface within a solid, where there is most room; in one step no more than its faces let pass
/// without haste.
template <int Dim>
void HeightOfFluid<Dim>::owe_below(int plane, int j, const Surface& surface) {
    constexpr Real at_once = 0.05;
    const Index n = columns_.column(plane, j);
    int best = -1;
    Real most = 0;
    for (int k = columns_.first(n); k <= surface.level; ++k) {
        const Offset c = columns_.cell(plane, j, k);
        const Real room = columns_.open(c) - solids_.volume(n, k) / columns_.volume(k);
        if (fraction_[c] >= 0.5 && room > most) best = k, most = room;
    }
    if (best < 0) return;
    const Real bound = at_once * most * columns_.volume(best);
    owe(columns_.cell(plane, j, best), best, std::clamp(surface.beyond, -bound, bound));
}

template <int Dim>
typename HeightOfFluid<Dim>::Surface HeightOfFluid<Dim>::surface_of(int plane, int j, Real liquid,
                                                                    int near) const noexcept {
    const Index n = columns_.column(plane, j);
    return solids_.has(n) ? solids_.surface(columns_, plane, j, liquid, level_around(n))
                          : columns_.surface(plane, j, liquid, near);
}

/// Of the columns beside one, those without solids first [m].
template <int Dim>
Real HeightOfFluid<Dim>::level_around(Index n) const noexcept {
    constexpr Real with_solids = 0.01;
    Real sum = 0, weights = 0;
    for (int a = 0; a < Dim - 1; ++a)
        for (const Index other : {n - columns_.step(a), n + columns_.step(a)}) {
            if (columns_.closed(other)) continue;
            const Real weight = solids_.has(other) ? with_solids : 1;
            sum += weight * height_[at(other)], weights += weight;
        }
    return weights > 0 ? sum / weights : height_[at(n)];
}

/// Solid carries momentum's volumes with it, as far as it is below the surface.
template <int Dim>
void HeightOfFluid<Dim>::add_solid(std::span<const SolidFlux> fluxes, Real dt) {
    solid_moved_.resize(fluxes.size());
    const auto plane_of = [&](Index i) { return layout_.number(fluxes[at(i)].face)[Layout<Dim>::outer]; };
    const auto count = static_cast<Index>(fluxes.size());
    // Bodies may share a face: a block begins and ends with a plane.
    const auto whole = [&](Index i) {
        while (i > 0 && i < count && plane_of(i) == plane_of(i - 1)) ++i;
        return i;
    };
    parallel_blocks(count, [&](Index, Index first, Index last) {
        const Index end = whole(last);
        for (Index i = whole(first); i < end; ++i) {
            const SolidFlux& f = fluxes[at(i)];
            const Real volume = f.axis == vertical ? 0 : solid_below(f, dt);
            solid_moved_[at(i)] = {f.face, f.axis, volume};
            if (volume != 0) volume_flux_[f.axis][f.face] += volume;
        }
    });
}

/// Of what goes through a face in a step, what does so below the surface [m3].
template <int Dim>
Real HeightOfFluid<Dim>::solid_below(const SolidFlux& flux, Real dt) const noexcept {
    const CellNumber<Dim> number = layout_.number(flux.face);
    const Index n = columns_.column(number);
    const int k = number[vertical];
    const Real surface = 0.5 * (height_[at(n)] + height_[at(n - columns_.step(flux.axis))]);
    const Real size = grid_.size(vertical, k);
    const Real share = std::clamp((surface - grid_.face(vertical, k)) / size, Real(0), Real(1));
    const Real area = columns_.plan() / grid_.size(flux.axis, 0) * size;
    return share * flux.speed * area * dt * (apertures_ ? (*apertures_)[flux.axis][flux.face] : 1);
}

}  // namespace abrade
