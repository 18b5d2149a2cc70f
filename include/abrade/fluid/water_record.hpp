#pragma once
// What a step below a surface began with: to go back to, and to tell how the velocity changes.

#include <abrade/fluid/surface_water.hpp>

#include <algorithm>
#include <utility>

namespace abrade::detail {

template <int Dim>
class WaterRecord {
public:
    WaterRecord() = default;
    /// At the start; `acceleration`: of the water as it stands [m/s2].
    WaterRecord(const FaceField<Dim>& velocity, const FaceField<Dim>& acceleration,
                const SurfaceWater<Dim>& water)
        : rows_(water.rows()), velocity_(velocity), pressure_(water.wet().size()), wet_(water.wet()),
          fraction_(water.liquid().fraction()), surplus_(water.liquid().surplus()) {
        for (int a = 0; a < Dim; ++a)
            for (Offset c = 0; c < velocity_[a].size(); ++c) velocity_[a][c] -= acceleration[a][c];
    }

    /// Keeps what there is before a step of dt [s], and leads: returns whether the velocity has changed.
    ///
    /// Liquid and velocity leap over each other, so the velocity stands half a step ahead. At the start it is
    /// moved there; where the length of the step changes so does that, and water is moved on by its last
    /// change. Or waves would gain energy by steps that follow their speed.
    bool keep(FaceField<Dim>& velocity, const Field<Real>& pressure, const SurfaceWater<Dim>& water,
              Real dt) {
        const WetRows<Dim> before = std::exchange(rows_, water.rows());
        // At the start what was kept lacks the acceleration of one second.
        const Real lead = last_step_ == 0 ? 0.5 * dt : std::clamp(0.5 * (dt / last_step_ - 1), -0.5, 0.5);
        for (int a = 0; a < Dim; ++a) {
            const Offset back = rows_.layout().stride[a];
            rows_.for_each_row([&](int plane, int row, const RowRange& r) {
                const Offset start = rows_.layout().row_start(plane, row);
                const RowRange known = before.row(plane, row);
                const std::uint8_t* const __restrict wet = water.wet().data() + start;
                const std::uint8_t* const __restrict wet_back = wet - back;
                const std::uint8_t* const __restrict was_wet = wet_.data() + start;
                const std::uint8_t* const __restrict was_wet_back = was_wet - back;
                Real* const __restrict now = velocity[a].data() + start;
                Real* const __restrict kept = velocity_[a].data() + start;
                // What is given to air is no change of its own.
                const int begin = std::max(r.begin, known.begin), end = std::min(r.end, known.end);
                constexpr int lanes = Layout<Dim>::lanes;
                for (int first = Layout<Dim>::pack(r.begin); first < r.end; first += lanes)
#pragma omp simd
                    for (int i = first; i < first + lanes; ++i) {
                        const int of_water = (wet[i] | wet_back[i]) & (was_wet[i] | was_wet_back[i]);
                        const Real old = kept[i], change = now[i] - old;
                        const bool stays = of_water != 0 && i >= begin && i < end;
                        kept[i] = now[i];
                        now[i] += lead * (stays ? change : 0);
                    }
            });
        }
        rows_.copy(water.wet(), wet_);
        rows_.copy(pressure, pressure_);
        rows_.copy(water.liquid().fraction(), fraction_);
        rows_.copy(water.liquid().surplus(), surplus_);
        return lead != 0;
    }

    /// Before the last step, and before it was moved on.
    const FaceField<Dim>& velocity() const noexcept { return velocity_; }
    const Field<std::uint8_t>& wet() const noexcept { return wet_; }
    void took(Real dt) noexcept { last_step_ = dt; }

    /// Puts all of it back.
    void restore(FaceField<Dim>& velocity, Field<Real>& pressure, SurfaceWater<Dim>& water) const {
        rows_.copy(velocity_, velocity);
        rows_.copy(pressure_, pressure);
        water.restore(fraction_, surplus_, rows_);
    }

private:
    WetRows<Dim> rows_;  ///< where it is kept
    FaceField<Dim> velocity_;
    Field<Real> pressure_;
    Field<std::uint8_t> wet_;
    Field<Real> fraction_, surplus_;
    Real last_step_ = 0;  ///< [s]
};

}  // namespace abrade::detail
