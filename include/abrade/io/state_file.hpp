#pragma once
// What classes list as their fields, to an HDF5 file and back, bit for bit.

#include <abrade/io/field_walk.hpp>
#include <abrade/io/hdf5_file.hpp>

#include <cstring>
#include <sstream>
#include <type_traits>

namespace abrade {

namespace detail {

inline std::pair<std::string_view, std::string_view> group_and_name(std::string_view path) {
    const std::size_t end = path.rfind('/');
    return {path.substr(0, end), path.substr(end + 1)};
}

/// Where several share a column, how many rows of it each has.
inline std::string counts_of(const std::string& path) { return path + "_count"; }

/// A port of FieldWalk that writes.
class StateWriter {
public:
    explicit StateWriter(Hdf5File& file) : file_(file) {}

    template <class Number, class T>
    void rows(const std::string& path, std::string_view unit, int numbers, const std::vector<const T*>& all) {
        std::vector<Number> values(all.size() * static_cast<std::size_t>(numbers));
        for (std::size_t n = 0; n < all.size(); ++n)
            std::memcpy(values.data() + n * static_cast<std::size_t>(numbers), all[n],
                        static_cast<std::size_t>(numbers) * sizeof(Number));
        write<Number>(path, unit, numbers, values);
    }
    template <class Number, class T>
    void blocks(const std::string& path, std::string_view unit, int numbers,
                const std::vector<const T*>& all) {
        if (all.size() == 1) return write<Number>(path, unit, numbers, block<Number>(*all.front(), numbers));
        std::vector<Number> values;
        for (const T* one : all) {
            const auto its = block<Number>(*one, numbers);
            values.insert(values.end(), its.begin(), its.end());
        }
        write<Number>(path, unit, numbers, values);
    }
    template <class T>
    void resize(const std::string& path, const std::vector<const T*>& all) {
        std::vector<std::uint64_t> counts;
        for (const T* one : all) counts.push_back(one->size());
        write<std::uint64_t>(counts_of(path), "-", 1, counts);
    }
    template <class T>
    void emplace(const std::string& path, const std::vector<const T*>& all) {
        std::vector<std::uint8_t> there;
        for (const T* one : all) there.push_back(one->has_value());
        write<std::uint8_t>(counts_of(path), "-", 1, there);
    }
    template <class Engine>
    void engine(const std::string& path, const Engine& engine) {
        std::ostringstream text;
        text << engine;
        write<char>(path, "-", 1, std::string(text.str()));
    }

private:
    template <class Number, class T>
    static std::span<const Number> block(const T& one, int numbers) {
        return {reinterpret_cast<const Number*>(one.data()),
                static_cast<std::size_t>(one.size()) * static_cast<std::size_t>(numbers)};
    }
    template <class Number>
    void write(const std::string& path, std::string_view unit, int numbers, std::span<const Number> values) {
        const auto [group, name] = group_and_name(path);
        file_.write_numbers<Number>(group, name, unit, numbers, values);
    }

    Hdf5File& file_;
};

/// A port of FieldWalk that reads. What is there already and has no size to be given must be as large.
class StateReader {
public:
    explicit StateReader(const Hdf5File& file) : file_(file) {}

    template <class Number, class T>
    void rows(const std::string& path, std::string_view /*unit*/, int numbers, const std::vector<T*>& all) {
        std::vector<Number> values(all.size() * static_cast<std::size_t>(numbers));
        file_.read_numbers<Number>(path, numbers, values);
        for (std::size_t n = 0; n < all.size(); ++n)
            std::memcpy(static_cast<void*>(all[n]), values.data() + n * static_cast<std::size_t>(numbers),
                        static_cast<std::size_t>(numbers) * sizeof(Number));
    }
    template <class Number, class T>
    void blocks(const std::string& path, std::string_view /*unit*/, int numbers, const std::vector<T*>& all) {
        if (all.size() == 1)
            return file_.read_numbers<Number>(path, numbers, block<Number>(*all.front(), numbers));
        std::size_t size = 0;
        for (T* one : all) size += block<Number>(*one, numbers).size();
        std::vector<Number> values(size);
        file_.read_numbers<Number>(path, numbers, values);
        auto from = values.begin();
        for (T* one : all) {
            const auto its = block<Number>(*one, numbers);
            std::copy_n(from, its.size(), its.begin());
            from += static_cast<std::ptrdiff_t>(its.size());
        }
    }
    template <class T>
    void resize(const std::string& path, const std::vector<T*>& all) {
        std::vector<std::uint64_t> counts(all.size());
        file_.read_numbers<std::uint64_t>(counts_of(path), 1, counts);
        for (std::size_t n = 0; n < all.size(); ++n) all[n]->resize(static_cast<std::size_t>(counts[n]));
    }
    template <class T>
    void emplace(const std::string& path, const std::vector<T*>& all) {
        std::vector<std::uint8_t> there(all.size());
        file_.read_numbers<std::uint8_t>(counts_of(path), 1, there);
        for (std::size_t n = 0; n < all.size(); ++n) {
            if (there[n] == 0)
                all[n]->reset();
            else if (!*all[n]) {
                if constexpr (requires { all[n]->emplace(); })
                    all[n]->emplace();
                else
                    fail({"checkpoint " + path, "of the same scene", {}, "build the scene as it was"}, "one");
            }
        }
    }
    template <class Engine>
    void engine(const std::string& path, Engine& engine) {
        std::string text(file_.rows<char>(path, 1), '\0');
        file_.read_numbers<char>(path, 1, std::span(text));
        std::istringstream(text) >> engine;
    }

private:
    template <class Number, class T>
    static std::span<Number> block(T& one, int numbers) {
        return {reinterpret_cast<Number*>(one.data()),
                static_cast<std::size_t>(one.size()) * static_cast<std::size_t>(numbers)};
    }

    const Hdf5File& file_;
};

}  // namespace detail

/// Writes all fields of an object below a group.
template <ListsFields T>
void write_fields(Hdf5File& file, std::string_view group, const T& object) {
    detail::StateWriter port(file);
    detail::FieldWalk(port).go(std::string(group), "-", std::vector{&object});
}
/// Reads them back into an object that was built as the other was. Throws InputError where the file has other
/// columns, or of other sizes; the object is then no good.
template <ListsFields T>
void read_fields(const Hdf5File& file, std::string_view group, T& object) {
    detail::StateReader port(file);
    detail::FieldWalk(port).go(std::string(group), "-", std::vector{&object});
}

}  // namespace abrade
