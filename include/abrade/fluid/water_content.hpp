#pragma once
// What water on a grid holds: volume and mass by the cells, kinetic and potential energy.

#include <abrade/fluid/cell_sizes.hpp>
#include <abrade/fluid/grid_fluid_params.hpp>
#include <abrade/fluid/liquid_centroid.hpp>
#include <abrade/fluid/wet_rows.hpp>

#include <cstdint>

namespace abrade::detail {

/// Of a flow, what its energy is measured from. Below `liquid`: null in a full box.
template <int Dim, class State>
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
    const VolumeOfFluid<Dim>* liquid = nullptr;
    const Walls<Dim>* walls = nullptr;
    const WetRows<Dim>* rows = nullptr;
    const Field<Real>* held_before = nullptr;  ///< liquid in whole cells when the step began [-]
    const Field<Real>* held = nullptr;         ///< and now
    const Field<std::uint8_t>* wet = nullptr;
    const PerAxis<FaceField<Dim, float>, Dim>* open_friction = nullptr;
};

/// Sum of term(offset, cell) over the cells of rows. The same bits for any number of threads.
template <int Dim>
Real sum_over_rows(const WetRows<Dim>& rows, auto&& term) {
    const Layout<Dim>& layout = rows.layout();
    const Index per_plane = layout.rows_per_plane();
    return parallel_sum<Real>(
        layout.planes() * per_plane,
        [&](Index n) {
            CellNumber<Dim> cell{};
            cell[Layout<Dim>::outer] = static_cast<int>(n / per_plane);
            const int row = static_cast<int>(n % per_plane);
            if constexpr (Dim == 3) cell[2] = row;
            const RowRange r = rows.row(cell[Layout<Dim>::outer], row);
            const Offset start = layout.row_start(cell[Layout<Dim>::outer], row);
            Real sum = 0;
            for (int& i = cell[Layout<Dim>::inner] = r.begin; i < r.end; ++i) sum += term(start + i, cell);
            return sum;
        },
        16);
}

/// Liquid and energy of a flow. Gravity along periodic axes makes no potential: it is `along_periodic`.
template <int Dim, class State>
class WaterContent {
    static constexpr int vertical = Grid<Dim>::vertical;

public:
    using View = EnergyView<Dim, State>;

    explicit WaterContent(const View& flow)
        : sizes_(flow.grid), all_(WetRows<Dim>::whole(flow.grid.layout())) {
        for (int a = 0; a < Dim; ++a)
            (flow.params.sides.periodic(a) ? along_periodic_ : gravity_)[a] = flow.params.gravity[a];
    }

    const Point<Dim>& gravity() const noexcept { return gravity_; }  ///< that makes a potential [m/s2]
    const Point<Dim>& along_periodic() const noexcept { return along_periodic_; }
    const CellSizes<Dim>& sizes() const noexcept { return sizes_; }
    /// Rows that hold water.
    const WetRows<Dim>& rows(const View& flow) const noexcept { return flow.rows ? *flow.rows : all_; }

    /// [J]; of each cell half the mean square of the speed at its faces. Below a surface that speed is the
    /// mean of `mid`, half a step before the liquid's time, and of the velocity now, half a step behind it.
    Real kinetic(const View& flow, const FaceField<Dim, State>& mid) const {
        const auto speed = [&](int a, Offset c) {
            const auto now = static_cast<Real>(flow.velocity[a][c]);
            return flow.liquid ? 0.5 * (now + static_cast<Real>(mid[a][c])) : now;
        };
        return flow.params.density * sum_over_rows(rows(flow), [&](Offset c, const CellNumber<Dim>& cell) {
                   const Real held = flow.held ? (*flow.held)[c] : 1;
                   Real squares = 0;
                   for (int a = 0; a < Dim && held > 0; ++a)
                       squares += square(speed(a, c)) + square(speed(a, c + flow.grid.layout().stride[a]));
                   return 0.25 * squares * held * sizes_.volume(cell[vertical]);
               });
    }

    /// [J], from the origin.
    Real potential(const View& flow) const {
        if (gravity_.isZero()) return 0;
        Real sum = sum_over_rows(rows(flow), [&](Offset c, const CellNumber<Dim>& cell) {
            const Real volume = volume_of(flow, c, cell[vertical]);
            return volume == 0 ? 0 : volume * gravity_.dot(flow.grid.centre(cell));
        });
        const auto add = [&](Offset c) {
            const CellNumber<Dim> cell = flow.grid.layout().number(c);
            const Real volume = volume_of(flow, c, cell[vertical]);
            return volume == 0 ? 0 : volume * gravity_.dot(off_centre(flow, c, cell));
        };
        if (flow.liquid) {
            const auto& cut = flow.liquid->planes().cell;
            sum += parallel_sum<Real>(static_cast<Index>(cut.size()),
                                      [&](Index i) { return add(cut[static_cast<std::size_t>(i)]); });
        }
        if (flow.walls) {
            const auto cut = flow.walls->wall_cells();
            sum += parallel_sum<Real>(static_cast<Index>(cut.size()), [&](Index i) {
                const Offset c = cut[static_cast<std::size_t>(i)].cell;
                return flow.liquid->plane_of(c) < 0 ? add(c) : 0;
            });
        }
        return -flow.params.density * sum;
    }

    /// From a cell's centre to that of its liquid [m].
    static Point<Dim> off_centre(const View& flow, Offset c, const CellNumber<Dim>& cell) noexcept {
        if (!flow.liquid) return Point<Dim>::Zero();
        Point<Dim> off = liquid_centroid(*flow.liquid, flow.walls, c);
        for (int a = 0; a < Dim; ++a) off[a] *= flow.grid.size(a, cell[a]);
        return off;
    }

    /// Of a face, whatever it holds [m3].
    Real control_volume(const View& flow, int a, int level) const noexcept {
        return sizes_.face(a, level) * flow.grid.gap(a, a == vertical ? level : 0);
    }
    /// Liquid of a face's control volume [m3]; 0 where it is too little to have a momentum.
    Real liquid_of_face(const View& flow, int a, Offset c, int level) const noexcept {
        constexpr Real least = 1e-9;  // that of momentum
        const Real volume = control_volume(flow, a, level);
        if (!flow.held) return volume;
        const Real upper = flow.grid.size(a, a == vertical ? level : 0);
        const Real lower = flow.grid.size(a, a == vertical ? level - 1 : 0);
        const Offset back = c - flow.grid.layout().stride[a];
        const Real share = (upper * (*flow.held)[c] + lower * (*flow.held)[back]) / (upper + lower);
        return share > least ? share * volume : 0;
    }

private:
    /// Liquid of a cell [m3].
    Real volume_of(const View& flow, Offset c, int level) const noexcept {
        if (!flow.liquid) return sizes_.volume(level);
        const Real open = flow.walls ? flow.walls->open_volume()[c] : 1;
        const Real share = flow.liquid->fraction()[c] + flow.liquid->surplus()[c];
        return open == 0 ? 0 : share * open * sizes_.volume(level);
    }

    CellSizes<Dim> sizes_;
    WetRows<Dim> all_;
    Point<Dim> gravity_ = Point<Dim>::Zero(), along_periodic_ = Point<Dim>::Zero();  ///< [m/s2]
};

}  // namespace abrade::detail
