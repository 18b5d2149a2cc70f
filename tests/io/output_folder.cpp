// Results appear all at once under their final name; what the user put there is never lost.
#include <abrade/io/output_folder.hpp>

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

using namespace abrade;
namespace fs = std::filesystem;

namespace {

void put(const fs::path& path, const std::string& text) { std::ofstream{path} << text; }

std::string text_of(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream{path}.rdbuf();
    return text.str();
}

/// Names in a folder, hidden ones too.
std::size_t entries(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator{folder}, fs::directory_iterator{}));
}

/// A fresh folder to work in.
fs::path fresh(const std::string& name) {
    fs::remove_all(name);
    fs::create_directories(name);
    return name;
}

std::string message_of(const fs::path& path) {
    try {
        const OutputFolder folder{path};
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was thrown";
}

bool has(const std::string& text, std::string_view part) { return text.find(part) != text.npos; }

}  // namespace

TEST_CASE("nothing appears before publish, everything after") {
    const fs::path base = fresh("publish");
    OutputFolder folder{base / "deep" / "run"};
    put(folder.path("summary.json"), "{}");
    put(folder.path("frames/0.png"), "png");
    CHECK(!fs::exists(base / "deep/run"));
    CHECK(folder.publish() == fs::absolute(base / "deep/run"));
    CHECK(text_of(base / "deep/run/summary.json") == "{}");
    CHECK(text_of(base / "deep/run/frames/0.png") == "png");
    CHECK(entries(base / "deep") == 1);
}

TEST_CASE("a run that does not publish leaves nothing, and the old results stand") {
    const fs::path base = fresh("unpublished");
    {
        OutputFolder first{base / "run"};
        put(first.path("a.txt"), "old");
        first.publish();
    }
    {
        OutputFolder second{base / "run"};
        put(second.path("a.txt"), "half");
    }
    CHECK(text_of(base / "run/a.txt") == "old");
    CHECK(entries(base) == 1);
}

TEST_CASE("the next run replaces its own files and keeps the user's") {
    const fs::path base = fresh("replace");
    {
        OutputFolder first{base / "run"};
        put(first.path("a.txt"), "old");
        put(first.path("gone/b.txt"), "old");
        first.publish();
    }
    put(base / "run/notes.md", "mine");
    put(base / "run/later.txt", "mine too");
    fs::create_directories(base / "run/gone/mine");
    put(base / "run/gone/mine/c.txt", "mine as well");
    for (int again = 0; again < 2; ++again) {
        OutputFolder next{base / "run"};
        put(next.path("a.txt"), "new");
        if (again == 0) put(next.path("later.txt"), "a result");
        next.publish();
        CHECK(text_of(base / "run/a.txt") == "new");
        CHECK(!fs::exists(base / "run/gone/b.txt"));
        CHECK(text_of(base / "run/notes.md") == "mine");
        CHECK(text_of(base / "run/later.txt.kept-1") == "mine too");
        CHECK(fs::exists(base / "run/later.txt") == (again == 0));
        CHECK(text_of(base / "run/gone/mine/c.txt") == "mine as well");
        CHECK(entries(base) == 1);
    }
}

TEST_CASE("a place that cannot be used is refused before the run") {
    const fs::path base = fresh("refused");
    put(base / "file", "text");
    CHECK(has(message_of(base / "file"), "must be a folder"));
    CHECK(has(message_of(base / "file/below"), "must be one that can be written"));
    CHECK(has(message_of(""), "must be a path"));
    CHECK(has(message_of("."), "name a folder below it"));
    CHECK(has(message_of(".."), "name a folder below it"));

    fs::create_directories(base / "theirs");
    put(base / "theirs/thesis.tex", "years of work");
    CHECK(has(message_of(base / "theirs"), "must be new, empty, or made by an earlier run"));
    CHECK(text_of(base / "theirs/thesis.tex") == "years of work");
    CHECK(entries(base) == 2);

    fs::create_directories(base / "empty");
    OutputFolder{base / "empty"}.publish();
    CHECK(fs::exists(base / "empty"));
    CHECK(message_of(base / "trailing/") == "nothing was thrown");
}

TEST_CASE("a link to a folder is followed, and stays") {
    const fs::path base = fresh("link");
    fs::create_directories(base / "disk/run");
    fs::create_directory_symlink(fs::absolute(base / "disk/run"), base / "run");
    OutputFolder folder{base / "run"};
    put(folder.path("a.txt"), "new");
    folder.publish();
    CHECK(fs::is_symlink(base / "run"));
    CHECK(text_of(base / "disk/run/a.txt") == "new");
}

TEST_CASE("files that turn up in the way during the run are safe, and so are the results") {
    const fs::path base = fresh("meanwhile");
    OutputFolder folder{base / "run"};
    put(folder.path("a.txt"), "result");
    fs::create_directories(base / "run");
    put(base / "run/theirs.txt", "theirs");
    std::string message;
    try {
        folder.publish();
    } catch (const FileError& error) {
        message = error.what();
    }
    CHECK(has(message, "they are in '"));
    CHECK(text_of(base / "run/theirs.txt") == "theirs");
    const OutputFolder other{base / "else"};
    const auto left = OutputFolder{base / "run2"}.leftovers();
    CHECK(left.empty());
    std::size_t kept = 0;
    for (const auto& entry : fs::directory_iterator{base})
        kept += fs::exists(entry.path() / "a.txt") &&
                entry.path().filename().string().starts_with(".run.partial-");
    CHECK(kept == 1);
}

TEST_CASE("a failed run can be put beside, and leftovers are found") {
    const fs::path base = fresh("beside");
    {
        OutputFolder good{base / "run"};
        put(good.path("a.txt"), "good");
        good.publish();
    }
    fs::create_directories(base / ".run.partial-1");
    OutputFolder folder{base / "run"};
    CHECK(folder.leftovers().size() == 1);
    put(folder.path("a.txt"), "bad");
    CHECK(folder.publish_beside("failed").filename() == "run.failed");
    CHECK(text_of(base / "run/a.txt") == "good");
    CHECK(text_of(base / "run.failed/a.txt") == "bad");
}
