#pragma once
// Sides where water leaves a box: freely, or against water that stands behind them.

#include <abrade/fluid/grid_fluid_params.hpp>
#include <abrade/fluid/projection.hpp>

#include <vector>

namespace abrade::detail {

/// Pressure's part in the velocity of faces where water leaves; the projection holds the pressure there.
/// Without a tailwater it is what it has come to. With one it is that of water at rest below its level,
///   p / rho = g max(d, 0),  d the depth below that level,
/// which a flow slower than its waves takes over.
template <int Dim>
class Outflows {
public:
    Outflows() = default;
    Outflows(const Grid<Dim>& grid, const GridFluidParams<Dim>& params) : held_(bool(params.outflow_water)) {
        for (int a = 0; a < Dim; ++a)
            for (const bool high : {false, true}) {
                if (params.sides[a][high] != Side::outflow) continue;
                grid.for_each_beside(a, high, [&](const CellNumber<Dim>& cell, Offset c) {
                    const Offset s = grid.layout().stride[a];
                    const Real size = grid.size(a, cell[a]);
                    Point<Dim> x = grid.centre(cell);
                    x[a] += high ? 0.5 * size : -0.5 * size;
                    const Real depth = held_ ? params.outflow_water(x) : 0;
                    if (!std::isfinite(depth))
                        require_finite(depth, "GridFluid.outflow_water at " + place_text<Dim>(x), "m");
                    faces_.push_back({a, c, high ? c + s : c, high ? c : c + s, s, (high ? 2 : -2) / size,
                                      std::max(depth, Real(0))});
                });
            }
    }

    struct Step {
        Real seconds = 0, weight = 0;  ///< dt; g across the bed [m/s2]
    };
    /// Pushes what leaves in a step: as the faces before it are about to be, or by the tailwater.
    void push(FaceField<Dim>& u, const Field<Real>& pressure, const Projection<Dim, Real>& projection,
              const Step& step) const {
        const auto [dt, weight] = step;
        const Poisson<Dim>& m = projection.multigrid().matrix();
        for (const Face& f : faces_)
            if (held_ && m.inverse_diagonal[f.cell] > 0)
                u[f.axis][f.face] -= dt * f.slope * (weight * f.depth - pressure[f.cell]);
            else if (!held_ && m.face[f.axis][f.inside] > 0)
                u[f.axis][f.face] -=
                    dt * 0.5 * std::abs(f.slope) * (pressure[f.inside] - pressure[f.inside - f.back]);
    }

private:
    struct Face {
        int axis;
        Offset cell, face, inside,
            back;    ///< inside: the next face, by the cell above it; back: to the one below
        Real slope;  ///< from the cell's centre to the side [1/m]
        Real depth;  ///< below the tailwater's level [m]
    };
    std::vector<Face> faces_;
    bool held_ = false;
};

}  // namespace abrade::detail
