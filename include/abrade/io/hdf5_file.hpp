#pragma once
// An HDF5 file as groups of named columns with units, and attributes. Over the C library, which is not
// thread-safe: one thread at a time.

#include <abrade/core/fields.hpp>
#include <abrade/core/require.hpp>
#include <abrade/core/types.hpp>
#include <abrade/io/file_error.hpp>
#include <abrade/io/hdf5_handle.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace abrade {

/// How a number lies in the file. In memory a column is always Real.
enum class StoredNumber {
    real64,  ///< every bit
    real32,  ///< half the size, 7 digits: for pictures, not for restarts
    int32,   ///< whole numbers
};

/// How a column lies in the file.
struct Hdf5Storage {
    StoredNumber number = StoredNumber::real64;
    int gzip = 0;  ///< 0 none, 1 fast, 9 small; ignored where HDF5 was built without it
};

/// A column that owns its values: what reading gives. Shape of `values`: [count x components].
struct Column {
    std::string name;
    std::string unit;
    int components = 1;
    std::vector<Real> values;

    FieldView view() const noexcept { return {name, unit, components, values}; }
};

/// A single value with a name. Texts are limited to 64 kB by HDF5.
using AttributeValue = std::variant<Real, std::int64_t, std::string>;
using Attributes = std::map<std::string, AttributeValue, std::less<>>;

/// An open HDF5 file. Paths inside it are "group/subgroup/name"; "" is the root.
/// A file that cannot be opened and an object that is not there are InputErrors; a failed write is a
/// FileError.
class Hdf5File {
public:
    /// Makes the file anew, whatever was there before.
    static Hdf5File create(const std::filesystem::path& path) {
        const hdf5::Quiet quiet;
        const hdf5::Handle list{H5Pcreate(H5P_FILE_CREATE)};
        H5Pset_link_creation_order(list.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
        return {path, "create", H5Fcreate(path.c_str(), H5F_ACC_TRUNC, list.get(), H5P_DEFAULT)};
    }

    /// Opens the file for reading.
    static Hdf5File open(const std::filesystem::path& path) {
        const hdf5::Quiet quiet;
        return {path, "open", H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)};
    }

    const std::filesystem::path& path() const noexcept { return path_; }

    /// Makes the group and those above it, where they are not there yet.
    void make_group(std::string_view group) {
        const hdf5::Quiet quiet;
        const hdf5::Handle list{H5Pcreate(H5P_GROUP_CREATE)};
        H5Pset_link_creation_order(list.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
        for (std::size_t end = 0; end < group.size();) {
            end = std::min(group.find('/', end + 1), group.size());
            const std::string part{group.substr(0, end)};
            if (H5Lexists(file_.get(), part.c_str(), H5P_DEFAULT) > 0) continue;
            const hdf5::Handle made{
                H5Gcreate2(file_.get(), part.c_str(), H5P_DEFAULT, list.get(), H5P_DEFAULT)};
            if (!made) throw_write(part);
        }
    }

    /// Writes one column as dataset `group/field.name` with the attribute "unit". A name is written once.
    void write(std::string_view group, const FieldView& field, Hdf5Storage storage = {}) {
        check(field);
        make_group(group);
        const hdf5::Quiet quiet;
        const std::string name = join(group, field.name);
        const std::array<hsize_t, 2> shape{field.count(), static_cast<hsize_t>(field.components)};
        const int rank = field.components == 1 ? 1 : 2;
        const hdf5::Handle space{H5Screate_simple(rank, shape.data(), nullptr)};
        const hdf5::Handle list{H5Pcreate(H5P_DATASET_CREATE)};
        if (storage.gzip > 0 && shape[0] > 0 && H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0) {
            const std::array<hsize_t, 2> chunk{std::min<hsize_t>(shape[0], 16384), shape[1]};
            H5Pset_chunk(list.get(), rank, chunk.data());
            H5Pset_shuffle(list.get());
            H5Pset_deflate(list.get(), static_cast<unsigned>(std::min(storage.gzip, 9)));
        }
        const hid_t type = storage.number == StoredNumber::real64   ? H5T_IEEE_F64LE
                           : storage.number == StoredNumber::real32 ? H5T_IEEE_F32LE
                                                                    : H5T_STD_I32LE;
        const hdf5::Handle set{
            H5Dcreate2(file_.get(), name.c_str(), type, space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT)};
        if (!set) throw_write(name);
        const bool done = field.values.empty() || H5Dwrite(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL,
                                                           H5P_DEFAULT, field.values.data()) >= 0;
        if (!done) throw_write(name);
        write_attribute(name, "unit", std::string{field.unit});
    }

    /// Reads the dataset at `name` ("group/field") with its unit.
    Column read(std::string_view name) const {
        const hdf5::Quiet quiet;
        const std::string path{name};
        const hdf5::Handle set{H5Dopen2(file_.get(), path.c_str(), H5P_DEFAULT)};
        if (!set) throw_missing("no such dataset", path);
        const hdf5::Handle type{H5Dget_type(set.get())};
        const hdf5::Handle space{H5Dget_space(set.get())};
        const H5T_class_t kind = H5Tget_class(type.get());
        const int rank = H5Sget_simple_extent_ndims(space.get());
        if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || rank < 1 || rank > 2)
            throw_missing("not a column of numbers", path);
        std::array<hsize_t, 2> shape{0, 1};
        H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
        Column column{path.substr(path.rfind('/') + 1), {}, static_cast<int>(shape[1]), {}};
        column.values.resize(shape[0] * shape[1]);
        if (!column.values.empty() &&
            H5Dread(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, column.values.data()) < 0)
            throw FileError(hdf5::message("read", path_, path, hdf5::reason()));
        if (H5Aexists(set.get(), "unit") > 0) column.unit = text_attribute(path, "unit");
        return column;
    }

