#pragma once
// The liquid's volume in each cell of a staggered grid, and how it is carried along.

#include <abrade/fluid/vof/moving_solids.hpp>
#include <abrade/fluid/vof/redistribution.hpp>
#include <abrade/fluid/vof/surface_position.hpp>
#include <abrade/fluid/vof/sweeps.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// Volume of fluid: f = liquid volume / open volume of a cell, 0 <= f <= 1.
///
///   f <- f - sum over axes of [Phi_high - Phi_low] / (open V),   Phi [m3]: liquid through a face in the
///   step,
/// by one sweep along each axis, their order rotating. The surface is a plane in each cell (SurfaceNormals);
/// a sweep carries what stands in the slab that the face sweeps. Within a step sweep k also adds
///   c (swept_high - swept_low) / (open V),   c = 1 where f > 1/2 at the step's beginning, else 0,
/// the dilatation of one axis (Weymouth & Yue 2010, doi:10.1016/j.jcp.2009.12.018), so that f stays within
/// its bounds in between. The last sweep takes back what the others added: the volume is conserved to
/// round-off for any velocities, divergence or not.
///
/// What is then above 1 or below 0 is moved through faces to neighbours that have room. Where all neighbours
/// are full, in the bulk, f is 1 and the rest is the cell's `volume_defect` (in shares of its open volume, of
/// either sign):
///   liquid volume = sum of (f + volume_defect) open V.
/// In the bulk the volume defect changes by -dt div(u) in a step, so it is bounded by the sum of the
/// divergences left; a projection whose target divergence is volume_defect / dt keeps it at what one step
/// leaves. Beside the surface, and in dry cells, it stays below `volume_tolerance::round_off`, but where
/// `VolumeStep::not_redistributed` tells of a cell.
///
/// Cells outside of the surface's band cost one light pass. Ghosts of `fraction()` at inflows are the user's.
template <int Dim>
class VolumeOfFluid {
    using Position = detail::SurfacePosition<Dim>;

public:
    /// Beyond this a slab is wider than its cell: refused.
    static constexpr Real courant_end = 1;

    struct Params {
        /// Whether normals are found anew for every sweep, not once a step (docs/verification tells what
        /// for).
        bool fit_every_sweep = false;
        /// Largest share of a cell that may leave it in a step [-]; `stable_step` takes it. Bounds of f hold
        /// without redistribution up to 0.5 (Weymouth & Yue).
        Real courant = 0.5;
        /// Air of less than this share of a cell [-] is a defect of the velocity's divergence, not a surface:
        /// take what a projection leaves, where that is more. Amid other water ten times as much is none.
        Real smallest_void = 1e-6;
        /// What a full cell beside the surface may hold beyond its volume, in shares of that [-]: more goes
        /// along full cells to where there is room. Infinite: none does, wherever the velocity diverges.
        Real largest_volume_defect = std::numeric_limits<Real>::infinity();

        void validate() const {
            require(courant > 0 && courant <= courant_end,
                    {"VolumeOfFluid.courant", "in (0, 1]", "", "0.5 is usual"}, courant);
            require(smallest_void >= 0 && smallest_void <= 1e-3,
                    {"VolumeOfFluid.smallest_void", "from 0 to 1e-3", "", "1e-6 is usual"}, smallest_void);
        }
    };

    VolumeOfFluid(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries, const Params& params)
        : params_((params.validate(), params)), liquid_(grid, boundaries),
          surface_(liquid_, params_.smallest_void), sizes_(liquid_) {}
    VolumeOfFluid(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries)
        : VolumeOfFluid(grid, boundaries, Params{}) {}

    /// Shares of faces and cells that walls leave open [-]; none: all open. They must outlive this. Call
    /// `prepare` afterwards.
    void set_walls(const FaceField<Dim>* apertures, const Field<Real>* open_fractions) {
        liquid_.set_walls(apertures, open_fractions);
        surface_.set_walls(liquid_);
    }
    /// What films fall off sides by [m/s2]; none: they stay at any side they lie on.
    void set_gravity(const Point<Dim>& gravity) noexcept { liquid_.gravity = gravity; }

