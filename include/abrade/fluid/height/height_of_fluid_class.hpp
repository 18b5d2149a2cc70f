#pragma once
// Liquid below a surface that is a height: z = h(x, y, t).

#include <abrade/fluid/height/columns.hpp>
#include <abrade/fluid/height/fluxes.hpp>
#include <abrade/fluid/height/solids_in_columns.hpp>
#include <abrade/fluid/mesh/ghost_cells.hpp>
#include <abrade/fluid/mesh/water_cells.hpp>
#include <abrade/fluid/vof/cell_marks.hpp>
#include <abrade/fluid/vof/volume_of_fluid_class.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace abrade {

/// Liquid in columns: below its height h a cell is full, above it dry.
///
///   V <- V - sum of [Q out - Q in],   Q [m3] = sum over levels of u dt A(h_face),
/// V [m3] liquid of a column, A [m2] the open part of a face that lies below the height of the column that
/// the level flows out of, led to the face by a limited slope (monotonized central, B. van Leer, doi
/// 10.1016/0021-9991(77)90095-X). What goes up through a cell's upper face follows from the volumes of the
/// cells below, so momentum goes with the fluxes that moved the liquid. No column gives more than it has:
/// volume is conserved to round-off for any velocities. The pressure is that of the whole flow, not
/// hydrostatic (V. Casulli, Int. J. Numer. Meth. Fluids 30 (1999) 425; G. Stelling & M. Zijlema, doi
/// 10.1002/fld.595).
///
/// It answers what VolumeOfFluid does, in the same units; it has no volume defect but where a column reaches
/// the top of the box, and below a surface that stands within a solid or under one. It knows no film between
/// dry cells that leaves its bed, no void, no spray. Where two columns differ by more than `Params::steepest`
/// times their distance and the difference would grow (the water wants to overturn), it grows by less; the
/// potential energy that this takes is booked (`overturning()`), and a run in which too much of the surface
/// is held so stops.
template <int Dim>
class HeightOfFluid {
    static constexpr int vertical = Grid<Dim>::vertical, inner = Layout<Dim>::inner,
                         outer = Layout<Dim>::outer;

public:
    static constexpr Real wisp = 1e-12;  ///< as VolumeOfFluid's
    /// Largest share of a column at its surface that leaves it sideways in a step [-].
    static constexpr Real courant_limit = 0.9;
    static constexpr Real courant_end = 1;
    /// See MomentumStage: what the surface cuts is bounded by its neighbours, whatever it holds.
    static constexpr Real bounded_below = 1;
    /// A film of less than this [cell] stays where it is, with no velocity or pressure of its own.
    static constexpr Real still_film = 1e-5;

    struct Params {
        Real smallest_void = 0;  ///< no part here: below the surface nothing lacks
        Real steepest = 2;       ///< slope of the surface beyond which it is held back from steepening [-]
        /// Share of the wet area that may be held back so, mean of about ten steps [-].
        Real most_overturning = 0.25;
    };

    /// What wanted to overturn.
    struct Overturning {
        Real share = 0;  ///< of the wet area, mean of about the last ten steps [-]
        Real most = 0;   ///< largest of all steps [-]
        Real lost =
            0;  ///< potential energy over density, summed over steps [m5/s2]; in two dimensions [m4/s2]
        static void fields(auto&& field) {
            field("share", &Overturning::share), field("most", &Overturning::most),
                field("lost", "m5/s2", &Overturning::lost);
        }
    };

    HeightOfFluid(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries, const Params& params)
        : params_(params), grid_(grid), boundaries_((boundaries.validate(), boundaries)),
          layout_(grid.layout()), columns_(grid), fluxes_(grid, boundaries), fraction_(layout_.total, 0),
          volume_defect_(layout_.total, 0), volume_flux_(face_field<Dim>(layout_)), wet_(layout_),
          active_(layout_), touched_(layout_) {
        const auto refuse = [&](const char* rule, const char* remedy, Boundary side) {
            fail({"GridFluid.boundaries.z", rule, "", remedy}, std::string(boundary_name(side)));
        };
        const auto [floor, top] = boundaries[vertical].values;
        if (floor == Boundary::outflow || floor == Boundary::inflow)
            refuse("a closed floor below a HeightSurface", "close it, or take FreeSurface", floor);
        if (top == Boundary::inflow)
            refuse("no inflow from above a HeightSurface", "close it, or take FreeSurface", top);
        marks_ = surface_marks(grid_, boundaries_, nullptr);
        begin_columns();
    }

