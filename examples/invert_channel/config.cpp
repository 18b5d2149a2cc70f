#include "config.hpp"
#include "fluids.hpp"
#include "water_start.hpp"

#include "../common/toml_reader.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace abrade::examples {

namespace {

constexpr std::array<std::string_view, 3> levels{"static", "rigid", "dynamic"},
    contact_laws{"hysteretic", "linear", "elastic_plastic"}, exchanges{"monolithic", "mixture", "direct"};
constexpr std::array<std::string_view, 4> worn_outs{"fines", "grain", "recorded", "recedes"},
    overflows{"crater", "patch", "epoch", "drop"};
constexpr std::array<std::string_view, 4> wear_laws{"sub_particle", "archard", "ishibashi", "none"};

constexpr std::string_view heaviest = "quartz has 2650 kg/m3, gold 19300";

/// Throws InputError where a key is given that the choice made does not use.
void refuse(const TomlReader& in, std::initializer_list<const char*> keys, const std::string& choice) {
    for (const char* key : keys)
        if (in.has(key))
            fail({in.where(key) + ": " + key, "left out: " + choice + " has no use for it"}, "a value");
}

void read_channel(TomlReader& in, ChannelConfig& c) {
    c.invert.length =
        in.number("channel.length", {.unit = "m", .help = "length of the reach", .bound = Bound::positive});
    c.invert.slope =
        in.number("channel.slope", {.unit = "m/m", .fallback = 0.05, .help = "1:20 in the experiment"});
    c.invert.width =
        in.number("channel.width", {.unit = "m",
                                    .fallback = 1.0,
                                    .help = "between the walls",
                                    .assumption = "the paper shows the section only as a picture",
                                    .bound = Bound::positive});
    c.invert.arc_radius =
        in.number("channel.arc_radius", {.unit = "m",
                                         .fallback = 1.0,
                                         .help = "of the concave invert",
                                         .assumption = "the paper shows the section only as a picture",
                                         .bound = Bound::positive});
}

void read_concrete(TomlReader& in, ChannelConfig& c) {
    c.lattice.sphere_diameter =
        in.number("concrete.sphere_diameter", {.unit = "m",
                                               .fallback = 0.02,
                                               .help = "of the bonded spheres",
                                               .assumption = "\"spheres of 0.02 m\" is read as the diameter",
                                               .bound = Bound::positive});
    const auto layers = in.integer("concrete.layers", {.fallback = 3,
                                                       .help = "of spheres; the deepest is fixed",
                                                       .assumption = "not in the text",
                                                       .bound = Bound::positive});
    require(layers <= 1000, {in.where("concrete.layers") + ": concrete.layers", "at most 1000"},
            static_cast<Real>(layers));
    c.lattice.layers = static_cast<Index>(layers);
    c.concrete.density = in.number("concrete.density", {.unit = "kg/m3",
                                                        .fallback = 2400,
                                                        .help = "of the spheres",
                                                        .least = 1,
                                                        .most = 3e4,
                                                        .remedy = heaviest});
    const auto level =
        in.choice("concrete.level", levels,
                  {.fallback = "static",
                   .help = "static: spheres stand, bonds are checked by equilibrium; rigid: they stand "
                           "whatever presses; dynamic: they move on their bonds"});
    c.concrete.level = level == "static"  ? ConcreteLevel::quasi_static
                       : level == "rigid" ? ConcreteLevel::rigid
                                          : ConcreteLevel::dynamic;
    c.concrete.cluster = static_cast<Index>(
        in.integer("concrete.cluster", {.fallback = 0,
                                        .help = "bonds about a loaded sphere within which all give way",
                                        .bound = Bound::not_negative}));
    require(c.concrete.cluster == 0 || level == "static",
            {in.where("concrete.cluster") + ": concrete.cluster", "0 unless concrete.level is \"static\"",
             "bonds", "leave it out"},
            c.concrete.cluster);
    require(c.concrete.cluster <= 2,
            {in.where("concrete.cluster") + ": concrete.cluster", "at most 2", "bonds",
             "0 lets the loaded sphere alone give way; each bond more costs much"},
            c.concrete.cluster);
    const auto worn_out =
        in.choice("concrete.worn_out", worn_outs,
                  {.fallback = "fines",
                   .help = "fines: a fully worn sphere vanishes; recedes: and until then it sinks as it "
                           "wears; grain: it stays as a loose grain; recorded: wear is written down on a "
                           "bed that stays as it is"});
    c.concrete.worn_out = worn_out == "fines"     ? WornOut::fines
                          : worn_out == "recedes" ? WornOut::recedes
                          : worn_out == "grain"   ? WornOut::grain
                                                  : WornOut::recorded;
    if (c.concrete.worn_out == WornOut::recedes && level == "dynamic")
        fail({in.where("concrete.worn_out") + ": concrete.worn_out", "another where concrete moves", "",
              "take concrete.level = \"static\", or worn_out = \"fines\""},
             worn_out);
    c.bond.tensile =
        in.number("concrete.tensile",
                  {.unit = "Pa", .fallback = 2.7e6, .help = "strength sigma_t0", .bound = Bound::positive});
    c.bond.friction_angle = in.number("concrete.friction_angle", {.unit = "degrees",
                                                                  .fallback = 35,
                                                                  .help = "slope of the yield line",
                                                                  .assumption = "not in the text"});
    c.bond.stiffness =
        in.number("concrete.stiffness",
                  {.unit = "N/m",
                   .help = "normal spring of a bond",
                   .assumption = "softer than concrete (E A/d is about 4e8 N/m) for a longer step",
                   .bound = Bound::positive});
    c.bond.stiffness_ratio = in.number("concrete.stiffness_ratio", {.fallback = 0.2,
                                                                    .help = "shear over normal spring",
                                                                    .assumption = "not in the text",
                                                                    .bound = Bound::positive});
    c.bond.damping = in.number("concrete.damping", {.fallback = 0.1,
                                                    .help = "share of critical damping of a bond",
                                                    .assumption = "not in the text",
                                                    .bound = Bound::not_negative});
    static constexpr std::array<std::string_view, 2> volumes{"cell", "sphere"};
    c.concrete.fracture_volume = in.choice("concrete.fracture_volume", volumes,
                                           {.fallback = "cell",
                                            .help = "V_omega: the lattice's cell or the sphere",
                                            .assumption = "not in the text"}) == "cell"
                                     ? FractureVolume::cell
                                     : FractureVolume::sphere;
    static constexpr std::array<std::string_view, 2> joins{"mean", "minimum"}, areas{"circle", "square"};
    c.bond.join = in.choice("concrete.join", joins,
                            {.fallback = "mean",
                             .help = "of two spheres' strengths in [3]",
                             .assumption = "equation [3] is lost"}) == "mean"
                      ? MohrCoulomb::Join::mean
                      : MohrCoulomb::Join::minimum;
    c.bond.area =
        in.choice("concrete.area", areas,
                  {.fallback = "circle", .help = "of a bond in [4]", .assumption = "equation [4] is lost"}) ==
                "circle"
            ? MohrCoulomb::Area::circle
            : MohrCoulomb::Area::square;
}

void read_contact(TomlReader& in, ChannelConfig& c) {
    c.contact_law = in.choice("contact.law", contact_laws,
                              {.fallback = "hysteretic",
                               .help = "hysteretic: loses by a dent, whatever the masses; linear: by a "
                                       "dashpot; elastic_plastic: Hertz that yields"});
    const Real friction = in.number("contact.friction", {.fallback = 0.5,
                                                         .help = "Coulomb coefficient",
                                                         .assumption = "not in the text",
                                                         .bound = Bound::not_negative});
    const std::string chosen = "contact.law = \"" + c.contact_law + "\"";
    if (c.contact_law == "elastic_plastic") {
        refuse(in, {"contact.stiffness", "contact.restitution", "contact.tangential_ratio"}, chosen);
        ElasticPlasticHertz::Params law;
        law.friction = friction, law.flat_radius = 0.5 * c.lattice.sphere_diameter;
        law.youngs = in.number("contact.youngs", {.unit = "Pa",
                                                  .fallback = 3e10,
                                                  .help = "modulus of stones and concrete",
                                                  .assumption = "usual for concrete",
                                                  .bound = Bound::positive});
        law.poisson = law.poisson_other =
            in.number("contact.poisson", {.fallback = 0.2, .help = "", .assumption = "usual for concrete"});
        law.yield_pressure = in.number("contact.yield_pressure",
                                       {.unit = "Pa",
                                        .help = "at which the concrete yields; fit it to a restitution",
                                        .assumption = "not in the text",
                                        .bound = Bound::positive});
        law.softening =
            in.number("contact.softening", {.fallback = 1e-2,
                                            .help = "share of the modulus that the run has",
                                            .assumption = "softer for a longer step; yield speed is kept",
                                            .bound = Bound::positive});
        c.contact = law;
        return;
    }
    refuse(in, {"contact.youngs", "contact.poisson", "contact.yield_pressure", "contact.softening"}, chosen);
    const Real stiffness = in.number(
        "contact.stiffness",
        {.unit = "N/m", .help = "normal spring", .assumption = "not in the text", .bound = Bound::positive});
    const Real restitution =
        in.number("contact.restitution",
                  {.fallback = 0.6, .help = "of a normal impact", .assumption = "not in the text"});
    const Real ratio = in.number("contact.tangential_ratio", {.fallback = 2.0 / 7,
                                                              .help = "tangential over normal spring",
                                                              .assumption = "not in the text",
                                                              .bound = Bound::positive});
    const auto fill = [&](auto law) {
        law.stiffness = stiffness, law.restitution = restitution, law.friction = friction;
        law.tangential_ratio = ratio;
        c.contact = law;
    };
    c.contact_law == "linear" ? fill(LinearSpring::Params{}) : fill(LinearHysteretic::Params{});
}

void read_wear(TomlReader& in, ChannelConfig& c) {
    c.wear_law = in.choice("wear.law", wear_laws,
                           {.fallback = "sub_particle", .help = "by which energy wears concrete"});
    const std::string &law = c.wear_law, chosen = "wear.law = \"" + law + "\"";
    const auto acceleration = [&] {
        return in.number(
            "wear.acceleration",
            {.fallback = 4800, .help = "beta, represented over simulated time", .bound = Bound::positive});
    };
    const auto wanted = [&](const char* key, const char* unit, const char* help) {
        return in.number(key, {.unit = unit, .help = help, .bound = Bound::not_negative});
    };
    if (law != "sub_particle") refuse(in, {"wear.normal_weight", "wear.tangential_weight"}, chosen);
    if (law != "archard") refuse(in, {"wear.hardness"}, chosen);
    if (law != "ishibashi") refuse(in, {"wear.impact", "wear.friction"}, chosen);
    if (law == "sub_particle") {
        SubParticleAbrasion::Params wear;
        wear.coefficient =
            in.number("wear.coefficient",
                      {.unit = "m3/J", .fallback = 1.1e-7, .help = "Cw", .bound = Bound::not_negative});
        wear.acceleration = acceleration();
        wear.normal_weight = in.number(
            "wear.normal_weight",
            {.fallback = 1, .help = "of impact losses; 1 is the paper", .bound = Bound::not_negative});
        wear.tangential_weight = in.number(
            "wear.tangential_weight",
            {.fallback = 1, .help = "of sliding losses; 1 is the paper", .bound = Bound::not_negative});
        c.wear = SubParticleAbrasion{wear};
    } else if (law == "archard") {
        const Real coefficient = wanted("wear.coefficient", "-", "Archard's k");
        const Real hardness = wanted("wear.hardness", "Pa", "of the concrete");
        c.wear = Archard{{.coefficient = coefficient, .hardness = hardness, .acceleration = acceleration()}};
    } else if (law == "ishibashi") {
        refuse(in, {"wear.coefficient"}, chosen);
        const Real impact = wanted("wear.impact", "m3/J", "per energy of impact"),
                   friction = wanted("wear.friction", "m3/J", "per work of friction");
        c.wear = Ishibashi{{.impact = impact, .friction = friction, .acceleration = acceleration()}};
    } else {
        in.allow("wear.coefficient");  // so that one --set turns wear off
        c.wear = ChosenWear{ChosenWear::Params{.acceleration = acceleration()}};
    }

    const auto overflow =
        in.choice("wear.overflow", overflows,
                  {.fallback = "crater",
                   .help = "where wear goes beyond its cell: nearest cells, a patch, the mean of an epoch, "
                           "or nowhere"});
    const std::string way = "wear.overflow = \"" + std::string(overflow) + "\"";
    if (overflow != "patch") refuse(in, {"wear.overflow_width"}, way);
    if (overflow != "epoch") refuse(in, {"wear.overflow_every"}, way);
    if (overflow == "patch") {
        SpreadOverPatch patch;
        patch.length = wanted("wear.overflow_length", "m", "of the patch, along the channel");
        patch.width = wanted("wear.overflow_width", "m", "of the patch, across");
        c.concrete.overflow = patch;
    } else if (overflow == "epoch") {
        SpreadByEpoch epoch;
        epoch.length = wanted("wear.overflow_length", "m", "of the strips whose mean is worn");
        epoch.every = wanted("wear.overflow_every", "s", "between two changes of the bed");
        require(epoch.every <= c.end_time,
                {in.where("wear.overflow_every") + ": wear.overflow_every",
                 "at most run.end_time (" + to_text(c.end_time) + " s)", "s",
                 "what an epoch has collected as the run ends wears nothing"},
                epoch.every);
        c.concrete.overflow = epoch;
    } else {
        refuse(in, {"wear.overflow_length"}, way);
        overflow == "crater" ? void(c.concrete.overflow = FillCrater{})
                             : void(c.concrete.overflow = DropOverflow{});
    }
}

void read_water(TomlReader& in, ChannelConfig& c) {
    c.water.section = c.invert;
    c.water.discharge = in.number(
        "water.discharge", {.unit = "m3/s", .fallback = 0.5, .help = "supply", .bound = Bound::positive});
    c.water.manning = in.number("water.manning", {.unit = "s/m^(1/3)",
                                                  .fallback = 0.015,
                                                  .help = "roughness",
                                                  .assumption = "usual for worn concrete",
                                                  .bound = Bound::positive});
    c.water.density = in.number("water.density", {.unit = "kg/m3",
                                                  .fallback = 1000,
                                                  .help = "",
                                                  .least = 500,
                                                  .most = 2000,
                                                  .remedy = "water has 1000 kg/m3"});
    c.water.viscosity = in.number("water.viscosity", {.unit = "Pa s",
                                                      .fallback = 1.31e-3,
                                                      .help = "at 10 degrees C",
                                                      .least = 1e-4,
                                                      .most = 1,
                                                      .remedy = "water has 1.31e-3 Pa s at 10 degrees C"});
    c.drag.shape_factor =
        in.number("water.drag_shape_factor", {.fallback = 1.0,
                                              .help = "on a sphere's drag coefficient",
                                              .assumption = "stones of this level of model drag like spheres",
                                              .bound = Bound::positive});
}

/// Notes what --set gives to a fluid that has no use for it; a file may keep it for another --fluid.
void note_unused(TomlReader& in, ChannelConfig& c, std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
        in.allow(key);
        if (in.overridden(key))
            c.notes.push_back(in.where(key) + ": fluid.model = \"" + c.fluid.model + "\" has no use for it");
    }
}

