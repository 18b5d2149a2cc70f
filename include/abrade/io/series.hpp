#pragma once
// Point clouds over time for ParaView: HDF5 files of columns, and per cloud one XDMF 3 file that names
// them.

#include <abrade/core/fields.hpp>
#include <abrade/core/require.hpp>
#include <abrade/io/file_error.hpp>
#include <abrade/io/hdf5_file.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace abrade {

/// Writes `stem.h5` (after each `begin_file` another one) and, for each cloud, `stem_<cloud>.xdmf`: a
/// temporal collection of Polyvertex grids. One file per cloud, because ParaView then gives each its own
/// filters and colours. In ParaView choose "Xdmf3 Reader T": the older "XDMF Reader" reads the same file, but
/// complains of times without points. The number of points may change from one time to the next. After every
/// write both files are complete on disk: a run that is killed leaves a series that opens and ends at the
/// last write.
///
/// A series goes on in a later run: `begin_file` before its fields are saved, and a writer made with
/// `goes_on` that reads them, at a stem to which the files have been copied. What was written in between is
/// dropped.
class SeriesWriter {
public:
    struct GoesOn {};
    static constexpr GoesOn goes_on{};

    explicit SeriesWriter(const std::filesystem::path& stem,
                          Hdf5Storage storage = {.number = StoredNumber::real32, .gzip = 1})
        : SeriesWriter(stem, goes_on, storage) {
        data_ = Hdf5File::create(file_path(files_ = 1));
    }
    SeriesWriter(const std::filesystem::path& stem, GoesOn,
                 Hdf5Storage storage = {.number = StoredNumber::real32, .gzip = 1})
        : stem_{stem}, storage_{storage} {
        if (storage.number == StoredNumber::int32)
            fail({"SeriesWriter storage", "real32 or real64", {}, "positions are no whole numbers"}, "int32");
    }

    /// Closes the data file, if there is anything in it, and goes on in another.
    void begin_file() {
        if (!std::exchange(written_, false)) return;
        data().close();
        begin_data(files_ + 1);
    }
    static void fields(auto&& field) {
        field("clouds", &SeriesWriter::clouds_), field("files", &SeriesWriter::files_);
    }
    /// Clouds whose files are gone begin anew.
    void restored() {
        for (Cloud& cloud : clouds_) {
            std::error_code error;
            if (std::filesystem::file_size(xdmf_path(cloud.name), error) <
                static_cast<std::uintmax_t>(cloud.end))
                error = std::make_error_code(std::errc::no_such_file_or_directory);
            if (!error)
                std::filesystem::resize_file(xdmf_path(cloud.name), static_cast<std::uintmax_t>(cloud.end),
                                             error);
            if (error) {
                begin(cloud);
            } else {
                cloud.xdmf.open(xdmf_path(cloud.name), std::ios::in | std::ios::out | std::ios::binary);
                append(cloud, {});
            }
        }
        begin_data(files_);
    }
    /// All that there is of a series at a stem.
    static std::vector<std::filesystem::path> files_at(const std::filesystem::path& stem) {
        std::vector<std::filesystem::path> found;
        std::error_code ignored;
        const std::string start = stem.filename().string();
        for (const auto& entry : std::filesystem::directory_iterator{stem.parent_path(), ignored}) {
            const std::string extension = entry.path().extension().string();
            if (entry.path().filename().string().starts_with(start) &&
                (extension == ".h5" || extension == ".xdmf"))
                found.push_back(entry.path());
        }
        return found;
    }

    /// Stores, once, what does not change: positions [m] (3 components) and fields of a cloud. Every later
    /// `write` to the cloud refers to them. Calling it again replaces them for the times that follow.
    void set_constant(std::string_view cloud, const FieldView& positions,
                      std::span<const FieldView> fields = {}) {
        Cloud& c = find_or_begin(cloud);
        const std::string group = c.name + "/constant_" + std::to_string(c.constants++);
        c.points = checked_count(c, positions);
        c.constant_geometry = geometry(store(group, positions));
        c.constant_fields.clear();
        for (const FieldView& field : fields)
            c.constant_fields += attribute(store_checked(c, group, field, c.points));
    }

