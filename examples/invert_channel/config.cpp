#include "config.hpp"
#include "fluids.hpp"

#include "../common/toml_reader.hpp"

#include <array>

namespace abrade::examples {

namespace {

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
    c.concrete_density =
        in.number("concrete.density",
                  {.unit = "kg/m3", .fallback = 2400, .help = "of the spheres", .bound = Bound::positive});
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
    c.wake_force =
        in.number("concrete.wake_force",
                  {.unit = "N",
                   .fallback = 10,
                   .help = "load that wakes sleeping concrete, 0: all is awake; a bond holds 848 N",
                   .bound = Bound::not_negative});
    c.wake_radius = static_cast<Index>(in.integer(
        "concrete.wake_radius",
        {.fallback = 2, .help = "bonds about what stones may touch", .bound = Bound::not_negative}));
    static constexpr std::array<std::string_view, 2> volumes{"cell", "sphere"};
    c.fracture_volume = in.choice("concrete.fracture_volume", volumes,
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
    c.contact.stiffness = in.number(
        "contact.stiffness",
        {.unit = "N/m", .help = "normal spring", .assumption = "not in the text", .bound = Bound::positive});
    c.contact.restitution =
        in.number("contact.restitution",
                  {.fallback = 0.6, .help = "of a normal impact", .assumption = "not in the text"});
    c.contact.friction = in.number("contact.friction", {.fallback = 0.5,
                                                        .help = "Coulomb coefficient",
                                                        .assumption = "not in the text",
                                                        .bound = Bound::not_negative});
    c.contact.tangential_ratio =
        in.number("contact.tangential_ratio", {.fallback = 2.0 / 7,
                                               .help = "tangential over normal spring",
                                               .assumption = "not in the text",
                                               .bound = Bound::positive});
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
    c.water.density =
        in.number("water.density", {.unit = "kg/m3", .fallback = 1000, .help = "", .bound = Bound::positive});
    c.water.viscosity =
        in.number("water.viscosity",
                  {.unit = "Pa s", .fallback = 1.31e-3, .help = "at 10 degrees C", .bound = Bound::positive});
    c.drag.shape_factor =
        in.number("water.drag_shape_factor", {.fallback = 1.0,
                                              .help = "on a sphere's drag coefficient",
                                              .assumption = "stones of this level of model drag like spheres",
                                              .bound = Bound::positive});
}

void read_fluid(TomlReader& in, ChannelConfig& c) {
    std::vector<std::string_view> names;
    for (const ChannelFluid& one : channel_fluids) names.push_back(one.name);
    c.fluid.model = in.choice(
        "fluid.model", names,
        {.fallback = "uniform",
         .help = "uniform: prescribed, shallow: depth-averaged, grid: with a free surface, or none"});
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
                                           "times what uniform flow takes down the channel, and 1 s",
                                   .bound = Bound::not_negative});
    require(c.fluid.spacing <= 0.25 * c.invert.width,
            {in.where("fluid.spacing") + ": fluid.spacing",
             "at most a quarter of the channel's width of " + to_text(c.invert.width) + " m", "m"},
            c.fluid.spacing);
}

void read_sediment(TomlReader& in, ChannelConfig& c) {
    FeedParams& feed = c.feed;
    feed.volume_rate = in.number(
        "sediment.rate",
        {.unit = "m3/s", .fallback = 0.0083, .help = "solid volume supplied", .bound = Bound::positive});
    feed.density =
        in.number("sediment.density",
                  {.unit = "kg/m3", .fallback = 2650, .help = "of the stones", .bound = Bound::positive});
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
    const Real speed = in.number("sediment.feed_speed", {.unit = "m/s",
                                                         .fallback = 2.0,
                                                         .help = "of the stones as they enter",
                                                         .assumption = "not in the text",
                                                         .bound = Bound::not_negative});
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
    feed.region = {{from, -half, 0.002}, {to, half, 0.02}};
    feed.velocity = {speed, 0, 0};
    feed.bed = [invert = c.invert](Real, Real y) { return invert.bed_height(y); };
    feed.seed = static_cast<std::uint32_t>(in.integer(
        "run.seed", {.fallback = 1, .help = "of all that is random", .bound = Bound::not_negative}));
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
    require(compare.to > compare.from,
            {in.where("compare.to") + ": compare.to",
             "downstream of compare.from (" + to_text(compare.from) + " m)", "m"},
            compare.to);
}

}  // namespace

ChannelConfig read_channel_config(const std::filesystem::path& file,
                                  const std::vector<std::string>& overrides) {
    TomlReader in = TomlReader::from_file(file, overrides);
    ChannelConfig c;
    c.source = file.filename().string();
    c.title = in.text("run.title", {.fallback = "Invert channel", .help = ""});
    c.end_time = in.number("run.end_time", {.unit = "s", .help = "simulated", .bound = Bound::positive});
    c.output_every = in.number("run.output_every",
                               {.unit = "s", .help = "between saved states", .bound = Bound::positive});
    c.time_step = in.number("run.time_step", {.unit = "s",
                                              .fallback = 0,
                                              .help = "0: run.safety times the stable step",
                                              .bound = Bound::not_negative});
    c.safety = in.number("run.safety",
                         {.fallback = 0.8, .help = "share of the stable step", .bound = Bound::positive});
    c.skin = in.number(
        "run.skin",
        {.unit = "m", .fallback = 0.006, .help = "of the neighbour list", .bound = Bound::positive});
    read_channel(in, c);
    read_concrete(in, c);
    read_contact(in, c);
    read_water(in, c);
    read_fluid(in, c);
    read_sediment(in, c);
    c.wear.coefficient = in.number(
        "wear.coefficient", {.unit = "m3/J", .fallback = 1.1e-7, .help = "Cw", .bound = Bound::not_negative});
    c.wear.acceleration = in.number(
        "wear.acceleration",
        {.fallback = 4800, .help = "beta, represented over simulated time", .bound = Bound::positive});
    c.wear.normal_weight =
        in.number("wear.normal_weight",
                  {.fallback = 1, .help = "of impact losses; 1 is the paper", .bound = Bound::not_negative});
    c.wear.tangential_weight =
        in.number("wear.tangential_weight",
                  {.fallback = 1, .help = "of sliding losses; 1 is the paper", .bound = Bound::not_negative});
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
    check("contact", [&] { LinearSpring{c.contact}; });
    check("wear", [&] { SubParticleAbrasion{c.wear}; });
    check("water", [&] { UniformFlow{c.water}; });
    check("sediment", [&] { c.feed.validate(); });
    return c;
}

}  // namespace abrade::examples