/// Of the choice of fluid, what the momentum exchanged with stones takes.
void read_exchange(TomlReader& in, ChannelConfig& c) {
    c.fluid.resolved_from = std::numeric_limits<Real>::infinity();
    if (c.fluid.model != "resolved") {
        refuse(in, {"fluid.exchange", "fluid.resolved_from"}, "fluid.model = \"" + c.fluid.model + "\"");
        if (c.fluid.model == "unresolved") c.fluid.exchange = exchanges.front();
        return;
    }
    c.fluid.exchange = in.choice(
        "fluid.exchange", exchanges,
        {.fallback = std::string(exchanges.front()),
         .help = "of momentum with the stones, monolithic: their velocities are found with the pressure; "
                 "one fluid whose velocity is made rigid in their place, mixture: the source's, whose "
                 "pressure knows their density, direct: whose pressure knows the water's alone"});
    if (c.fluid.exchange != exchanges.front()) {
        refuse(in, {"fluid.resolved_from"},
               "fluid.exchange = \"" + c.fluid.exchange + "\", which resolves all stones,");
        return;
    }
    c.fluid.resolved_from = in.number(
        "fluid.resolved_from", {.unit = "cells",
                                .fallback = 3,
                                .help = "diameter from which on the water flows around a stone; smaller "
                                        "ones are spread over the flow, as all are where it is unresolved",
                                .least = 0,
                                .most = 1000,
                                .remedy = "fluid.model = \"unresolved\" spreads all stones"});
}

