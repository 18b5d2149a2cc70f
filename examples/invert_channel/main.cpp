// The main job: gravel and water down a concrete channel, and what they wear off it.
//
//   examples/run invert_channel [FILE.toml] [--fluid NAME] [--set section.key=value]... [--out FOLDER]
//   [--threads N] [--check] [--resume]
//
// config       what the TOML file says, checked
// fluids       which engines there are, by fluid and contact law; fluid_NAME.cpp: one of them
// run_channel  a run with one of them
// channel      from the configuration to a simulation, and from a simulation to results
// bed          what has passed along the channel, and the bed when enough had
// travel       how stones of each size travel
// water_start  how water that flows begins, and the cells of its grid
// recorder     what is written while it runs
// interruption checkpoints, and how a run goes on from one
// pictures     what is drawn when it is done
// profiles     the worn bed along the centre and across, for examples/ensemble

#include "fluids.hpp"
#include "pictures.hpp"
#include "profiles.hpp"

#include "../common/gnuplot.hpp"
#include "../common/interrupt.hpp"
#include "../common/measured_points.hpp"
#include "../common/saltation.hpp"

#include <abrade/core/parallel.hpp>
#include <abrade/io/state_file.hpp>

#include <hdf5.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <new>
#include <numeric>
#include <optional>

using namespace abrade;
using namespace abrade::examples;

