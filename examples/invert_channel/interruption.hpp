#pragma once
// A run that goes on after it was interrupted: its checkpoint, and the series that it had written by then.

#include "config.hpp"

#include <abrade/io/restart.hpp>
#include <abrade/io/series.hpp>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

namespace abrade::examples {

/// Where a run writes, and whether it goes on with what is there.
struct ChannelFiles {
    std::filesystem::path series;      ///< stem of the series for ParaView, in a folder of the run's own
    std::filesystem::path checkpoint;  ///< made and renamed beside the results
    std::filesystem::path results;     ///< folder of the results of a run that was stopped well
    bool resume = false;
};

/// Where the series of a run lies, and whose it is.
struct SeriesPlace {
    std::string stem{}, run{};
    static void fields(auto&& field) { field("stem", &SeriesPlace::stem), field("run", &SeriesPlace::run); }
};

/// Keeps the checkpoint of a run. It belongs to a run with these parameters.
class Interruption {
public:
    /// Throws InputError where another run with the same checkpoint is under way.
    Interruption(const ChannelConfig& config, const ChannelFiles& files)
        : files_(files), lock_path_(files.checkpoint.string() + ".lock"),
          clock_(60 * config.checkpoint_every), about_("version = " ABRADE_VERSION "\n") {
        for (const Parameter& one : config.parameters)
            if (one.key != "run.checkpoint_every") about_ += one.key + " = " + one.value + "\n";
        lock_ = ::open(lock_path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (lock_ >= 0 && ::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
            ::close(std::exchange(lock_, -1));
            fail({"output folder", "of one run at a time", {}, "wait for the other run, or name another"},
                 "'" + files.results.string() + "' of one that is under way");
        }
        if (files.resume) return;
        here_.run = std::to_string(std::chrono::system_clock::now().time_since_epoch().count()) + "-" +
                    std::to_string(::getpid());
        sign();
    }
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;
    ~Interruption() {
        if (lock_ < 0) return;
        std::error_code ignored;
        std::filesystem::remove(lock_path_, ignored);
        ::close(lock_);
    }

    bool due() const { return clock_.due(); }
    bool owns_checkpoint() const noexcept { return owns_; }

    template <class... T>
    void save(StatePart<T>... parts) {
        here_.stem = std::filesystem::absolute(files_.series).string();
        save_state(files_.checkpoint, about_, StatePart{"series", std::as_const(here_)}, parts...);
        clock_.saved(), owns_ = true;
        std::error_code ignored;
        if (!left_.empty()) std::filesystem::remove_all(std::exchange(left_, {}), ignored);
    }

    /// Also brings the series here that was written until then. Throws InputError where the checkpoint is not
    /// this run's.
    template <class... T>
    void restore(StatePart<T>... parts) {
        restore_state(files_.checkpoint, about_, StatePart{"series", here_});
        const std::filesystem::path stem = here_.stem;
        std::filesystem::path failed = files_.results;
        failed += ".failed";
        // In the folder of a run that was killed, or where one that ended early has put its results.
        for (const auto& folder : {stem.parent_path(), files_.results, failed}) {
            if (signature_in(folder / stem.filename()) != here_.run) continue;
            for (const auto& file : SeriesWriter::files_at(folder / stem.filename()))
                std::filesystem::copy_file(file, files_.series.parent_path() / file.filename());
            if (folder == stem.parent_path()) left_ = folder;
            break;
        }
        sign();
        restore_state(files_.checkpoint, about_, parts...);
        owns_ = true;
    }

    /// The folder of the run that was killed, which the checkpoint still names; none: it names this run's. To
    /// be removed with the checkpoint, or where that is written anew.
    const std::filesystem::path& left() const noexcept { return left_; }

private:
    static std::filesystem::path signature_path(std::filesystem::path stem) { return stem += ".run"; }
    static std::string signature_in(const std::filesystem::path& stem) {
        std::string run;
        std::ifstream(signature_path(stem)) >> run;
        return run;
    }
    void sign() const { std::ofstream(signature_path(files_.series)) << here_.run << "\n"; }

    ChannelFiles files_;
    std::string lock_path_;
    int lock_ = -1;
    CheckpointClock clock_;
    std::string about_;
    SeriesPlace here_;
    std::filesystem::path left_;
    bool owns_ = false;  ///< this run has written the checkpoint, or goes on from it
};

}  // namespace abrade::examples