    /// As VolumeOfFluid's, and the wall in each cell. Throws InputError where a wall hangs over water.
    void set_walls(const EmbeddedBoundary<Dim>& walls) {
        apertures_ = &walls.aperture(), open_fractions_ = &walls.open_fraction();
        columns_.set_walls(apertures_, open_fractions_, walls.cut_cells());
        marks_ = surface_marks(grid_, boundaries_, open_fractions_);
        cut_.cell.clear();
        grid_.for_each([&](const CellNumber<Dim>&, Offset c) {
            if ((*open_fractions_)[c] > 0 && (*open_fractions_)[c] < 1)
                cut_.cell.push_back(static_cast<Index>(c));
        });
        begin_columns();
    }
    /// What holds the water on its bed. Throws InputError where it points upwards.
    void set_gravity(const Point<Dim>& gravity) {
        if (gravity[vertical] > 0)
            fail({"GridFluid.gravity.z", "at most 0 where the surface is a HeightSurface", "m/s2",
                  "let it point down, or take FreeSurface"},
                 to_text(gravity[vertical]));
        gravity_ = gravity;
    }

    Field<Real>& fraction() noexcept { return fraction_; }
    const Field<Real>& fraction() const noexcept { return fraction_; }

    /// Lets the level of water decide what stands where walls cut the cell at its surface: `water` is above 0
    /// below it. Throws InputError where water stands over air.
    void begin(const auto& water);