    /// To be set by the user, then `prepare`.
    Field<Real>& fraction() noexcept { return liquid_.fraction; }
    const Field<Real>& fraction() const noexcept { return liquid_.fraction; }
    /// Takes over fractions that were set from outside. Throws InputError where one is not from 0 to 1.
    void prepare() {
        liquid_.take_over();
        surface_.begin(liquid_);
    }

    /// One step. `velocity` [m/s]: component a of a cell on its lower face along a, also at the upper sides
    /// and, where cells at the surface have air beside them, on the faces of that air. `flux` [m3]: liquid,
    /// and solids below the surface, that went through each lower face; the same field in each step, 0 at
    /// first: faces that no water comes near are not written. `sources`: water that is put into cells that
    /// hold some, or taken out of them, at the end; told how much that was. Throws InputError beyond
    /// `courant_end`.
    VolumeStep advance(const FaceField<Dim>& velocity, Real dt, FaceField<Dim>& flux,
                       std::span<CellSource> sources = {}) {
        require_not_negative(dt, "VolumeOfFluid.advance: dt", "s");
        VolumeStep step{.courant = dt * outflow_rate(velocity)};
        if (!(step.courant <= courant_end)) fail_courant(velocity, dt);

        detail::Sweeps<Dim> sweeps(
            liquid_, surface_, sizes_,
            {velocity, dt, flux, params_.fit_every_sweep, params_.largest_volume_defect});
        sweeps.run(steps_++);
        const bool solids = liquid_.solids.any();
        if (solids)
            solid_moved_ = detail::move_solids(liquid_, std::exchange(solid_fluxes_, {}), dt,
                                               1 - surface_.void_inside_water(), flux);
        const auto done = redistribution(flux).run(sweeps.overfull());
        step.redistributed = done.redistributed, step.not_redistributed = done.not_redistributed;
        if (solids) detail::close_voids(liquid_, surface_);
        take_sources(sources, dt);
        surface_.follow(liquid_);
        return step;
    }
    /// Whether `advance` would take such a step.
    bool can_advance(const FaceField<Dim>& u, Real dt) const { return dt * outflow_rate(u) <= courant_end; }
    /// The largest step [s] at which no more than `Params::courant` of a cell at the surface leaves it;
    /// infinite where nothing moves there.
    Real stable_step(const FaceField<Dim>& velocity) const {
        const Real rate = outflow_rate(velocity);
        return rate > 0 ? params_.courant / rate : std::numeric_limits<Real>::infinity();
    }

    /// Brings what cells hold beyond their volume to where there is room, after walls have changed; what goes
    /// through faces for that adds to `flux`.
    void make_room(FaceField<Dim>& flux) {
        redistribution(flux).make_room();
        surface_.begin(liquid_);
    }

    /// Solids that are among the liquid from the next step on, and what of them goes through faces in it
    /// (SolidsInCells). Velocities are then those of the liquid times its share of a face, shares of volume
    /// those that solids leave, too.
    void set_solids(std::span<const SolidPart> parts, std::span<const SolidFlux> fluxes) {
        if (liquid_.solids.any() || !parts.empty()) liquid_.solids.set(liquid_.grid, parts);
        solid_fluxes_ = fluxes;
    }
    /// Solids that the liquid has been given around, up to its surface as it stands.
    void stand_solids(std::span<const SolidPart> parts) { liquid_.solids.stand(liquid_.grid, parts); }
    /// After a step that went wrong.
    void take_back_solids() { liquid_.solids.take_back(); }
    bool has_solid(Offset cell) const noexcept { return liquid_.solids.has(cell); }
    /// Of the last step's `flux`, what was solid.
    std::span<const SolidVolume> solid_moved() const noexcept { return solid_moved_; }
    /// Shares of cells that walls and solids leave to the liquid [-]; none: all.
    const Field<Real>* room() const noexcept { return liquid_.room(); }

