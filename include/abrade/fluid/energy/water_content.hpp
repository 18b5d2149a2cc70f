#pragma once
// What water on a grid holds: volume and mass by the cells, kinetic and potential energy.

#include <abrade/fluid/embedded_boundary/wall_friction.hpp>
#include <abrade/fluid/energy/liquid_centroid.hpp>
#include <abrade/fluid/mesh/level_table.hpp>
#include <abrade/fluid/mesh/solid_parts.hpp>
#include <abrade/fluid/mesh/volume_tolerance.hpp>
#include <abrade/fluid/mesh/wet_rows.hpp>
#include <abrade/fluid/momentum/forcing.hpp>
#include <abrade/fluid/setup/grid_fluid_params.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace abrade::detail {

/// Of a flow, what its energy is measured from. Below `liquid`: null in a full box.
template <int Dim, class State, class Liquid = VolumeOfFluid<Dim>>
struct EnergyView {
    const Grid<Dim>& grid;
    const GridFluidParams<Dim>& params;
    const WallFriction<Dim>& friction;
    const PerAxis<WetRows<Dim>, Dim>& faces;  ///< that carry momentum
    const FaceField<Dim, State>& before;      ///< when the step began [m/s]
    const FaceField<Dim, State>& stage;       ///< after the first stage [m/s]; asked in a full box alone
    const FaceField<Dim, State>& velocity;    ///< now [m/s]
    const Field<State>& pressure;             ///< over density [m2/s2]
    Real time = 0;                            ///< when the step began [s]
    const Field<State>* eddies = nullptr;  ///< nu_t of cells that acted in the step [m2/s]; none: no eddies
    const Liquid* liquid = nullptr;
    /// That moved the liquid, solids among it included [m3]; once a step is done, what carried momentum in
    /// its second stage.
    const FaceField<Dim>* flux = nullptr;
    const EmbeddedBoundary<Dim>* walls = nullptr;
    const WetRows<Dim>* rows = nullptr;
    const Field<Real>* liquid_fraction_before = nullptr;  ///< liquid in whole cells when the step began [-]
    const Field<Real>* liquid_fraction = nullptr;         ///< and now
    const Field<std::uint8_t>* wet = nullptr;
    const PerAxis<FaceField<Dim, float>, Dim>* open_friction = nullptr;
    std::vector<SolidVolume> solids{}, new_solids{};  ///< in control volumes; of those that came in the step
    Point<Dim> solid_moment = Point<Dim>::Zero();     ///< volume in the water times place [m4]
    Point<Dim> new_solid_moment = Point<Dim>::Zero();
    std::span<const SolidFlux> solid_fluxes{};  ///< of a full box
    /// What carried momentum in the second stage among solids [m/s]; none: a stage's own velocity. Of a full
    /// box.
    const FaceField<Dim, State>* advecting_flux = nullptr;
    Real solid_friction = 0;                                     ///< lost in the step [J]
    const PerAxis<std::vector<FaceGain>, Dim>* gains = nullptr;  ///< by a user's force; none: nothing
    std::span<const CellSource> sources{};
};

/// Sum of of_row(plane, row, range) over the rows that are not dry. The same bits for any number of threads.
template <int Dim>
Real sum_over_rows(const WetRows<Dim>& rows, auto&& of_row) {
    const Index per_plane = rows.layout().rows_per_plane();
    constexpr Index together = 16;
    return parallel_sum<Real>(
        rows.layout().planes() * per_plane,
        [&](Index n) {
            const int plane = static_cast<int>(n / per_plane), row = static_cast<int>(n % per_plane);
            const RowRange& r = rows.row(plane, row);
            return r.empty() ? Real(0) : of_row(plane, row, r);
        },
        together);
}

/// Liquid and energy of a flow. Gravity along periodic axes makes no potential: it is `along_periodic`.
template <int Dim, class State, class Liquid = VolumeOfFluid<Dim>>
class WaterContent {
    static constexpr int vertical = Grid<Dim>::vertical, inner = Layout<Dim>::inner;

public:
    using View = EnergyView<Dim, State, Liquid>;