/// What water that runs down the channel takes.
void read_running_water(TomlReader& in, ChannelConfig& c) {
    c.fluid.spacing = in.number(
        "fluid.spacing",
        {.unit = "m", .fallback = 0.02, .help = "of the grid of water that flows", .bound = Bound::positive});
    c.fluid.inflow_depth =
        in.number("fluid.inflow_depth", {.unit = "m",
                                         .fallback = 0,
                                         .help = "of water that flows in upstream, 0: of uniform flow",
                                         .assumption = "not in the text",
                                         .bound = Bound::not_negative});
    c.fluid.settle =
        in.number("fluid.settle", {.unit = "s",
                                   .fallback = 0,
                                   .help = "that water runs before the stones begin, 0: three "
                                           "times what uniform flow takes down the channel, and 1 s; 3 s at "
                                           "most where it begins as uniform flow",
                                   .bound = Bound::not_negative});
    require(c.fluid.spacing <= 0.25 * c.invert.width,
            {in.where("fluid.spacing") + ": fluid.spacing",
             "at most a quarter of the channel's width of " + to_text(c.invert.width) + " m", "m"},
            c.fluid.spacing);
}

/// What the water on a grid takes.
void read_grid(TomlReader& in, ChannelConfig& c, bool feels_stones) {
    constexpr std::array<std::string_view, 2> surfaces{"volume", "height"}, begins{"dry", "uniform"};
    c.fluid.surface = in.choice(
        "fluid.surface",
        std::span(surfaces).subspan(feels_stones ? 1 : 0),  // no engine has stones in volumes
        {.fallback = feels_stones ? "height" : "volume",
         .help = "of the grid's water, volume: of any shape, height: one over each place, which is faster"});
    c.fluid.energy = in.flag("fluid.energy", {.fallback = true,
                                              .help = "whether the grid's water keeps its energy account, "
                                                      "which costs a quarter of a step"});
    c.fluid.begins_uniform =
        in.choice(
            "fluid.begins", begins,
            {.fallback = feels_stones ? "uniform" : "dry",
             .help = "what a grid's water begins as, dry: it runs down the channel, uniform: as uniform "
                     "flow all along it"}) == "uniform";
}

