#pragma once
// Parameters from a TOML file: typed, with units; what is mistyped, misplaced or missing is one clear
// InputError.

#include <abrade/core/require.hpp>
#include <abrade/core/types.hpp>

#include "nearest_name.hpp"
#include "parameter.hpp"

#include <toml++/toml.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace abrade::examples {

/// Which numbers a key takes.
enum class Bound { any, positive, not_negative };

/// What a program knows of a key. Without a fallback the key is required.
template <class Value>
struct Key {
    std::string_view unit{};          ///< "m"; empty when dimensionless
    std::optional<Value> fallback{};  ///< the value where the file says nothing
    std::string_view help{};          ///< what it is, for the report
    std::string_view
        assumption{};  ///< why this value, where the model's source leaves it open: marked in the report
    Bound bound = Bound::any;  ///< numbers only
};

/// Reads keys like "water.depth" or "stones[0].diameter" from one TOML document. It remembers what was asked
/// for: after the last key `reject_unknown` finds what nobody asked for, and `parameters` lists what was
/// used.
class TomlReader {
public:
    /// Reads a file. `overrides` are texts "section.key=value" with values in TOML, as `--set` takes them.
    static TomlReader from_file(const std::filesystem::path& path,
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
        TomlReader reader = from_text(text.str(), path.string(), overrides);
        reader.folder_ = path.parent_path();
        return reader;
    }

    /// Reads a document from memory; `source` names it in messages.
    static TomlReader from_text(std::string_view text, std::string source,
                                std::span<const std::string> overrides = {}) {
        TomlReader reader;
        reader.source_ = std::move(source);
        try {
            reader.root_ = toml::parse(text, reader.source_);
        } catch (const toml::parse_error& error) {
            throw InputError(reader.place(error.source()) +
                             ": not valid TOML: " + std::string{error.description()});
        }
        for (const std::string& assignment : overrides) reader.set(assignment);
        return reader;
    }

    /// A finite number; TOML may write it as an integer.
    Real number(std::string_view key, const Key<Real>& about = {}) {
        return get<Real>(key, about, [&](const toml::node& node) {
            return to_number(node, key, about.unit, about.bound);
        });
    }

    /// A whole number.
    std::int64_t integer(std::string_view key, const Key<std::int64_t>& about = {}) {
        return get<std::int64_t>(key, about, [&](const toml::node& node) {
            if (!node.is_integer()) wrong_type(node, key, "a whole number", about.unit);
            const std::int64_t value = node.as_integer()->get();
            check(static_cast<Real>(value), node, key, about.unit, about.bound);
            return value;
        });
    }

    /// true or false.
    bool flag(std::string_view key, const Key<bool>& about = {}) {
        return get<bool>(key, about, [&](const toml::node& node) {
            if (!node.is_boolean()) wrong_type(node, key, "true or false");
            return node.as_boolean()->get();
        });
    }

    /// A text.
    std::string text(std::string_view key, const Key<std::string>& about = {}) {
        return get<std::string>(key, about, [&](const toml::node& node) { return to_string(node, key); });
    }

    /// One of the named choices.
    std::string choice(std::string_view key, std::span<const std::string_view> choices,
                       const Key<std::string>& about = {}) {
        return get<std::string>(key, about, [&](const toml::node& node) {
            std::string value = to_string(node, key);
            if (std::find(choices.begin(), choices.end(), value) != choices.end()) return value;
            std::string rule = "one of";
            for (const std::string_view name : choices) rule.append(" \"").append(name).append("\"");
            const std::string nearest = nearest_name(value, choices);
            fail({label(node, key), rule, {}, nearest.empty() ? "" : "did you mean \"" + nearest + "\"?"},
                 "\"" + value + "\"");
        });
    }

    /// An array of numbers.
    std::vector<Real> numbers(std::string_view key, const Key<std::vector<Real>>& about = {}) {
        return get<std::vector<Real>>(key, about, [&](const toml::node& node) {
            if (!node.is_array()) wrong_type(node, key, "an array of numbers", about.unit);
            std::vector<Real> values;
            for (const toml::node& item : *node.as_array())
                values.push_back(to_number(item, std::string{key} + "[" + std::to_string(values.size()) + "]",
                                           about.unit, about.bound));
            return values;
        });
    }

    /// A file; a relative path counts from the folder of the TOML file. Empty stays empty.
    std::filesystem::path file(std::string_view key, const Key<std::string>& about = {}) {
        const std::filesystem::path given = text(key, about);
        const bool as_is = given.empty() || given.is_absolute() || overrides_.contains(key);
        return as_is ? given : folder_ / given;
    }

