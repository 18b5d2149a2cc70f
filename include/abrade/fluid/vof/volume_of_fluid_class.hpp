#pragma once
// The class VolumeOfFluid: what it holds and answers. What a step does stands in sweeps.hpp and
// redistribution.hpp; users include volume_of_fluid.hpp, which has all.

#include <abrade/fluid/mesh/water_cells.hpp>
#include <abrade/fluid/vof/band.hpp>
#include <abrade/fluid/vof/cell_marks.hpp>
#include <abrade/fluid/vof/normals.hpp>
#include <abrade/fluid/vof/normals_at_walls.hpp>
#include <abrade/fluid/vof/solids_in_cells.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace abrade {

/// What a step of VolumeOfFluid did.
struct VolumeStep {
    Real courant = 0;      ///< largest share of a cell at the surface that left it in the step [-]
    Real moved_aside = 0;  ///< volume that found no room where it flowed and was given to neighbours [m3]
    int left_over =
        0;  ///< cells of the band whose neighbours could not take it either: it is `volume_defect`
};

/// Volume of fluid: f = liquid volume / open volume of a cell, 0 <= f <= 1.
///
///   f <- f - sum over axes of [Phi_high - Phi_low] / (open V),   Phi [m3]: liquid through a face in the
///   step,
/// by one sweep along each axis, their order rotating. The surface is a plane in each cell (SurfaceNormals);
/// a sweep carries what stands in the slab that the face sweeps. Within a step sweep k also adds
///   c (swept_high - swept_low) / (open V),   c = 1 where f > 1/2 at the step's beginning, else 0,
/// the dilatation of one axis (Weymouth & Yue 2010, doi 10.1016/j.jcp.2009.12.018), so that f stays within
/// its bounds in between. The last sweep takes back what the others added: the volume is conserved to
/// round-off for any velocities, divergence or not.
///
/// What is then above 1 or below 0 is moved through faces to neighbours that have room. Where all neighbours
/// are full, in the bulk, f is 1 and the rest is the cell's `volume_defect` (in shares of its open volume, of
/// either sign):
///   liquid volume = sum of (f + volume_defect) open V.
/// In the bulk the volume defect changes by -dt div(u) in a step, so it is bounded by the sum of the
/// divergences left; a projection whose target divergence is volume_defect / dt keeps it at what one step
/// leaves. Beside the surface, and in dry cells, it stays below `wisp`, but where `left_over` tells of a
/// cell.
///
/// Cells outside of the surface's band cost one light pass. Ghosts of `fraction()` at inflows are the user's.
template <int Dim>
class VolumeOfFluid {
public:
    static constexpr Real wisp = 1e-12;  ///< less than this is no fraction but volume defect [-]
    /// Beyond this a slab is wider than its cell: refused.
    static constexpr Real courant_end = 1;

    struct Params {
        /// Whether normals are found anew for every sweep, not once a step (docs/verification tells what
        /// for).
        bool fit_every_sweep = false;
        /// Largest share of a cell that may leave it in a step [-]; `stable_step` takes it. Bounds of f hold
        /// without anything moved aside up to 0.5 (Weymouth & Yue).
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
        : params_((params.validate(), params)), grid_(grid), boundaries_((boundaries.validate(), boundaries)),
          layout_(grid.layout()), sizes_(grid), normals_(layout_, sizes_),
          at_walls_(layout_, sizes_, params_.smallest_void), fraction_(layout_.total, 0),
          volume_defect_(layout_.total, 0), volume_flux_(face_field<Dim>(layout_)),
          plane_of_(layout_.total, -1), band_(layout_, void_inside_water()), wet_(layout_), active_(layout_),
          touched_(layout_), filled_(layout_.total), solids_(layout_.total),
          overfull_(static_cast<std::size_t>(layout_.planes())) {
        for (int a = 0; a < Dim; ++a)
            for (int k = -Layout<Dim>::ghosts; k < grid.cells(vertical) + Layout<Dim>::ghosts; ++k)
                areas_[index(a)].push_back(sizes_.face(a, k));
        for (int k = -Layout<Dim>::ghosts; k < grid.cells(vertical) + Layout<Dim>::ghosts; ++k)
            per_volume_.push_back(1 / sizes_.volume(k));
        // Packs look beyond the end of a row.
        for (auto& areas : areas_) areas.resize(areas.size() + pack_lanes, 0);
        per_volume_.resize(per_volume_.size() + pack_lanes, 0);
        swept_per_speed_ = areas_;
        set_walls(nullptr, nullptr);
    }

