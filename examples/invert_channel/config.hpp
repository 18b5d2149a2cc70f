#pragma once
// What the TOML file of the invert channel says, checked and in the library's own terms.

#include "../common/chosen_wear.hpp"
#include "../common/parameter.hpp"

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/coupling/drag/drag.hpp>
#include <abrade/dem/laws/elastic_plastic_hertz.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/fluid/uniform_flow.hpp>
#include <abrade/sim/scene/scene.hpp>

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace abrade::examples {

/// Where the result is compared, and with what.
struct Comparison {
    Real gauge = 0;                  ///< x where passing sediment is counted [m]
    Real from = 0, to = 0;           ///< section of the centre line [m]
    Real half_width = 0;             ///< of the strip that counts as the centre [m]
    std::vector<Real> gauges;        ///< x where the volume that has passed is recorded [m]
    std::vector<Real> converted;     ///< volumes at which the bed is kept; the last ends the run [m3]
    bool hops = true;                ///< whether hops of stones are recorded
    std::filesystem::path measured;  ///< CSV of the user's own points, or empty
};

/// Which water runs down the channel, and what it needs beyond Manning's formula.
struct WaterChoice {
    std::string model;            ///< a name of `channel_fluids`
    std::string surface;          ///< of a grid's water: volume or height
    bool energy = true;           ///< whether a grid's water keeps its energy account
    Real spacing = 0;             ///< of a grid [m]; 0: none
    std::string exchange;         ///< of momentum with stones, on a grid; a name of `exchanges`
    Real resolved_from = 0;       ///< stones that it flows around: of so many cells to a diameter
    Real inflow_depth = 0;        ///< at the centre line [m]; 0: of uniform flow
    bool begins_uniform = false;  ///< or dry
    Real settle = 0;              ///< before the stones begin [s]
};

struct ChannelConfig {
    static constexpr Real ceiling = 5;  ///< over the invert, which stones must not reach [m]
    std::string title;
    std::string source;  ///< the TOML file
    Invert invert;
    LatticeSize lattice;
    ConcreteBlock concrete;             ///< but for its lattice
    std::string contact_law, wear_law;  ///< as in the file
    std::variant<LinearHysteretic::Params, LinearSpring::Params, ElasticPlasticHertz::Params> contact;
    MohrCoulomb::Params bond;
    ChosenWear wear{ChosenWear::Params{}};
    UniformFlow::Params water;
    WaterChoice fluid;
    CliftGauvin::Params drag;
    FeedParams feed;
    Comparison comparison;
    Real end_time = 0, output_every = 0, time_step = 0, safety = 0, skin = 0;
    Real checkpoint_every = 0;          ///< of wall time [min]
    std::vector<Parameter> parameters;  ///< all that was read, for the report
    std::vector<std::string> notes;     ///< on what was given and has no use
};

/// The name of a level, of what becomes of worn-out spheres, of a way that excess goes; as in the file.
std::string name_of(ConcreteLevel level);
std::string name_of(WornOut worn_out);
std::string name_of(const Overflow& overflow);

/// Reads and checks a file; `overrides` are "section.key=value". Throws InputError.
ChannelConfig read_channel_config(const std::filesystem::path& file,
                                  const std::vector<std::string>& overrides);

}  // namespace abrade::examples