void read_fluid(TomlReader& in, ChannelConfig& c) {
    std::vector<std::string_view> names;
    for (const ChannelEngine& one : channel_engines)
        if (std::find(names.begin(), names.end(), one.fluid) == names.end()) names.push_back(one.fluid);
    c.fluid.model = in.choice(
        "fluid.model", names,
        {.fallback = "uniform",
         .help = "uniform: prescribed, shallow: depth-averaged, grid: with a free surface, unresolved and "
                 "resolved: with one that feels the stones, or none"});
    const bool feels_stones = c.fluid.model == "unresolved" || c.fluid.model == "resolved";
    const bool on_a_grid = c.fluid.model == "grid" || feels_stones;
    read_exchange(in, c);
    if (on_a_grid || c.fluid.model == "shallow")
        read_running_water(in, c);
    else
        note_unused(in, c, {"fluid.spacing", "fluid.inflow_depth", "fluid.settle"});
    if (on_a_grid)
        read_grid(in, c, feels_stones);
    else
        note_unused(in, c, {"fluid.surface", "fluid.energy", "fluid.begins"});
}

void read_sediment(TomlReader& in, ChannelConfig& c) {
    FeedParams& feed = c.feed;
    feed.volume_rate = in.number(
        "sediment.rate",
        {.unit = "m3/s", .fallback = 0.0083, .help = "solid volume supplied", .bound = Bound::positive});
    feed.density = in.number("sediment.density", {.unit = "kg/m3",
                                                  .fallback = 2650,
                                                  .help = "of the stones",
                                                  .least = 1,
                                                  .most = 3e4,
                                                  .remedy = heaviest});
    const auto sizes =
        in.numbers("sediment.sizes", {.unit = "m",
                                      .fallback = std::vector<Real>{0.04, 0.05, 0.075, 0.10, 0.15},
                                      .help = "nominal diameters",
                                      .bound = Bound::positive});
    const auto fractions =
        in.numbers("sediment.fractions", {.fallback = std::vector<Real>{0.2, 0.2, 0.2, 0.2, 0.2},
                                          .help = "of the solid volume",
                                          .assumption = "the paper gives the distribution only as a picture",
                                          .bound = Bound::not_negative});
    require(fractions.size() == sizes.size(),
            {in.where("sediment.fractions") + ": sediment.fractions",
             "as many as sediment.sizes (" + std::to_string(sizes.size()) + ")", "values"},
            static_cast<Real>(fractions.size()));
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        require(sizes[i] < c.invert.width,
                {in.where("sediment.sizes") + ": sediment.sizes",
                 "smaller than the channel's width of " + to_text(c.invert.width) + " m", "m",
                 "take smaller stones or a wider channel"},
                sizes[i]);
        feed.classes.push_back({sizes[i], fractions[i], StoneShape::sphere});
    }
    const auto shape = in.choice("sediment.shape",
                                 std::array<std::string_view, 4>{"mixed", "sphere", "ellipsoid", "angular"},
                                 {.fallback = "mixed",
                                  .help = "of the stones; mixed: angular up to 0.05 m, ellipsoid above",
                                  .assumption = "not in the text"});
    for (StoneClass& stones : feed.classes)
        stones.shape = shape == "sphere" ? StoneShape::sphere
                       : shape == "angular" || (shape == "mixed" && stones.size <= 0.05)
                           ? StoneShape::angular
                           : StoneShape::ellipsoid;
    const Real from = in.number(
        "sediment.feed_from",
        {.unit = "m", .fallback = 0.0, .help = "upstream end of the feed", .bound = Bound::not_negative});
    const Real to = in.number("sediment.feed_to",
                              {.unit = "m", .help = "downstream end of the feed", .bound = Bound::positive});
    const Real half = in.number("sediment.feed_half_width", {.unit = "m",
                                                             .fallback = 0.35,
                                                             .help = "to each side of the centre line",
                                                             .assumption = "not in the text",
                                                             .bound = Bound::positive});
    const Real speed =
        in.number("sediment.feed_speed", {.unit = "m/s",
                                          .fallback = 2.0,
                                          .help = "of the stones as they enter",
                                          .assumption = "not in the text",
                                          .least = 0,
                                          .most = 100,
                                          .remedy = "stones enter with some share of the water's speed"});
    require(half <= 0.5 * c.invert.width,
            {in.where("sediment.feed_half_width") + ": sediment.feed_half_width",
             "at most half the channel's width (" + to_text(0.5 * c.invert.width) + " m)", "m"},
            half);
    require(to <= c.invert.length,
            {in.where("sediment.feed_to") + ": sediment.feed_to",
             "at most the channel's length (" + to_text(c.invert.length) + " m)", "m"},
            to);
    require(from < to,
            {in.where("sediment.feed_from") + ": sediment.feed_from",
             "upstream of sediment.feed_to (" + to_text(to) + " m)", "m"},
            from);
    const Real height = in.number("sediment.feed_height", {.unit = "m",
                                                           .fallback = 0.02,
                                                           .help = "over the bed up to which stones enter; "
                                                                   "0.02: they lie on it, more: they drop",
                                                           .assumption = "not in the text",
                                                           .bound = Bound::positive});
    const Real until = in.number(
        "sediment.feed_until",
        {.unit = "s", .fallback = 0, .help = "end of the supply, 0: none", .bound = Bound::not_negative});
    // As many as the concrete may have spheres; smaller stones would be fed for ever.
    Real per_volume = 0;
    for (std::size_t i = 0; i < sizes.size(); ++i) per_volume += fractions[i] / (pi / 6 * cube(sizes[i]));
    const Real stones =
        feed.volume_rate * (until > 0 ? std::min(until, c.end_time) : c.end_time) * per_volume;
    require(stones <= 1e8,
            {in.where("sediment.sizes") + ": sediment.sizes with sediment.rate and run.end_time",
             "such that at most 1e8 stones are fed", "stones",
             "leave out the smallest stones or run for a shorter time"},
            stones);
    require(height > 0.002 && height <= 4,
            {in.where("sediment.feed_height") + ": sediment.feed_height", "above 0.002 m, at most 4 m", "m"},
            height);
    if (until > 0) feed.end = until;
    feed.region = {{from, -half, 0.002}, {to, half, height}};
    feed.velocity = {speed, 0, 0};
    feed.bed = [invert = c.invert](Real, Real y) { return invert.bed_height(y); };
    const auto seed = in.integer(
        "run.seed", {.fallback = 1, .help = "of all that is random", .bound = Bound::not_negative});
    require(seed <= std::numeric_limits<std::uint32_t>::max(),
            {in.where("run.seed") + ": run.seed", "at most 4294967295", ""}, static_cast<Real>(seed));
    feed.seed = static_cast<std::uint32_t>(seed);
}

