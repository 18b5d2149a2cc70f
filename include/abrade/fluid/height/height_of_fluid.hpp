#pragma once
// Liquid below a surface that is a height: z = h(x, y, t).

#include <abrade/fluid/height/fluxes.hpp>
#include <abrade/fluid/height/overturning.hpp>
#include <abrade/fluid/height/renewal.hpp>
#include <abrade/fluid/height/water_columns.hpp>
#include <abrade/fluid/mesh/ghost_cells.hpp>
#include <abrade/fluid/mesh/water_cells.hpp>
#include <abrade/fluid/vof/cell_marks.hpp>

#include <algorithm>
#include <limits>
#include <span>
#include <utility>
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
    /// Largest share of a column at its surface that leaves it sideways in a step [-].
    static constexpr Real courant_limit = 0.9;
    static constexpr Real courant_end = 1;
    /// See MomentumStage: what the surface cuts is bounded by its neighbours, whatever it holds.
    static constexpr Real bounded_below = 1;

    struct Params {
        Real steepest = 2;  ///< slope of the surface beyond which it is held back from steepening [-]
        /// Share of the wet area that may be held back so, mean of about ten steps [-].
        Real most_overturning = 0.25;
    };

    HeightOfFluid(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries, const Params& params)
        : params_(params), water_(grid, boundaries), layout_(grid.layout()), fluxes_(grid, boundaries),
          marks_(surface_marks(grid, boundaries, nullptr)), wet_(layout_), active_(layout_),
          touched_(layout_), near_solid_(columns_near_solids(water_)) {
        const auto refuse = [&](const char* rule, const char* remedy, Boundary side) {
            fail({"GridFluid.boundaries.z", rule, "", remedy}, std::string(boundary_name(side)));
        };
        const auto [floor, top] = boundaries[vertical].values;
        if (floor == Boundary::outflow || floor == Boundary::inflow)
            refuse("a closed floor below a HeightSurface", "close it, or take FreeSurface", floor);
        if (top == Boundary::inflow)
            refuse("no inflow from above a HeightSurface", "close it, or take FreeSurface", top);
    }

    /// As VolumeOfFluid's, and the wall in each cell. Throws InputError where a wall hangs over water.
    void set_walls(const EmbeddedBoundary<Dim>& walls) {
        water_.set_walls(walls);
        marks_ = surface_marks(grid(), boundaries(), &walls.open_fraction());
        cut_.cell.clear();
        grid().for_each([&](const CellNumber<Dim>&, Offset c) {
            if (walls.open_fraction()[c] > 0 && walls.open_fraction()[c] < 1)
                cut_.cell.push_back(static_cast<Index>(c));
        });
        near_solid_ = columns_near_solids(water_);
    }
    /// What holds the water on its bed. Throws InputError where it points upwards.
    void set_gravity(const Point<Dim>& gravity) {
        if (gravity[vertical] > 0)
            fail({"GridFluid.gravity.z", "at most 0 where the surface is a HeightSurface", "m/s2",
                  "let it point down, or take FreeSurface"},
                 to_text(gravity[vertical]));
        gravity_ = gravity;
    }

    Field<Real>& fraction() noexcept { return water_.fraction; }
    const Field<Real>& fraction() const noexcept { return water_.fraction; }

    /// Lets the level of water decide what stands where walls cut the cell at its surface: `water` is above 0
    /// below it. Throws InputError where water stands over air.
    void begin(const auto& water) { water_.begin(water); }
    /// Takes over fractions that were set from outside: each column keeps its volume. Throws InputError where
    /// one is not from 0 to 1.
    void prepare() {
        water_.check_fractions();
        volume_defect().fill(0);
        gather();
    }
    /// The same, and what `volume_defect()` says.
    void gather() {
        water_.gather();
        wet_.find(fraction());
        locate(false);
    }

    /// One step, as VolumeOfFluid's; sources are those of the part of a cell that lies below the surface.
    /// Throws InputError beyond `courant_end`, and where too much of the surface wants to overturn.
    VolumeStep advance(const FaceField<Dim>& velocity, Real dt, FaceField<Dim>& flux,
                       std::span<CellSource> sources = {}) {
        require_not_negative(dt, "HeightOfFluid.advance: dt", "s");
        VolumeStep step{.courant = dt * outflow_rate(velocity)};
        if (!(step.courant <= courant_end))
            fail({"HeightOfFluid.advance: dt",
                  "small enough that no more than all of a cell at the surface leaves it", "s",
                  "take at most stable_step()"},
                 short_text(dt));
        const detail::HeightFlow<Dim> flow{water_.shape,
                                           water_.fraction,
                                           water_.volume,
                                           water_.height,
                                           water_.top,
                                           touched_,
                                           velocity,
                                           water_.apertures,
                                           flux,
                                           dt,
                                           water_.film_volume()};
        std::vector<Real> next = water_.volume;
        fluxes_.find(flow);
        fluxes_.limit(flow);
        fluxes_.sum(flow, next);
        solid_moved_ = detail::carry_solids(water_, std::exchange(solid_fluxes_, {}), dt, flux);
        take_sources(sources, dt, next);
        if (dt > 0)
            detail::hold_slopes(
                water_, {params_.steepest, params_.most_overturning, -gravity_[vertical], near_solid_}, next,
                flux, overturning_);
        detail::ColumnRenewal<Dim> renewal(water_, touched_, next, flux);
        const bool rose_far = renewal.run();
        renewal.raise_by(sources);
        ++steps_;
        if (rose_far)
            wet_.find(fraction());
        else
            wet_.find_within(active_, fraction());
        locate(rose_far);
        return step;
    }
    bool can_advance(const FaceField<Dim>& u, Real dt) const { return dt * outflow_rate(u) <= courant_end; }
    Real stable_step(const FaceField<Dim>& velocity) const {
        const Real rate = outflow_rate(velocity);
        return rate > 0 ? courant_limit / rate : std::numeric_limits<Real>::infinity();
    }

    /// Solids that are among the water from the next step on, and what of them goes through upright faces in
    /// it. Velocities are then those of the water times its share of a face; fractions are those of both
    /// below the surface.
    void set_solids(std::span<const SolidPart> parts, std::span<const SolidFlux> fluxes) {
        std::swap(water_.solids, water_.solids_before);
        water_.solids.set(parts, grid(), columns());
        solid_fluxes_ = fluxes;
    }
    /// Solids that the water has been given around, up to its surface as it stands.
    void stand_solids(std::span<const SolidPart> parts) {
        water_.solids.set(parts, grid(), columns());
        gather();
    }
    /// After a step that went wrong.
    void take_back_solids() { water_.solids = water_.solids_before; }
    /// Somewhere in the cell's column.
    bool has_solid(Offset cell) const noexcept { return water_.solids.has(column_of(cell)); }
    std::span<const SolidVolume> solid_moved() const noexcept { return solid_moved_; }

    Index steps() const noexcept { return steps_; }
    void set_steps(Index steps) noexcept { steps_ = steps; }
    const Field<Real>& volume_defect() const noexcept { return water_.volume_defect; }
    Field<Real>& volume_defect() noexcept { return water_.volume_defect; }
    bool has_volume_defect() const noexcept { return water_.brim; }
    Real full() const noexcept { return 1 - volume_tolerance::round_off; }
    Real void_inside_water() const noexcept { return volume_tolerance::round_off; }
    const WetRows<Dim>& wet() const noexcept { return wet_; }
    const Grid<Dim>& grid() const noexcept { return water_.grid; }
    const BoundaryConditions<Dim>& boundaries() const noexcept { return water_.boundaries; }
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
        for (int plane = 0; plane < grid().cells(0); ++plane)
            for (int j = 0; j < columns().across(); ++j) sum += column_volume(columns().column(plane, j));
        return sum;
    }
    const detail::HeightColumns<Dim>& columns() const noexcept { return water_.shape; }
    Real height(Index column) const noexcept { return water_.height[at(column)]; }         ///< [m]
    Real column_volume(Index column) const noexcept { return water_.volume[at(column)]; }  ///< [m3]
    /// Level of the cell at the surface.
    int top(Index column) const noexcept { return water_.top[at(column)]; }

    /// Whether the centre of a cell lies below the surface of its column.
    bool is_liquid(Offset cell) const noexcept {
        const CellNumber<Dim> number = layout_.number(cell);
        const Index n = columns().column(number);
        return water_.is_wet(n) && fraction()[cell] > 0 &&
               height(n) >= grid().centre(vertical, number[vertical]);
    }
    /// Whether a dry cell's centre lies below the bed of a dry column: nothing tells where on the way to it
    /// the pressure is 0.
    bool is_wall_dry(Offset dry) const noexcept {
        const CellNumber<Dim> number = layout_.number(dry);
        return height(columns().column(number)) >= grid().centre(vertical, number[vertical]);
    }
    /// Where the surface is between the centres of two neighbours, as VolumeOfFluid has it: by the depths of
    /// both centres below the heights of their columns.
    Real surface_share(Offset liquid, Index level, int axis, int side, Real least = 0) const noexcept {
        const Index n = column_of(liquid);
        const int k = static_cast<int>(level);
        const Real shallow = least * grid().size(vertical, k);
        const Real depth = std::max(height(n) - grid().centre(vertical, k), shallow);
        if (axis == vertical)
            return std::clamp(depth / grid().gap(vertical, side > 0 ? k + 1 : k), least, Real(1));
        const Index other = n + side * columns().step(axis);
        const Real missing = std::max(grid().centre(vertical, k) - height(other), Real(0));
        return std::clamp(depth / (depth + missing), least, Real(1));
    }

    /// Films on a bed do not fall: no pressure would stop them.
    void clamp_films(FaceField<Dim>& u) const noexcept {
        columns().parallel_for_each([&](int plane, int j, Index n) {
            if (!(column_volume(n) > 0)) return;
            const Offset c = columns().cell(plane, j, top(n)), s = layout_.stride[vertical];
            const bool bottom = top(n) == columns().first(n);
            if (!bottom || is_liquid(c)) return;
            u[vertical][c] = 0;
            if (top(n) + 1 < columns().levels()) u[vertical][c + s] = 0;
        });
    }

    static void fields(auto&& field) {
        field("fluxes", &HeightOfFluid::fluxes_), field("water", &HeightOfFluid::water_),
            field("wet", &HeightOfFluid::wet_), field("active", &HeightOfFluid::active_),
            field("touched", &HeightOfFluid::touched_), field("overturning", &HeightOfFluid::overturning_),
            field("steps", &HeightOfFluid::steps_);
    }

