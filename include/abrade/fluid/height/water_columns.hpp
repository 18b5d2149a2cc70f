#pragma once
// Water in columns, each filled up to its height: what HeightOfFluid carries along.

#include <abrade/fluid/height/columns.hpp>
#include <abrade/fluid/height/solids_in_columns.hpp>
#include <abrade/fluid/mesh/boundary_conditions.hpp>
#include <abrade/fluid/mesh/volume_tolerance.hpp>

#include <algorithm>
#include <atomic>
#include <span>
#include <vector>

namespace abrade::detail {

/// Volume [m3] and height [m] of each column, and what follows from them: fractions of cells, and what cells
/// hold beyond their room. Columns have numbers as HeightColumns gives them, those of ghosts included.
template <int Dim>
struct WaterColumns {
    static constexpr int vertical = Grid<Dim>::vertical;
    using Surface = typename HeightColumns<Dim>::Surface;

    WaterColumns(const Grid<Dim>& cells, const BoundaryConditions<Dim>& sides)
        : grid(cells), boundaries((sides.validate(), sides)), layout(cells.layout()), shape(cells),
          fraction(layout.total, 0), volume_defect(layout.total, 0) {
        empty();
    }
    /// Throws InputError where a wall hangs over water.
    void set_walls(const EmbeddedBoundary<Dim>& walls) {
        apertures = &walls.aperture(), open_fractions = &walls.open_fraction();
        shape.set_walls(apertures, open_fractions, walls.cut_cells());
        empty();
    }

    /// Lets the level of water decide what stands where walls cut the cell at its surface: `water` is above 0
    /// below it. Throws InputError where water stands over air.
    void begin(const auto& water);
    /// Fills columns with what their cells hold.
    void gather();
    /// Throws InputError where a fraction that was set from outside is not from 0 to 1.
    void check_fractions() const {
        grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            if (fraction[c] >= 0 && fraction[c] <= 1) return;
            fail({"HeightOfFluid.fraction at " + place_text<Dim>(grid.centre(cell)), "from 0 to 1", "",
                  "give the share of the cell's open volume that is liquid"},
                 to_text(fraction[c]));
        });
    }

    bool is_wet(Index n) const noexcept { return volume[at(n)] > film_volume(); }
    /// Less stays where it is, with no velocity or pressure of its own [m3].
    Real film_volume() const noexcept { return volume_tolerance::film * shape.volume(0); }
    Real solid_in(Index n) const noexcept { return solids.empty() ? 0 : solids.volume(n); }
    /// Whether a step that leads to `next` [m3] moves anything in it.
    bool changes(Index n, Real next) const noexcept {
        return next != volume[at(n)] || solids.has(n) || solids_before.has(n);
    }
    /// Where some water would stand; `near`: a level to look from.
    Surface surface_of(int plane, int j, Real water, int near) const noexcept {
        const Index n = shape.column(plane, j);
        return solids.has(n) ? solids.surface(shape, plane, j, water, level_around(n))
                             : shape.surface(plane, j, water, near);
    }
    /// The column's cells have the fractions of that surface.
    void put(int plane, int j, Index n, Real water, const Surface& surface) {
        volume[at(n)] = water, height[at(n)] = surface.height, top[at(n)] = surface.level;
        const Real beyond = water + solid_in(n) - shape.capacity(n);
        if (beyond > 0 && !shape.closed(n))  // a lid of the box
            owe(shape.cell(plane, j, shape.levels() - 1), shape.levels() - 1, beyond);
        else if (surface.beyond != 0)
            owe_below(plane, j, surface);
    }
    /// Before columns are put anew.
    void owe_nothing() {
        if (brim) volume_defect.fill(0);
        brim = false;
    }

    void fill_ghost_columns();

    CellNumber<Dim> number(int plane, int j, int level) const noexcept {
        CellNumber<Dim> cell{};
        cell[0] = plane;
        if constexpr (Dim == 3) cell[1] = j;
        cell[vertical] = level;
        return cell;
    }
    static std::size_t at(auto i) noexcept { return static_cast<std::size_t>(i); }

    Grid<Dim> grid;
    BoundaryConditions<Dim> boundaries;
    Layout<Dim> layout;
    HeightColumns<Dim> shape;
    const FaceField<Dim>* apertures = nullptr;
    const Field<Real>* open_fractions = nullptr;
    Field<Real> fraction, volume_defect;  ///< [-]
    std::vector<Real> volume, height;     ///< [column] of the water [m3]; of its surface [m]
    std::vector<int> top;                 ///< [column] level of the cell at the surface
    SolidsInColumns<Dim> solids, solids_before;
    /// Some column reaches the top of the box, or has its surface within a solid or under one.
    bool brim = false;

    static void fields(auto&& field) {
        field("fraction", &WaterColumns::fraction), field("volume_defect", &WaterColumns::volume_defect),
            field("volume", "m3", &WaterColumns::volume), field("height", "m", &WaterColumns::height),
            field("top", &WaterColumns::top), field("solids", &WaterColumns::solids),
            field("brim", &WaterColumns::brim);
    }