    explicit WaterContent(const View& flow)
        : all_(WetRows<Dim>::whole(flow.grid.layout())),
          volume_(flow.grid, [&](int k) { return cell_volume(flow.grid, k); }) {
        const Grid<Dim>& grid = flow.grid;
        for (int a = 0; a < Dim; ++a) {
            (flow.params.boundaries.periodic(a) ? along_periodic_ : gravity_)[a] = flow.params.gravity[a];
            control_volume_[a] = LevelTable<Dim, Real>(grid, [&](int k) {
                const int number = a == vertical ? k : 0;
                return cell_volume(grid, k) / grid.size(a, number) * grid.gap(a, number);
            });
        }
        for (int i = 0; i < grid.cells(inner); ++i)
            along_row_.push_back(gravity_[inner] * grid.centre(inner, i));
        look_at_walls(flow);
    }

    /// What does not change with the water: centres of what walls leave open.
    void look_at_walls(const View& flow) {
        off_by_wall_.clear();
        if (!flow.walls || gravity_.isZero()) return;
        for (const CutCell<Dim>& w : flow.walls->cut_cells()) {
            off_by_wall_.push_back(offset_above_wall(*flow.walls, w, in_cells(flow, w.cell, gravity_)));
        }
    }

    const Point<Dim>& gravity() const noexcept { return gravity_; }  ///< that makes a potential [m/s2]
    const Point<Dim>& along_periodic() const noexcept { return along_periodic_; }
    /// Rows that hold water.
    const WetRows<Dim>& rows(const View& flow) const noexcept { return flow.rows ? *flow.rows : all_; }
    const LevelTable<Dim, Real>& volume() const noexcept { return volume_; }  ///< of cells [m3]
    /// Of the faces along an axis, whatever they hold [m3].
    const LevelTable<Dim, Real>& control_volume(int a) const noexcept { return control_volume_[a]; }

    /// [J]; of each cell half the mean square of the speed at its faces. Below a surface that speed is the
    /// mean of `mid`, half a step before the liquid's time, and of the velocity now, half a step after it.
    Real kinetic(const View& flow, const FaceField<Dim, State>& mid) const {
        return flow.params.density * sum_over_rows(rows(flow), [&](int plane, int row, const RowRange& r) {
                   const Offset start = flow.grid.layout().row_start(plane, row);
                   const auto volume = volume_.row(row);
                   const Real* const liquid_fraction =
                       flow.liquid_fraction ? flow.liquid_fraction->data() + start : nullptr;
                   Real sum = 0;
                   for (int a = 0; a < Dim; ++a) {
                       const State* const now = flow.velocity[a].data() + start;
                       const State* const then = flow.liquid ? mid[a].data() + start : now;
                       const Offset up = flow.grid.layout().stride[a];
#pragma omp simd reduction(+ : sum)
                       for (int i = r.begin; i < r.end; ++i) {
                           const Real low = static_cast<Real>(now[i]) + static_cast<Real>(then[i]);
                           const Real high = static_cast<Real>(now[i + up]) + static_cast<Real>(then[i + up]);
                           sum += (low * low + high * high) * volume[i] *
                                  (liquid_fraction ? liquid_fraction[i] : 1);
                       }
                   }
                   return sum / 16;
               });
    }

