#pragma once
// Save and restore: named columns in groups ("bodies", "spheres", ...) and single values, bit for bit.

#include <abrade/core/fields.hpp>
#include <abrade/core/require.hpp>
#include <abrade/io/file_error.hpp>
#include <abrade/io/hdf5_file.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace abrade {

/// The columns of one group, to be saved. All must have as many rows.
struct FieldGroup {
    std::string_view name;  ///< "bodies"
    std::span<const FieldView> fields;
};

/// What a checkpoint holds.
struct Checkpoint {
    std::map<std::string, std::vector<Column>, std::less<>> groups;
    Attributes attributes;

    bool has(std::string_view group, std::string_view field) const noexcept {
        const auto found = groups.find(group);
        if (found == groups.end()) return false;
        for (const Column& column : found->second)
            if (column.name == field) return true;
        return false;
    }

    /// The column `group/field`; InputError, with the names that are there, where it is missing.
    const Column& column(std::string_view group, std::string_view field) const {
        std::string known;
        if (const auto found = groups.find(group); found != groups.end()) {
            for (const Column& candidate : found->second) {
                if (candidate.name == field) return candidate;
                known += " " + candidate.name;
            }
        } else {
            for (const auto& entry : groups) known += " " + entry.first + "/";
        }
        throw InputError("checkpoint has no column " + std::string{group} + "/" + std::string{field} +
                         "; it has:" + (known.empty() ? " nothing" : known));
    }

    /// The attribute `name` as Value (Real, std::int64_t or std::string); InputError where it is missing or
    /// another kind.
    template <class Value>
    const Value& attribute(std::string_view name) const {
        const auto found = attributes.find(name);
        if (found == attributes.end()) {
            std::string known;
            for (const auto& entry : attributes) known += " " + entry.first;
            throw InputError("checkpoint has no attribute " + std::string{name} +
                             "; it has:" + (known.empty() ? " nothing" : known));
        }
        const Value* value = std::get_if<Value>(&found->second);
        if (value == nullptr)
            throw InputError("checkpoint attribute " + std::string{name} +
                             " is of another kind than asked for; ask for what was saved");
        return *value;
    }
};

inline constexpr std::string_view checkpoint_version_name = "abrade_checkpoint_version";
inline constexpr std::int64_t checkpoint_version = 1;

/// Saves groups of columns and single values to `path`: written to `path.tmp`, then renamed, so that `path`
/// is always a whole checkpoint, the old one or the new one.
inline void save_fields(const std::filesystem::path& path, std::span<const FieldGroup> groups,
                        const Attributes& attributes = {}) {
    std::filesystem::path aside = path;
    aside += ".tmp";
    try {
        Hdf5File file = Hdf5File::create(aside);
        for (const FieldGroup& group : groups) {
            file.make_group(group.name);
            const std::string label = "checkpoint " + std::string{group.name};
            for (const FieldView& field : group.fields) {
                require(field.count() == group.fields.front().count(),
                        {label + "." + std::string{field.name},
                         "as long as the other columns of its group (" +
                             std::to_string(group.fields.front().count()) + ")",
                         "rows", "put it into another group"},
                        static_cast<Real>(field.count()));
                file.write(group.name, field);
            }
        }
        for (const auto& [name, value] : attributes) file.write_attribute({}, name, value);
        file.write_attribute({}, checkpoint_version_name, checkpoint_version);
        file.close();
        std::filesystem::rename(aside, path);
    } catch (const std::filesystem::filesystem_error& error) {
        std::error_code ignored;
        std::filesystem::remove(aside, ignored);
        throw FileError("cannot write '" + path.string() + "': " + error.code().message());
    } catch (...) {
        std::error_code ignored;
        std::filesystem::remove(aside, ignored);
        throw;
    }
}

/// Reads what `save_fields` saved. InputError where the file is missing, not a checkpoint, or of another
/// version.
inline Checkpoint load_fields(const std::filesystem::path& path) {
    const Hdf5File file = Hdf5File::open(path);
    Checkpoint checkpoint;
    checkpoint.attributes = file.attributes();
    const auto version = checkpoint.attributes.find(checkpoint_version_name);
    if (version == checkpoint.attributes.end())
        throw InputError("cannot read '" + path.string() +
                         "': it is an HDF5 file but not a checkpoint; name one that save_fields() wrote");
    if (version->second != AttributeValue{checkpoint_version})
        throw InputError("cannot read '" + path.string() + "': it is a checkpoint of another version than " +
                         std::to_string(checkpoint_version) + "; read it with the Abrade that saved it");
    checkpoint.attributes.erase(version);
    for (const std::string& group : file.names()) {
        std::vector<Column>& columns = checkpoint.groups[group];
        for (const std::string& name : file.names(group)) columns.push_back(file.read(group + "/" + name));
    }
    return checkpoint;
}

}  // namespace abrade
