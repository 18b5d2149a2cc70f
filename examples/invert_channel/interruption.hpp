#pragma once
// A run that goes on after it was interrupted: its checkpoint, and the series that it had written by then.

#include "config.hpp"

#include <abrade/io/restart.hpp>
#include <abrade/io/series.hpp>

#include <filesystem>
#include <string>

namespace abrade::examples {

/// Where a run writes, and whether it goes on with what is there.
struct ChannelFiles {
    std::filesystem::path series;      ///< stem of the series for ParaView, in a folder of the run's own
    std::filesystem::path checkpoint;  ///< made and renamed beside the results
    std::filesystem::path results;     ///< folder of the results of a run that was stopped well
    bool resume = false;
};

/// Of a run's series.
struct SeriesPlace {
    std::string stem{};
    static void fields(auto&& field) { field("stem", &SeriesPlace::stem); }
};

/// Keeps the checkpoint of a run. What belongs to it is the file's text and all parameters.
class Interruption {
public:
    Interruption(const ChannelConfig& config, const ChannelFiles& files)
        : files_(files), clock_(60 * config.checkpoint_every) {
        for (const Parameter& one : config.parameters)
            if (one.key != "run.checkpoint_every") about_ += one.key + " = " + one.value + "\n";
    }

    bool due() const { return clock_.due(); }

    template <class... T>
    void save(StatePart<T>... parts) {
        const SeriesPlace here{std::filesystem::absolute(files_.series).string()};
        save_state(files_.checkpoint, about_, StatePart{"series", here}, parts...);
        clock_.saved();
        if (!left_.empty()) std::filesystem::remove_all(std::exchange(left_, {}));
    }

    /// Also brings the series here that was written until then. Throws InputError where the checkpoint is not
    /// this run's.
    template <class... T>
    void restore(StatePart<T>... parts) {
        SeriesPlace there;
        restore_state(files_.checkpoint, about_, StatePart{"series", there});
        const std::filesystem::path stem = there.stem;
        std::filesystem::path failed = files_.results;
        failed += ".failed";
        // In the folder of a run that was killed, or where one that ended early has put its results.
        for (const auto& folder : {stem.parent_path(), files_.results, failed}) {
            const auto files = SeriesWriter::files_at(folder / stem.filename());
            for (const auto& file : files)
                std::filesystem::copy_file(file, files_.series.parent_path() / file.filename());
            if (!files.empty()) break;
        }
        if (std::filesystem::exists(stem.parent_path())) left_ = stem.parent_path();
        restore_state(files_.checkpoint, about_, parts...);
    }

private:
    ChannelFiles files_;
    CheckpointClock clock_;
    std::string about_;
    std::filesystem::path left_;  ///< the folder of the run that was killed, until the next checkpoint
};

}  // namespace abrade::examples
