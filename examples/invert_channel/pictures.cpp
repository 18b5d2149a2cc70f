#include "pictures.hpp"

#include "../common/charts.hpp"
#include "../common/measured_points.hpp"
#include "../common/report.hpp"
#include "../common/saltation.hpp"

#include <algorithm>
#include <filesystem>

namespace abrade::examples {

namespace {

Axis along_channel(const ChannelConfig& c) {
    return {.label = "distance along the channel", .unit = "m", .min = 0.0, .max = c.invert.length};
}
Axis across_channel(const ChannelConfig& c) {
    return {.label = "across", .unit = "m", .min = -0.5 * c.invert.width, .max = 0.5 * c.invert.width};
}

namespace fs = std::filesystem;

constexpr auto stone_colour = "#7a8b99";

/// Stones and the centre line's concrete from the side, the surface layer and the stones from above.
void draw_snapshot(const ChannelConfig& c, const ChannelResults& r, const fs::path& side,
                   const fs::path& plan) {
    const Axis x = along_channel(c);
    const Axis fracture{.label = "fracture rate", .min = 0.0};
    CircleSet bed_side{.title = "", .circles = {}},
        stones_side{.title = "stones", .circles = {}, .colour = stone_colour, .outline = true};
    CircleSet bed_plan = bed_side, stones_plan = stones_side;
    for (const DrawnSphere& s : r.spheres) {
        const bool stone = s.fracture < 0;
        (stone ? stones_plan : bed_plan)
            .circles.push_back({s.centre.x(), s.centre.y(), s.radius, s.fracture});
        // A side view of the middle; the flanks of the concave bed would hide it.
        if (stone || std::abs(s.centre.y()) < c.lattice.sphere_diameter)
            (stone ? stones_side : bed_side)
                .circles.push_back({s.centre.x(), s.centre.z(), s.radius, s.fracture});
    }
    // Long channels: the compared section only, or stones would be specks.
    Axis shown = x;
    if (c.invert.length > 4)
        shown.min = c.comparison.from, shown.max = std::min(c.comparison.from + 4, c.invert.length);
    std::vector<Curve> surface;
    Real top = 0.3;
    if (r.water) {
        Curve line{.title = "water surface", .x = {}, .y = {}};
        for (std::size_t n = 0; n < r.water->surface_x.size(); ++n) {
            const Real at = r.water->surface_x[n];
            const bool ends = r.water->surface_x.size() == 2;  // a straight line: cut, not left out
            if (!ends && (at < *shown.min || at > *shown.max)) continue;
            line.x.push_back(std::clamp(at, *shown.min, *shown.max)), line.y.push_back(r.water->surface_z[n]);
        }
        top = 0.12 + *std::max_element(line.y.begin(), line.y.end());
        surface.push_back(std::move(line));
    }
    draw(CirclePicture{.title = "Side view at the end",
                       .x = shown,
                       .y = {.label = "height", .unit = "m", .min = -0.02, .max = top},
                       .colour = fracture,
                       .sets = {bed_side, stones_side},
                       .lines = surface},
         side);
    draw(CirclePicture{.title = "Plan view at the end",
                       .x = shown,
                       .y = across_channel(c),
                       .colour = fracture,
                       .sets = {bed_plan, stones_plan}},
         plan);
}

void draw_water(const ChannelConfig& c, const ChannelWater& water, const fs::path& picture) {
    ColourMap map{.title = "Depth of water at the end",
                  .x = along_channel(c),
                  .y = across_channel(c),
                  .colour = {.label = "depth", .unit = "m", .min = 0.0},
                  .columns = static_cast<std::size_t>(water.columns),
                  .values = water.depth_map};
    map.palette = Palette::water;
    map.equal_aspect = c.invert.length < 4;
    draw(map, picture);
}

/// Long channels are shown as means over 0.1 m: single spheres are hit by chance, and would be specks.
void draw_depth_map(const ChannelConfig& c, const ChannelResults& r, const BedDepth& bed,
                    const std::string& title, const fs::path& picture) {
    const bool is_long = c.invert.length > 4;
    const Index each = is_long ? static_cast<Index>(std::lround(0.1 / c.lattice.sphere_diameter)) : 1;
    const Index columns = r.along / std::max<Index>(each, 1);
    ColourMap map{.title = title + (is_long ? ", means over 0.1 m along" : ""),
                  .x = along_channel(c),
                  .y = across_channel(c),
                  .colour = {.label = "abrasion depth", .unit = "mm", .min = 0.0},
                  .columns = static_cast<std::size_t>(columns),
                  .values = {}};
    for (Index j = 0; j < r.across; ++j)
        for (Index i = 0; i < columns; ++i) {
            Real sum = 0;
            for (Index n = i * each; n < (i + 1) * each; ++n)
                sum += bed.depth_m[static_cast<std::size_t>(n * r.across + j)];
            map.values.push_back(1e3 * sum / static_cast<Real>(each));
        }
    std::vector<Real> sorted = map.values;
    std::sort(sorted.begin(), sorted.end());
    // One hole must not turn all else pale.
    map.colour.max =
        sorted.back() <= 0 ? 1.0 : std::max(sorted[sorted.size() * 995 / 1000], 0.2 * sorted.back());
    map.equal_aspect = !is_long;
    draw(map, picture);
}

/// A running mean over about five columns: single spheres are hit by chance.
std::vector<Real> smoothed(const std::vector<Real>& values, std::size_t half) {
    std::vector<Real> out(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t from = i > half ? i - half : 0, to = std::min(values.size(), i + half + 1);
        for (std::size_t k = from; k < to; ++k) out[i] += values[k] / static_cast<Real>(to - from);
    }
    return out;
}

std::string milestone_text(const Milestone& one) {
    return short_number(one.converted_m3) + " m3 had passed x = " + short_number(one.past_m) + " m";
}

void draw_centre_line(const ChannelConfig& c, const ChannelResults& r, const fs::path& picture) {
    const Real width = r.bed.band_width_m > 0 ? r.bed.band_width_m : 1;
    const Bracket bracket = Bracket{}.per_width(width);
    const Real from = c.comparison.from, to = c.comparison.to, mean = r.bed.centre_mean_per_m3;
    LineChart chart{
        .title = "Abrasion depth at the centre line per volume of sediment passed",
        .x = along_channel(c),
        .y = {.label = "depth per converted sediment", .unit = "mm/m3", .min = 0.0},
        .curves = {},
        .bands = {{.title = "physical bracket for a worn band of " + short_number(width, 2) + " m",
                   .x = {from, to},
                   .low = {bracket.low, bracket.low},
                   .high = {bracket.high, bracket.high}}}};
    if (std::isfinite(mean)) {
        chart.curves.push_back(
            {.title = "simulation", .x = r.bed.x_m, .y = smoothed(r.bed.centre_depth_per_m3, 2)});
        chart.curves.push_back({.title = "mean of the compared section",
                                .x = {from, to},
                                .y = {mean, mean},
                                .style = CurveStyle::dashed});
        for (const Milestone& one : r.milestones)
            chart.curves.push_back({.title = "as " + milestone_text(one),
                                    .x = one.bed.x_m,
                                    .y = smoothed(one.bed.centre_depth_per_m3, 2)});
    } else {
        chart.title = "No sediment has passed the gauge yet";
    }
    if (!c.comparison.measured.empty()) {
        Curve points{.title = "measured (" + c.comparison.measured.filename().string() + ")",
                     .x = {},
                     .y = {},
                     .style = CurveStyle::points};
        for (const MeasuredPoint& p : read_measured_points(c.comparison.measured))
            points.x.push_back(p.x), points.y.push_back(p.depth);
        chart.curves.push_back(std::move(points));
    }
    draw(chart, picture);
}

Real largest(const std::vector<Real>& values) {
    return std::max(*std::max_element(values.begin(), values.end()), 1e-300);
}

/// Mean depth across the compared section, which losses wear it, and where stones run.
void draw_cross_section(const ChannelConfig& c, const ChannelResults& r, const fs::path& picture) {
    const auto over = [](std::vector<Real> values, Real largest) {
        for (Real& one : values) one /= largest;
        return values;
    };
    const std::vector<Real>& y = r.bed.y_m;
    const std::vector<Real> stones = smoothed(r.stones_across, 1), impacts = smoothed(r.impacts_across, 1),
                            sliding = smoothed(r.sliding_across, 1);
    const Real depth = largest(r.bed.across_depth_m), losses = std::max(largest(impacts), largest(sliding));
    draw(LineChart{.title =
                       "Across the compared section (greatest depth " + short_number(1e3 * depth, 3) + " mm)",
                   .x = across_channel(c),
                   .y = {.label = "share of the largest", .min = 0.0},
                   .curves = {{.title = "mean depth", .x = y, .y = over(r.bed.across_depth_m, depth)},
                              {.title = "losses by sliding", .x = y, .y = over(sliding, losses)},
                              {.title = "losses by impacts", .x = y, .y = over(impacts, losses)},
                              {.title = "stones",
                               .x = y,
                               .y = over(stones, largest(stones)),
                               .style = CurveStyle::dashed}}},
         picture);
}

void draw_passed(const ChannelConfig& c, const ChannelResults& r, const fs::path& picture) {
    LineChart chart{.title = "Solid volume that has passed",
                    .x = {.label = "time", .unit = "s", .min = 0.0},
                    .y = {.label = "volume of stones", .unit = "m3", .min = 0.0},
                    .curves = {}};
    std::vector<Real> fed;
    for (const Real t : r.passed.time_s)
        fed.push_back(c.feed.volume_rate * std::clamp(t - c.feed.start, 0.0, c.feed.end - c.feed.start));
    chart.curves.push_back(
        {.title = "due to be fed", .x = r.passed.time_s, .y = fed, .style = CurveStyle::dashed});
    for (std::size_t g = 0; g < r.passed.x_m.size(); ++g)
        chart.curves.push_back({.title = "past x = " + short_number(r.passed.x_m[g]) + " m",
                                .x = r.passed.time_s,
                                .y = r.passed.passed_m3[g]});
    draw(chart, picture);
}

void draw_ledger(const ChannelResults& r, const fs::path& picture) {
    LineChart chart{.title = "Energy over time",
                    .x = {.label = "time", .unit = "s", .min = 0.0},
                    .y = {.label = "energy", .unit = "J"},
                    .curves = {}};
    static const std::vector<std::pair<std::string, std::string>> shown{
        {"kinetic", "kinetic energy"},       {"drag_input", "put in by the flow"},
        {"lost_drag", "lost in drag"},       {"flow_work", "work of the flow on the bodies"},
        {"lost_sliding", "lost in sliding"}, {"lost_normal", "lost in impacts"},
        {"lost_bond", "lost in bonds"},      {"integration_residue", "integration residue"}};
    for (const auto& [name, title] : shown) {
        const auto found = std::find(r.ledger.names.begin(), r.ledger.names.end(), name);
        if (found == r.ledger.names.end()) continue;
        const auto& values = r.ledger.values[static_cast<std::size_t>(found - r.ledger.names.begin())];
        const bool nothing = std::ranges::all_of(values, [](Real value) { return value == 0; });
        if (nothing && name != "kinetic") continue;
        chart.curves.push_back({.title = title, .x = r.ledger.time, .y = values});
    }
    draw(chart, picture);
}

std::vector<ReportRow> summary_rows(const ChannelResults& r) {
    const auto row = [](const char* name, Real value, const char* unit,
                        const char* otherwise = "no sediment has passed yet") {
        return ReportRow{name, std::isfinite(value) ? short_number(value) : otherwise,
                         std::isfinite(value) ? unit : ""};
    };
    std::vector<ReportRow> rows{
        row("simulated time", r.simulated_s, "s"),
        row("represented time (times beta)", r.represented_h, "h"),
        row("wall time", r.wall_s, "s"),
        row("time step", 1e6 * r.time_step_s, "us"),
        row("stable time step", 1e6 * r.stable_time_step_s, "us"),
        row("stones fed", r.stones_fed, ""),
        row("stones in the channel at the end", r.stones, ""),
        row("their mean speed", r.mean_stone_speed_m_per_s, "m/s"),
        row("speed in the compared section, mean over time", r.sampled_stone_speed_m_per_s, "m/s",
            "no stone came there"),
        row("share of stones off the bed there", r.stones_off_bed_share, "-", "no stone came there"),
        row("concrete spheres", r.concrete_spheres, ""),
        row("bonds broken", r.bonds_broken, ""),
        row("spheres fully worn", r.spheres_worn_out, ""),
        row("spheres let go by their bonds", r.spheres_let_go, ""),
        row("restitution at 1 m/s", r.restitution_at_1_m_per_s, ""),
        row("sediment past the gauge", r.sediment_passed_m3, "m3"),
        row("converted sediment (times beta)", r.converted_sediment_m3, "m3"),
        row("worn volume", 1e6 * r.worn_volume_m3, "cm3"),
        row("wear from the energy lost", 1e6 * r.worn_volume_from_energy_m3, "cm3", "another law"),
        row("overflow: worn off nothing", 1e6 * r.overflow_volume_m3, "cm3"),
        row("waiting for the end of its epoch", 1e6 * r.waiting_volume_m3, "cm3"),
        row("worn, overflow and waiting over what the energy gives", r.worn_over_energy(), "", "another law"),
        row("sound concrete that went with loosened spheres", 1e6 * r.detached_volume_m3, "cm3"),
        row("largest share of a cell that one collision wore", r.largest_collision_share, ""),
        row("largest safe beta", r.largest_safe_beta, "", "nothing was worn"),
        row("depth at the centre per converted sediment", r.bed.centre_mean_per_m3, "mm/m3"),
        row("greatest depth", 1e3 * r.bed.max_depth_m, "mm"),
        row("mean depth", r.mean_depth_mm, "mm"),
        row("width of the worn band (90 % of the volume)", r.bed.band_width_m, "m"),
        row("energy lost in impacts on concrete", r.energy_lost_normal_J, "J"),
        row("energy lost in sliding on concrete", r.energy_lost_sliding_J, "J"),
        row("ledger residual, relative", r.ledger_residual_relative, ""),
        row("integration residue", r.integration_residue_J, "J")};
    if (r.water) {
        const ChannelWater& water = *r.water;
        for (const ReportRow& one :
             {row("water depth at the centre as the stones begin", water.depth_m, "m"),
              row("Manning's depth", water.manning_depth_m, "m"),
              row("mean water speed as the stones begin", water.speed_m_per_s, "m/s"),
              row("Manning's speed", water.manning_speed_m_per_s, "m/s"),
              row("Froude number", water.froude, ""), row("bed shear", water.bed_shear_Pa, "Pa")})
            rows.push_back(one);
    }
    return rows;
}

/// Where there is none, nothing.
std::string number_or_none(Real value) { return std::isfinite(value) ? short_number(value) : "none"; }

/// One row of the table that an ensemble has of all levels.
ReportTable level_table(const ChannelConfig& c, const ChannelResults& r) {
    ReportTable table{.title = "What this level of fluid costs, and what it gives", .columns = {"level"}};
    table.rows.push_back({"fluid.model = " + c.fluid.model +
                          (c.fluid.exchange.empty() ? "" : ", fluid.exchange = " + c.fluid.exchange)});
    const auto figures = level_figures(r);
    for (std::size_t n = 0; n < figures.size(); ++n) {
        const Metric metric = metric_of(fluid_metrics[n]);
        table.columns.push_back(with_unit(metric));
        table.rows.front().push_back(number_or_none(metric.factor * figures[n]));
    }
    return table;
}

ReportTable travel_table(const ChannelConfig& c, const ChannelResults& r) {
    ReportTable table{.title = "How stones of each size travel in the compared section",
                      .columns = {"size [m]", "speed [m/s]", "touches no concrete [-]",
                                  "a tenth of its size off the bed [-]"}};
    if (c.comparison.hops)
        for (const char* column : {"hops", "height [m]", "length [m]"}) table.columns.push_back(column);
    if (r.water)
        for (const char* column : {"Sklar & Dietrich: speed [m/s]", "hop height [m]"})
            table.columns.push_back(column);
    for (const TravelOfSize& one : r.travel) {
        std::vector<std::string> row{short_number(one.size_m), number_or_none(one.speed_m_per_s),
                                     number_or_none(one.off_bed_share), number_or_none(one.clear_share)};
        if (c.comparison.hops)
            for (const std::string& text : {std::to_string(one.hops), number_or_none(one.hop_height_m),
                                            number_or_none(one.hop_length_m)})
                row.push_back(text);
        if (r.water) {
            const Saltation saltation{.shear = r.water->bed_shear_Pa, .water = c.water.density};
            row.push_back(number_or_none(saltation.speed({one.size_m, c.feed.density})));
            row.push_back(number_or_none(saltation.height({one.size_m, c.feed.density})));
        }
        table.rows.push_back(row);
    }
    return table;
}

ReportTable passed_table(const ChannelConfig& c, const ChannelResults& r) {
    ReportTable table{
        .title = "Sediment that has passed",
        .columns = {"run", "time [s]", "fed [m3]", "past x [m]", "passed [m3]", "of what was fed [-]"}};
    table.rows.push_back({"this one", short_number(r.simulated_s), short_number(r.sediment_fed_m3),
                          short_number(c.comparison.gauge), short_number(r.sediment_passed_m3),
                          number_or_none(r.passed_share())});
    if (const SourceRun source; c.comparison.gauge == source.past_m)
        table.rows.push_back({"the source's, as it compares", short_number(source.end_s),
                              short_number(source.fed_m3), short_number(source.past_m),
                              short_number(source.passed_m3),
                              short_number(source.passed_m3 / source.fed_m3, 2)});
    return table;
}

/// Whether the bed that stones run on is that of the model.
std::string bed_validity(const ChannelConfig& c, const ChannelResults& r) {
    const std::string size = short_number(c.lattice.sphere_diameter) + " m";
    if (c.concrete.worn_out == WornOut::recorded)
        return "Recorded on a frozen bed, which neither stones nor water feel: outside the model's validity "
               "where depth exceeds a sphere's " +
               size + ", for there the bed would be another. The greatest depth is " +
               short_number(r.bed.max_depth_m, 2) + " m" +
               (r.water ? ", the water is " + short_number(r.water->depth_m, 2) + " m deep." : ".");
    if (const Real beta = c.wear.params().acceleration; beta > r.largest_safe_beta)
        return "Warning: one collision wore " + short_number(r.largest_collision_share, 2) +
               " times its sphere's cell: beta " + short_number(beta) + " is above the safe " +
               short_number(r.largest_safe_beta, 2) +
               ". How much of the worn volume such collisions brought is not known: see docs/verification/convergence.md.";
    if (r.largest_collision_share == 0)
        return "No collision wore concrete: nothing tells which beta is safe.";
    return "No collision wore more than half of its cell: beta was safe.";
}

}  // namespace

std::string validity(const ChannelConfig& c, const ChannelResults& r) {
    if (!r.breaks_by_blows) return bed_validity(c, r);
    return "Warning: blows broke " + std::to_string(r.bonds_broken) +
           " bonds of standing concrete; moving concrete would break several times as many, and more of it "
           "would come loose (docs/howto/standing_concrete.md). " +
           bed_validity(c, r);
}

void write_report(const ChannelConfig& c, const ChannelResults& r, const OutputFolder& folder) {
    const fs::path side = folder.path("side_view.png"), plan = folder.path("plan_view.png"),
                   depth = folder.path("abrasion_depth.png"), centre = folder.path("centre_line.png"),
                   section = folder.path("cross_section.png"), passed = folder.path("passed.png"),
                   ledger = folder.path("ledger.png");
    draw_snapshot(c, r, side, plan);
    draw_depth_map(c, r, r.bed, "Abrasion depth", depth);
    draw_cross_section(c, r, section);
    draw_passed(c, r, passed);
    draw_centre_line(c, r, centre);
    draw_ledger(r, ledger);
    const bool flows = r.water && !r.water->depth_map.empty();
    const bool feels_stones =
        c.fluid.model == "shallow" || c.fluid.model == "unresolved" || c.fluid.model == "resolved";
    if (flows) draw_water(c, *r.water, folder.path("water.png"));

    const Bracket bracket;
    Report report;
    report.title = c.title;
    report.explanation =
        "Concrete: " + name_of(c.concrete.level) +
        (c.concrete.worn_out == WornOut::recorded
             ? ", wear only recorded on a frozen bed"
             : ", worn-out spheres: " + name_of(c.concrete.worn_out) +
                   ", wear beyond a cell: " + name_of(c.concrete.overflow)) +
        ". Contacts: " + c.contact_law + " (e = " + short_number(r.restitution_at_1_m_per_s, 2) +
        " at 1 m/s). Wear: " + c.wear_law + ". " + validity(c, r) + " Gravel is fed into " +
        std::string(!r.water ? "a dry channel"
                    : flows  ? "water that runs down a channel"
                             : "steady uniform water at the upstream end of a channel") +
        " whose invert is made of bonded concrete spheres. The ledger follows every joule" +
        (c.wear_law == "sub_particle" ? "; worn volume is the energy lost times a constant, to round-off."
                                      : ".");
    if (r.stopped)
        report.explanation +=
            " The run was stopped by the user before its end: figures are of the part that was computed.";
    if (r.worn_through)
        report.explanation +=
            " The concrete was worn through before the end of the run: give it more layers.";
    report.summary = summary_rows(r);
    report.tables = {level_table(c, r), travel_table(c, r), passed_table(c, r)};
    report.figures = {
        {side,
         "Stones, water surface and the middle of the invert at the end, seen from the side. Concrete is "
         "coloured by its fracture rate."},
        {plan, "The same from above: the surface layer of the concrete, with the stones on it."},
        {depth, "Abrasion depth in plan: fracture inside standing spheres, and spheres gone."},
        {centre,
         "Depth along the centre line per m3 of converted sediment (running mean of five columns), with the "
         "bracket that physics sets for a band worn evenly: " +
             short_number(bracket.low) + " mm/m3 (impacts of saltating stones only) to " +
             short_number(bracket.high) +
             " mm/m3 (all stones sliding at mu = 0.3) on a strip 1 m wide, divided by the width that wears "
             "here." +
             (c.comparison.measured.empty() ? " No measured points were given (compare.measured)." : "")},
        {section,
         "Across the compared section: mean abrasion depth; what contacts with concrete lose, by sliding and "
         "by impacts to one scale; the volume of stones summed over time. Each as a share of its largest. "
         "Losses and stones are sampled, running means of three columns."},
        {passed, "Solid volume that has passed, against what was due to be fed."},
        {ledger,
         "Energy over time. The integration residue is the integrator's error in energy, shown and not "
         "hidden in a loss."}};
    for (std::size_t n = 0; n < r.milestones.size(); ++n) {
        const Milestone& one = r.milestones[n];
        const fs::path picture = folder.path("milestone_" + std::to_string(n + 1) + ".png");
        const std::string when = milestone_text(one);
        draw_depth_map(c, r, one.bed, "Abrasion depth as " + when, picture);
        report.figures.push_back({picture, "Abrasion depth in plan as " + when + ", at " +
                                               short_number(one.time_s) + " s. At the centre " +
                                               short_number(one.bed.centre_mean_per_m3) +
                                               " mm/m3 over what has passed each place."});
    }
    if (flows)
        report.figures.push_back(
            {folder.path("water.png"),
             "Depth of the water at the end, in plan. It has run since before the stones "
             "came; its surface stands in the side view."});
    report.parameters = c.parameters;
    report.notes = {
        "The measured curve of the original experiment is not available in the text that this model was "
        "built from. The result is judged by the bracket, by the closed ledger and by the hydraulics.",
        std::string(!r.water ? "There is no water."
                    : !flows ? "The water is prescribed: it drives the stones and does not feel them."
                    : feels_stones
                        ? "The water runs by itself: it drives the stones and feels them."
                        : "The water runs by itself: it drives the stones and does not feel them.") +
            " Stones drag like spheres of the same volume" +
            (c.fluid.model == "resolved" ? ", but for those that the water flows around." : "."),
        "Parameters marked as assumptions are open in the source; they are choices, not data."};
    if (c.comparison.hops)
        report.notes.push_back(
            "A hop is from one touch of concrete to the next, and rises by a tenth of the stone's size and "
            "more. "
            "It counts where it ends; where a channel is hardly longer than hops, long ones leave it "
            "before." +
            std::string(r.water ? " Sklar & Dietrich (2004) fitted mostly subcritical experiments over rough "
                                  "beds, which scatter by a factor of 1.5 and more: beside each other, not a "
                                  "test. None: by their critical stress (0.03) such a stone stays."
                                : ""));
    report.versions = build_versions();
    report.versions.push_back({"configuration", c.source, ""});
    report.versions.push_back(
        {"policies", r.contact + " x " + r.bond + " x " + r.wear + " x " + r.fluid, ""});
    report.versions.push_back({"threads", std::to_string(r.threads), ""});
    write_report(report, folder.path("report.html"));
}

}  // namespace abrade::examples
