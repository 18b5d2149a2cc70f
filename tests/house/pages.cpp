// Programs that pages show are the tested ones and links lead somewhere, and the checks of that can fail.

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <utility>
#include <vector>

namespace fs = std::filesystem;

namespace {

std::string read(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Files of tests/consumer/shown that no page below `root` holds as a whole code block.
std::vector<std::string> not_shown(const fs::path& root) {
    std::string pages = read(root / "README.md");
    for (const auto& entry : fs::recursive_directory_iterator(root / "docs"))
        if (entry.path().extension() == ".md") pages += read(entry.path());
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(root / "tests/consumer/shown"))
        if (pages.find("\n```cpp\n" + read(entry.path()) + "```\n") == std::string::npos)
            found.push_back(entry.path().filename().string());
    return found;
}

/// Pages of docs below `root` that show a picture and no command that draws one.
std::vector<std::string> without_command(const fs::path& root) {
    static const std::regex picture(R"(!\[[^\]]*\]\([^)]+\))"),
        command(R"((bench|bench/charts|examples|docs)/run)");
    std::vector<std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(root / "docs"))
        if (entry.path().extension() == ".md")
            if (const std::string text = read(entry.path());
                std::regex_search(text, picture) && !std::regex_search(text, command))
                found.push_back(entry.path().lexically_relative(root).generic_string());
    return found;
}

/// Links of pages below `root` that lead to no file: "docs/a.md: b.md".
std::vector<std::string> broken_links(const fs::path& root) {
    std::vector<fs::path> pages;
    for (const char* page : {"README.md", "CONTRIBUTING.md"})
        if (fs::exists(root / page)) pages.push_back(root / page);
    for (const auto& entry : fs::recursive_directory_iterator(root / "docs"))
        if (entry.path().extension() == ".md") pages.push_back(entry.path());
    static const std::regex link(R"(\]\(([^)\s"#]+)(#[^)\s"]*)?\))");
    std::vector<std::string> found;
    for (const fs::path& page : pages) {
        const std::string text = read(page);
        for (std::sregex_iterator one(text.begin(), text.end(), link), end; one != end; ++one)
            if (const std::string target = (*one)[1];
                target.find(':') == std::string::npos && !fs::exists(page.parent_path() / target))
                found.push_back(page.lexically_relative(root).generic_string() + ": " + target);
    }
    return found;
}

/// Pages of docs below `root`, those of verification apart, which its site's index (docs/site/index.md) does
/// not list.
std::vector<std::string> not_listed(const fs::path& root) {
    const std::string index = read(root / "docs/site/index.md");
    std::vector<std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(root / "docs")) {
        const fs::path page = entry.path().lexically_relative(root / "docs");
        const std::string folder = page.begin()->string();
        if (page.extension() != ".md" || folder == "site" || folder == "verification") continue;
        if (index.find("\n../" + fs::path(page).replace_extension().generic_string() + "\n") ==
            std::string::npos)
            found.push_back(page.generic_string());
    }
    std::sort(found.begin(), found.end());
    return found;
}

/// A folder of these files alone.
struct MadeUp {
    fs::path root;

    MadeUp(const char* name, const std::vector<std::pair<std::string, std::string>>& files) : root(name) {
        fs::remove_all(root);
        for (const auto& [file, text] : files) {
            fs::create_directories((root / file).parent_path());
            std::ofstream(root / file) << text;
        }
    }
    ~MadeUp() { fs::remove_all(root); }
    MadeUp(const MadeUp&) = delete;
    MadeUp& operator=(const MadeUp&) = delete;
};

}  // namespace

TEST_CASE("the site lists each page") {
    for (const std::string& page : not_listed(fs::path(ABRADE_INCLUDE_DIR).parent_path()))
        FAIL_CHECK("docs/" << page << " stands in no list of docs/site/index.md");
}

TEST_CASE("a page that the site does not list is found") {
    const MadeUp site("made_up_site", {{"docs/site/index.md", "```{toctree}\n../howto/a\n../a\n```\n"},
                                       {"docs/howto/a.md", ""},
                                       {"docs/howto/ab.md", ""},
                                       {"docs/a.md", ""},
                                       {"docs/verification.md", ""}});
    CHECK(not_listed(site.root) == std::vector<std::string>{"howto/ab.md", "verification.md"});
}

TEST_CASE("what pages show is what is tested, to the letter") {
    for (const std::string& file : not_shown(fs::path(ABRADE_INCLUDE_DIR).parent_path()))
        FAIL_CHECK("tests/consumer/shown/" << file << " stands in no code block of README.md or of docs");
}

TEST_CASE("links of pages lead somewhere") {
    for (const std::string& link : broken_links(fs::path(ABRADE_INCLUDE_DIR).parent_path())) FAIL_CHECK(link);
}

TEST_CASE("a link that leads nowhere is found") {
    const MadeUp links("made_up_links",
                       {{"README.md", "[a](docs/howto/a.md#top), [web](https://example.org), `f[0](x)`\n"},
                        {"docs/howto/a.md", "[up](../../README.md) and [gone](../gone.md)\n"}});
    CHECK(broken_links(links.root) ==
          std::vector<std::string>{"README.md: x", "docs/howto/a.md: ../gone.md"});
}

TEST_CASE("pages with pictures say what draws them") {
    for (const std::string& page : without_command(fs::path(ABRADE_INCLUDE_DIR).parent_path()))
        FAIL_CHECK(page);
}

TEST_CASE("a page with a picture and no command is found") {
    const MadeUp pictures("made_up_pictures", {{"docs/a.md", "![a curve](a.png)\n"},
                                               {"docs/b.md", "    bench/run charts b\n\n![a curve](b.png)\n"},
                                               {"docs/c.md", "No picture.\n"}});
    CHECK(without_command(pictures.root) == std::vector<std::string>{"docs/a.md"});
}

TEST_CASE("a page that shows something else is found") {
    const MadeUp house("made_up_house",
                       {{"tests/consumer/shown/law.hpp", "int law;\n"}, {"docs/howto/law.md", ""}});
    const fs::path& root = house.root;
    const auto shows = [&](const std::string& page, const std::string& text) {
        std::ofstream(root / page) << text;
        return not_shown(root).empty();
    };
    CHECK(!shows("README.md", "No code.\n"));
    CHECK(!shows("docs/howto/law.md", "\n```cpp\nint  law;\n```\n"));
    CHECK(!shows("docs/howto/law.md", "\n```cpp\nint law;\nint more;\n```\n"));
    CHECK(shows("docs/howto/law.md", "\n```cpp\nint law;\n```\n"));
    CHECK(!shows("docs/howto/law.md", "Gone.\n"));
    CHECK(shows("README.md", "\n```cpp\nint law;\n```\n"));
}
