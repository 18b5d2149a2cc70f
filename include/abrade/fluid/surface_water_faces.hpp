#pragma once
// Faces at and beside the surface: what carries them in a stage, how they begin, what shear does to them.

#include <abrade/fluid/surface_water_class.hpp>

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
            Real* const __restrict c = liquid_.moved()[a].data() + start;
            const Real* const __restrict v = stage[a].data() + start;
            const Real* const __restrict f = held().data() + start;
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
        join(liquid_.moved()[a]);
    }
}

template <int Dim, class Liquid>
void SurfaceWater<Dim, Liquid>::begin_faces(FaceField<Dim>& u, const FaceField<Dim>& before,
                                            const Field<std::uint8_t>& was_wet,
                                            const Point<Dim>& fallen) const {
    if (!walls_) return;
    for (const Index c : liquid_.planes().cell) {
        if (wet_[c] == 0 || was_wet[c] != 0 || walls_->open_volume()[c] == 1) continue;
        const CellNumber<Dim> cell = layout().number(c);
        for (int a = 0; a < Dim; ++a)
            for (const int end : {0, 1}) {
                const Offset s = layout().stride[a], face = c + end * s, other = face - (1 - end) * s;
                const int number = cell[a] + end;
                const bool at_side = number == 0 || number == grid_->cells(a);
                if ((at_side && !sides_.periodic(a)) || was_wet[other] != 0 ||
                    walls_->open_area()[a][face] == 0)
                    continue;
                const Offset inside = face - (number == grid_->cells(a) ? number * s : 0);
                u[a][inside] = before[a][inside] + fallen[a];
            }
    }
}

template <int Dim, class Liquid>
void SurfaceWater<Dim, Liquid>::share_shear(FaceField<Dim>& result, const FaceField<Dim>& by, Real viscous) {
    parallel_tasks(Dim, [&](Index component) {
        const int a = static_cast<int>(component);
        Field<Real>& burden = burden_[a];
        const Offset back = layout().stride[a];
        const auto mass = [&](Offset c) { return 0.5 * (held()[c] + held()[c - back]); };
        const auto& riders = extension_.riders(a);
        for (const auto& r : riders) burden[r.carrier] += r.share * mass(r.face);
        for (const auto& r : riders) {
            const Real own = mass(r.carrier), more = std::exchange(burden[r.carrier], 0);
            // Little liquid has bounds of its own in momentum; beside walls shear acts on open shares
            // only.
            if (more == 0 || own < 0.5 || (walls_ && is_cut(r.carrier, back))) continue;
            const CellNumber<Dim> cell = layout().number(r.carrier);
            if ((cell[a] == 0 && !sides_.periodic(a)) || cell[a] >= grid_->cells(a)) continue;
            Real shear = 0;
            for (int b = 0; b < Dim; ++b) {
                const int n = cell[b];
                const Offset s = layout().stride[b], c = r.carrier;
                const Real below = a == b ? grid_->size(b, n - 1) : grid_->gap(b, n),
                           above = a == b ? grid_->size(b, n) : grid_->gap(b, n + 1);
                shear += ((by[a][c + s] - by[a][c]) / above - (by[a][c] - by[a][c - s]) / below) /
                         (a == b ? grid_->gap(b, n) : grid_->size(b, n));
            }
            result[a][r.carrier] -= viscous * shear * (1 / own - 1 / (own + more));
        }
    });
}

template <int Dim, class Liquid>
void SurfaceWater<Dim, Liquid>::weigh_reached(FaceField<Dim>& velocity, const Point<Dim>& fall) const {
    for (int a = 0; a < Dim; ++a) {
        if (fall[a] == 0) continue;
        Offset last = -1;  // a face has as many riders as carriers, one after the other
        for (const auto& r : extension_.riders(a)) {
            if (r.face == std::exchange(last, r.face)) continue;
            if (walls_ && is_cut(r.face, layout().stride[a])) continue;
            if ((wet_[r.face] | wet_[r.face - layout().stride[a]]) != 0) velocity[a][r.face] += fall[a];
        }
    }
}

}  // namespace abrade::detail