void read_comparison(TomlReader& in, ChannelConfig& c) {
    Comparison& compare = c.comparison;
    compare.gauge = in.number("compare.gauge", {.unit = "m", .help = "where passing sediment is counted"});
    compare.from = in.number("compare.from", {.unit = "m", .help = "upstream end of the compared section"});
    compare.to = in.number("compare.to", {.unit = "m", .help = "downstream end of the compared section"});
    compare.half_width =
        in.number("compare.half_width", {.unit = "m",
                                         .fallback = 0.05,
                                         .help = "of the strip that counts as the centre line",
                                         .assumption = "not in the text",
                                         .bound = Bound::positive});
    compare.gauges = in.numbers("compare.gauges", {.unit = "m",
                                                   .fallback = std::vector<Real>{compare.from, compare.to},
                                                   .help = "where the volume that has passed is recorded",
                                                   .bound = Bound::not_negative});
    compare.converted = in.numbers("compare.converted",
                                   {.unit = "m3",
                                    .fallback = std::vector<Real>{},
                                    .help = "converted sediment at which the bed is kept, as it has passed "
                                            "compare.from and compare.to; the last ends the run",
                                    .bound = Bound::positive});
    std::sort(compare.converted.begin(), compare.converted.end());
    compare.hops = in.flag("compare.hops", {.fallback = true,
                                            .help = "whether hops of stones are recorded, for which all are "
                                                    "looked at every few steps"});
    compare.measured =
        in.file("compare.measured",
                {.fallback = "", .help = "CSV of measured points of your own: x [m], depth [mm/m3]"});
    const auto inside = [&](const char* key, Real x) {
        require(
            x >= 0 && x <= c.invert.length,
            {in.where(key) + ": " + key, "inside the channel, 0 to " + to_text(c.invert.length) + " m", "m"},
            x);
    };
    inside("compare.gauge", compare.gauge), inside("compare.from", compare.from),
        inside("compare.to", compare.to);
    for (const Real x : compare.gauges) inside("compare.gauges", x);
    require(compare.to > compare.from,
            {in.where("compare.to") + ": compare.to",
             "downstream of compare.from (" + to_text(compare.from) + " m)", "m"},
            compare.to);
    // A section or a strip without a column of spheres in it would have a depth of nothing.
    const Real sphere = c.lattice.sphere_diameter;
    require(compare.to - compare.from >= sphere,
            {in.where("compare.to") + ": compare.to",
             "at least a sphere of the concrete (" + to_text(sphere) + " m) from compare.from", "m"},
            compare.to);
    require(compare.half_width >= 0.5 * sphere && compare.half_width <= 0.5 * c.invert.width,
            {in.where("compare.half_width") + ": compare.half_width",
             "from half a sphere of the concrete to half the channel's width", "m"},
            compare.half_width);
}

}  // namespace

