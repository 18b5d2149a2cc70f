#pragma once
// Parameters from a TOML file: typed, with units. What is mistyped, misplaced or missing is one clear
// InputError.

#include <abrade/core/require.hpp>
#include <abrade/core/types.hpp>

#include "nearest_name.hpp"
#include "parameter.hpp"
#include "toml_document.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
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
    std::string_view assumption{};  ///< why this value, where the model leaves it open; marked in the report
    Bound bound = Bound::any;       ///< numbers only
    Real least = -std::numeric_limits<Real>::infinity();  ///< and most: numbers outside are a slip of a unit
    Real most = std::numeric_limits<Real>::infinity();
    std::string_view remedy{};  ///< for what is outside
};

/// Reads keys like "water.depth" or "stones[0].diameter" from one TOML document. It remembers what was asked
/// for: after the last key `reject_unknown` finds what nobody asked for, and `parameters` lists what was
/// used.
class TomlReader {
public:
    explicit TomlReader(TomlDocument document) : document_{std::move(document)} {}

    /// Reads a file. `overrides` are texts "section.key=value" with values in TOML, as `--set` takes them.
    static TomlReader from_file(const std::filesystem::path& path,
                                std::span<const std::string> overrides = {}) {
        return TomlReader{TomlDocument::from_file(path, overrides)};
    }

    /// Reads a document from memory; `source` names it in messages.
    static TomlReader from_text(std::string_view text, std::string source,
                                std::span<const std::string> overrides = {}) {
        return TomlReader{TomlDocument::from_text(text, std::move(source), overrides)};
    }

    /// A finite number; TOML may write it as an integer.
    Real number(std::string_view key, const Key<Real>& about = {}) {
        return get<Real>(key, about, [&](const toml::node& node) { return to_number(node, key, about); });
    }

    /// A whole number.
    std::int64_t integer(std::string_view key, const Key<std::int64_t>& about = {}) {
        return get<std::int64_t>(key, about, [&](const toml::node& node) {
            if (!node.is_integer()) document_.wrong_type(node, key, "a whole number", about.unit);
            const std::int64_t value = node.as_integer()->get();
            check(static_cast<Real>(value), node, key, about);
            return value;
        });
    }

    /// true or false.
    bool flag(std::string_view key, const Key<bool>& about = {}) {
        return get<bool>(key, about, [&](const toml::node& node) {
            if (!node.is_boolean()) document_.wrong_type(node, key, "true or false");
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
            fail({document_.label(node, key),
                  rule,
                  {},
                  nearest.empty() ? "" : "did you mean \"" + nearest + "\"?"},
                 "\"" + value + "\"");
        });
    }

    /// An array of numbers.
    std::vector<Real> numbers(std::string_view key, const Key<std::vector<Real>>& about = {}) {
        return get<std::vector<Real>>(key, about, [&](const toml::node& node) {
            if (!node.is_array()) document_.wrong_type(node, key, "an array of numbers", about.unit);
            std::vector<Real> values;
            for (const toml::node& item : *node.as_array())
                values.push_back(
                    to_number(item, std::string{key} + "[" + std::to_string(values.size()) + "]", about));
            return values;
        });
    }

    /// A file; a relative path counts from the folder of the TOML file. Empty stays empty.
    std::filesystem::path file(std::string_view key, const Key<std::string>& about = {}) {
        const std::filesystem::path given = text(key, about);
        const bool as_is = given.empty() || given.is_absolute() || !document_.override_of(key).empty();
        return as_is ? given : document_.folder() / given;
    }

    /// How many tables `[[key]]` there are. Their keys are "key[0].name" and so on.
    std::size_t count(std::string_view key) {
        asked_.emplace(key);
        const toml::node* node = document_.find(key);
        if (node == nullptr) return 0;
        const toml::array* array = node->as_array();
        if (array == nullptr || !(array->empty() || node->is_array_of_tables()))
            document_.wrong_type(*node, key, "tables [[" + std::string{key} + "]]");
        return array->size();
    }

    /// Whether the file or an override gives the key. Does not count as asking for it.
    bool has(std::string_view key) const { return document_.find(key) != nullptr; }

    /// Whether an override gives it.
    bool overridden(std::string_view key) const { return !document_.override_of(key).empty(); }

    /// Takes any key at or below `key` as known: settings of a variant that was not chosen.
    void allow(std::string_view key) { allowed_.emplace_back(key); }

    /// "quick.toml:12:9" or "--set ...": where the key's value comes from; the file's name where it is not
    /// given.
    std::string where(std::string_view key) const {
        const toml::node* node = document_.find(key);
        return node == nullptr ? document_.source() : document_.where(*node, key);
    }

