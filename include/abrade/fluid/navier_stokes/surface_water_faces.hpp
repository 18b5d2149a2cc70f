#pragma once
// Faces at and beside the surface: their advecting flux in a stage, what slaved ones give to master faces.

#include <abrade/fluid/navier_stokes/surface_water_class.hpp>

namespace abrade::detail {

template <int Dim, class Liquid>
void SurfaceWater<Dim, Liquid>::carry_by(const FaceField<Dim>& stage, Real step) {
    const Real full = liquid_.full();
    const LevelTable<Dim, Real> volumes(*grid_, [&](int k) {
        CellNumber<Dim> cell{};
        cell[vertical] = k;
        return grid_->volume(cell);
    });
    for (int a = 0; a < Dim; ++a) {
        const LevelTable<Dim, Real> swept(*grid_, [&](int k) {
            CellNumber<Dim> cell{};
            cell[vertical] = k;
            return step * grid_->volume(cell) / grid_->size(a, cell[a]);
        });
        const Offset back = layout().stride[a];
        rows_.for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = layout().row_start(plane, row);
            Real* const __restrict c = liquid_.volume_flux()[a].data() + start;
            const Real* const __restrict v = stage[a].data() + start;
            const Real* const __restrict f = liquid_fraction().data() + start;
            const Real* const __restrict f_back = f - back;
            const Real* const __restrict g = before_.data() + start;
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
        join(liquid_.volume_flux()[a]);
    }
}

template <int Dim, class Liquid>
void SurfaceWater<Dim, Liquid>::load_masters(FaceField<Dim>& velocity, const Field<std::uint8_t>& was_wet) {
    const auto load = [&](int a, const auto& slaved) {
        for (auto first = slaved.begin(), last = first; first != slaved.end(); first = last) {
            Real& v = velocity[a][first->master];
            Real mass = liquid_of(a, first->master), given = 0, given_by_new = 0;
            for (; last != slaved.end() && last->master == first->master; ++last) {
                const bool is_new = was_wet[last->face] != 0 || was_wet[last->face - layout().stride[a]] != 0;
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
        const auto& slaved = extension_.carried(a);
        const auto of_plane = [&](Index plane) { load(a, slaved[static_cast<std::size_t>(plane)]); };
        parallel_for(static_cast<Index>(slaved.size()), of_plane, block_of_planes);
    }
    extension_.lead(velocity);
}

template <int Dim, class Liquid>
Real SurfaceWater<Dim, Liquid>::liquid_of(int a, Offset face) const noexcept {
    CellNumber<Dim> cell = layout().number(face);
    const Real above = liquid_fraction()[face] * grid_->volume(cell);
    --cell[a];
    return 0.5 * (above + liquid_fraction()[face - layout().stride[a]] * grid_->volume(cell));
}

template <int Dim, class Liquid>
void SurfaceWater<Dim, Liquid>::find_rows() {
    const WetRows<Dim>& wet = liquid_.wet();
    rows_ = wet.dilated(VelocityExtension<Dim>::layers, boundaries_.periodic_axes());
    for (int a = 0; a < Dim; ++a) {
        const int first = boundaries_.periodic(a) ? 0 : 1;  // a face at a side is the side's
        faces_[a].for_each_plane([&](int plane) {
            for (int row = 0; row < layout().rows_per_plane(); ++row) {
                RowRange r = wet.row(plane, row);
                const int number = a == outer ? plane : row;
                if (a == inner) {
                    const int n = layout().row_length();
                    const bool around = first == 0 && r.end == n;  // its upper face is the row's first
                    if (!r.empty()) r = {around ? 0 : std::max(first, r.begin), std::min(n, r.end + 1)};
                } else if (number < first) {
                    r = {};
                } else {
                    const int below = number > 0 ? number - 1 : layout().cells[a] - 1;
                    r = hull(r, a == outer ? wet.row(below, row) : wet.row(plane, below));
                }
                faces_[a].row(plane, row) = r;
            }
        });
        faces_[a].share_out();
    }
}

}  // namespace abrade::detail
