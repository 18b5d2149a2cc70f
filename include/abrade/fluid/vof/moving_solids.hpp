#pragma once
// Solids that move among the liquid of a VolumeOfFluid, within its step.

#include <abrade/fluid/vof/surface_reconstruction.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

namespace abrade::detail {

/// Liquid in the room that solids leave it now. Answers what of them went through faces below the surface
/// [m3]: it carries momentum, too, and is added to `flux`.
template <int Dim>
std::vector<SolidVolume> move_solids(LiquidCells<Dim>& liquid, std::span<const SolidFlux> fluxes, Real dt,
                                     Real full, FaceField<Dim>& flux) {
    std::vector<SolidVolume> moved;
    for (const SolidFlux& f : fluxes) {
        const Index level = liquid.layout.number(f.face)[Grid<Dim>::vertical];
        moved.push_back({f.face, f.axis,
                         f.speed * liquid.aperture(f.axis, f.face) * dt * liquid.sizes.face(f.axis, level)});
    }
    std::vector<Real> below;
    for (const SolidVolume& s : moved)
        below.push_back(
            std::clamp(liquid.fraction[s.volume > 0 ? s.face - liquid.layout.stride[s.axis] : s.face],
                       Real(0), Real(1)));
    // No faster than water falls through a cell, however short the step.
    constexpr Real most = 0.05;
    const Real gravity = liquid.gravity.norm();
    const Real falls = gravity > 0 ? dt * std::sqrt(gravity / liquid.grid.smallest()) : most;
    liquid.solids.move(liquid.grid, liquid.boundaries, liquid.fraction, liquid.volume_defect, moved,
                       std::min(falls, most), full);
    for (std::size_t n = 0; n < below.size(); ++n) {
        SolidVolume& s = moved[n];
        s.volume *= below[n], flux[s.axis][s.face] += s.volume;
    }
    return moved;
}

/// A plane that cuts a cell leaves the centre of one of the cells around it dry. A cell that is not full and
/// has no such neighbour holds a void that nothing can fill, for its pressure is that of water: it is full,
/// and lacks what the pressure is to draw in.
template <int Dim>
void close_voids(LiquidCells<Dim>& liquid, const SurfaceReconstruction<Dim>& surface) {
    constexpr Real wet = 0.5;
    Field<Real>& fraction = liquid.fraction;
    std::vector<Offset> around{0};
    for (const Offset stride : liquid.layout.stride)
        for (std::size_t n = around.size(); n-- > 0;)
            around.push_back(around[n] - stride), around.push_back(around[n] + stride);
    std::vector<std::vector<Offset>> voids(static_cast<std::size_t>(liquid.layout.planes()));
    surface.for_band_packs([&](const BandPack& pack) {
        const Pack f = Pack::load(fraction.data() + pack.first);
        for (unsigned lanes = lanes_of(pack.in_band & (f >= Pack(wet)) & (f < Pack(1))); lanes != 0;
             lanes &= lanes - 1) {
            const Offset cell = pack.first + std::countr_zero(lanes);
            if (std::ranges::all_of(
                    around, [&](Offset s) { return fraction[cell + s] >= wet || !liquid.is_open(cell + s); }))
                voids[static_cast<std::size_t>(pack.plane)].push_back(cell);
        }
    });
    for (const auto& plane : voids)
        for (const Offset c : plane)
            liquid.solids.lag_by(c, (fraction[c] - 1) * (*liquid.room())[c]), fraction[c] = 1;
    liquid.solids.keep_volume_defect(fraction, liquid.volume_defect);
}

}  // namespace abrade::detail