    /// How many tables `[[key]]` there are. Their keys are "key[0].name" and so on.
    std::size_t count(std::string_view key) {
        asked_.emplace(key);
        const toml::node* node = find(key);
        if (node == nullptr) return 0;
        const toml::array* array = node->as_array();
        if (array == nullptr || !(array->empty() || node->is_array_of_tables()))
            wrong_type(*node, key, "tables [[" + std::string{key} + "]]");
        return array->size();
    }

    /// Whether the file or an override gives the key. Does not count as asking for it.
    bool has(std::string_view key) const { return find(key) != nullptr; }

    /// Takes any key at or below `key` as known: settings of a variant that was not chosen.
    void allow(std::string_view key) { allowed_.emplace_back(key); }

    /// "quick.toml:12:9" or "--set ...": where the key's value comes from; the file's name where it is not
    /// given.
    std::string where(std::string_view key) const {
        const toml::node* node = find(key);
        return node == nullptr ? source_ : where(*node, key);
    }

    /// Call it after the last key was asked for: InputError that names every key nobody asked for, with file,
    /// line, column and the nearest known key.
    void reject_unknown() const {
        std::string all;
        visit_leaves(root_, {}, [&](const std::string& key, const toml::source_region& at) {
            if (is_known(key)) return;
            const std::string from = origin(key);
            if (!all.empty()) all += '\n';
            all += (from.empty() ? place(at) : from) + ": unknown key " + key + hint(key);
        });
        if (!all.empty()) throw InputError(all);
    }

