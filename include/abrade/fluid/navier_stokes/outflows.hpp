#pragma once
// Sides where water leaves a box: freely, or against water that stands behind them.

#include <abrade/fluid/pressure/projection.hpp>
#include <abrade/fluid/setup/grid_fluid_params.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace abrade::detail {

/// Pressure's part in the velocity of faces where water leaves; the projection holds the pressure there.
/// Without a tailwater it is what it has come to, but for water that comes back, which starts from 0:
/// p / rho = -u^2 / 2. With one it is that of water below a level, which a flow slower than its waves takes
/// over,
///   p / rho = g max(d + r, 0) - max(-u, 0)^2 / 2,  r = sqrt(h / g) (U - U_T),
/// u outwards, d the depth below the level that is given:
/// - r lets waves out: as high as one that goes on would be where the mean speed U through the side changes
///   from what it has been for a while, U_T, in a section of mean depth h (R. A. Flather, A tidal model of
///   the north-west European continental shelf, Mem. Soc. R. Sci. Liege 6-10 (1976) 141). What stays meets
///   the level, and without swinging: a while is the period of the box's slowest swing, 4 L / sqrt(g h).
/// - Water that comes back has its speed from its own weight: its head is no higher than the level.
template <int Dim>
class Outflows {
    static constexpr int vertical = Grid<Dim>::vertical;

public:
    Outflows() = default;
    Outflows(const Grid<Dim>& grid, const GridFluidParams<Dim>& params) : held_(bool(params.outflow_water)) {
        for (int a = 0; a < Dim; ++a)
            for (const bool high : {false, true})
                if (params.boundaries[a][high] == Boundary::outflow) add_side(grid, params, a, high);
    }

    struct Step {
        Real seconds = 0, weight = 0;  ///< dt; g across the bed [m/s2]
        bool from_rest = false;        ///< the velocity is how water at rest is accelerated
    };
    /// Pushes what leaves in a step: as the faces before it are about to be, or by the tailwater.
    void push(FaceField<Dim>& u, const Field<Real>& pressure, const auto& projection, const Step& step) {
        const Real dt = step.seconds;
        const Poisson<Dim>& m = projection.solver().matrix();
        for (OutflowSide& side : boundaries_) {
            const Real raised = held_ && !step.from_rest ? rise(side, u, m, step) : 0;
            for (const Face& f : side.faces) {
                Real& speed = u[side.axis][f.face];
                const Real back = step.from_rest ? 0 : std::max(-side.outwards * speed, Real(0));
                if ((held_ || back > 0) && m.inverse_diagonal[f.cell] > 0) {
                    const Real head = held_ ? step.weight * std::max(f.depth + raised, Real(0)) : 0;
                    speed -= dt * f.slope * (head - 0.5 * square(back) - pressure[f.cell]);
                } else if (!held_ && m.face[side.axis][f.inside] > 0) {
                    const Real fall = pressure[f.inside] - pressure[f.inside - f.back];
                    speed -= dt * 0.5 * std::abs(f.slope) * fall * carried(projection, side.axis, f);
                }
            }
        }
    }
    /// The step that was pushed has been taken.
    void took() noexcept {
        for (OutflowSide& side : boundaries_) side.mean_speed = side.next_mean;
    }

    static void fields(auto&& field) { field("boundaries", &Outflows::boundaries_); }

private:
    struct Face {
        Offset cell, face, inside,
            back;     ///< inside: the next face, by the cell above it; back: to the one below
        Real slope;   ///< from the cell's centre to the side [1/m]
        Real depth;   ///< below the tailwater's level [m]
        Real height;  ///< of the face [m]
        int column;   ///< along the side
    };
    struct OutflowSide {
        int axis = 0;
        Real outwards = 1;  ///< sign of u that leaves
        Real length = 0;    ///< of the box [m]
        std::vector<Face> faces;
        std::optional<Real> mean_speed, next_mean;  ///< U_T before the step, after it [m/s]
        std::vector<std::uint8_t> wet;              ///< columns
        static void fields(auto&& field) {
            field("mean_speed", "m/s", &OutflowSide::mean_speed),
                field("next_mean", "m/s", &OutflowSide::next_mean);
        }
    };

    void add_side(const Grid<Dim>& grid, const GridFluidParams<Dim>& params, int axis, bool high) {
        OutflowSide side;
        side.axis = axis, side.outwards = high ? 1 : -1;
        side.length = grid.high(axis) - grid.low(axis);
        const int along = Dim == 3 && axis != vertical ? 1 - axis : axis;
        side.wet.assign(static_cast<std::size_t>(grid.cells(along)), 0);
        grid.for_each_beside(axis, high, [&](const CellNumber<Dim>& cell, Offset c) {
            const Offset s = grid.layout().stride[axis];
            const Real size = grid.size(axis, cell[axis]);
            Point<Dim> x = grid.centre(cell);
            x[axis] += high ? 0.5 * size : -0.5 * size;
            const Real depth = held_ ? params.outflow_water(x) : 0;
            if (!std::isfinite(depth))
                require_finite(depth, "GridFluid.outflow_water at " + place_text<Dim>(x), "m");
            side.faces.push_back({c, high ? c + s : c, high ? c : c + s, s, (high ? 2 : -2) / size, depth,
                                  grid.size(vertical, cell[vertical]), cell[along]});
        });
        boundaries_.push_back(std::move(side));
    }

    static Real carried(const auto& projection, int axis, const Face& f) noexcept {
        const FaceField<Dim>* const open = projection.aperture();
        return open ? carried_share((*open)[axis], f.inside, f.face) : 1;
    }

    /// r [m]. Also finds what U_T will be: slower than waves, or no tailwater would hold it. A front that
    /// comes first would drain the box by its speed.
    static Real rise(OutflowSide& side, const FaceField<Dim>& u, const Poisson<Dim>& m, const Step& step) {
        side.next_mean = side.mean_speed;
        if (side.axis == vertical || !(step.weight > 0)) return 0;
        Real height = 0, flow = 0, columns = 0;  // of whole wet faces, of columns of equal width
        std::fill(side.wet.begin(), side.wet.end(), 0);
        for (const Face& f : side.faces) {
            if (!(m.inverse_diagonal[f.cell] > 0)) continue;
            height += f.height, flow += f.height * side.outwards * u[side.axis][f.face];
            auto& wet = side.wet[static_cast<std::size_t>(f.column)];
            columns += 1 - wet, wet = 1;
        }
        if (columns == 0) return 0;
        const Real speed = flow / height, depth = height / columns, wave = std::sqrt(step.weight * depth);
        const Real mean = std::clamp(side.mean_speed.value_or(speed), -wave, wave);
        const Real swings = step.seconds * wave / (4 * side.length);
        side.next_mean = mean + swings / (1 + swings) * (speed - mean);
        return std::sqrt(depth / step.weight) * (speed - mean);
    }

    std::vector<OutflowSide> boundaries_;
    bool held_ = false;
};

}  // namespace abrade::detail
