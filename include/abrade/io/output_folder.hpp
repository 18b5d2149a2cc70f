#pragma once
// Results appear under their final name all at once, or not at all.

#include <abrade/core/require.hpp>
#include <abrade/io/file_error.hpp>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace abrade {

/// A folder of results that is filled aside, in the hidden sibling `.name.partial-<pid>`, and then put in the
/// place of `name`.
/// - The constructor refuses (InputError), before any work is done, a place that cannot be written and a
/// folder
///   that holds files but was not made by this class: nothing of the user's is in danger by a mistyped path.
/// - `publish` swaps the folders. It deletes of the old one only the files on the list `.abrade-files`, which
/// the
///   run that made them left there. Anything else is the user's and is carried over; where the new run made a
///   file of the same name, the user's becomes `file.kept-1`.
/// - Without `publish` the destructor removes the partial folder. A killed run leaves it (`leftovers`).
class OutputFolder {
public:
    explicit OutputFolder(const std::filesystem::path& final_path) : final_{resolve(final_path)} {
        check_replaceable();
        partial_ = sibling("partial");
        std::error_code error;
        std::filesystem::create_directories(partial_, error);
        if (error) refuse(error.message());
        if (!std::ofstream{partial_ / list_name_}) {
            std::filesystem::remove_all(partial_, error);
            refuse("no permission to make a file there");
        }
    }
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;
    ~OutputFolder() {
        std::error_code ignored;
        if (!partial_.empty()) std::filesystem::remove_all(partial_, ignored);
    }

    /// Where to write the file `name` ("summary.json", "frames/0.png") now. Folders above it are made.
    std::filesystem::path path(const std::filesystem::path& name) const {
        const std::filesystem::path whole = partial_ / name;
        std::filesystem::create_directories(whole.parent_path());
        return whole;
    }

    /// Where the results will be.
    const std::filesystem::path& final_path() const noexcept { return final_; }

    /// Where they are until then.
    const std::filesystem::path& partial_path() const noexcept { return partial_; }

    /// Partial folders of earlier runs that were killed: to be shown to the user, who may still want what
    /// they hold.
    std::vector<std::filesystem::path> leftovers() const {
        std::vector<std::filesystem::path> found;
        std::error_code ignored;
        const std::string start = "." + final_.filename().string() + ".partial-";
        for (const auto& entry : std::filesystem::directory_iterator{final_.parent_path(), ignored})
            if (entry.path() != partial_ && entry.path().filename().string().starts_with(start))
                found.push_back(entry.path());
        return found;
    }

    /// Puts the results in place. Every file of this run must be closed. Returns the final path.
    /// On failure the results stay in the partial folder, and the error says where.
    std::filesystem::path publish() { return publish_to(final_); }

    /// Puts them beside it instead, as `name.suffix`: for a run that failed and whose last state is worth
    /// keeping. What an earlier failure left under that name goes by the rules of `publish`.
    std::filesystem::path publish_beside(std::string_view suffix) {
        std::filesystem::path place = final_;
        place += "." + std::string{suffix};
        return publish_to(place);
    }

private:
    static constexpr const char* list_name_ = ".abrade-files";

    /// Absolute, links followed, so that the sibling is on the same disk.
    static std::filesystem::path resolve(const std::filesystem::path& given) {
        if (given.empty()) fail({"output folder", "a path", {}, "name a folder"}, "''");
        std::error_code error;
        std::filesystem::path path =
            std::filesystem::weakly_canonical(std::filesystem::absolute(given), error);
        if (error) path = std::filesystem::absolute(given).lexically_normal();
        return path.has_filename() ? path : path.parent_path();
    }

    std::filesystem::path sibling(std::string_view kind) const { return sibling_of(final_, kind); }

    static std::filesystem::path sibling_of(const std::filesystem::path& place, std::string_view kind) {
        const std::string stem =
            "." + place.filename().string() + "." + std::string{kind} + "-" + std::to_string(getpid());
        std::filesystem::path path = place.parent_path() / stem;
        for (int i = 2; exists(path); ++i) path = place.parent_path() / (stem + "-" + std::to_string(i));
        return path;
    }