private:
    void empty() {
        volume.assign(shape.count(), 0), height.assign(shape.count(), 0), top.assign(shape.count(), 0);
    }
    Real level_around(Index n) const noexcept;
    void owe(Offset cell, int level, Real beyond) {
        std::atomic_ref(brim).store(true, std::memory_order_relaxed);
        volume_defect[cell] = beyond / (shape.open(cell) * shape.volume(level));
    }
    void owe_below(int plane, int j, const Surface& surface);
    /// Of a column from empty cells.
    void fill_column(int plane, int j, Index n, Real water) {
        const Surface surface = surface_of(plane, j, water, 0);
        for (int k = 0; k < shape.levels(); ++k)
            fraction[shape.cell(plane, j, k)] = k < shape.first(n)   ? 0
                                                : k < surface.level  ? 1
                                                : k == surface.level ? surface.share
                                                                     : 0;
        put(plane, j, n, water, surface);
    }
};

template <int Dim>
void WaterColumns<Dim>::gather() {
    brim = false;
    shape.for_each([&](int plane, int j, Index n) {
        Real sum = 0;
        for (int k = shape.first(n); k < shape.levels(); ++k) {
            const Offset c = shape.cell(plane, j, k);
            const Real solid = solids.empty() ? 0 : solids.volume(n, k);
            sum += fraction[c] * std::max(shape.open(c) * shape.volume(k) - solid, Real(0));
            sum += volume_defect[c] * shape.open(c) * shape.volume(k);
        }
        for (int k = 0; k < shape.levels(); ++k) fraction[shape.cell(plane, j, k)] = 0;
        for (int k = 0; k < shape.levels(); ++k) volume_defect[shape.cell(plane, j, k)] = 0;
        fill_column(plane, j, n, sum);
    });
}

template <int Dim>
void WaterColumns<Dim>::begin(const auto& water) {
    const auto fail_air = [&](int plane, int j, int level) {
        fail({"GridFluid.water at " + place_text<Dim>(grid.centre(number(plane, j, level))),
              "below one height where the surface is a HeightSurface", "",
              "take FreeSurface for drops, jets and voids"},
             "water above air");
    };
    shape.for_each([&](int plane, int j, Index n) {
        int air = -1;
        for (int k = shape.first(n); k < shape.levels(); ++k) {
            const Real f = fraction[shape.cell(plane, j, k)];
            if (air >= 0 && f > fraction[shape.cell(plane, j, air)] + 0.5) fail_air(plane, j, k);
            if (air < 0 || f < fraction[shape.cell(plane, j, air)]) air = k;
        }
        const int whole = shape.whole_from(n);
        if (!water || shape.closed(n) || whole == shape.first(n)) return;
        Point<Dim> x = grid.centre(number(plane, j, 0));
        const auto depth = [&](Real z) { return x[vertical] = z, water(x); };
        // A tilted surface reaches down into a cut cell from the whole one above it.
        Real low = grid.face(vertical, shape.first(n));
        Real high = grid.face(vertical, std::min(whole + 1, shape.levels()));
        if (depth(high) > 0) return;
        if (!(depth(low) > 0)) {  // dry but for a corner
            Real corner = 0;
            for (int k = shape.first(n); k < shape.levels(); ++k) {
                const Offset c = shape.cell(plane, j, k);
                corner += fraction[c] * shape.open(c) * shape.volume(k);
            }
            if (corner < 0.5 * shape.volume(0)) fill_column(plane, j, n, 0);
            return;
        }
        for (int step = 0; step < 60; ++step) {
            const Real z = 0.5 * (low + high);
            (depth(z) > 0 ? low : high) = z;
        }
        fill_column(plane, j, n, shape.volume_below(plane, j, low));
    });
}