    /// Adds one time [s] with its own positions. Times of a cloud must rise.
    void write(std::string_view cloud, Real time, const FieldView& positions,
               std::span<const FieldView> fields = {}) {
        Cloud& c = find_or_begin(cloud);
        const std::size_t points = checked_count(c, positions);
        require(c.constant_fields.empty() || points == c.points,
                {"SeriesWriter." + c.name + " positions",
                 "as many as those of its constant fields (" + std::to_string(c.points) + ")", "points",
                 "call set_constant again"},
                static_cast<Real>(points));
        add_time(c, time, points, &positions, fields);
    }

    /// Adds one time [s] at the positions given to `set_constant`.
    void write(std::string_view cloud, Real time, std::span<const FieldView> fields) {
        Cloud& c = find_or_begin(cloud);
        if (c.constant_geometry.empty())
            fail({"SeriesWriter." + c.name,
                  "given positions by set_constant before it is written without",
                  {},
                  "call it once"},
                 "none");
        add_time(c, time, c.points, nullptr, fields);
    }

    /// The XDMF file of a cloud: what a user opens.
    std::filesystem::path xdmf_path(std::string_view cloud) const {
        return with_suffix("_" + std::string{cloud} + ".xdmf");
    }

    /// Closes the data file. What was written stays readable in any case.
    void close() { data().close(); }

private:
    struct Cloud {
        std::string name;
        std::size_t points = 0;  ///< of the constant positions
        int constants = 0;
        int times = 0;
        Real last_time = -std::numeric_limits<Real>::infinity();
        std::string constant_geometry;  ///< XDMF text; empty while there are none
        std::string constant_fields;    ///< XDMF text
        std::fstream xdmf;
        std::streamoff end = 0;  ///< where the closing tags begin

        static void fields(auto&& field) {
            field("name", &Cloud::name), field("points", &Cloud::points),
                field("constants", &Cloud::constants), field("times", &Cloud::times),
                field("last_time", "s", &Cloud::last_time),
                field("constant_geometry", &Cloud::constant_geometry),
                field("constant_fields", &Cloud::constant_fields), field("end", &Cloud::end);
        }
    };
    struct Item {
        const FieldView* field;
        std::string path;  ///< in the HDF5 file
    };

    static constexpr std::string_view closing_tags_ = "    </Grid>\n  </Domain>\n</Xdmf>\n";

    /// In the middle of a run: a file that cannot be made is no wrong input.
    void begin_data(int number) {
        try {
            data_ = Hdf5File::create(file_path(files_ = number));
        } catch (const InputError& error) {
            throw FileError(error.what());
        }
    }
    Hdf5File& data() {
        if (!data_) throw std::logic_error("SeriesWriter: read its fields before it goes on");
        return *data_;
    }
    std::filesystem::path file_path(int number) const {
        return with_suffix(number == 1 ? ".h5" : "-" + std::to_string(number) + ".h5");
    }
    std::filesystem::path with_suffix(const std::string& suffix) const {
        std::filesystem::path path = stem_;
        return path += suffix;
    }

    Cloud& find_or_begin(std::string_view name) {
        for (Cloud& cloud : clouds_)
            if (cloud.name == name) return cloud;
        if (name.empty() || name.find_first_of("/<>&\"' ") != name.npos)
            fail({"SeriesWriter cloud", "a name without spaces, '/' or signs of XML", {}, "join words by _"},
                 "'" + std::string{name} + "'");
        Cloud& c = clouds_.emplace_back();
        c.name = name;
        begin(c);
        return c;
    }
    void begin(Cloud& c) {
        c.end = 0;
        c.xdmf.open(xdmf_path(c.name), std::ios::in | std::ios::out | std::ios::trunc | std::ios::binary);
        const std::string head =
            "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n    <Grid Name=\"" + c.name +
            "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
        append(c, head);
    }

    /// Overwrites the closing tags by `text` and the closing tags, in one go: the file is whole before and
    /// after.
    void append(Cloud& c, const std::string& text) {
        c.xdmf.seekp(c.end);
        const std::string block = text + std::string{closing_tags_};
        c.xdmf.write(block.data(), static_cast<std::streamsize>(block.size()));
        c.xdmf.flush();
        if (!c.xdmf)
            throw FileError("cannot write '" + xdmf_path(c.name).string() +
                            "': is the disk full or the folder gone?");
        c.end += static_cast<std::streamoff>(text.size());
    }

    static std::size_t checked_count(const Cloud& c, const FieldView& positions) {
        require(positions.components == 3,
                {"SeriesWriter." + c.name + " positions", "of 3 components", {}, "x, y and z of each point"},
                positions.components);
        return positions.count();
    }