    static bool exists(const std::filesystem::path& path) {
        std::error_code ignored;
        return std::filesystem::symlink_status(path, ignored).type() > std::filesystem::file_type::not_found;
    }

    [[noreturn]] void refuse(const std::string& why) const {
        fail({"output folder", "one that can be written", {}, "choose another"},
             "'" + final_.string() + "' (" + why + ")");
    }

    void check_replaceable() const { check_replaceable(final_); }

    static void check_replaceable(const std::filesystem::path& place) {
        namespace fs = std::filesystem;
        const std::string shown = "'" + place.string() + "'";
        std::error_code error;
        const fs::path here = fs::current_path(error);
        if (!error &&
            std::mismatch(place.begin(), place.end(), here.begin(), here.end()).first == place.end())
            fail({"output folder", "one that can be replaced", {}, "name a folder below it"},
                 shown + " (the working folder or above it)");
        if (!exists(place)) return;
        if (!fs::is_directory(place, error))
            fail({"output folder", "a folder", {}, "choose another name or move the file"},
                 shown + " (a file)");
        const bool empty = fs::is_empty(place, error);
        if (error)
            fail({"output folder", "one that can be read", {}, "choose another"},
                 shown + " (" + error.message() + ")");
        if (!empty && !exists(place / list_name_))
            fail({"output folder",
                  "new, empty, or made by an earlier run",
                  {},
                  "choose another or move what it holds"},
                 shown + " (it holds other files)");
    }

    std::filesystem::path publish_to(const std::filesystem::path& place) {
        namespace fs = std::filesystem;
        fs::path old;
        try {
            write_list();
            check_replaceable(place);
            if (exists(place)) {
                old = sibling_of(place, "old");
                fs::rename(place, old);
            }
            fs::rename(partial_, place);
        } catch (const std::exception& error) {
            std::error_code ignored;
            if (!old.empty() && exists(old) && !exists(place)) fs::rename(old, place, ignored);
            const std::string kept = std::exchange(partial_, {}).string();
            throw FileError("cannot put the results at '" + place.string() + "' (" + error.what() +
                            "); they are in '" + kept + "'");
        }
        partial_.clear();
        if (!old.empty()) retire(old, place);
        return place;
    }

    /// Lists what this run made, so that the next one knows what it may delete.
    void write_list() const {
        namespace fs = std::filesystem;
        std::set<std::string> files{list_name_};
        for (const auto& entry : fs::recursive_directory_iterator{partial_})
            if (!entry.is_directory() || entry.is_symlink())
                files.insert(entry.path().lexically_relative(partial_).generic_string());
        std::ofstream list{partial_ / list_name_};
        for (const std::string& file : files) list << file << '\n';
        list.close();
        if (!list) throw FileError("cannot write the list of files; is the disk full?");
    }

    /// Deletes the listed files of the old folder, moves all others to the new one, removes the folders left
    /// empty.
    static void retire(const std::filesystem::path& old, const std::filesystem::path& place) {
        namespace fs = std::filesystem;
        std::error_code error;  // the results are in place: nothing here may spoil that
        std::set<std::string> ours;
        std::ifstream list{old / list_name_};
        for (std::string line; std::getline(list, line);) ours.insert(line);
        std::vector<fs::path> files;
        std::vector<fs::path> folders{old};
        for (const auto& entry :
             fs::recursive_directory_iterator{old, fs::directory_options::skip_permission_denied, error})
            (entry.is_directory() && !entry.is_symlink() ? folders : files).push_back(entry.path());
        for (const fs::path& file : files) {
            const fs::path name = file.lexically_relative(old);
            if (ours.contains(name.generic_string())) {
                fs::remove(file, error);
                continue;
            }
            fs::path target = place / name;
            for (int i = 1; exists(target); ++i)
                target = place / (name.string() + ".kept-" + std::to_string(i));
            fs::create_directories(target.parent_path(), error);
            fs::rename(file, target, error);  // where that fails the file stays, and so does the old folder
        }
        for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder) fs::remove(*folder, error);
    }

    std::filesystem::path final_;
    std::filesystem::path partial_;
};

}  // namespace abrade