    /// Takes over fractions that were set from outside: each column keeps its volume. Throws InputError where
    /// one is not from 0 to 1.
    void prepare() {
        grid_.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            if (fraction_[c] >= 0 && fraction_[c] <= 1) return;
            fail({"HeightOfFluid.fraction at " + place_text<Dim>(grid_.centre(cell)), "from 0 to 1", "",
                  "give the share of the cell's open volume that is liquid"},
                 to_text(fraction_[c]));
        });
        volume_defect_.fill(0);
        gather();
    }
    /// The same, and what `volume_defect()` says.
    void gather();

    /// One step. Throws InputError beyond `courant_end`, and where too much of the surface wants to overturn.
    VolumeStep advance(const FaceField<Dim>& velocity, Real dt) {
        require_not_negative(dt, "HeightOfFluid.advance: dt", "s");
        VolumeStep step{.courant = dt * outflow_rate(velocity)};
        if (!(step.courant <= courant_end))
            fail({"HeightOfFluid.advance: dt",
                  "small enough that no more than all of a cell at the surface leaves it", "s",
                  "take at most stable_step()"},
                 short_text(dt));
        const detail::HeightFlow<Dim> flow{columns_,     fraction_, volume_,      height_,
                                           top_,         touched_,  velocity,     apertures_,
                                           volume_flux_, dt,        film_volume()};
        fluxes_.find(flow);
        fluxes_.limit(flow);
        fluxes_.sum(flow, next_);
        add_solid(std::exchange(solid_fluxes_, {}), dt);
        const std::span<CellSource> sources = std::exchange(sources_, {});
        take_sources(sources, dt);
        hold_slopes(dt);
        renew();
        raise_by(sources);
        ++steps_;
        if (rose_far_)
            wet_.find(fraction_);
        else
            wet_.find_within(active_, fraction_);
        locate();
        return step;
    }

    /// Solids that are among the water from the next step on, and what of them goes through upright faces in
    /// it. Velocities are then those of the water times its share of a face. `volume_flux()` holds both, and
    /// fractions are those of both below the surface.
    void set_solids(std::span<const SolidPart> parts, std::span<const SolidFlux> fluxes) {
        std::swap(solids_, solids_before_);
        solids_.set(parts, grid_, columns_);
        solid_fluxes_ = fluxes;
    }
    /// As VolumeOfFluid's; within the next step, of the part of a cell that lies below the surface.
    void set_sources(std::span<CellSource> sources) noexcept { sources_ = sources; }
    /// Solids that the water has been given around, up to its surface as it stands.
    void stand_solids(std::span<const SolidPart> parts) {
        solids_.set(parts, grid_, columns_);
        gather();
    }
    /// After a step that went wrong.
    void take_back_solids() { solids_ = solids_before_; }

    /// Somewhere in the cell's column.
    bool has_solid(Offset cell) const noexcept { return solids_.has(columns_.column(layout_.number(cell))); }

    bool can_advance(const FaceField<Dim>& u, Real dt) const { return dt * outflow_rate(u) <= courant_end; }
    Real stable_step(const FaceField<Dim>& velocity) const {
        const Real rate = outflow_rate(velocity);
        return rate > 0 ? courant_limit / rate : std::numeric_limits<Real>::infinity();
    }

    Index steps() const noexcept { return steps_; }
    void set_steps(Index steps) noexcept { steps_ = steps; }
    const FaceField<Dim>& volume_flux() const noexcept { return volume_flux_; }
    FaceField<Dim>& volume_flux() noexcept { return volume_flux_; }
    std::span<const SolidVolume> solid_moved() const noexcept { return solid_moved_; }  ///< part of it
    const Field<Real>& volume_defect() const noexcept { return volume_defect_; }
    Field<Real>& volume_defect() noexcept { return volume_defect_; }
    /// Some column reaches the top of the box, or has its surface within a solid or under one.
    bool has_volume_defect() const noexcept { return brim_; }
    Real full() const noexcept { return 1 - wisp; }
    Real void_inside_water() const noexcept { return wisp; }
    const WetRows<Dim>& wet() const noexcept { return wet_; }
    const Grid<Dim>& grid() const noexcept { return grid_; }
    const BoundaryConditions<Dim>& boundaries() const noexcept { return boundaries_; }
    const Field<std::uint8_t>& marks() const noexcept { return marks_; }
    const Overturning& overturning() const noexcept { return overturning_; }

    /// Cells that walls cut: only for them `is_liquid` says more than their fraction.
    struct CutCells {
        std::vector<Index> cell;
        Index count() const noexcept { return static_cast<Index>(cell.size()); }
    };
    const CutCells& planes() const noexcept { return cut_; }

    /// Liquid in the box [m3].
    Real volume() const {
        Real sum = 0;
        for (int plane = 0; plane < grid_.cells(0); ++plane)
            for (int j = 0; j < columns_.across(); ++j) sum += volume_[at(columns_.column(plane, j))];
        return sum;
    }
    const detail::HeightColumns<Dim>& columns() const noexcept { return columns_; }
    Real height(Index column) const noexcept { return height_[at(column)]; }         ///< [m]
    Real column_volume(Index column) const noexcept { return volume_[at(column)]; }  ///< [m3]
    int top(Index column) const noexcept { return top_[at(column)]; }  ///< level of the cell at the surface
    bool is_wet(Index column) const noexcept { return volume_[at(column)] > film_volume(); }

    /// Whether the centre of a cell lies below the surface of its column.
    bool is_liquid(Offset cell) const noexcept {
        const CellNumber<Dim> number = layout_.number(cell);
        const Index n = columns_.column(number);
        return is_wet(n) && fraction_[cell] > 0 && height_[at(n)] >= grid_.centre(vertical, number[vertical]);
    }
    /// Whether a dry cell's centre lies below the bed of a dry column: nothing tells where on the way to it
    /// the pressure is 0.
    bool is_ashore(Offset dry) const noexcept {
        const CellNumber<Dim> number = layout_.number(dry);
        const Index n = columns_.column(number);
        return height_[at(n)] >= grid_.centre(vertical, number[vertical]);
    }
    /// Where the surface is between the centres of two neighbours, as VolumeOfFluid has it: by the depths of
    /// both centres below the heights of their columns.
    Real surface_share(Offset liquid, Index level, int axis, int side, Real least = 0) const noexcept {
        const CellNumber<Dim> number = layout_.number(liquid);
        const Index n = columns_.column(number);
        const int k = static_cast<int>(level);
        const Real shallow = least * grid_.size(vertical, k);
        const Real depth = std::max(height_[at(n)] - grid_.centre(vertical, k), shallow);
        if (axis == vertical)
            return std::clamp(depth / grid_.gap(vertical, side > 0 ? k + 1 : k), least, Real(1));
        const Index other = n + side * columns_.step(axis);
        const Real missing = std::max(grid_.centre(vertical, k) - height_[at(other)], Real(0));
        return std::clamp(depth / (depth + missing), least, Real(1));
    }

    /// Films on a bed do not fall: no pressure would stop them.
    void clamp_films(FaceField<Dim>& u) const noexcept {
        columns_.parallel_for_each([&](int plane, int j, Index n) {
            if (!(volume_[at(n)] > 0)) return;
            const Offset c = columns_.cell(plane, j, top_[at(n)]), s = layout_.stride[vertical];
            const bool bottom = top_[at(n)] == columns_.first(n);
            if (!bottom || is_liquid(c)) return;
            u[vertical][c] = 0;
            if (top_[at(n)] + 1 < columns_.levels()) u[vertical][c + s] = 0;
        });
    }

    static void fields(auto&& field) {
        field("fluxes", &HeightOfFluid::fluxes_), field("fraction", &HeightOfFluid::fraction_),
            field("volume_defect", &HeightOfFluid::volume_defect_),
            field("moved", "m3", &HeightOfFluid::volume_flux_), field("wet", &HeightOfFluid::wet_),
            field("active", &HeightOfFluid::active_), field("touched", &HeightOfFluid::touched_),
            field("volume", "m3", &HeightOfFluid::volume_), field("next", "m3", &HeightOfFluid::next_),
            field("height", "m", &HeightOfFluid::height_), field("top", &HeightOfFluid::top_),
            field("rises", "m3", &HeightOfFluid::rises_), field("solids", &HeightOfFluid::solids_),
            field("overturning", &HeightOfFluid::overturning_), field("steps", &HeightOfFluid::steps_),
            field("brim", &HeightOfFluid::brim_), field("rose_far", &HeightOfFluid::rose_far_);
    }

