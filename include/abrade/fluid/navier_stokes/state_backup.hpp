#pragma once
// What a step below a surface began with: to go back to, and to tell how the velocity changes.

#include <abrade/fluid/navier_stokes/step_history.hpp>
#include <abrade/fluid/navier_stokes/surface_water.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace abrade::detail {

template <int Dim, class Liquid = VolumeOfFluid<Dim>>
class StateBackup {
public:
    StateBackup() = default;
    /// At the start; `acceleration`: of the water as it stands [m/s2].
    StateBackup(const Grid<Dim>& grid, const FaceField<Dim>& velocity, const FaceField<Dim>& acceleration,
                const SurfaceWater<Dim, Liquid>& water)
        : rows_(water.rows()), velocity_(velocity), change_(face_field<Dim, float>(grid.layout())),
          pressure_(water.wet().size()), wet_(water.wet()), fraction_(water.liquid().fraction()),
          volume_defect_(water.liquid().volume_defect()) {
        for (int a = 0; a < Dim; ++a) {
            for (Offset c = 0; c < change_[a].size(); ++c)
                change_[a][c] = static_cast<float>(acceleration[a][c]);
            size_[a] = grid.smallest(a);
        }
    }

    /// Keeps what there is before a step of dt [s], and leads: returns whether the velocity has changed.
    ///
    /// Liquid and velocity leap over each other, so the velocity stands half a step ahead. At the start it is
    /// moved there; where the length of the step changes so does that, and water is moved on with its
    /// acceleration in the last step. Or waves would gain energy by steps that follow their speed. No further
    /// than a quarter of a cell: an impact's acceleration does not go on. In a step that is brief beside late
    /// ones the velocity stays where it stands, half of those ahead.
    bool keep_and_lead(FaceField<Dim>& velocity, const Field<Real>& pressure,
                       const SurfaceWater<Dim, Liquid>& water, const StepHistory& history, Real dt) {
        const WetRows<Dim> before = std::exchange(rows_, water.rows());
        const auto bounded = [](Real x, Real most) {
            const Real below = x > most ? most : x;
            return below < -most ? -most : below;
        };
        const bool begins = history.last == 0;
        sub_step_ = history.is_sub_step(dt);
        const Real knows = begins || was_sub_step_ || (restored_ && known_) ? 1 : 0;
        const Real per_last = begins ? 0 : 1 / history.last;
        // An equal step that went wrong has not found the change; a later one catches up.
        const bool waits = sub_step_ || (restored_ && !known_);
        const Real led = std::exchange(lead_, waits ? 0 : 0.5 * dt - ahead_);
        const Real led_far = std::exchange(far_, begins ? std::numeric_limits<Real>::infinity() : 0.25);
        known_ = lead_ != 0 || led != 0 || sub_step_;
        if (!known_) rows_.copy(velocity, velocity_);  // equal steps
        for (int a = 0; a < Dim && known_; ++a) {
            const Real most = far_ * size_[a] / dt, led_most = led_far * size_[a] / history.last;
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
                float* const __restrict changes = change_[a].data() + start;
                // What is given to air is no change of its own.
                const int begin = std::max(r.begin, known.begin), end = std::min(r.end, known.end);
                constexpr int lanes = Layout<Dim>::lanes;
                for (int first = Layout<Dim>::pack(r.begin); first < r.end; first += lanes)
#pragma omp simd
                    for (int i = first; i < first + lanes; ++i) {
                        const int of_water = (wet[i] | wet_back[i]) & (was_wet[i] | was_wet_back[i]);
                        const Real stays = (i >= begin ? 1 : 0) * (i < end ? 1 : 0) * of_water;
                        const Real last = static_cast<Real>(changes[i]);
                        const Real began = kept[i] + bounded(led * last, led_most);
                        const Real rate = (now[i] - began) * per_last;
                        const auto change = static_cast<float>(stays * (knows * last + (1 - knows) * rate));
                        kept[i] = now[i];
                        changes[i] = change;
                        now[i] += bounded(lead_ * static_cast<Real>(change), most);
                    }
            });
        }
        rows_.copy(water.wet(), wet_);
        water.join(wet_);
        rows_.copy(pressure, pressure_);
        rows_.copy(water.liquid().fraction(), fraction_);
        rows_.copy(water.liquid().volume_defect(), volume_defect_);
        steps_ = water.liquid().steps();
        restored_ = false;
        return lead_ != 0;
    }

    /// Takes the lead back: where water is thrown about it may drive out more than cells hold. A later step
    /// catches up.
    void stay(FaceField<Dim>& velocity) {
        rows_.copy(velocity_, velocity);
        lead_ = 0;
    }

    /// Before the last step, and before it was moved on.
    const FaceField<Dim>& velocity() const noexcept { return velocity_; }
    const Field<std::uint8_t>& wet() const noexcept { return wet_; }
    /// To another pressure, a share of what was more than that before the last step.
    void add_excess(Field<Real>& pressure, Real share) const {
        rows_.for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = rows_.layout().row_start(plane, row);
            for (Offset c = start + r.begin; c < start + r.end; ++c)
                pressure[c] += share * (pressure_[c] - pressure[c]);
        });
    }
    void took() noexcept { ahead_ += lead_, was_sub_step_ = sub_step_; }

    /// Puts all of it back.
    void restore(FaceField<Dim>& velocity, Field<Real>& pressure, SurfaceWater<Dim, Liquid>& water) {
        rows_.copy(velocity_, velocity);
        rows_.copy(pressure_, pressure);
        water.restore(fraction_, volume_defect_, rows_, steps_);
        restored_ = true;
    }

    static void fields(auto&& field) {
        field("rows", &StateBackup::rows_), field("velocity", "m/s", &StateBackup::velocity_),
            field("change", "m/s2", &StateBackup::change_),
            field("pressure", "m2/s2", &StateBackup::pressure_), field("wet", &StateBackup::wet_),
            field("fraction", &StateBackup::fraction_), field("volume_defect", &StateBackup::volume_defect_),
            field("steps", &StateBackup::steps_), field("ahead", "s", &StateBackup::ahead_),
            field("lead", "s", &StateBackup::lead_), field("far", &StateBackup::far_),
            field("sub_step", &StateBackup::sub_step_), field("was_sub_step", &StateBackup::was_sub_step_),
            field("known", &StateBackup::known_), field("restored", &StateBackup::restored_);
    }

private:
    Point<Dim> size_;               ///< of the smallest cells [m]
    WetRows<Dim> rows_;             ///< where it is kept
    FaceField<Dim> velocity_;       ///< before it was moved on
    FaceField<Dim, float> change_;  ///< acceleration in late steps [m/s2]
    Field<Real> pressure_;
    Field<std::uint8_t> wet_;
    Field<Real> fraction_, volume_defect_;
    Index steps_ = 0;
    Real ahead_ = 0;                                ///< by which the velocity stands ahead of the water [s]
    Real lead_ = 0;                                 ///< by which the velocity was moved on with it [s]
    Real far_ = 0;                                  ///< no further than this [cell]
    bool sub_step_ = false, was_sub_step_ = false;  ///< the step, the one before
    bool known_ = false;                            ///< the change was found in the last step
    bool restored_ = false;                         ///< and it is that of the present velocity
};

}  // namespace abrade::detail