    /// Steps taken: they say in which order the axes are swept. Set to go back.
    Index steps() const noexcept { return steps_; }
    void set_steps(Index steps) noexcept { steps_ = steps; }

    /// Liquid beyond `fraction()`, in shares of the open volume [-].
    const Field<Real>& volume_defect() const noexcept { return liquid_.volume_defect; }
    Field<Real>& volume_defect() noexcept { return liquid_.volume_defect; }
    /// Beside air there is a surface below this [-].
    Real full() const noexcept { return surface_.full(); }
    /// Amid other water a cell that lacks no more than this is full [-].
    Real void_inside_water() const noexcept { return surface_.void_inside_water(); }
    const WetRows<Dim>& wet() const noexcept { return surface_.wet(); }
    const SurfaceBand<Dim>& band() const noexcept { return surface_.band(); }
    const SurfacePlanes<Dim>& planes() const noexcept { return surface_.planes(); }
    /// Number of a cell's plane, or -1.
    Index plane_of(Offset cell) const noexcept { return surface_.plane_of(cell); }
    const Grid<Dim>& grid() const noexcept { return liquid_.grid; }
    const BoundaryConditions<Dim>& boundaries() const noexcept { return liquid_.boundaries; }
    const Field<std::uint8_t>& marks() const noexcept { return liquid_.marks; }
    Real volume() const { return liquid_.volume(); }  ///< of the liquid in the box [m3]

    /// Whether the centre of a cell lies below the surface: f >= 1/2, or, in a cell that a wall cuts, what
    /// the surface beside it tells. Pressure lives in these cells.
    bool is_liquid(Offset cell) const noexcept { return Position(liquid_, surface_).is_liquid(cell); }
    /// Whether a dry cell is that for its wall alone: its centre lies below the surface, all of its open part
    /// above. Nothing tells where on the way to it the pressure is 0.
    bool is_wall_dry(Offset dry) const noexcept { return Position(liquid_, surface_).is_wall_dry(dry); }
    /// Where the surface is between the centres of two neighbours, as a share of their distance from the
    /// liquid one, f >= 1/2, to the other one, at `side` (-1 or 1) of it along `axis`. Exact for planes,
    /// second order for curved surfaces. The liquid one's centre counts as `least` of a cell below the
    /// surface at least, so that shares along all axes tell the same pressure there.
    Real surface_share(Offset liquid, Index level, int axis, int side, Real least = 0) const noexcept {
        return Position(liquid_, surface_).share(liquid, level, axis, side, least);
    }

    static void fields(auto&& field) {
        field("liquid", &VolumeOfFluid::liquid_), field("surface", &VolumeOfFluid::surface_),
            field("steps", &VolumeOfFluid::steps_);
    }

private:
    using Sizes = detail::LevelSizes<Dim>;

    detail::Redistribution<Dim> redistribution(FaceField<Dim>& flux) {
        return {liquid_, surface_, params_.largest_volume_defect, flux};
    }
    void take_sources(std::span<CellSource> sources, Real dt);
    /// Share of its open volume that leaves a cell at the surface per second, at most [1/s].
    Real outflow_rate(const FaceField<Dim>& velocity) const;
    /// The same of one cell of the band.
    Real outflow_rate(const FaceField<Dim>& velocity, Offset c, Index level) const noexcept;
    [[noreturn]] void fail_courant(const FaceField<Dim>& velocity, Real dt) const;

    Params params_;
    detail::LiquidCells<Dim> liquid_;
    detail::SurfaceReconstruction<Dim> surface_;
    Sizes sizes_;
    std::span<const SolidFlux> solid_fluxes_;  ///< of the step to come
    std::vector<SolidVolume> solid_moved_;
    Index steps_ = 0;
};