namespace {

struct Options {
    std::filesystem::path file = std::filesystem::path(ABRADE_EXAMPLE_DIR) / "quick.toml";
    std::vector<std::string> overrides;
    std::optional<std::string> fluid;
    std::filesystem::path out = "out/invert_channel";
    int threads = 0;
    bool check = false, resume = false;
};

void write_summary(const ChannelConfig& c, const ChannelResults& r, const std::filesystem::path& path) {
    nlohmann::ordered_json summary{
        {"title", c.title},
        {"configuration", c.source},
        {"version", ABRADE_VERSION},
        {"compiler", ABRADE_COMPILER},
        {"seed", c.feed.seed},
        {"stopped_early", r.stopped},
        {"threads", r.threads},
        {"wall_s", r.wall_s},
        {"simulated_s", r.simulated_s},
        {"represented_h", r.represented_h},
        {"steps", r.steps},
        {"time_step_s", r.time_step_s},
        {"stable_time_step_s", r.stable_time_step_s},
        {"stones", r.stones},
        {"stones_fed", r.stones_fed},
        {"concrete_spheres", r.concrete_spheres},
        {"bonds_broken", r.bonds_broken},
        {"spheres_let_go", r.spheres_let_go},
        {"spheres_worn_out", r.spheres_worn_out},
        {"worn_through", r.worn_through},
        {"sediment_fed_m3", r.sediment_fed_m3},
        {"sediment_passed_m3", r.sediment_passed_m3},
        {"converted_sediment_m3", r.converted_sediment_m3},
        {"worn_volume_m3", r.worn_volume_m3},
        {"worn_volume_from_energy_m3", r.worn_volume_from_energy_m3},
        {"overflow_volume_m3", r.overflow_volume_m3},
        {"waiting_volume_m3", r.waiting_volume_m3},
        {"worn_over_energy", r.worn_over_energy()},
        {"detached_volume_m3", r.detached_volume_m3},
        {"largest_collision_share", r.largest_collision_share},
        {"largest_safe_beta", r.largest_safe_beta},
        {"centre_depth_mm_per_m3", r.bed.centre_mean_per_m3},
        {"max_depth_mm", 1e3 * r.bed.max_depth_m},
        {"mean_depth_mm", r.mean_depth_mm},
        {"worn_band_width_m", r.bed.band_width_m},
        {"energy_lost_normal_J", r.energy_lost_normal_J},
        {"energy_lost_sliding_J", r.energy_lost_sliding_J},
        {"impact_share", r.impact_share()},
        {"impact_share_compared_sampled",
         std::accumulate(r.impacts_across.begin(), r.impacts_across.end(), Real{0})},
        {"restitution_at_1_m_per_s", r.restitution_at_1_m_per_s},
        {"ledger_residual_relative", r.ledger_residual_relative},
        {"integration_residue_J", r.integration_residue_J},
        {"mean_stone_speed_m_per_s", r.mean_stone_speed_m_per_s},
        {"sampled_stone_speed_m_per_s", r.sampled_stone_speed_m_per_s},
        {"stones_off_bed_share", r.stones_off_bed_share},
        {"wall_s_by_room",
         {{"contacts_and_wear", r.wall_contacts_s},
          {"bonds", r.wall_bonds_s},
          {"motion_and_fluid", r.wall_motion_s},
          {"lists", r.wall_lists_s},
          {"changing_fluid", r.wall_fluid_s}}},
        {"policies", {{"fluid", r.fluid}, {"contact", r.contact}, {"bond", r.bond}, {"wear", r.wear}}},
        {"contact_law", c.contact_law},
        {"wear_law", c.wear_law},
        {"concrete_level", name_of(c.concrete.level)},
        {"cluster", c.concrete.cluster},
        {"worn_out", name_of(c.concrete.worn_out)},
        {"overflow", name_of(c.concrete.overflow)},
        {"validity", validity(c, r)},
        {"passed_share_of_fed", r.passed_share()},
        {"passed_volume", {{"x_m", r.passed.x_m}, {"time_s", r.passed.time_s}, {"m3", r.passed.passed_m3}}}};
    for (const TravelOfSize& one : r.travel) {
        nlohmann::ordered_json& travel = summary["stones_by_size"].emplace_back();
        travel = {{"size_m", one.size_m},
                  {"looks", one.looks},
                  {"speed_m_per_s", one.speed_m_per_s},
                  {"off_bed_share", one.off_bed_share},
                  {"clear_of_bed_share", one.clear_share}};
        if (c.comparison.hops)
            travel.update(
                {{"hops", one.hops}, {"hop_height_m", one.hop_height_m}, {"hop_length_m", one.hop_length_m}});
        if (!r.water) continue;
        const Saltation saltation{.shear = r.water->bed_shear_Pa, .water = c.water.density};
        travel.update({{"sklar_dietrich_speed_m_per_s", saltation.speed({one.size_m, c.feed.density})},
                       {"sklar_dietrich_hop_height_m", saltation.height({one.size_m, c.feed.density})}});
    }
    if (const SourceRun source; c.comparison.gauge == source.past_m)
        summary["source"] = {{"end_s", source.end_s},
                             {"sediment_fed_m3", source.fed_m3},
                             {"sediment_passed_m3", source.passed_m3},
                             {"passed_share_of_fed", source.passed_m3 / source.fed_m3}};
    for (const Milestone& one : r.milestones)
        summary["milestones"].push_back({{"converted_m3", one.converted_m3},
                                         {"past_m", one.past_m},
                                         {"time_s", one.time_s},
                                         {"centre_depth_mm_per_m3", one.bed.centre_mean_per_m3},
                                         {"max_depth_mm", 1e3 * one.bed.max_depth_m},
                                         {"worn_band_width_m", one.bed.band_width_m}});
    if (r.water) {
        summary["water_depth_m"] = r.water->depth_m;
        summary["water_speed_m_per_s"] = r.water->speed_m_per_s;
        summary["manning_depth_m"] = r.water->manning_depth_m;
        summary["manning_speed_m_per_s"] = r.water->manning_speed_m_per_s;
        summary["water_off_manning"] = r.water->off_manning();
        summary["water_settled"] = r.water->off_manning() <= ChannelWater::settled_within;
        for (const auto& [name, value] : r.water->figures) summary[name] = value;
    }
    nlohmann::ordered_json level;
    const auto figures = level_figures(r);
    for (std::size_t n = 0; n < figures.size(); ++n) level[std::string(fluid_metrics[n])] = figures[n];
    level["model"] = c.fluid.model;
    if (!c.fluid.exchange.empty()) level["exchange"] = c.fluid.exchange;
    summary["level"] = level;
    std::ofstream file(path);
    file << summary.dump(2) << "\n";
    if (!file.flush()) throw FileError("cannot write '" + path.string() + "'");
}

/// Puts the last good state of a run that failed, and what was recorded of it, beside where the results would
/// have been.
void keep_failed_run(const ChannelRun& run, OutputFolder& folder) {
    try {
        Hdf5File file = Hdf5File::create(folder.path("last_good.h5"));
        write_fields(file, "state", run.last_good);
        for (const auto& one : run.last_water) file.write("water", {one.name, one.unit, 1, one.values});
        if (!run.last_water.empty()) file.write_attribute("water", "time_s", run.last_water_time);
        file.close();
    } catch (const std::exception& error) {
        std::cerr << "the last good state is lost: " << error.what() << "\n";
    }
    std::cerr << "what there is of the run is in " << folder.publish_beside("failed").string() << "\n";
}

int run(const Options& options) {
    if (options.threads > 0) set_thread_count(options.threads);
    const ChannelConfig config = read_channel_config(options.file, options.overrides);
    for (const std::string& note : config.notes) std::cerr << "note: " << note << "\n";
    require_gnuplot();
    if (!config.comparison.measured.empty()) read_measured_points(config.comparison.measured);
    if (options.check) return 0;
    OutputFolder folder(options.out);
    for (const auto& left : folder.leftovers())
        std::cerr << "note: " << left.string()
                  << " was left by a run that was killed; delete it if you do not need it\n";

    const ChannelEngine& engine = find_engine(config.fluid.model, config.contact_law, config.fluid.surface);
    ChannelFiles files{folder.path("series"), folder.final_path(), folder.final_path(), options.resume};
    files.checkpoint += ".checkpoint.h5";
    const bool interrupted = std::filesystem::exists(files.checkpoint);
    if (options.resume && !interrupted)
        fail({"--resume", "used where a run was interrupted", {}, "leave it out to begin anew"},
             "no checkpoint '" + files.checkpoint.string() + "'");
    if (!options.resume && interrupted)
        std::cerr << "note: '" << files.checkpoint.string()
                  << "' is of a run that was interrupted; --resume would have gone on with it\n";
    const ChannelRun run = engine.run(config, files);
    if (run.code != 0) {
        std::cerr << "error: " << run.went_wrong << "\n";
        keep_failed_run(run, folder);
        return run.code;
    }
    const ChannelResults& results = run.results;
    const Interrupt drawing;  // does not stop for a Ctrl-C, which would lose what was computed
    std::string unfinished;   // the results are kept where their pictures fail
    try {
        write_summary(config, results, folder.path("summary.json"));
        write_profiles(config, results, folder.path("profiles.json"));
        write_report(config, results, folder);
    } catch (const std::exception& error) {
        unfinished = error.what();
    }
    const std::filesystem::path place = folder.publish();
    std::error_code ignored;
    if (!results.stopped && run.owns_checkpoint) std::filesystem::remove(files.checkpoint, ignored);
    if (!results.stopped && !run.left.empty()) std::filesystem::remove_all(run.left, ignored);

    std::cout << run.printed;
    if (results.stopped)
        std::cout << "stopped early, at " << short_text(results.simulated_s) << " s of "
                  << short_text(config.end_time) << " s; the same command with --resume goes on\n";
    if (results.worn_through)
        std::cout << "the concrete is worn through, at " << short_text(results.simulated_s) << " s of "
                  << short_text(config.end_time) << " s: give it more concrete.layers\n";
    const Real due = config.feed.volume_rate * std::min(results.simulated_s, config.feed.end);
    Real largest = 0;  // stones are fed whole
    for (const StoneClass& stones : config.feed.classes)
        largest = std::max(largest, pi / 6 * cube(stones.size));
    if (results.sediment_fed_m3 < 0.95 * due - largest)
        std::cerr << "note: the supply fell short, there was no room: " << short_text(results.sediment_fed_m3)
                  << " of " << short_text(due) << " m3 were fed; widen the feed or raise its speed\n";
    if (results.water && results.water->off_manning() > ChannelWater::settled_within)
        std::cerr << "note: as the stones began the water was "
                  << short_text(100 * results.water->off_manning())
                  << " % off Manning's depth or speed; let it settle for longer (fluid.settle)\n";
    std::cout << "worn " << short_text(1e6 * results.worn_volume_m3) << " cm3; ";
    if (std::isfinite(results.bed.centre_mean_per_m3))
        std::cout << "at the centre " << short_text(results.bed.centre_mean_per_m3)
                  << " mm per m3 of sediment\n";
    else
        std::cout << "no sediment has passed the gauge yet\n";
    if (!unfinished.empty()) {
        std::cerr << "error: " << unfinished << "\nwhat was computed is in " << place.string()
                  << ", its pictures or its summary are not complete\n";
        return 1;
    }
    std::cout << "results in " << place.string() << ", start with report.html\n";
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("Gravel and water wear a concrete channel.");
    app.add_option("file", options.file, "TOML file; quick.toml and paper.toml come with the program")
        ->capture_default_str();
    app.add_option("--fluid", options.fluid,
                   "none, uniform, shallow, grid, unresolved or resolved; as fluid.model in the file");
    app.add_option("--set", options.overrides, "section.key=value, overrides the file")
        ->allow_extra_args(false)
        ->take_all();
    app.add_option("--out", options.out, "folder of the results")->capture_default_str();
    app.add_option("--threads", options.threads, "0: OMP_NUM_THREADS or all cores")
        ->check(CLI::Range(0, 1024));
    app.add_flag("--check", options.check,
                 "reads and checks the file and runs nothing; what only the whole scene tells, as the stable "
                 "step, is checked as a run begins");
    app.add_flag("--resume", options.resume,
                 "goes on with the run of the same file and options that was interrupted: to the same bits");
    H5dont_atexit();  // files are closed here; after a full disk HDF5's own clean-up at exit would crash
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        std::cerr << "error: " << error.what() << "; see --help\n";
        return 2;
    }
    try {
        // A bare name is one of the files that come with the program.
        if (const auto beside = std::filesystem::path(ABRADE_EXAMPLE_DIR) / options.file;
            !std::filesystem::exists(options.file) && std::filesystem::exists(beside))
            options.file = beside;
        if (options.fluid) options.overrides.push_back("fluid.model=\"" + *options.fluid + "\"");
        return run(options);
    } catch (const InputError& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 2;
    } catch (const std::bad_alloc&) {
        std::cerr << "error: not enough memory; take fewer spheres of concrete or a coarser grid\n";
        return 1;
    } catch (const std::exception& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 1;
    }
}
