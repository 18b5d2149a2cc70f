#pragma once
// A TOML document that knows where each value comes from: a line of the file, or an override of the command
// line.

#include <abrade/core/require.hpp>

#include <toml++/toml.h>

#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace abrade::examples {

/// A parsed document with overrides applied. Keys are written "water.depth" or "stones[0].diameter".
class TomlDocument {
public:
    /// Reads a file. `overrides` are texts "section.key=value" with values in TOML.
    static TomlDocument from_file(const std::filesystem::path& path,
                                  std::span<const std::string> overrides = {}) {
        const auto refuse = [&](const std::string& why) {
            fail({"parameter file", "one that can be read", {}, "check its path"},
                 "'" + path.string() + "' (" + why + ")");
        };
        std::error_code error;
        if (std::filesystem::is_directory(path, error)) refuse("a folder");
        std::ifstream file{path, std::ios::binary};
        if (!file) refuse(std::error_code{errno, std::generic_category()}.message());
        std::ostringstream text;
        text << file.rdbuf();
        TomlDocument document = from_text(text.str(), path.string(), overrides);
        document.folder_ = path.parent_path();
        return document;
    }

    /// Parses a text; `source` names it in messages.
    static TomlDocument from_text(std::string_view text, std::string source,
                                  std::span<const std::string> overrides = {}) {
        TomlDocument document;
        document.source_ = std::move(source);
        try {
            document.root_ = toml::parse(text, document.source_);
        } catch (const toml::parse_error& error) {
            throw InputError(document.place(error.source()) +
                             ": not valid TOML: " + std::string{error.description()});
        }
        for (const std::string& assignment : overrides) document.set(assignment);
        return document;
    }

    /// The file's name as given.
    const std::string& source() const noexcept { return source_; }

    /// The folder of the file; empty for a text.
    const std::filesystem::path& folder() const noexcept { return folder_; }

    /// The value at `key`, or nullptr. InputError where a table is wanted on the way and something else is
    /// there.
    const toml::node* find(std::string_view key) const {
        const toml::node* node = &root_;
        for (const Step& step : split(key)) {
            if (!node->is_table()) wrong_type(*node, key, "inside a table");
            node = node->as_table()->get(step.name);
            if (node == nullptr) return nullptr;
            if (!step.index) continue;
            if (!node->is_array()) wrong_type(*node, key, "inside an array");
            node = node->as_array()->get(*step.index);
            if (node == nullptr) return nullptr;
        }
        return node;
    }

    /// Calls visit(full key, place of the key) for each value, array of values and empty table.
    void visit_leaves(const auto& visit) const { visit_leaves(root_, {}, visit); }

    /// "quick.toml:12:9" or "--set key=value".
    std::string where(const toml::node& node, std::string_view key) const {
        std::string given = override_of(key);
        return given.empty() ? place(node.source()) : given;
    }

    /// "quick.toml:12:9".
    std::string place(const toml::source_region& at) const {
        if (at.begin.line == 0) return source_;
        return source_ + ":" + std::to_string(at.begin.line) + ":" + std::to_string(at.begin.column);
    }

    /// What a message begins with: "quick.toml:12:9: water.depth".
    std::string label(const toml::node& node, std::string_view key) const {
        return where(node, key) + ": " + std::string{key};
    }

    /// "--set ..." where an override gave the key, or a table or array that holds it; else empty.
    std::string override_of(std::string_view key) const {
        for (const auto& [set, text] : overrides_)
            if (is_within(key, set)) return text;
        return {};
    }

    /// Whether `key` is `outer` or something inside it.
    static bool is_within(std::string_view key, std::string_view outer) {
        return key.starts_with(outer) &&
               (key.size() == outer.size() || key[outer.size()] == '.' || key[outer.size()] == '[');
    }

    /// Throws InputError "quick.toml:12:9: water.depth must be a number in m, got the text 'deep'".
    [[noreturn]] void wrong_type(const toml::node& node, std::string_view key, const std::string& wanted,
                                 std::string_view unit = {}) const {
        std::ostringstream value;
        if (const auto* number = node.as_floating_point()) {
            value << " " << to_text(number->get());
        } else if (node.is_value()) {
            node.visit([&](const auto& n) {
                if constexpr (toml::is_value<decltype(n)>) value << " " << n;
            });
        }
        fail({label(node, key), wanted + (unit.empty() ? "" : " in " + std::string{unit})},
             type_name(node) + value.str());
    }

private:
    struct Step {
        std::string name;
        std::optional<std::size_t> index;
    };