    /// Writes numbers as they are in memory, row after row, as dataset `name`: so that a whole number stays
    /// one, and a float single.
    void write_rows(std::string_view name, std::string_view unit, const detail::ColumnOf& of,
                    std::span<const std::byte> values) {
        const std::string whole{name};
        if (const std::size_t end = name.rfind('/'); end != name.npos) make_group(name.substr(0, end));
        const hdf5::Quiet quiet;
        const std::array<hsize_t, 2> shape{values.size() / of.row(), static_cast<hsize_t>(of.numbers)};
        const hdf5::Handle space{H5Screate_simple(2, shape.data(), nullptr)};
        const hid_t type = hdf5::type_of(of);
        const hdf5::Handle list{H5Pcreate(H5P_DATASET_CREATE)};
        if (shape[0] > 0) {  // each chunk with its sum: what a disk has changed is not read
            const std::array<hsize_t, 2> chunk{std::min<hsize_t>(shape[0], 131072), shape[1]};
            H5Pset_chunk(list.get(), 2, chunk.data());
            H5Pset_fletcher32(list.get());
        }
        const hdf5::Handle set{
            H5Dcreate2(file_.get(), whole.c_str(), type, space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT)};
        if (!set ||
            (!values.empty() && H5Dwrite(set.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0))
            throw_write(whole);
        write_attribute(whole, "unit", std::string{unit});
    }
    /// Rows of a dataset that `write_rows` wrote; InputError where there is none of these numbers.
    std::size_t count_rows(std::string_view name, const detail::ColumnOf& of) const {
        const hdf5::Quiet quiet;
        return static_cast<std::size_t>(open_rows(name, of).second);
    }
    /// Reads all of its rows, for which `out` has room exactly; else InputError.
    void read_rows(std::string_view name, const detail::ColumnOf& of, std::span<std::byte> out) const {
        const hdf5::Quiet quiet;
        const auto [set, count] = open_rows(name, of);
        if (count != out.size() / of.row())
            throw_missing(std::to_string(count) + " rows and not the " +
                              std::to_string(out.size() / of.row()) + " that are asked for",
                          name);
        if (!out.empty() &&
            H5Dread(set.get(), hdf5::type_of(of), H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) < 0)
            throw FileError(hdf5::message("read", path_, name, hdf5::reason()));
    }

    /// Whether there is a group or dataset of that name.
    bool contains(std::string_view name) const {
        const hdf5::Quiet quiet;
        for (std::size_t end = 0; end < name.size();) {  // H5Lexists wants every step of the path to be there
            end = std::min(name.find('/', end + 1), name.size());
            if (H5Lexists(file_.get(), std::string{name.substr(0, end)}.c_str(), H5P_DEFAULT) <= 0)
                return false;
        }
        return true;
    }

    /// The names directly inside a group, in the order in which they were written (by name in foreign files).
    std::vector<std::string> names(std::string_view group = {}) const {
        const hdf5::Quiet quiet;
        const hdf5::Handle object = open_object(group);
        std::vector<std::string> found;
        const auto add = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
            static_cast<std::vector<std::string>*>(out)->emplace_back(name);
            return 0;
        };
        hsize_t at = 0;
        if (H5Literate(object.get(), H5_INDEX_CRT_ORDER, H5_ITER_INC, &at, add, &found) >= 0) return found;
        found.clear();
        at = 0;
        if (H5Literate(object.get(), H5_INDEX_NAME, H5_ITER_INC, &at, add, &found) < 0)
            throw_missing("not a group", group);
        return found;
    }