    VolumeOfFluid(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries)
        : VolumeOfFluid(grid, boundaries, Params{}) {}

    /// Shares of faces and cells that walls leave open [-]; none: all open. They must outlive this. Call
    /// `prepare` afterwards.
    void set_walls(const FaceField<Dim>* apertures, const Field<Real>* open_fractions) {
        if ((apertures == nullptr) != (open_fractions == nullptr))
            fail({"VolumeOfFluid.set_walls", "both open faces and open volumes, or neither", "",
                  "walls close faces and take volume"},
                 "one of them");
        apertures_ = apertures;
        open_fractions_ = open_fractions;
        at_walls_.set_walls(apertures, open_fractions);
        solids_.set_walls(open_fractions);
        marks_ = surface_marks(grid_, boundaries_, open_fractions_);
    }

    /// What films fall off sides by [m/s2]; none: they stay at any side they lie on.
    void set_gravity(const Point<Dim>& gravity) noexcept { gravity_ = gravity; }

    /// To be set by the user, then `prepare`.
    Field<Real>& fraction() noexcept { return fraction_; }
    const Field<Real>& fraction() const noexcept { return fraction_; }

    /// Takes over fractions that were set from outside. Throws InputError where one is not from 0 to 1.
    void prepare() {
        grid_.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            const Real f = fraction_[c];
            if (!(f >= 0 && f <= 1)) fail_fraction(cell, f);
            set_cell(c, marks_[c] & cell_mark::open ? f : 0);
            if (f >= 1 - void_inside_water() && f < 1) settled_.push_back(static_cast<Index>(c));
        });
        wet_.find(fraction_);
        locate();
    }

    /// Brings what cells hold beyond their volume to where there is room: after walls have changed.
    void make_room();

    /// One step. `velocity` [m/s]: component a of a cell on its lower face along a, also at the upper sides
    /// and, where cells at the surface have air beside them, on the faces of that air. Throws InputError
    /// beyond `courant_end`.
    VolumeStep advance(const FaceField<Dim>& velocity, Real dt) {
        require_not_negative(dt, "VolumeOfFluid.advance: dt", "s");
        VolumeStep step{.courant = dt * outflow_rate(velocity)};
        if (!(step.courant <= courant_end)) fail_courant(velocity, dt);
        velocity_ = &velocity;
        for (std::size_t a = 0; a < Dim; ++a)
            for (std::size_t k = 0; k < areas_[a].size(); ++k) swept_per_speed_[a][k] = dt * areas_[a][k];
        carry_bulk();
        for (int sweep = 0; sweep < Dim; ++sweep) this->sweep(sweep);
        if (solids_.any()) move_solids(dt);
        settle(step);
        if (solids_.any()) close_voids();
        take_sources(dt);
        ++steps_;
        wet_.find_within(active_, fraction_);
        locate();
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

    /// Solids that are among the liquid from the next step on, and what of them goes through faces in it
    /// (SolidsInCells). Velocities are then those of the liquid times its share of a face, shares of volume
    /// those that solids leave, too. `volume_flux()` holds both.
    void set_solids(std::span<const SolidPart> parts, std::span<const SolidFlux> fluxes) {
        if (solids_.any() || !parts.empty()) solids_.set(grid_, parts);
        solid_fluxes_ = fluxes;
    }
    /// Water that is put into cells that hold some, or taken out of them, at the end of the next step; told
    /// how much that was.
    void set_sources(std::span<CellSource> sources) noexcept { sources_ = sources; }
    /// Solids that the liquid has been given around, up to its surface as it stands.
    void stand_solids(std::span<const SolidPart> parts) { solids_.stand(grid_, parts); }
    /// After a step that went wrong.
    void take_back_solids() { solids_.take_back(); }
    bool has_solid(Offset cell) const noexcept { return solids_.has(cell); }
    std::span<const SolidVolume> solid_moved() const noexcept { return solid_moved_; }  ///< part of `moved`
    /// Shares of cells that walls and solids leave to the liquid [-]; none: all.
    const Field<Real>* room() const noexcept { return solids_.any() ? &solids_.room() : open_fractions_; }

    /// Steps taken: they say in which order the axes are swept. Set to go back.
    Index steps() const noexcept { return steps_; }
    void set_steps(Index steps) noexcept { steps_ = steps; }

    /// Volume of liquid that went through each lower face in the last step [m3].
    const FaceField<Dim>& volume_flux() const noexcept { return volume_flux_; }
    FaceField<Dim>& volume_flux() noexcept {
        return volume_flux_;
    }  ///< until the next step nobody asks for it here
    /// Liquid beyond `fraction()`, in shares of the open volume [-].
    const Field<Real>& volume_defect() const noexcept { return volume_defect_; }
    Field<Real>& volume_defect() noexcept { return volume_defect_; }
    /// Beside air there is a surface below this [-].
    Real full() const noexcept { return 1 - params_.smallest_void; }
    /// Amid other water a cell that lacks no more than this is full: residues of some steps come together.
    Real void_inside_water() const noexcept { return 10 * params_.smallest_void; }
    const WetRows<Dim>& wet() const noexcept { return wet_; }
    const SurfaceBand<Dim>& band() const noexcept { return band_; }
    const SurfacePlanes<Dim>& planes() const noexcept { return planes_; }
    const Grid<Dim>& grid() const noexcept { return grid_; }
    const BoundaryConditions<Dim>& boundaries() const noexcept { return boundaries_; }
    const Field<std::uint8_t>& marks() const noexcept { return marks_; }
    /// Number of a cell's plane, or -1.
    Index plane_of(Offset cell) const noexcept { return plane_of_[cell]; }

    /// Liquid in the box [m3].
    Real volume() const {
        std::vector<Real> plane(static_cast<std::size_t>(layout_.planes()), 0);
        parallel_tasks(layout_.planes(), [&](Index p) {
            Real sum = 0;
            for (int r = 0; r < layout_.rows_per_plane(); ++r) {
                const Offset start = layout_.row_start(p, r);
                for (int i = 0; i < layout_.row_length(); ++i) {
                    const Offset c = start + i;
                    if ((marks_[c] & cell_mark::open) != 0)
                        sum += (fraction_[c] + volume_defect_[c]) * open_volume(c, Dim == 3 ? r : i) +
                               (solids_.has(c) ? solids_.lag(c) * sizes_.volume(Dim == 3 ? r : i) : 0);
                }
            }
            plane[static_cast<std::size_t>(p)] = sum;
        });
        Real total = 0;
        for (const Real sum : plane) total += sum;
        return total;
    }

    /// Whether the centre of a cell lies below the surface: f >= 1/2, or, in a cell that a wall cuts, what
    /// the surface beside it tells. Pressure lives in these cells.
    bool is_liquid(Offset cell) const noexcept {
        const Index i = plane_of_[cell];
        const Real f = fraction_[cell];
        if (i < 0 || planes_.reconstructed[index(i)] == 0 || f < little || f > nearly_full) return f >= 0.5;
        return planes_.position[index(i)] >= 0;
    }

    /// Whether a dry cell is that for its wall alone: its centre lies below the surface, all of its open part
    /// above. Nothing tells where on the way to it the pressure is 0.
    bool is_ashore(Offset dry) const noexcept {
        const Index i = plane_of_[dry];
        return i >= 0 && planes_.reconstructed[index(i)] != 0 && fraction_[dry] < little &&
               planes_.position[index(i)] >= 0;
    }

    /// Where the surface is between the centres of two neighbours, as a share of their distance from the
    /// liquid one, f >= 1/2, to the other one, at `side` (-1 or 1) of it along `axis`. Exact for planes,
    /// second order for curved surfaces. The liquid one's centre counts as `least` of a cell below the
    /// surface at least, so that shares along all axes tell the same pressure there.
    Real surface_share(Offset liquid, Index level, int axis, int side, Real least = 0) const noexcept;

    static void fields(auto&& field) {
        field("fraction", &VolumeOfFluid::fraction_), field("volume_defect", &VolumeOfFluid::volume_defect_),
            field("moved", "m3", &VolumeOfFluid::volume_flux_), field("plane_of", &VolumeOfFluid::plane_of_),
            field("planes", &VolumeOfFluid::planes_), field("planes_before", &VolumeOfFluid::planes_before_),
            field("band", &VolumeOfFluid::band_), field("at_walls", &VolumeOfFluid::at_walls_),
            field("wet", &VolumeOfFluid::wet_), field("active", &VolumeOfFluid::active_),
            field("touched", &VolumeOfFluid::touched_), field("filled", &VolumeOfFluid::filled_),
            field("settled", &VolumeOfFluid::settled_), field("steps", &VolumeOfFluid::steps_),
            field("solids", &VolumeOfFluid::solids_);
    }

private:
    static constexpr Real little = 1e-5;  ///< less liquid of a cell than this has no momentum to speak of [-]
    /// Without a pressure of its own a cell that holds more than this takes in more than it has room for [-].
    static constexpr Real nearly_full = 0.9;
    /// A trace of air or of water tells nothing of where the surface is, but in a cell that a wall cuts.
    bool tells(Offset cell) const noexcept {
        const Index i = plane_of_[cell];
        return i >= 0 && (planes_.reconstructed[index(i)] != 0 ||
                          (fraction_[cell] > params_.smallest_void && fraction_[cell] < full()));
    }

    static constexpr int vertical = Grid<Dim>::vertical, inner = Layout<Dim>::inner;
    static std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }

    /// A cell's plane, seen along an axis; not known where there is none, or a trace of air or of water.
    struct Sight {
        bool known = false, nearly_level = false;  ///< level: along the axis
        Real depth = 0;                            ///< of the centre below the plane, along its normal [m]
        Real slope = 0;                            ///< component of the unit normal
    };
    Sight sight_of(Offset cell, Index level, int axis) const noexcept;

    Real open_volume(Offset c, Index level) const noexcept {
        return sizes_.volume(level) * (room() ? (*room())[c] : 1);
    }
    /// Volume that a lower face sweeps in a step, positive upwards [m3].
    Real swept(int axis, Offset c, Index level) const noexcept {
        const Real volume =
            (*velocity_)[index(axis)][c] * swept_per_speed_[index(axis)][index(level + Layout<Dim>::ghosts)];
        return apertures_ ? volume * (*apertures_)[index(axis)][c] : volume;
    }
    // The same of packs, from one cell on.
    static Pack at_level(const std::vector<Real>& by_level, Index level) noexcept {
        const Real* first = by_level.data() + level + Layout<Dim>::ghosts;
        return Dim == 3 ? Pack(*first) : Pack::load_from_anywhere(first);
    }
    Pack swept_of_pack(int axis, Offset c, Index level) const noexcept {
        const Pack volume = Pack::load_from_anywhere((*velocity_)[index(axis)].data() + c) *
                            at_level(swept_per_speed_[index(axis)], level);
        return apertures_ ? volume * Pack::load_from_anywhere((*apertures_)[index(axis)].data() + c) : volume;
    }
    /// Calls body(plane, first cell, its level, those in the band) for the band's packs; planes in parallel.
    void for_band_packs(auto&& body) const;
    void set_cell(Offset c, Real liquid) noexcept {
        fraction_[c] = liquid < wisp ? 0 : liquid > 1 - wisp ? 1 : liquid;
        volume_defect_[c] = liquid - fraction_[c];
        // Adding a wisp to 1 rounds it; what lies between is exact.
        if (fraction_[c] == liquid) volume_defect_[c] = 0;
    }

    /// Share of its open volume that leaves a cell at the surface per second, at most [1/s].
    Real outflow_rate(const FaceField<Dim>& velocity) const;
    /// The same of one cell of the band, for errors.
    Real rate_of(const FaceField<Dim>& velocity, Index i) const noexcept;

    // The surface moves in a step by less than a cell; wisps that are moved aside, by one more.
    void locate();
    void include_inflows();
    void reconstruct(bool within_step);
    void carry_bulk();
    struct CellAt {
        Offset cell;
        Index level;
    };
    void carry_row(Offset start, Index level, const RowRange& range, bool cells,
                   std::vector<CellAt>& overfull);
    void sweep(int number);
    void fluxes_of_band(int axis);
    void fluxes_of_planes(int axis);
    void join_periodic(int axis);
    bool is_stray(int axis, Offset c, int way) const noexcept;
    void even_out_rims(int axis);
    void move_solids(Real dt);
    void close_voids();
    void take_sources(Real dt);
    void settle(VolumeStep& step);
    Real share_out(Offset c, Index level, Real amount);
    void push_volume_defect(Offset c, Index level, std::size_t reach);

    [[noreturn]] void fail_fraction(const CellNumber<Dim>& cell, Real f) const {
        fail({std::string("VolumeOfFluid.fraction") + text(cell), "from 0 to 1", "",
              "give the share of the cell's open volume that is liquid"},
             to_text(f));
    }
    [[noreturn]] void fail_courant(const FaceField<Dim>& velocity, Real dt) const;
    static std::string text(const CellNumber<Dim>& cell) {
        std::string result = "[";
        for (std::size_t a = 0; a < Dim; ++a) result += (a ? ", " : "") + std::to_string(cell[a]);
        return result + "]";
    }

    Params params_;
    Grid<Dim> grid_;
    BoundaryConditions<Dim> boundaries_;
    Layout<Dim> layout_;
    CellSizes<Dim> sizes_;
    std::array<std::vector<Real>, Dim> areas_;  ///< of faces, by level from the first ghost [m2]
    std::vector<Real> per_volume_;              ///< likewise [1/m3]
    const FaceField<Dim>* apertures_ = nullptr;
    const Field<Real>* open_fractions_ = nullptr;
    SurfaceNormals<Dim> normals_;
    SurfaceAtWalls<Dim> at_walls_;

    Field<Real> fraction_, volume_defect_;
    FaceField<Dim> volume_flux_;
    Field<std::uint8_t> marks_;
    Field<Index> plane_of_;
    SurfacePlanes<Dim> planes_, planes_before_;
    SurfaceBand<Dim> band_;
    WetRows<Dim> wet_, active_, touched_;  ///< touched: active now or in the step before
    Field<std::uint8_t> filled_;           ///< 1: c of Weymouth and Yue; of cells of the band
    detail::SolidsInCells<Dim> solids_;
    std::vector<std::vector<CellAt>> overfull_;  ///< [plane] of the bulk, beyond `largest_volume_defect`
    std::vector<SolidVolume> solid_moved_;
    std::span<const SolidFlux> solid_fluxes_;  ///< of the step to come
    std::span<CellSource> sources_;            ///< likewise
    /// Cells outside of the last band that may have to be closed: set from outside, or given what was moved
    /// aside.
    std::vector<Index> settled_;
    Index steps_ = 0;
    Point<Dim> gravity_ = Point<Dim>::Zero();

    const FaceField<Dim>* velocity_ = nullptr;  ///< of the step at work
    std::array<std::vector<Real>, Dim>
        swept_per_speed_;  ///< dt times area, by level from the first ghost [m2 s]
};

}  // namespace abrade