/// Below a surface within a solid, where there is most room; in one step no more than its faces let pass
/// without haste.
template <int Dim>
void WaterColumns<Dim>::owe_below(int plane, int j, const Surface& surface) {
    constexpr Real at_once = 0.05;
    const Index n = shape.column(plane, j);
    int best = -1;
    Real most = 0;
    for (int k = shape.first(n); k <= surface.level; ++k) {
        const Offset c = shape.cell(plane, j, k);
        const Real room = shape.open(c) - solids.volume(n, k) / shape.volume(k);
        if (fraction[c] >= 0.5 && room > most) best = k, most = room;
    }
    if (best < 0) return;
    const Real bound = at_once * most * shape.volume(best);
    owe(shape.cell(plane, j, best), best, std::clamp(surface.beyond, -bound, bound));
}

/// Of the columns beside one, those without solids first [m].
template <int Dim>
Real WaterColumns<Dim>::level_around(Index n) const noexcept {
    constexpr Real with_solids = 0.01;
    Real sum = 0, weights = 0;
    for (int a = 0; a < Dim - 1; ++a)
        for (const Index other : {n - shape.step(a), n + shape.step(a)}) {
            if (shape.closed(other)) continue;
            const Real weight = solids.has(other) ? with_solids : 1;
            sum += weight * height[at(other)], weights += weight;
        }
    return weights > 0 ? sum / weights : height[at(n)];
}

/// Heights beyond sides: what comes in again, what is given, or as inside.
template <int Dim>
void WaterColumns<Dim>::fill_ghost_columns() {
    for (int a = 0; a < Dim - 1; ++a) {
        const int n = grid.cells(a);
        const Index along = shape.step(a);
        const int others = a == 0 ? shape.across() : grid.cells(0);
        for (int o = 0; o < others; ++o)
            for (const bool high : {false, true})
                for (int g = 0; g < Layout<Dim>::ghosts; ++g) {
                    const Index first = a == 0 ? shape.column(0, o) : shape.column(o, 0);
                    const Index to = first + (high ? n + g : -1 - g) * along;
                    const int inside = boundaries.periodic(a) ? copied_cell(n, high, g) : high ? n - 1 : 0;
                    const Index from = first + inside * along;
                    volume[at(to)] = volume[at(from)], height[at(to)] = height[at(from)];
                    top[at(to)] = top[at(from)];
                }
    }
}

/// Solid carries momentum's volumes with it, as far as it is below the surface: adds to `flux` [m3] what goes
/// through upright faces, and answers it.
template <int Dim>
std::vector<SolidVolume> carry_solids(const WaterColumns<Dim>& water, std::span<const SolidFlux> fluxes,
                                      Real dt, FaceField<Dim>& flux) {
    constexpr int vertical = Grid<Dim>::vertical;
    const auto at = [](auto i) { return static_cast<std::size_t>(i); };
    const auto below_surface = [&](const SolidFlux& f) {
        const CellNumber<Dim> number = water.layout.number(f.face);
        const Index n = water.shape.column(number);
        const int k = number[vertical];
        const Real surface = 0.5 * (water.height[at(n)] + water.height[at(n - water.shape.step(f.axis))]);
        const Real size = water.grid.size(vertical, k);
        const Real share = std::clamp((surface - water.grid.face(vertical, k)) / size, Real(0), Real(1));
        const Real area = water.shape.plan() / water.grid.size(f.axis, 0) * size;
        return share * f.speed * area * dt * (water.apertures ? (*water.apertures)[f.axis][f.face] : 1);
    };
    std::vector<SolidVolume> moved(fluxes.size());
    const auto plane_of = [&](Index i) {
        return water.layout.number(fluxes[at(i)].face)[Layout<Dim>::outer];
    };
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
            const Real volume = f.axis == vertical ? 0 : below_surface(f);
            moved[at(i)] = {f.face, f.axis, volume};
            if (volume != 0) flux[f.axis][f.face] += volume;
        }
    });
    return moved;
}

}  // namespace abrade::detail