    /// Writes a named value at a group, a dataset or the root (""). A name is written once.
    void write_attribute(std::string_view object, std::string_view name, const AttributeValue& value) {
        const hdf5::Quiet quiet;
        const hdf5::Handle owner = open_object(object);
        const hdf5::Handle space{H5Screate(H5S_SCALAR)};
        const auto put = [&](hid_t stored, hid_t given, const void* data) {
            const hdf5::Handle made{H5Acreate2(owner.get(), std::string{name}.c_str(), stored, space.get(),
                                               H5P_DEFAULT, H5P_DEFAULT)};
            if (!made || H5Awrite(made.get(), given, data) < 0) throw_write(join(object, name));
        };
        if (const Real* number = std::get_if<Real>(&value)) {
            put(H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, number);
        } else if (const std::int64_t* integer = std::get_if<std::int64_t>(&value)) {
            put(H5T_STD_I64LE, H5T_NATIVE_INT64, integer);
        } else {
            const std::string& text = std::get<std::string>(value);
            const hdf5::Handle type = text_type(std::max<std::size_t>(text.size(), 1));
            put(type.get(), type.get(), text.c_str());
        }
    }

    /// All named values of a group, a dataset or the root ("").
    Attributes attributes(std::string_view object = {}) const {
        const hdf5::Quiet quiet;
        const hdf5::Handle owner = open_object(object);
        std::vector<std::string> found;
        const auto add = [](hid_t, const char* name, const H5A_info_t*, void* out) -> herr_t {
            static_cast<std::vector<std::string>*>(out)->emplace_back(name);
            return 0;
        };
        hsize_t at = 0;
        H5Aiterate2(owner.get(), H5_INDEX_NAME, H5_ITER_INC, &at, add, &found);
        Attributes all;
        for (const std::string& name : found) all.emplace(name, attribute(object, name));
        return all;
    }

    /// One named value; InputError where there is none.
    AttributeValue attribute(std::string_view object, std::string_view name) const {
        const hdf5::Quiet quiet;
        const hdf5::Handle owner = open_object(object);
        const hdf5::Handle found{H5Aopen(owner.get(), std::string{name}.c_str(), H5P_DEFAULT)};
        if (!found) throw_missing("no such attribute", join(object, name));
        const hdf5::Handle type{H5Aget_type(found.get())};
        const hdf5::Handle space{H5Aget_space(found.get())};
        if (H5Sget_simple_extent_npoints(space.get()) != 1)
            throw_missing("not a single value", join(object, name));
        const auto get = [&](hid_t wanted, void* out) {
            if (H5Aread(found.get(), wanted, out) < 0)
                throw FileError(hdf5::message("read", path_, join(object, name), hdf5::reason()));
        };
        const H5T_class_t kind = H5Tget_class(type.get());
        if (kind == H5T_FLOAT) {
            Real number = 0;
            get(H5T_NATIVE_DOUBLE, &number);
            return number;
        }
        if (kind == H5T_INTEGER) {
            std::int64_t integer = 0;
            get(H5T_NATIVE_INT64, &integer);
            return integer;
        }
        if (kind != H5T_STRING || H5Tis_variable_str(type.get()) > 0)
            throw_missing("not a number or a text of fixed length", join(object, name));
        std::string text(H5Tget_size(type.get()), '\0');
        get(text_type(text.size()).get(), text.data());
        text.erase(text.find_last_not_of('\0') + 1);
        return text;
    }

