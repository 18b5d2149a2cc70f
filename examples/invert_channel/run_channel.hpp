#pragma once
// One run of the invert channel with a fluid that is known when this is compiled.

#include "channel.hpp"
#include "fluids.hpp"
#include "recorder.hpp"
#include "water_start.hpp"

#include "../common/interrupt.hpp"
#include "../common/progress.hpp"

#include <sstream>

namespace abrade::examples {

/// Between two looks at what has passed and at what contacts take up, at most [s].
constexpr Real look_every = 0.02;

/// Steps of `stable_dt` between two looks for touches. The smallest stone touches with its centre behind the
/// contact for some nine of them, with a corner aside for a half of that.
constexpr Real touch_steps = 3;

/// Looks in `every` [s] that see touches, 1 where nobody asks for hops.
template <ContactLaw Contact>
Real looks_for_touches(const ChannelConfig& c, Real every) {
    if (!c.comparison.hops) return 1;
    const Real size = std::ranges::min_element(c.feed.classes, {}, &StoneClass::size)->size;
    const Real step = make_contact<Contact>(c).stable_dt(c.feed.density * pi / 6 * cube(size), 0.5 * size);
    return std::ceil(every / (touch_steps * step));
}

/// `look_at(fluid, first)` sees the water as the stones begin, and at the end; what it saw first is in
/// `water`.
template <ContactLaw Contact, FluidModel Fluid, class LookAt>
ChannelRun run_channel(const ChannelConfig& config, const ChannelFiles& files, Fluid fluid,
                       ChannelWater& water, LookAt&& look_at) {
    ChannelRun run;
    auto sim = make_simulation<Contact>(config, std::move(fluid));
    const Interrupt interrupt;
    LedgerHistory history;
    BedRecord bed(config);
    Interruption interruption(config, files);
    {
        Recorder recorder(files.series, config.output_every, files.resume);
        const auto with_parts = [&](auto&& body) {
            body(StatePart{"simulation", sim}, StatePart{"bed", bed}, StatePart{"recorder", recorder},
                 StatePart{"water", water});
        };
        if (files.resume) {
            sim.build();
            with_parts([&](auto... parts) { interruption.restore(parts...); });
        }
        Progress progress("invert channel", config.end_time, "s", sim.time());
        bool asked = false;  // to stop, and what there was then is saved
        const auto stop = [&] {
            std::string note = std::to_string(sim.feed()->supplied_stones()) + " stones fed";
            if constexpr (AdvancingFluid<Fluid>)
                if (sim.fluid_model().time() < 0)
                    note = "water settles for " + short_text(-sim.fluid_model().time()) + " s";
            progress.update(sim.time(), note);
            if (bed.done()) return true;
            asked = interrupt.requested();
            if (asked || interruption.due()) {
                recorder.close_file();
                with_parts([&](auto... parts) { interruption.save(parts...); });
            }
            return asked;
        };
        const Real every = config.output_every / std::ceil(config.output_every / look_every);
        const auto watch = [&](const auto& now) {
            if (now.steps() == 0) look_at(now.fluid_model(), true);
            if (config.comparison.hops) bed.see_hops(now);
            const bool ends = now.time() >= config.end_time || now.stopped() || now.concrete().worn_through();
            if (!bed.due(now.time(), now.time_step(), every) && !ends) return;
            bed(now);
            recorder(now);
        };
        try {
            sim.run({.end_time = config.end_time,
                     .time_step = config.time_step,
                     .safety = config.safety,
                     .observe_every = every / looks_for_touches<Contact>(config, every),
                     .skin = config.skin,
                     .stop = stop},
                    watch);
        } catch (const RunError& error) {
            progress.clear();
            run.went_wrong = error.what(), run.code = 3;
        } catch (const InputError& error) {
            throw InputError(config.source + ": " + error.what());  // what only the whole scene could tell
        } catch (const std::exception& error) {                     // a full disk, no memory
            progress.clear();
            run.went_wrong = error.what(), run.code = 1;
        }
        history = recorder.take_history();
        run.results.stopped = asked;
    }
    run.owns_checkpoint = interruption.owns_checkpoint();
    if (run.code != 0) {
        run.last_good = sim.last_good();
        const auto& flow = sim.fluid_model();
        if constexpr (requires { flow.columns().fields(), flow.time(); }) {
            const auto columns = flow.columns();
            for (const FieldView& one : columns.fields())
                run.last_water.push_back(
                    {std::string(one.name), std::string(one.unit), {one.values.begin(), one.values.end()}});
            run.last_water_time = flow.time();
        }
        return run;
    }
    look_at(sim.fluid_model(), false);
    const bool stopped = run.results.stopped;
    run.results = make_results(config, sim, std::move(history), bed);
    run.results.stopped = stopped;
    run.left = interruption.left();
    std::ostringstream printed;
    printed << sim;
    run.printed = printed.str();
    return run;
}

}  // namespace abrade::examples