    Item store(const std::string& group, const FieldView& field) {
        data().write(group, field, storage_);
        written_ = true;
        return {&field, group + "/" + std::string{field.name}};
    }

    Item store_checked(const Cloud& c, const std::string& group, const FieldView& field, std::size_t points) {
        require(
            field.values.size() == points * static_cast<std::size_t>(field.components),
            {"SeriesWriter." + c.name + "." + std::string{field.name},
             "one row per point (" + std::to_string(points) + " x " + std::to_string(field.components) + ")",
             "values", "does it belong to another cloud?"},
            static_cast<Real>(field.values.size()));
        return store(group, field);
    }

    void add_time(Cloud& c, Real time, std::size_t points, const FieldView* positions,
                  std::span<const FieldView> fields) {
        require(
            std::isfinite(time) && time > c.last_time,
            {"SeriesWriter." + c.name + " time", "later than the one before (" + to_text(c.last_time) + ")",
             "s", "write each time once, in order"},
            time);
        const std::string group = c.name + "/time_" + std::to_string(c.times);
        std::string text = "      <Grid Name=\"" + c.name +
                           "\" GridType=\"Uniform\">\n        <Time Value=\"" + to_text(time) + "\"/>\n" +
                           topology(points);
        text += positions == nullptr ? c.constant_geometry : geometry(store(group, *positions));
        for (const FieldView& field : fields) text += attribute(store_checked(c, group, field, points));
        text += c.constant_fields + "      </Grid>\n";
        data().flush();  // the data first: the XDMF never names what is not on disk
        append(c, text);
        c.last_time = time;
        ++c.times;
    }

    /// One vertex per point. ParaView's newer reader draws only what is listed, so the list 0, 1, 2, ... is
    /// stored, once for each number of points.
    std::string topology(std::size_t points) {
        const std::string count = std::to_string(points);
        const std::string list = "vertices/of_" + count;
        if (!data().contains(list)) {
            std::vector<Real> numbers(points);
            std::iota(numbers.begin(), numbers.end(), Real{0});
            data().write("vertices", {"of_" + count, "-", 1, numbers}, {StoredNumber::int32, storage_.gzip});
        }
        return "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" + count +
               "\" NodesPerElement=\"1\"><DataItem Format=\"HDF\" NumberType=\"Int\" Precision=\"4\" "
               "Dimensions=\"" +
               count + "\">" + escape(data().path().filename().string()) + ":/" + list +
               "</DataItem></Topology>\n";
    }

    std::string geometry(const Item& item) const {
        return "        <Geometry GeometryType=\"XYZ\">" + data_item(item) + "</Geometry>\n";
    }

    std::string attribute(const Item& item) const {
        const int n = item.field->components;
        const std::string_view kind = n == 1   ? "Scalar"
                                      : n == 3 ? "Vector"
                                      : n == 6 ? "Tensor6"
                                      : n == 9 ? "Tensor"
                                               : "Matrix";
        return "        <Attribute Name=\"" + escape(item.field->name) + "\" AttributeType=\"" +
               std::string{kind} + "\" Center=\"Node\"><Information Name=\"unit\" Value=\"" +
               escape(item.field->unit) + "\"/>" + data_item(item) + "</Attribute>\n";
    }

    std::string data_item(const Item& item) const {
        std::string shape = std::to_string(item.field->count());
        if (item.field->components > 1) shape += " " + std::to_string(item.field->components);
        return "<DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"" +
               std::string{storage_.number == StoredNumber::real32 ? "4" : "8"} + "\" Dimensions=\"" + shape +
               "\">" + escape(data_->path().filename().string()) + ":/" + escape(item.path) + "</DataItem>";
    }

    static std::string escape(std::string_view text) {
        std::string out;
        for (const char c : text) {
            switch (c) {
                case '&':
                    out += "&amp;";
                    break;
                case '<':
                    out += "&lt;";
                    break;
                case '>':
                    out += "&gt;";
                    break;
                case '"':
                    out += "&quot;";
                    break;
                default:
                    out += c;
            }
        }
        return out;
    }

    std::filesystem::path stem_;
    Hdf5Storage storage_;
    std::optional<Hdf5File> data_;
    int files_ = 0;         ///< the number of `data_`
    bool written_ = false;  ///< to it
    std::vector<Cloud> clouds_;
};

}  // namespace abrade