    /// [J], from the origin.
    Real potential(const View& flow) const {
        if (gravity_.isZero()) return 0;
        Real sum = sum_over_rows(rows(flow), [&](int plane, int row, const RowRange& r) {
            const Offset start = flow.grid.layout().row_start(plane, row);
            const auto volume = volume_.row(row);
            Real across = gravity_[0] * flow.grid.centre(0, plane);
            if constexpr (Dim == 3) across += gravity_[2] * flow.grid.centre(2, row);
            const Real* const f = flow.liquid ? flow.liquid->fraction().data() + start : nullptr;
            const Real* const volume_defect =
                flow.liquid ? flow.liquid->volume_defect().data() + start : nullptr;
            const Real* const open = flow.walls ? flow.walls->open_fraction().data() + start : nullptr;
            const Real* const along = along_row_.data();
            Real of_row = 0;
#pragma omp simd reduction(+ : of_row)
            for (int i = r.begin; i < r.end; ++i)
                of_row += (f ? f[i] + volume_defect[i] : 1) * (open ? open[i] : 1) * volume[i] *
                          (across + along[i]);
            return of_row;
        });
        if (flow.liquid) {
            const auto cut = cells_at_surface(*flow.liquid);
            sum += parallel_sum<Real>(static_cast<Index>(cut.size()), [&](Index i) {
                const Offset c = cut[static_cast<std::size_t>(i)];
                const Real volume = liquid_of_cell(flow, c);
                return volume == 0 ? 0 : volume * off_centre(flow, c, gravity_);
            });
        }
        if (flow.walls) {
            const auto cut = flow.walls->cut_cells();
            sum += parallel_sum<Real>(static_cast<Index>(cut.size()), [&](Index i) {
                const auto k = static_cast<std::size_t>(i);
                const Offset c = cut[k].cell;
                return !surface_cuts(*flow.liquid, c) ? liquid_of_cell(flow, c) * off_by_wall_[k] : 0;
            });
        }
        return -flow.params.density * sum;
    }

    /// From a cell's centre to that of its liquid, projected on `along`.
    static Real off_centre(const View& flow, Offset c, const Point<Dim>& along) noexcept {
        return flow.liquid ? liquid_offset(*flow.liquid, flow.walls, c, in_cells(flow, c, along)) : 0;
    }

    /// Whether a face has liquid enough to have a momentum; `liquid_fraction` of the cell above it.
    static bool carries(const Real* liquid_fraction, Offset back) noexcept {
        return liquid_fraction[0] + liquid_fraction[-back] > 2 * volume_tolerance::mass;
    }
    /// Of a face [m3]: its control volume, and the liquid in it, 0 where that has no momentum.
    Real control_volume_of(const View& flow, int a, Offset c) const noexcept {
        const int level = flow.grid.layout().number(c)[vertical], number = a == vertical ? level : 0;
        return cell_volume(flow.grid, level) / flow.grid.size(a, number) * flow.grid.gap(a, number);
    }
    Real liquid_of_face(const View& flow, int a, Offset c) const noexcept {
        const Real volume = control_volume_of(flow, a, c);
        const Offset back = flow.grid.layout().stride[a];
        if (!flow.liquid_fraction) return volume;
        if (!carries(flow.liquid_fraction->data() + c, back)) return 0;
        const int number = a == vertical ? flow.grid.layout().number(c)[vertical] : 0;
        const Real upper = flow.grid.size(a, number), lower = flow.grid.size(a, number - 1);
        return volume * (upper * (*flow.liquid_fraction)[c] + lower * (*flow.liquid_fraction)[c - back]) /
               (upper + lower);
    }

private:
    static Point<Dim> in_cells(const View& flow, Offset c, Point<Dim> along) noexcept {
        const CellNumber<Dim> cell = flow.grid.layout().number(c);
        for (int a = 0; a < Dim; ++a) along[a] *= flow.grid.size(a, cell[a]);
        return along;
    }
    static Real cell_volume(const Grid<Dim>& grid, int level) noexcept {
        CellNumber<Dim> cell{};
        cell[vertical] = level;
        return grid.volume(cell);
    }
    Real liquid_of_cell(const View& flow, Offset c) const noexcept {
        const Real open = flow.walls ? flow.walls->open_fraction()[c] : 1;
        if (open == 0) return 0;
        return (flow.liquid->fraction()[c] + flow.liquid->volume_defect()[c]) * open *
               cell_volume(flow.grid, flow.grid.layout().number(c)[vertical]);
    }

    WetRows<Dim> all_;
    LevelTable<Dim, Real> volume_;
    PerAxis<LevelTable<Dim, Real>, Dim> control_volume_;
    Point<Dim> gravity_ = Point<Dim>::Zero(), along_periodic_ = Point<Dim>::Zero();  ///< [m/s2]
    std::vector<Real> along_row_;    ///< gravity times place of a row's cells, its part along it [m2/s2]
    std::vector<Real> off_by_wall_;  ///< the same of the centre of what is open, from the cell's [wall cell]
};

}  // namespace abrade::detail
