#pragma once
// What a run of the invert channel came to, as plain numbers: made by main, read by pictures and report.

#include "config.hpp"

#include "../common/metrics.hpp"

#include <abrade/core/fields.hpp>

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abrade::examples {

/// One sphere of a stone or of loose concrete, or of the standing surface, at the end.
struct DrawnSphere {
    Vec3 centre = Vec3::Zero();  ///< [m]
    Real radius = 0;             ///< [m]
    Real fracture = -1;          ///< gamma_f of concrete; -1 for a stone
};

/// A curve of the ledger over time.
struct LedgerHistory {
    std::vector<std::string> names;
    std::vector<Real> time;                 ///< [s]
    std::vector<std::vector<Real>> values;  ///< [name][time] [J]

    static void fields(auto&& field) {
        field("names", &LedgerHistory::names), field("time", "s", &LedgerHistory::time),
            field("values", "J", &LedgerHistory::values);
    }
};

/// The water of a run.
struct ChannelWater {
    Real depth_m = 0, speed_m_per_s = 0;  ///< at the centre line, and mean; as the stones begin
    Real froude = 0, bed_shear_Pa = 0;
    Real manning_depth_m = 0, manning_speed_m_per_s = 0;  ///< of uniform flow
    /// Its surface along the centre line at the end [m].
    std::vector<Real> surface_x, surface_z;
    /// Of water that is reckoned: depth at the end [m], [row x column] from the right wall on.
    std::vector<Real> depth_map;
    Index columns = 0;
    std::vector<std::pair<std::string, Real>> figures;  ///< more that is known of it, for the summary

    /// The larger deviation from Manning's depth and speed [-].
    Real off_manning() const {
        return std::max(std::abs(depth_m / manning_depth_m - 1),
                        std::abs(speed_m_per_s / manning_speed_m_per_s - 1));
    }
    static constexpr Real settled_within = 0.1;

    /// What was seen as the stones began.
    static void fields(auto&& field) {
        field("depth_m", "m", &ChannelWater::depth_m),
            field("speed_m_per_s", "m/s", &ChannelWater::speed_m_per_s),
            field("froude", &ChannelWater::froude), field("bed_shear_Pa", "Pa", &ChannelWater::bed_shear_Pa);
    }
};

/// Abrasion depth, in plan and per volume of converted sediment.
struct BedDepth {
    std::vector<Real> depth_m;              ///< [along x across]
    std::vector<Real> x_m, y_m;             ///< [along], [across] of the columns
    std::vector<Real> centre_depth_per_m3;  ///< [along] over what has passed there; NaN: nothing has [mm/m3]
    std::vector<Real> across_depth_m;       ///< [across] mean over the compared section
    std::vector<Real> across_depth_per_m3;  ///< the same over what has passed each place [mm/m3]
    Real centre_mean_per_m3 = 0;            ///< over the compared section [mm/m3]
    Real max_depth_m = 0, band_width_m = 0;

    static void fields(auto&& field) {
        field("depth_m", "m", &BedDepth::depth_m), field("x_m", "m", &BedDepth::x_m),
            field("y_m", "m", &BedDepth::y_m),
            field("centre_depth_per_m3", "mm/m3", &BedDepth::centre_depth_per_m3),
            field("across_depth_m", "m", &BedDepth::across_depth_m),
            field("across_depth_per_m3", "mm/m3", &BedDepth::across_depth_per_m3),
            field("centre_mean_per_m3", "mm/m3", &BedDepth::centre_mean_per_m3),
            field("max_depth_m", "m", &BedDepth::max_depth_m),
            field("band_width_m", "m", &BedDepth::band_width_m);
    }
};

/// The bed as a converted volume had passed a place.
struct Milestone {
    Real converted_m3 = 0, past_m = 0, time_s = 0;
    BedDepth bed;

    static void fields(auto&& field) {
        field("converted_m3", "m3", &Milestone::converted_m3), field("past_m", "m", &Milestone::past_m),
            field("time_s", "s", &Milestone::time_s), field("bed", &Milestone::bed);
    }
};

/// Solid volume that has passed places over time.
struct PassedHistory {
    std::vector<Real> x_m, time_s;
    std::vector<std::vector<Real>> passed_m3;  ///< [x][time]

    static void fields(auto&& field) {
        field("x_m", "m", &PassedHistory::x_m), field("time_s", "s", &PassedHistory::time_s),
            field("passed_m3", "m3", &PassedHistory::passed_m3);
    }
};

/// How stones of one size travel: means over looks at those in the compared section, and over hops that end
/// there. NaN: there were none.
struct TravelOfSize {
    Real size_m = 0;
    Index looks = 0;
    Real speed_m_per_s = 0;
    Real off_bed_share = 0;  ///< touches no concrete
    Real clear_share = 0;    ///< is farther from the bed than a tenth of its size
    Index hops = 0;          ///< higher than that
    Real hop_height_m = 0, hop_length_m = 0;
};

/// What the source says of its own run: how much it had fed and how much had passed the place at which it
/// compares (91 m3 of converted sediment over beta), presumably at the end.
struct SourceRun {
    Real end_s = 25, fed_m3 = 0.2075, past_m = 10, passed_m3 = 0.019;
};

struct ChannelResults {
    bool stopped = false;  ///< by a signal
    bool worn_through = false;
    Real wall_s = 0, simulated_s = 0, represented_h = 0, time_step_s = 0, stable_time_step_s = 0;
    Index steps = 0, stones = 0, stones_fed = 0, concrete_spheres = 0, bonds_broken = 0;
    int threads = 1;
    Real sediment_fed_m3 = 0, sediment_passed_m3 = 0, converted_sediment_m3 = 0;
    Real worn_volume_m3 = 0, overflow_volume_m3 = 0, detached_volume_m3 = 0;
    /// What the energy lost wears; NaN for other laws than sub-particle abrasion.
    Real worn_volume_from_energy_m3 = std::numeric_limits<Real>::quiet_NaN();
    Real largest_collision_share = 0;  ///< of a cell's volume that one collision wore
    Real largest_safe_beta = 0;        ///< at which that would have been 1/2; infinite where nothing wore
    Real mean_depth_mm = 0;
    Real energy_lost_normal_J = 0, energy_lost_sliding_J = 0;  ///< in contacts with concrete
    Real ledger_residual_relative = 0, integration_residue_J = 0;
    Real mean_stone_speed_m_per_s = 0;  ///< at the end
    /// In the compared section, means over looks; NaN: no stone came there. Off the bed: touches no concrete.
    Real sampled_stone_speed_m_per_s = 0, stones_off_bed_share = 0;
    Real waiting_volume_m3 = 0;         ///< told to wear, its epoch has not ended
    Index spheres_let_go = 0;           ///< that bonds no longer held
    bool breaks_by_blows = false;       ///< bonds gave way to blows rather than to wear
    Index spheres_worn_out = 0;         ///< fully fractured; of a recorded bed: whose cell was used up
    Real restitution_at_1_m_per_s = 0;  ///< of the middle stone on concrete
    Real wall_contacts_s = 0, wall_bonds_s = 0, wall_motion_s = 0, wall_lists_s = 0, wall_fluid_s = 0;
    std::optional<ChannelWater> water;
    std::string fluid, contact, bond, wear;  ///< names of the policies

    BedDepth bed;
    Index along = 0, across = 0;
    // Across the compared section, sampled at the looks of `BedRecord`; each kind sums up to 1, impacts and
    // sliding together.
    std::vector<Real> stones_across;   ///< [across] volume x time of stones [-]
    std::vector<Real> impacts_across;  ///< [across] energy that contacts with concrete take, normal [-]
    std::vector<Real> sliding_across;  ///< [across] and tangential [-]
    std::vector<TravelOfSize> travel;  ///< [class of stones]
    PassedHistory passed;
    std::vector<Milestone> milestones;
    std::vector<DrawnSphere> spheres;
    LedgerHistory ledger;

    /// All that wear was told, over what the energy lost gives: 1 but for round-off.
    Real worn_over_energy() const {
        return (worn_volume_m3 + overflow_volume_m3 + waiting_volume_m3) / worn_volume_from_energy_m3;
    }
    Real impact_share() const {  ///< of the losses on concrete [-]
        return energy_lost_normal_J / (energy_lost_normal_J + energy_lost_sliding_J);
    }
    Real passed_share() const { return sediment_passed_m3 / sediment_fed_m3; }  ///< the gauge, of all fed [-]
};

/// What the level of fluid costs and what it gives: each of `fluid_metrics`.
inline std::array<Real, fluid_metrics.size()> level_figures(const ChannelResults& r) {
    static_assert(fluid_metrics ==
                  std::array<std::string_view, 6>{"wall_s", "centre_depth_mm_per_m3", "energy_lost_normal_J",
                                                  "energy_lost_sliding_J", "sampled_stone_speed_m_per_s",
                                                  "stones_off_bed_share"});
    return {r.wall_s,
            r.bed.centre_mean_per_m3,
            r.energy_lost_normal_J,
            r.energy_lost_sliding_J,
            r.sampled_stone_speed_m_per_s,
            r.stones_off_bed_share};
}

/// What physics allows for the centre line of a worn band: depth per converted sediment [mm/m3].
/// Lower: only the normal impacts of saltating stones; upper: all stones sliding under their submerged weight
/// at mu = 0.3, half the energy in the concrete. Both are for a strip 1 m wide.
struct Bracket {
    Real low = 0.01, high = 0.27;
    Bracket per_width(Real width) const { return {low / width, high / width}; }
};

}  // namespace abrade::examples
