#pragma once
// Faces at and beside the surface: what carries them in a stage, what they give to others.

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
void SurfaceWater<Dim, Liquid>::load_carriers(FaceField<Dim>& velocity, const Field<std::uint8_t>& was_wet) {
    parallel_tasks(Dim, [&](Index component) {
        const int a = static_cast<int>(component);
        // Riders of a carrier come one after the other: its mass grows by each.
        for (const auto& r : extension_.riders(a)) {
            Real& v = velocity[a][r.carrier];
            const Real faster = velocity[a][r.face] - v;
            const bool begins = was_wet[r.face] != 0 || was_wet[r.face - layout().stride[a]] != 0;
            if (begins && faster * v > 0) continue;
            Real& more = burden_[a][r.carrier];
            const Real has = liquid_of(a, r.carrier) + more;
            const Real adds = r.share * liquid_of(a, r.face);
            if (has + adds > 0) v += faster * adds / (has + adds);
            more += adds;
        }
        for (const auto& r : extension_.riders(a)) burden_[a][r.carrier] = 0;
    });
    extension_.lead(velocity);
}

template <int Dim, class Liquid>
Real SurfaceWater<Dim, Liquid>::liquid_of(int a, Offset face) const noexcept {
    CellNumber<Dim> cell = layout().number(face);
    const Real above = held()[face] * grid_->volume(cell);
    --cell[a];
    return 0.5 * (above + held()[face - layout().stride[a]] * grid_->volume(cell));
}

}  // namespace abrade::detail
