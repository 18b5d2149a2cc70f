#pragma once
// Faces that carry momentum below a surface: which they are, their advecting flux in the second stage, what
// slaved ones give to their masters.

#include <abrade/fluid/mesh/level_table.hpp>
#include <abrade/fluid/mesh/wet_rows.hpp>
#include <abrade/fluid/navier_stokes/velocity_extension.hpp>

#include <algorithm>
#include <cmath>

namespace abrade::detail {

/// Faces of wet cells, but for those at the box's sides.
template <int Dim>
void find_momentum_faces(const WetRows<Dim>& wet, const Layout<Dim>& layout,
                         const BoundaryConditions<Dim>& boundaries, PerAxis<WetRows<Dim>, Dim>& faces) {
    constexpr int inner = Layout<Dim>::inner, outer = Layout<Dim>::outer;
    for (int a = 0; a < Dim; ++a) {
        const int first = boundaries.periodic(a) ? 0 : 1;  // a face at a side is the side's
        faces[a].for_each_plane([&](int plane) {
            for (int row = 0; row < layout.rows_per_plane(); ++row) {
                RowRange r = wet.row(plane, row);
                const int number = a == outer ? plane : row;
                if (a == inner) {
                    const int n = layout.row_length();
                    const bool around = first == 0 && r.end == n;  // its upper face is the row's first
                    if (!r.empty()) r = {around ? 0 : std::max(first, r.begin), std::min(n, r.end + 1)};
                } else if (number < first) {
                    r = {};
                } else {
                    const int below = number > 0 ? number - 1 : layout.cells[a] - 1;
                    r = hull(r, a == outer ? wet.row(below, row) : wet.row(plane, below));
                }
                faces[a].row(plane, row) = r;
            }
        });
        faces[a].share_out();
    }
}

/// A step of the liquid: its length [s], and shares of whole cells before and after it [-]; more than `full`
/// is full.
struct LiquidStep {
    Real dt;
    const Field<Real>&before, &now;
    Real full;
};

/// In the bulk the second stage is carried by its own velocity; at the surface by the liquid's fluxes. So it
/// is where that velocity crosses more than a cell: the pressure of an impact, which lasted one step, has
/// pushed it for another, and a speed that carries itself would grow without bound. A trace of air makes no
/// surface, or round-off would choose between the two.
template <int Dim>
void carry_bulk_by(const FaceField<Dim>& stage, const Grid<Dim>& grid, const WetRows<Dim>& rows,
                   const LiquidStep& liquid, FaceField<Dim>& flux) {
    const auto at_level = [&](int k) {
        CellNumber<Dim> cell{};
        cell[Grid<Dim>::vertical] = k;
        return cell;
    };
    const Real full = liquid.full;
    const LevelTable<Dim, Real> volumes(grid, [&](int k) { return grid.volume(at_level(k)); });
    for (int a = 0; a < Dim; ++a) {
        const LevelTable<Dim, Real> swept(grid, [&](int k) {
            const CellNumber<Dim> cell = at_level(k);
            return liquid.dt * grid.volume(cell) / grid.size(a, cell[a]);
        });
        const Offset back = grid.layout().stride[a];
        rows.for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = grid.layout().row_start(plane, row);
            Real* const __restrict c = flux[a].data() + start;
            const Real* const __restrict v = stage[a].data() + start;
            const Real* const __restrict f = liquid.now.data() + start;
            const Real* const __restrict f_back = f - back;
            const Real* const __restrict g = liquid.before.data() + start;
            const Real* const __restrict g_back = g - back;
            const auto area = swept.row(row), room = volumes.row(row);
            constexpr int lanes = Layout<Dim>::lanes;
            for (int first = Layout<Dim>::pack(r.begin); first < r.end; first += lanes)
#pragma omp simd
                for (int i = first; i < first + lanes; ++i) {
                    const Real old = c[i], swept_by_it = v[i] * area[i];
                    const bool in_bulk = (f[i] >= full) & (f_back[i] >= full) & (g[i] >= full) &
                                         (g_back[i] >= full) & (std::abs(swept_by_it) <= room[i]) &
                                         (i >= r.begin) & (i < r.end);
                    c[i] = in_bulk ? swept_by_it : old;
                }
        });
    }
}

/// Slaved faces give their master face their momentum, as in an inelastic impact. A face that is slaved from
/// this step on (`was_wet` beside it) may only slow its master down: what it is faster by it had for nothing
/// when it began to move by itself, for a pressure that ends at a surface near a cell's centre pushes next to
/// no mass there. Given on, waves would gain energy however short the step.
template <int Dim>
void load_masters(FaceField<Dim>& velocity, VelocityExtension<Dim>& extension, const Grid<Dim>& grid,
                  const Field<Real>& liquid_fraction, const Field<std::uint8_t>& was_wet) {
    const Layout<Dim>& layout = grid.layout();
    const auto liquid_of = [&](int a, Offset face) {  // in its control volume [m3]
        CellNumber<Dim> cell = layout.number(face);
        const Real above = liquid_fraction[face] * grid.volume(cell);
        --cell[a];
        return 0.5 * (above + liquid_fraction[face - layout.stride[a]] * grid.volume(cell));
    };
    const auto load = [&](int a, const auto& slaved) {
        for (auto first = slaved.begin(), last = first; first != slaved.end(); first = last) {
            Real& v = velocity[a][first->master];
            Real mass = liquid_of(a, first->master), given = 0, given_by_new = 0;
            for (; last != slaved.end() && last->master == first->master; ++last) {
                const bool is_new = was_wet[last->face] != 0 || was_wet[last->face - layout.stride[a]] != 0;
                const Real adds = last->share * liquid_of(a, last->face);
                (is_new ? given_by_new : given) += adds * (velocity[a][last->face] - v);
                mass += adds;
            }
            if (mass <= 0) continue;
            v += given / mass;
            const auto [least, most] = std::minmax({-v, Real(0)});
            v += std::clamp(given_by_new / mass, least, most);
        }
    };
    for (int a = 0; a < Dim; ++a) {
        const auto& slaved = extension.carried(a);
        const auto of_plane = [&](Index plane) { load(a, slaved[static_cast<std::size_t>(plane)]); };
        parallel_for(static_cast<Index>(slaved.size()), of_plane, block_of_planes);
    }
    extension.lead(velocity);
}

}  // namespace abrade::detail