private:
    using Surface = typename detail::HeightColumns<Dim>::Surface;

    static std::size_t at(auto i) noexcept { return static_cast<std::size_t>(i); }
    Real film_volume() const noexcept { return still_film * columns_.volume(0); }
    CellNumber<Dim> number(int plane, int j, int level) const noexcept {
        CellNumber<Dim> cell{};
        cell[0] = plane;
        if constexpr (Dim == 3) cell[1] = j;
        cell[vertical] = level;
        return cell;
    }

    void begin_columns();
    Real solid_in(Index n) const noexcept { return solids_.empty() ? 0 : solids_.volume(n); }
    bool changes(Index n) const noexcept {
        return next_[at(n)] != volume_[at(n)] || solids_.has(n) || solids_before_.has(n);
    }
    Surface surface_of(int plane, int j, Real liquid, int near) const noexcept;
    Real level_around(Index n) const noexcept;
    void add_solid(std::span<const SolidFlux> fluxes, Real dt);
    Real solid_below(const SolidFlux& flux, Real dt) const noexcept;
    /// Of a column from empty cells.
    void set_fractions(int plane, int j, Index n, Real liquid) {
        const auto surface = surface_of(plane, j, liquid, 0);
        for (int k = 0; k < columns_.levels(); ++k) {
            const Offset c = columns_.cell(plane, j, k);
            fraction_[c] = k < columns_.first(n) ? 0
                           : k < surface.level   ? 1
                           : k == surface.level  ? surface.share
                                                 : 0;
        }
        put(plane, j, n, liquid, surface);
    }
    void put(int plane, int j, Index n, Real liquid, const Surface& surface);
    /// What the pressure is to drive out [m3].
    void owe(Offset cell, int level, Real beyond);
    void owe_below(int plane, int j, const Surface& surface);

    void take_sources(std::span<CellSource> sources, Real dt);
    /// What they are goes up through level faces to the surface, beside what `renew` finds there.
    void raise_by(std::span<const CellSource> sources);

    /// Holds slopes that are too steep back from growing.
    void hold_slopes(Real dt);
    /// Fills columns to their new volumes; what went through level faces.
    void renew();
    void renew_plane(int plane);

    void locate() {
        touched_ = active_;
        active_ = wet_.dilated(2, boundaries_.periodic_axes());
        include_inflows();
        touched_.include(active_);
        if (rose_far_) touched_ = WetRows<Dim>::whole(layout_);
        rose_far_ = false;
        fill_ghosts(fraction_, touched_, boundaries_);
        fill_ghost_columns();
    }
    /// Rows beside inflows with water beyond.
    void include_inflows() {
        for (int a = 0; a < Dim - 1; ++a)
            for (const bool high : {false, true}) {
                if (boundaries_[a][high] != Boundary::inflow) continue;
                grid_.for_each_beside(a, high, [&](const CellNumber<Dim>& cell, Offset c) {
                    const Offset s = layout_.stride[a];
                    if (!(fraction_[high ? c + s : c - s] > 0)) return;
                    const int i = cell[inner];
                    RowRange& row = active_.row(cell[outer], Dim == 3 ? cell[Dim - 1] : 0);
                    row = hull(row, {std::max(i - 1, 0), std::min(i + 2, layout_.row_length())});
                });
            }
    }
    /// Heights beyond sides: what comes in again, what is given, or as inside.
    void fill_ghost_columns() {
        for (int a = 0; a < Dim - 1; ++a) {
            const int n = grid_.cells(a);
            const Index along = columns_.step(a);
            const int others = a == 0 ? columns_.across() : grid_.cells(0);
            for (int o = 0; o < others; ++o)
                for (const bool high : {false, true})
                    for (int g = 0; g < Layout<Dim>::ghosts; ++g) {
                        const Index first = a == 0 ? columns_.column(0, o) : columns_.column(o, 0);
                        const Index to = first + (high ? n + g : -1 - g) * along;
                        const Index from = first + (boundaries_.periodic(a) ? copied_cell(n, high, g)
                                                    : high                  ? n - 1
                                                                            : 0) *
                                                       along;
                        volume_[at(to)] = volume_[at(from)], height_[at(to)] = height_[at(from)];
                        top_[at(to)] = top_[at(from)];
                    }
        }
    }

    /// Share of a cell at the surface that leaves it sideways per second, at most [1/s].
    Real outflow_rate(const FaceField<Dim>& u) const;

    [[noreturn]] void fail_air(int plane, int j, int level) const {
        fail({"GridFluid.water at " + place_text<Dim>(grid_.centre(number(plane, j, level))),
              "below one height where the surface is a HeightSurface", "",
              "take FreeSurface for drops, jets and voids"},
             "water above air");
    }

    Params params_;
    Grid<Dim> grid_;
    BoundaryConditions<Dim> boundaries_;
    Layout<Dim> layout_;
    detail::HeightColumns<Dim> columns_;
    detail::HeightFluxes<Dim> fluxes_;
    const FaceField<Dim>* apertures_ = nullptr;
    const Field<Real>* open_fractions_ = nullptr;
    Field<Real> fraction_, volume_defect_;
    FaceField<Dim> volume_flux_;
    Field<std::uint8_t> marks_;
    CutCells cut_;
    WetRows<Dim> wet_, active_, touched_;
    std::vector<Real> volume_, next_, height_;  ///< [column] now, after the step [m3]; [m]
    std::vector<int> top_;                      ///< [column]
    std::vector<Real> rises_;                   ///< [column] what goes up through the level at work [m3]
    std::vector<Surface> risen_;                ///< [column] where the step leads
    std::vector<std::uint8_t> near_solid_;      ///< [column]
    detail::SolidsInColumns<Dim> solids_, solids_before_;
    std::vector<SolidVolume> solid_moved_;
    std::span<const SolidFlux> solid_fluxes_;  ///< of the step to come
    std::span<CellSource> sources_;            ///< likewise
    Overturning overturning_;
    Point<Dim> gravity_ = Point<Dim>::Zero();
    Index steps_ = 0;
    bool brim_ = false, rose_far_ = false;
};

}  // namespace abrade