    /// Applies "a.b=value".
    void set(const std::string& assignment) {
        const std::size_t sign = assignment.find('=');
        const std::string key = sign == std::string::npos ? "" : trimmed(assignment.substr(0, sign));
        if (key.empty()) fail({"--set", "given as section.key=value"}, "'" + assignment + "'");
        const std::string value = trimmed(assignment.substr(sign + 1));
        toml::table parsed;
        try {
            parsed = toml::parse("value = " + value);
        } catch (const toml::parse_error&) {  // left empty: told below
        }
        if (parsed.size() != 1)
            fail({"--set " + key,
                  "given a TOML value",
                  {},
                  "text needs quotes: --set '" + key + "=\"" + value + "\"'"},
                 "'" + value + "'");
        put(key, *parsed.get("value"));
        overrides_[key] = "--set " + assignment;
    }

    void put(const std::string& key, const toml::node& value) {
        const std::vector<Step> steps = split(key);
        toml::node* node = &root_;
        for (const Step& step : steps) {
            const bool last = &step == &steps.back();
            toml::table* table = node->as_table();
            if (table == nullptr) fail({"--set " + key, "inside a table"}, "inside " + type_name(*node));
            if (!step.index) {
                if (last)
                    table->insert_or_assign(step.name, value);
                else
                    table->insert(step.name, toml::table{});  // does nothing where it is there
                node = table->get(step.name);
                continue;
            }
            node = table->get(step.name);
            toml::array* array = node == nullptr ? nullptr : node->as_array();
            if (array == nullptr || *step.index >= array->size())
                fail({"--set " + key, "within the arrays of " + source_, {}, "add the element there"},
                     step.name + "[" + std::to_string(*step.index) + "], which is not there");
            if (last) array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(*step.index), value);
            node = array->get(*step.index);
        }
    }

    static std::vector<Step> split(std::string_view key) {
        std::vector<Step> steps;
        for (std::size_t from = 0; from <= key.size();) {
            const std::size_t end = std::min(key.find('.', from), key.size());
            const std::string_view part = key.substr(from, end - from);
            const std::size_t bracket = std::min(part.find('['), part.size());
            Step step{std::string{part.substr(0, bracket)}, {}};
            if (bracket < part.size()) {
                std::size_t index = 0;
                const char* const end_of_part = part.data() + part.size();
                const auto [last, error] = std::from_chars(part.data() + bracket + 1, end_of_part, index);
                if (error != std::errc{} || last + 1 != end_of_part || *last != ']')
                    fail({"key", "of the form section.name[0]"}, "'" + std::string{key} + "'");
                step.index = index;
            }
            steps.push_back(std::move(step));
            from = end + 1;
        }
        return steps;
    }

    static std::string type_name(const toml::node& node) {
        switch (node.type()) {
            case toml::node_type::table:
                return "a table";
            case toml::node_type::array:
                return "an array";
            case toml::node_type::string:
                return "the text";
            case toml::node_type::integer:
                return "the whole number";
            case toml::node_type::floating_point:
                return "the number";
            case toml::node_type::boolean:
                return "the truth value";
            default:
                return "the date or time";
        }
    }

    /// Calls visit(full key, place of the key) for each value, array of values and empty table.
    static void visit_leaves(const toml::table& table, const std::string& prefix, const auto& visit) {
        for (const auto& [key, node] : table) {
            const std::string name = prefix + std::string{key.str()};
            if (const toml::table* inner = node.as_table(); inner != nullptr && !inner->empty()) {
                visit_leaves(*inner, name + ".", visit);
            } else if (node.is_array_of_tables()) {
                std::size_t i = 0;
                for (const toml::node& element : *node.as_array())
                    visit_leaves(*element.as_table(), name + "[" + std::to_string(i++) + "].", visit);
            } else {
                visit(name, key.source());
            }
        }
    }

    static std::string trimmed(const std::string& text) {
        const std::size_t from = text.find_first_not_of(" \t");
        return from == std::string::npos ? "" : text.substr(from, text.find_last_not_of(" \t") - from + 1);
    }

    toml::table root_;
    std::string source_;
    std::filesystem::path folder_;
    std::map<std::string, std::string, std::less<>> overrides_;  ///< key -> "--set key=value"
};

}  // namespace abrade::examples