    /// Every parameter asked for so far, in that order.
    const std::vector<Parameter>& parameters() const noexcept { return parameters_; }

private:
    /// Applies "a.b=value".
    void set(const std::string& assignment) {
        const std::size_t sign = assignment.find('=');
        const std::string shown = "--set " + assignment;
        const std::string key = sign == std::string::npos ? "" : trimmed(assignment.substr(0, sign));
        if (key.empty()) fail({"--set", "given as section.key=value"}, "'" + assignment + "'");
        toml::table parsed;
        const std::string value = trimmed(assignment.substr(sign + 1));
        try {
            parsed = toml::parse("value = " + value);
        } catch (const toml::parse_error&) {
        }
        if (parsed.size() != 1)
            fail({"--set " + key,
                  "given a TOML value",
                  {},
                  "text needs quotes: --set '" + key + "=\"" + value + "\"'"},
                 "'" + value + "'");
        toml::node* node = &root_;
        const std::vector<Step> steps = split(key);
        for (std::size_t i = 0; i < steps.size(); ++i) {
            toml::table* table = node->as_table();
            if (table == nullptr) fail({"--set " + key, "a key of a table"}, "a key of " + type_name(*node));
            if (i + 1 == steps.size() && !steps[i].index) {
                table->insert_or_assign(steps[i].name, *parsed.get("value"));
                break;
            }
            if (!table->contains(steps[i].name)) table->insert(steps[i].name, toml::table{});
            node = table->get(steps[i].name);
            if (!steps[i].index) continue;
            toml::array* array = node->as_array();
            if (array == nullptr || *steps[i].index >= array->size())
                fail({"--set " + key, "within the arrays of " + source_, {}, "add the element there"},
                     "an index beyond");
            if (i + 1 == steps.size())
                array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(*steps[i].index),
                               *parsed.get("value"));
            node = array->get(*steps[i].index);
        }
        overrides_[key] = shown;
    }

    struct Step {
        std::string name;
        std::optional<std::size_t> index;
    };

    static std::vector<Step> split(std::string_view key) {
        std::vector<Step> steps;
        for (std::size_t from = 0; from <= key.size();) {
            const std::size_t end = std::min(key.find('.', from), key.size());
            const std::string_view part = key.substr(from, end - from);
            const std::size_t bracket = std::min(part.find('['), part.size());
            Step step{std::string{part.substr(0, bracket)}, {}};
            if (bracket < part.size()) {
                std::size_t index = 0;
                const auto [last, error] =
                    std::from_chars(part.data() + bracket + 1, part.data() + part.size(), index);
                if (error != std::errc{} || last + 1 != part.data() + part.size() || *last != ']')
                    fail({"key", "of the form section.name[0]"}, "'" + std::string{key} + "'");
                step.index = index;
            }
            steps.push_back(step);
            from = end + 1;
        }
        return steps;
    }

    const toml::node* find(std::string_view key) const {
        const toml::node* node = &root_;
        for (const Step& step : split(key)) {
            if (!node->is_table()) wrong_type(*node, key, "a key of a table");
            node = node->as_table()->get(step.name);
            if (node == nullptr) return nullptr;
            if (!step.index) continue;
            if (!node->is_array()) wrong_type(*node, key, "an element of an array");
            node = node->as_array()->get(*step.index);
            if (node == nullptr) return nullptr;
        }
        return node;
    }

    template <class Value, class Convert>
    Value get(std::string_view key, const Key<Value>& about, Convert&& convert) {
        const bool first = asked_.emplace(key).second;
        const toml::node* node = find(key);
        if (node == nullptr && !about.fallback) missing(key, about.unit);
        const Value value = node == nullptr ? *about.fallback : Value{convert(*node)};
        if (first)
            parameters_.push_back({std::string{key}, shown(value), std::string{about.unit},
                                   std::string{about.help}, std::string{about.assumption},
                                   node == nullptr       ? "default"
                                   : origin(key).empty() ? "file"
                                                         : "--set"});
        return value;
    }

    static std::string shown(Real value) { return to_text(value); }
    static std::string shown(std::int64_t value) { return std::to_string(value); }
    static std::string shown(bool value) { return value ? "true" : "false"; }
    static std::string shown(const std::string& value) { return value; }
    static std::string shown(const std::vector<Real>& values) {
        std::string text;
        for (const Real value : values) text += (text.empty() ? "" : ", ") + to_text(value);
        return "[" + text + "]";
    }

    Real to_number(const toml::node& node, std::string_view key, std::string_view unit, Bound bound) const {
        if (!node.is_number()) wrong_type(node, key, "a number", unit);
        const Real value =
            node.is_integer() ? static_cast<Real>(node.as_integer()->get()) : node.as_floating_point()->get();
        check(value, node, key, unit, bound);
        return value;
    }

    std::string to_string(const toml::node& node, std::string_view key) const {
        if (!node.is_string()) wrong_type(node, key, "a text in quotes");
        return node.as_string()->get();
    }

    void check(Real value, const toml::node& node, std::string_view key, std::string_view unit,
               Bound bound) const {
        const std::string name = label(node, key);
        require(std::isfinite(value), {name, "finite", unit}, value);
        require(bound != Bound::positive || value > 0, {name, "> 0", unit}, value);
        require(bound != Bound::not_negative || value >= 0, {name, ">= 0", unit}, value);
    }

    [[noreturn]] void wrong_type(const toml::node& node, std::string_view key, const std::string& wanted,
                                 std::string_view unit = {}) const {
        std::ostringstream value;
        if (node.is_value())
            node.visit([&](const auto& n) {
                if constexpr (toml::is_value<decltype(n)>) value << " " << n;
            });
        fail({label(node, key), wanted + (unit.empty() ? "" : " in " + std::string{unit})},
             type_name(node) + value.str());
    }

    [[noreturn]] void missing(std::string_view key, std::string_view unit) const {
        std::string text = source_ + ": " + std::string{key} +
                           (unit.empty() ? "" : " [" + std::string{unit} + "]") +
                           " is required but not given";
        const std::string section = std::string{key.substr(0, key.rfind('.') + 1)};
        visit_leaves(root_, {}, [&](const std::string& other, const toml::source_region& at) {
            if (!is_known(other) && other.starts_with(section) && edit_distance(key, other) <= 2)
                text += "; " + place(at) + " has " + other + ": is that meant?";
        });
        throw InputError(text);
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

    std::string label(const toml::node& node, std::string_view key) const {
        return where(node, key) + ": " + std::string{key};
    }

    std::string where(const toml::node& node, std::string_view key) const {
        const std::string from = origin(key);
        return from.empty() ? place(node.source()) : from;
    }

    std::string place(const toml::source_region& at) const {
        if (at.begin.line == 0) return source_;
        return source_ + ":" + std::to_string(at.begin.line) + ":" + std::to_string(at.begin.column);
    }

    /// "--set ..." where an override gave the key or a table or array that holds it; else empty.
    std::string origin(std::string_view key) const {
        for (const auto& [set, text] : overrides_)
            if (is_within(key, set)) return text;
        return {};
    }

    static bool is_within(std::string_view key, std::string_view outer) {
        return key.starts_with(outer) &&
               (key.size() == outer.size() || key[outer.size()] == '.' || key[outer.size()] == '[');
    }

    bool is_known(const std::string& key) const {
        if (asked_.contains(key)) return true;
        for (const std::string& outer : allowed_)
            if (is_within(key, outer)) return true;
        return false;
    }

    std::string hint(const std::string& key) const {
        const std::string nearest = nearest_name(key, asked_);
        if (!nearest.empty()) return "; did you mean " + nearest + "?";
        const std::string section = key.substr(0, key.rfind('.') + 1);
        std::string known;
        for (const std::string& name : asked_)
            if (name.starts_with(section)) known += (known.empty() ? "" : ", ") + name;
        return known.empty() ? std::string{} : "; known there: " + known;
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
            } else if (inner == nullptr) {
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
    std::set<std::string, std::less<>> asked_;
    std::vector<std::string> allowed_;
    std::vector<Parameter> parameters_;
};

}  // namespace abrade::examples
