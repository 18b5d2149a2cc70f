#pragma once
// What classes list as their fields, to an HDF5 file and back, bit for bit.

#include <abrade/io/field_walk.hpp>
#include <abrade/io/hdf5_file.hpp>

#include <cstdint>
#include <cstring>
#include <filesystem>

namespace abrade {

namespace detail {

/// Where several share a column, how many rows of it each has.
inline std::string counts_of(const std::string& path) { return path + "_count"; }

class StateWriter : public FieldPort {
public:
    explicit StateWriter(Hdf5File& file) : file_(file) {}

    bool reads() const noexcept override { return false; }
    void column(const std::string& path, std::string_view unit, const ColumnOf& of,
                std::span<const std::span<std::byte>> parts) override {
        if (parts.size() == 1) return file_.write_rows(path, unit, of, parts.front());
        std::vector<std::byte> all;
        for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
        file_.write_rows(path, unit, of, all);
    }
    void counts(const std::string& path, std::vector<std::uint64_t>& counts) override {
        file_.write_rows(counts_of(path), "-", column_of<std::uint64_t>(1), std::as_bytes(std::span(counts)));
    }
    void text(const std::string& path, std::string& text) override {
        file_.write_rows(path, "-", column_of<char>(1), std::as_bytes(std::span(text)));
    }

private:
    Hdf5File& file_;
};

/// A member whose size is fixed must be as large as its column.
class StateReader : public FieldPort {
public:
    explicit StateReader(const Hdf5File& file)
        : file_(file), most_(std::filesystem::file_size(file.path())) {}

    bool reads() const noexcept override { return true; }
    void column(const std::string& path, std::string_view /*unit*/, const ColumnOf& of,
                std::span<const std::span<std::byte>> parts) override {
        if (parts.size() == 1) return file_.read_rows(path, of, parts.front());
        std::size_t size = 0;
        for (const auto& part : parts) size += part.size();
        std::vector<std::byte> all(size);
        file_.read_rows(path, of, all);
        const std::byte* from = all.data();
        for (const auto& part : parts) {
            if (!part.empty()) std::memcpy(part.data(), from, part.size());
            from += part.size();
        }
    }
    void counts(const std::string& path, std::vector<std::uint64_t>& counts) override {
        file_.read_rows(counts_of(path), column_of<std::uint64_t>(1),
                        std::as_writable_bytes(std::span(counts)));
        std::uint64_t left = most_;  // a row takes a byte at least
        for (const std::uint64_t count : counts) {
            if (count > left)
                fail({"checkpoint " + path, "no more rows than the file has bytes", {}, "save anew"},
                     std::to_string(count));
            left -= count;
        }
    }
    void text(const std::string& path, std::string& text) override {
        text.resize(file_.count_rows(path, column_of<char>(1)));
        file_.read_rows(path, column_of<char>(1), std::as_writable_bytes(std::span(text)));
    }

private:
    const Hdf5File& file_;
    std::uint64_t most_;
};

}  // namespace detail

/// Writes all fields of an object below a group.
template <ListsFields T>
void write_fields(Hdf5File& file, std::string_view group, const T& object) {
    detail::StateWriter port(file);  // which changes nothing in the object
    detail::FieldWalk(port).go(std::string(group), const_cast<T&>(object));
}
/// Reads them back into an object that was built as the other was. Throws InputError where the file has other
/// columns, or of other sizes; the object is then no good.
template <ListsFields T>
void read_fields(const Hdf5File& file, std::string_view group, T& object) {
    detail::StateReader port(file);
    detail::FieldWalk(port).go(std::string(group), object);
}

}  // namespace abrade
