#pragma once
// A run that goes on later as if it had never been interrupted: checkpoints, and reading them back.

#include <abrade/core/simd.hpp>
#include <abrade/io/state_file.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

namespace abrade {

/// An object whose fields are saved together with others, under a name of its own.
template <ListsFields T>
struct StatePart {
    std::string_view name;  ///< "simulation"
    T& object;
};
template <class T>
StatePart(const char*, T&) -> StatePart<T>;
template <class T>
StatePart(const char*, const T&) -> StatePart<const T>;

namespace detail {

inline constexpr std::int64_t state_version = 4;
inline constexpr std::string_view state_version_name = "abrade_state_version";

/// Asks the disk to have a file, or a folder's list of files, for good: some say only then that they are
/// full.
inline void settle_on_disk(const std::filesystem::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY);
    const bool done = file >= 0 && ::fsync(file) == 0;
    const int why = errno;
    if (file >= 0) ::close(file);
    if (!done) throw FileError(std::strerror(why));
}

/// The first line in which two texts differ.
inline std::pair<std::string, std::string> first_difference(const std::string& a, const std::string& b) {
    std::istringstream one(a), other(b);
    std::string line, its;
    for (;;) {
        const bool more = static_cast<bool>(std::getline(one, line)),
                   its_more = static_cast<bool>(std::getline(other, its));
        if (!more) line.clear();
        if (!its_more) its.clear();
        if (line != its || (!more && !its_more)) return {line, its};
    }
}

}  // namespace detail

/// Saves all fields of the parts: written to `path.tmp`, then renamed, so that `path` is a whole checkpoint
/// at any time, the old one or the new one. `about`, lines of text, says what they belong to: a restart asks
/// for the same. Throws FileError where the disk is full or the folder gone; the old one is then still there.
template <class... T>
void save_state(const std::filesystem::path& path, const std::string& about, StatePart<T>... parts) {
    std::filesystem::path aside = path;
    aside += ".tmp";
    try {
        Hdf5File file = Hdf5File::create(aside);
        (write_fields(file, parts.name, std::as_const(parts.object)), ...);
        file.write_rows("about/text", "-", detail::column_of<char>(1), std::as_bytes(std::span(about)));
        file.write_attribute({}, "pack_lanes", std::int64_t{pack_lanes});
        file.write_attribute({}, detail::state_version_name, detail::state_version);
        file.close();
        detail::settle_on_disk(aside);
        std::filesystem::rename(aside, path);
        detail::settle_on_disk(std::filesystem::absolute(path).parent_path());
    } catch (const std::exception& error) {
        std::error_code ignored;
        std::filesystem::remove(aside, ignored);
        throw FileError("cannot save '" + path.string() + "': " + error.what());
    }
}

/// Reads the fields of a checkpoint into parts that were built as the saved ones were: a simulation of the
/// same scene and laws after `build()`. It then goes on, with any number of threads, to the same bits. Throws
/// InputError where the file is no such checkpoint, is broken, of another version, of another machine's packs
/// or about something else; the parts are then no good.
template <class... T>
void restore_state(const std::filesystem::path& path, const std::string& about, StatePart<T>... parts) {
    const Hdf5File file = Hdf5File::open(path);
    const auto refuse = [&](const std::string& why) {
        throw InputError("cannot go on from '" + path.string() + "': " + why);
    };
    const auto value = [&](std::string_view name) -> std::int64_t {
        try {
            const AttributeValue found = file.attribute({}, name);
            const auto* number = std::get_if<std::int64_t>(&found);
            return number ? *number : -1;
        } catch (const InputError&) {
            return -1;
        }
    };
    if (value(detail::state_version_name) < 0)
        refuse("it is an HDF5 file but not what save_state() wrote; name a checkpoint of a run");
    if (value(detail::state_version_name) != detail::state_version)
        refuse("it is of version " + std::to_string(value(detail::state_version_name)) + ", not " +
               std::to_string(detail::state_version) + "; go on with the Abrade that saved it");
    if (value("pack_lanes") != pack_lanes)
        refuse("it was saved by a program that works on " + std::to_string(value("pack_lanes")) +
               " numbers at a time, not " + std::to_string(pack_lanes) +
               "; go on with a program compiled for the same processor");
    std::string its(file.count_rows("about/text", detail::column_of<char>(1)), '\0');
    file.read_rows("about/text", detail::column_of<char>(1), std::as_writable_bytes(std::span(its)));
    if (its != about) {
        const auto [saved, asked] = detail::first_difference(its, about);
        refuse("it is about '" + saved + "', not '" + asked + "'; ask for the run that was saved");
    }
    try {
        (read_fields(file, parts.name, parts.object), ...);
    } catch (const FileError& error) {
        refuse(std::string("it is damaged: ") + error.what());
    }
}

/// When to save: so many seconds of wall time after the last time.
class CheckpointClock {
public:
    explicit CheckpointClock(Real every) : every_(every) {
        require_positive(every, "CheckpointClock.every", "s");
    }
    bool due() const { return std::chrono::duration<Real>(Clock::now() - last_).count() >= every_; }
    void saved() { last_ = Clock::now(); }

private:
    using Clock = std::chrono::steady_clock;
    Real every_;  ///< [s]
    Clock::time_point last_ = Clock::now();
};

}  // namespace abrade