std::string name_of(ConcreteLevel level) {
    return level == ConcreteLevel::quasi_static ? "static"
           : level == ConcreteLevel::rigid      ? "rigid"
                                                : "dynamic";
}
std::string name_of(WornOut worn_out) { return std::string(worn_outs[static_cast<std::size_t>(worn_out)]); }
std::string name_of(const Overflow& overflow) { return std::string(overflows[overflow.index()]); }

ChannelConfig read_channel_config(const std::filesystem::path& file,
                                  const std::vector<std::string>& overrides) {
    TomlReader in = TomlReader::from_file(file, overrides);
    ChannelConfig c;
    c.source = file.filename().string();
    c.title = in.text("run.title", {.fallback = "Invert channel", .help = ""});
    c.end_time = in.number("run.end_time", {.unit = "s", .help = "simulated", .bound = Bound::positive});
    c.output_every = in.number("run.output_every",
                               {.unit = "s", .help = "between saved states", .bound = Bound::positive});
    c.checkpoint_every = in.number("run.checkpoint_every", {.unit = "min",
                                                            .fallback = 10,
                                                            .help = "of wall time between checkpoints",
                                                            .bound = Bound::positive});
    c.time_step = in.number("run.time_step", {.unit = "s",
                                              .fallback = 0,
                                              .help = "0: run.safety times the stable step",
                                              .bound = Bound::not_negative});
    c.safety = in.number("run.safety",
                         {.fallback = 0.8, .help = "share of the stable step", .bound = Bound::positive});
    require(c.safety <= 1, {in.where("run.safety") + ": run.safety", "in (0, 1]", "", "0.8 is common"},
            c.safety);
    c.skin =
        in.number("run.skin",
                  {.unit = "m", .fallback = 0.03, .help = "of the neighbour list", .bound = Bound::positive});
    read_channel(in, c);
    read_concrete(in, c);
    read_contact(in, c);
    read_water(in, c);
    read_fluid(in, c);
    find_engine(c.fluid.model, c.contact_law, c.fluid.surface);
    read_sediment(in, c);
    read_wear(in, c);
    read_comparison(in, c);
    in.reject_unknown();
    c.parameters = in.parameters();

    // Whatever else the laws object to is said now, before anything is written.
    const auto check = [&](const char* section, auto&& make) {
        try {
            make();
        } catch (const InputError& error) {
            throw InputError(c.source + ", [" + section + "]: " + error.what());
        }
    };
    check("channel", [&] { c.invert.validate(); });
    check("concrete", [&] { MohrCoulomb{c.bond}, check_size(c.lattice, c.invert.length, c.invert.width); });
    check("contact", [&] { std::visit([](const auto& params) { params.validate(); }, c.contact); });
    check("wear", [&] { validate(c.concrete.overflow); });
    check("water", [&] {
        const Real depth = UniformFlow{c.water}.depth();
        require(depth < ChannelConfig::ceiling,
                {"water.discharge of " + to_text(c.water.discharge) + " m3/s: depth of uniform flow",
                 "below " + to_text(ChannelConfig::ceiling) + " m, which is as high as stones may go", "m",
                 "take a smaller discharge or a steeper channel"},
                depth);
    });
    if (c.fluid.spacing > 0) check("fluid", [&] { check_cells(c); });
    check("sediment", [&] { c.feed.validate(); });
    return c;
}

}  // namespace abrade::examples