    /// Call it after the last key was asked for: InputError that names every key nobody asked for, with file,
    /// line, column and the nearest known key.
    void reject_unknown() const {
        std::vector<std::pair<std::pair<int, int>, std::string>> found;  // line and column, message
        document_.visit_leaves([&](const std::string& key, const toml::source_region& at) {
            if (is_known(key)) return;
            const std::string given = document_.override_of(key);
            found.push_back(
                {{static_cast<int>(at.begin.line), static_cast<int>(at.begin.column)},
                 (given.empty() ? document_.place(at) : given) + ": unknown key " + key + hint(key)});
        });
        std::sort(found.begin(), found.end());
        std::string all;
        for (const auto& entry : found) all += (all.empty() ? "" : "\n") + entry.second;
        if (!all.empty()) throw InputError(all);
    }

    /// Every parameter asked for so far, in that order.
    const std::vector<Parameter>& parameters() const noexcept { return parameters_; }

private:
    template <class Value, class Convert>
    Value get(std::string_view key, const Key<Value>& about, Convert&& convert) {
        const bool first = asked_.emplace(key).second;
        const toml::node* node = document_.find(key);
        if (node == nullptr && !about.fallback) missing(key, about.unit);
        const Value value = node == nullptr ? *about.fallback : Value{convert(*node)};
        if (first)
            parameters_.push_back({std::string{key}, shown(value), std::string{about.unit},
                                   std::string{about.help}, std::string{about.assumption},
                                   node == nullptr                      ? "default"
                                   : document_.override_of(key).empty() ? "file"
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

    Real to_number(const toml::node& node, std::string_view key, const auto& about) const {
        if (!node.is_number()) document_.wrong_type(node, key, "a number", about.unit);
        const Real value =
            node.is_integer() ? static_cast<Real>(node.as_integer()->get()) : node.as_floating_point()->get();
        check(value, node, key, about);
        return value;
    }

    std::string to_string(const toml::node& node, std::string_view key) const {
        if (!node.is_string()) document_.wrong_type(node, key, "a text in quotes");
        return node.as_string()->get();
    }

    void check(Real value, const toml::node& node, std::string_view key, const auto& about) const {
        const std::string name = document_.label(node, key);
        const std::string_view unit = about.unit;
        require(std::isfinite(value), {name, "finite", unit}, value);
        require(about.bound != Bound::positive || value > 0, {name, "> 0", unit}, value);
        require(about.bound != Bound::not_negative || value >= 0, {name, ">= 0", unit}, value);
        require(value >= about.least && value <= about.most,
                {name, "from " + to_text(about.least) + " to " + to_text(about.most), unit, about.remedy},
                value);
    }

    [[noreturn]] void missing(std::string_view key, std::string_view unit) const {
        std::string text = document_.source() + ": " + std::string{key} +
                           (unit.empty() ? "" : " [" + std::string{unit} + "]") +
                           " is required but not given";
        const std::string section = std::string{key.substr(0, key.rfind('.') + 1)};
        document_.visit_leaves([&](const std::string& other, const toml::source_region& at) {
            if (!is_known(other) && other.starts_with(section) && edit_distance(key, other) <= 2)
                text += "; " + document_.place(at) + " has " + other + ": is that meant?";
        });
        throw InputError(text);
    }

    bool is_known(const std::string& key) const {
        if (asked_.contains(key)) return true;
        for (const std::string& outer : allowed_)
            if (TomlDocument::is_within(key, outer)) return true;
        for (const std::string& inner : asked_)
            if (TomlDocument::is_within(inner, key)) return true;  // an empty table that may hold known keys
        return false;
    }

    std::string hint(const std::string& key) const {
        std::set<std::string> known_keys(asked_.begin(), asked_.end());
        known_keys.insert(allowed_.begin(), allowed_.end());
        const std::string nearest = nearest_name(key, known_keys);
        if (!nearest.empty()) return "; did you mean " + nearest + "?";
        const std::string section = key.substr(0, key.rfind('.') + 1);
        std::set<std::string> names;
        for (const std::string& name : known_keys)
            if (name.starts_with(section))
                names.insert(name.substr(0, name.find_first_of(".[", section.size())));
        std::string known;
        for (const std::string& name : names) known += (known.empty() ? "; known there: " : ", ") + name;
        return known;
    }

    TomlDocument document_;
    std::set<std::string, std::less<>> asked_;
    std::vector<std::string> allowed_;
    std::vector<Parameter> parameters_;
};

}  // namespace abrade::examples