    /// Hands everything written so far to the operating system: what a killed run leaves can be opened.
    void flush() {
        const hdf5::Quiet quiet;
        if (H5Fflush(file_.get(), H5F_SCOPE_LOCAL) < 0) throw_write({});
    }

    /// Writes what is pending and closes; the destructor does so too, but cannot say that it failed.
    void close() {
        const hdf5::Quiet quiet;
        if (file_ && H5Fclose(file_.release()) < 0) throw_write({});
    }

private:
    Hdf5File(const std::filesystem::path& path, std::string_view action, hid_t id) : path_{path}, file_{id} {
        if (!file_) throw InputError(hdf5::message(action, path, {}, hdf5::reason()));
    }

    static std::string join(std::string_view group, std::string_view name) {
        std::string text{group};
        if (!text.empty()) text += '/';
        return text.append(name);
    }

    static hdf5::Handle text_type(std::size_t length) {
        hdf5::Handle type{H5Tcopy(H5T_C_S1)};
        H5Tset_size(type.get(), length);
        H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
        H5Tset_cset(type.get(), H5T_CSET_UTF8);
        return type;
    }

    static void check(const FieldView& field) {
        const std::string label = "FieldView '" + std::string{field.name} + "'";
        if (field.name.empty() || field.name.find('/') != field.name.npos || field.name == ".")
            fail({label, "named, without '/'", {}, "what it lies in is the group"},
                 "'" + std::string{field.name} + "'");
        require(field.components >= 1,
                {label, "of one component or more", {}, "1 for numbers, 3 for vectors"}, field.components);
        require(field.values.size() % static_cast<std::size_t>(field.components) == 0,
                {label, "whole rows of " + std::to_string(field.components) + " components", "values",
                 "check its components and its values"},
                static_cast<Real>(field.values.size()));
    }

    std::pair<hdf5::Handle, hsize_t> open_rows(std::string_view name, const detail::ColumnOf& of) const {
        hdf5::Handle set{H5Dopen2(file_.get(), std::string{name}.c_str(), H5P_DEFAULT)};
        if (!set) throw_missing("no such dataset", name);
        const hdf5::Handle type{H5Dget_type(set.get())}, space{H5Dget_space(set.get())};
        std::array<hsize_t, 2> shape{0, 0};
        if (H5Sget_simple_extent_ndims(space.get()) != 2 || H5Tequal(type.get(), hdf5::type_of(of)) <= 0)
            throw_missing("numbers of another kind", name);
        H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
        if (shape[1] != static_cast<hsize_t>(of.numbers))
            throw_missing(
                "rows of " + std::to_string(shape[1]) + " numbers and not of " + std::to_string(of.numbers),
                name);
        return {std::move(set), shape[0]};
    }

    hdf5::Handle open_object(std::string_view name) const {
        const std::string path = name.empty() ? "/" : std::string{name};
        hdf5::Handle object{H5Oopen(file_.get(), path.c_str(), H5P_DEFAULT)};
        if (!object) throw_missing("no such group or dataset", path);
        return object;
    }

    std::string text_attribute(std::string_view object, std::string_view name) const {
        const AttributeValue value = attribute(object, name);
        const std::string* text = std::get_if<std::string>(&value);
        return text == nullptr ? std::string{} : *text;
    }

    [[noreturn]] void throw_write(std::string_view object) const {
        throw FileError(hdf5::message("write", path_, object, hdf5::reason()));
    }
    [[noreturn]] void throw_missing(std::string_view why, std::string_view object) const {
        throw InputError(hdf5::message("read", path_, object, why));
    }

    std::filesystem::path path_;
    hdf5::Handle file_;
};

}  // namespace abrade