private:
    static std::size_t at(auto i) noexcept { return static_cast<std::size_t>(i); }
    Index column_of(Offset cell) const noexcept { return columns().column(layout_.number(cell)); }

    void take_sources(std::span<CellSource> sources, Real dt, std::vector<Real>& next) const {
        for (CellSource& s : sources) {
            const CellNumber<Dim> cell = layout_.number(s.cell);
            const Index n = columns().column(cell);
            const Real holds = fraction()[s.cell] * columns().open(s.cell) * columns().volume(cell[vertical]);
            s.volume = std::max(s.rate * dt * holds, -next[at(n)]);
            next[at(n)] += s.volume;
        }
    }

    /// Rows that the water may reach in the next step.
    void locate(bool rose_far) {
        touched_ = active_;
        active_ = wet_.dilated(2, boundaries().periodic_axes());
        include_inflows();
        touched_.include(active_);
        if (rose_far) touched_ = WetRows<Dim>::whole(layout_);
        fill_ghosts(fraction(), touched_, boundaries());
        water_.fill_ghost_columns();
    }
    /// Rows beside inflows with water beyond.
    void include_inflows() {
        for (int a = 0; a < Dim - 1; ++a)
            for (const bool high : {false, true}) {
                if (boundaries()[a][high] != Boundary::inflow) continue;
                grid().for_each_beside(a, high, [&](const CellNumber<Dim>& cell, Offset c) {
                    const Offset s = layout_.stride[a];
                    if (!(fraction()[high ? c + s : c - s] > 0)) return;
                    const int i = cell[inner];
                    RowRange& row = active_.row(cell[outer], Dim == 3 ? cell[Dim - 1] : 0);
                    row = hull(row, {std::max(i - 1, 0), std::min(i + 2, layout_.row_length())});
                });
            }
    }

    /// Share of a cell at the surface that leaves it sideways per second, at most [1/s].
    Real outflow_rate(const FaceField<Dim>& u) const {
        return columns().parallel_max_of([&](int plane, int j, Index n) {
            if (!water_.is_wet(n)) return Real(0);
            const Offset c = columns().cell(plane, j, top(n));
            Real rate = 0;
            for (int a = 0; a < Dim - 1; ++a) {
                const Offset s = layout_.stride[a];
                const Real low = water_.apertures ? (*water_.apertures)[a][c] : 1;
                const Real high = water_.apertures ? (*water_.apertures)[a][c + s] : 1;
                rate += (high * std::max(u[a][c + s], Real(0)) + low * std::max(-u[a][c], Real(0))) /
                        grid().size(a, 0);
            }
            return rate / std::max(columns().open(c), Real(0.5));
        });
    }

    Params params_;
    detail::WaterColumns<Dim> water_;
    Layout<Dim> layout_;
    detail::HeightFluxes<Dim> fluxes_;
    Field<std::uint8_t> marks_;
    CutCells cut_;
    WetRows<Dim> wet_, active_, touched_;
    std::vector<std::uint8_t> near_solid_;  ///< [column]
    std::vector<SolidVolume> solid_moved_;
    std::span<const SolidFlux> solid_fluxes_;  ///< of the step to come
    Overturning overturning_;
    Point<Dim> gravity_ = Point<Dim>::Zero();
    Index steps_ = 0;
};

}  // namespace abrade