template <int Dim>
void VolumeOfFluid<Dim>::take_sources(std::span<CellSource> sources, Real dt) {
    for (CellSource& s : sources) {
        if (!(liquid_.fraction[s.cell] > 0)) continue;
        const Real held = liquid_.held(s.cell), share = std::max(s.rate * dt, -held);
        s.volume = share * liquid_.open_volume(s.cell, liquid_.layout.number(s.cell)[Grid<Dim>::vertical]);
        if (liquid_.fraction[s.cell] == 1)
            liquid_.volume_defect[s.cell] += share;
        else
            liquid_.set(s.cell, held + share), surface_.look_again_at(s.cell);
    }
}

template <int Dim>
Real VolumeOfFluid<Dim>::outflow_rate(const FaceField<Dim>& velocity) const {
    std::vector<Pack> most(static_cast<std::size_t>(liquid_.layout.planes()), Pack(0));
    surface_.for_band_packs([&](const detail::BandPack& pack) {
        const Offset c = pack.first;
        const PackMask holds = pack.in_band & !(Pack::load(liquid_.fraction.data() + c) == Pack(0));
        if (!any(holds)) return;
        Pack rate = Pack(0);
        for (int a = 0; a < Dim; ++a) {
            const Offset up = c + liquid_.layout.stride[a];
            const Real* const u = velocity[a].data();
            Pack low = max(-Pack::load(u + c), Pack(0)),
                 high = max(Pack::load_from_anywhere(u + up), Pack(0));
            if (liquid_.apertures) {
                const Real* const open = (*liquid_.apertures)[a].data();
                low *= Pack::load(open + c), high *= Pack::load_from_anywhere(open + up);
            }
            rate += (low + high) * Sizes::of_pack(sizes_.area[a], pack.level);
        }
        rate *= Sizes::of_pack(sizes_.per_volume, pack.level);
        // Cells that are mostly wall do not rule the step: what is too much for them is redistributed.
        if (room()) rate /= max(Pack::load(room()->data() + c), Pack(0.5));
        Pack& largest = most[static_cast<std::size_t>(pack.plane)];
        largest = select(holds & !(rate <= largest), rate, largest);  // keeps what is not a number
    });
    Real largest = 0;
    for (const Pack& rates : most)
        for (int lane = 0; lane < pack_lanes; ++lane)
            if (!(rates[lane] <= largest)) largest = rates[lane];
    return largest;
}

template <int Dim>
Real VolumeOfFluid<Dim>::outflow_rate(const FaceField<Dim>& velocity, Offset c, Index level) const noexcept {
    if (liquid_.fraction[c] == 0) return 0;
    Real rate = 0;
    for (int a = 0; a < Dim; ++a) {
        const auto& u = velocity[a];
        const Offset up = c + liquid_.layout.stride[a];
        rate += (liquid_.aperture(a, up) * std::max(u[up], Real(0)) +
                 liquid_.aperture(a, c) * std::max(-u[c], Real(0))) /
                liquid_.sizes.edge(a, level);
    }
    return rate / (room() ? std::max((*room())[c], Real(0.5)) : 1);
}

template <int Dim>
void VolumeOfFluid<Dim>::fail_courant(const FaceField<Dim>& velocity, Real dt) const {
    std::size_t worst = 0;
    Real most = -1;  // or not a number, which counts as the most
    for (std::size_t i = 0; i < band().cells().size() && !std::isnan(most); ++i)
        if (const Real rate = outflow_rate(velocity, band().cells()[i], band().levels()[i]); !(rate <= most))
            worst = i, most = rate;
    fail({"VolumeOfFluid.advance: dt",
          "small enough that no more than all of a cell at the surface leaves it, " + short_text(dt * most) +
              " times cell " + liquid_.text(liquid_.layout.number(band().cells()[worst])) + " would",
          "s", "take at most stable_step()"},
         short_text(dt));
}

}  // namespace abrade
