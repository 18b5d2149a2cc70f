#pragma once
// A walk through what classes list as their fields, to the numbers that they are made of.

#include <abrade/core/fields.hpp>
#include <abrade/core/require.hpp>
#include <abrade/io/column_of.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <locale>
#include <optional>
#include <ostream>
#include <random>
#include <span>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace abrade::detail {

/// So many numbers of one kind: a row of a column. 0: T is none.
template <class T>
struct RowOf {
    static constexpr int numbers = 0;
};
template <class T>
requires std::is_arithmetic_v<T>
struct RowOf<T> {
    using Number = std::conditional_t<std::same_as<T, bool>, std::uint8_t, T>;
    static constexpr int numbers = 1;
};
template <class T>
requires std::is_enum_v<T>
struct RowOf<T> : RowOf<std::underlying_type_t<T>> {
};
template <class Of, int Rows, int Columns, int Options>
requires(Rows > 0 && Columns > 0) struct RowOf<Eigen::Matrix<Of, Rows, Columns, Options>> {
    using Number = Of;
    static constexpr int numbers = Rows * Columns;
};
template <class Of>
struct RowOf<Eigen::Quaternion<Of>> {
    using Number = Of;
    static constexpr int numbers = 4;
};
template <class T, std::size_t Size>
requires(RowOf<T>::numbers > 0) struct RowOf<std::array<T, Size>> {
    using Number = typename RowOf<T>::Number;
    static constexpr int numbers = static_cast<int>(Size) * RowOf<T>::numbers;
};

// clang-format off
template <class T>
concept IsRow = RowOf<T>::numbers > 0 &&
                sizeof(T) == static_cast<std::size_t>(RowOf<T>::numbers) * sizeof(typename RowOf<T>::Number);
/// std::vector, std::string.
template <class T>
concept IsResizable = requires(T& all) { typename T::value_type; all.resize(std::size_t{}); all.data(); };
/// Rows next to each other, as many as there are: a field over a grid.
template <class T>
concept IsBlock = !IsResizable<T> &&
                  requires(T& all) { all.data(); all.size(); requires IsRow<std::remove_cvref_t<decltype(*all.data())>>; };
template <class T>
concept IsPerAxis = !IsBlock<T> && !IsResizable<T> && requires(T& all) { all.begin(); all.end(); };
template <class T>
concept IsOptional = requires(T& one) { one.has_value(); one.reset(); *one; };
template <class T>
concept IsEngine =
    requires(T& engine, std::ostream& out) { typename T::result_type; engine.discard(1); out << engine; };
/// Has something to do once its fields have been read.
template <class T>
concept IsToldOfRestart = requires(T& one) { one.restored(); };
// clang-format on

/// Writes or reads the columns that a walk comes to.
class FieldPort {
public:
    FieldPort() = default;
    FieldPort(const FieldPort&) = delete;
    FieldPort& operator=(const FieldPort&) = delete;
    virtual ~FieldPort() = default;

    virtual bool reads() const noexcept = 0;
    /// A column whose rows lie in these parts of memory, one after the other.
    virtual void column(const std::string& path, std::string_view unit, const ColumnOf& of,
                        std::span<const std::span<std::byte>> parts) = 0;
    /// How many rows each of several has of a column.
    virtual void counts(const std::string& path, std::vector<std::uint64_t>& counts) = 0;
    virtual void text(const std::string& path, std::string& text) = 0;
};

/// Goes through fields in the order in which they are listed, of all objects of a kind at once, by pointers
/// to them: so one column holds a field of all of them. Cold, and pointers without types: there are hundreds
/// of kinds, each of which is compiled, and it is files that take the time.
class FieldWalk {
public:
    explicit FieldWalk(FieldPort& port) : port_(port) {}

    template <ListsFields T>
    void go(const std::string& group, T& object) {
        visit<T, false>(group, "-", {&object});
    }

private:
    using Objects = std::vector<void*>;

    /// With `as_bytes` a type that is unknown here is copied as it lies in memory.
    template <class T, bool as_bytes>
    [[gnu::cold, gnu::noinline]] void visit(const std::string& path, std::string_view unit,
                                            const Objects& all) {
        if constexpr (IsRow<T>) {
            rows(path, unit, column_of<typename RowOf<T>::Number>(RowOf<T>::numbers), all);
        } else if constexpr (ListsFields<T>) {
            T::fields(Members<T>{*this, path, all});
            if constexpr (IsToldOfRestart<T>)
                if (port_.reads())
                    for (void* one : all) static_cast<T*>(one)->restored();
        } else if constexpr (IsResizable<T>) {
            resize<T>(path, all);
            if constexpr (IsRow<typename T::value_type>)
                blocks<T>(path, unit, all);
            else
                visit<typename T::value_type, as_bytes>(path + "/each", unit, elements<T>(all));
        } else if constexpr (IsBlock<T>) {
            blocks<T>(path, unit, all);
        } else if constexpr (IsOptional<T>) {
            using Value = std::remove_reference_t<decltype(*std::declval<T&>())>;
            visit<Value, as_bytes>(path + "/each", unit, those_there<T>(path, all));
        } else if constexpr (IsEngine<T>) {
            for (void* one : all) engine(path, *static_cast<T*>(one));
        } else if constexpr (IsPerAxis<T>) {
            using Element = std::remove_reference_t<decltype(*std::declval<T&>().begin())>;
            const Objects each = elements<T>(all);
            if (all.size() != 1) return visit<Element, as_bytes>(path, unit, each);
            for (std::size_t axis = 0; axis < each.size();
                 ++axis)  // the largest columns there are need no copy
                visit<Element, as_bytes>(path + "/" + std::to_string(axis), unit, {each[axis]});
        } else {
            static_assert(as_bytes && std::is_trivially_destructible_v<T>,
                          "a field that cannot be saved: let its class list its fields");
            if constexpr (!std::is_empty_v<T>)
                rows(path, unit, column_of<std::uint8_t>(static_cast<int>(sizeof(T))), all);
        }
    }

    /// Takes the list of a class.
    template <class T>
    struct Members {  // of T, or of what it is derived from
        FieldWalk& walk;
        const std::string& path;
        const Objects& all;

        template <class Type, class Of>
        void operator()(std::string_view name, Type Of::*member) const {
            (*this)(name, "-", member);
        }
        template <class Type, class Of>
        void operator()(std::string_view name, std::string_view unit, Type Of::*member) const {
            walk.visit<Type, false>(path + "/" + std::string(name), unit, of(member));
        }
        template <class Type, class Of>
        void bytes(std::string_view name, Type Of::*member) const {
            walk.visit<Type, true>(path + "/" + std::string(name), "-", of(member));
        }
        template <class Type, class Of>
        Objects of(Type Of::*member) const {
            Objects found;
            for (void* one : all) found.push_back(&(static_cast<T*>(one)->*member));
            return found;
        }
    };

    template <class T>
    static Objects elements(const Objects& all) {
        Objects found;
        for (void* one : all)
            for (auto& element : *static_cast<T*>(one)) found.push_back(&element);
        return found;
    }
    void rows(const std::string& path, std::string_view unit, const ColumnOf& of, const Objects& all) {
        std::vector<std::span<std::byte>> parts;
        for (void* one : all) parts.emplace_back(static_cast<std::byte*>(one), of.row());
        port_.column(path, unit, of, parts);
    }
    template <class T>
    void blocks(const std::string& path, std::string_view unit, const Objects& all) {
        using Row = std::remove_cvref_t<decltype(*std::declval<T&>().data())>;
        std::vector<std::span<std::byte>> parts;
        for (void* one : all) {
            T& block = *static_cast<T*>(one);
            parts.emplace_back(reinterpret_cast<std::byte*>(block.data()),
                               static_cast<std::size_t>(block.size()) * sizeof(Row));
        }
        port_.column(path, unit, column_of<typename RowOf<Row>::Number>(RowOf<Row>::numbers), parts);
    }
    template <class T>
    void resize(const std::string& path, const Objects& all) {
        std::vector<std::uint64_t> counts;
        for (void* one : all) counts.push_back(static_cast<T*>(one)->size());
        port_.counts(path, counts);
        if (port_.reads())
            for (std::size_t n = 0; n < all.size(); ++n)
                static_cast<T*>(all[n])->resize(static_cast<std::size_t>(counts[n]));
    }
    template <class T>
    Objects those_there(const std::string& path, const Objects& all) {
        std::vector<std::uint64_t> counts;
        for (void* one : all) counts.push_back(static_cast<T*>(one)->has_value());
        port_.counts(path, counts);
        Objects there;
        for (std::size_t n = 0; n < all.size(); ++n) {
            T& one = *static_cast<T*>(all[n]);
            if (counts[n] == 0) one.reset();
            if (counts[n] != 0 && !one) {
                if constexpr (requires { one.emplace(); })
                    one.emplace();
                else
                    fail({"checkpoint " + path, "of the same scene", {}, "build the scene as it was"},
                         "another");
            }
            if (one) there.push_back(&*one);
        }
        return there;
    }
    template <class T>
    void engine(const std::string& path, T& engine) {
        std::ostringstream now;
        now.imbue(std::locale::classic());
        now << engine;
        std::string text = now.str();
        port_.text(path, text);
        if (!port_.reads()) return;
        std::istringstream saved(text);
        saved.imbue(std::locale::classic());
        if (!(saved >> engine))
            fail({"checkpoint " + path, "the state of a random engine", {}, "save anew"}, "another");
    }

    FieldPort& port_;
};

static_assert(IsRow<Vec3> && IsRow<std::array<Real, 2>> && !IsRow<std::string>);
static_assert(IsResizable<std::vector<Vec3>> && IsResizable<std::string> && !IsResizable<Real>);
static_assert(!IsBlock<std::vector<Real>> && !IsBlock<Real>);
static_assert(IsPerAxis<std::array<std::vector<Real>, 2>> && !IsPerAxis<std::vector<Real>>);
static_assert(IsOptional<std::optional<Vec3>> && !IsOptional<Vec3>);
static_assert(IsEngine<std::mt19937_64> && !IsEngine<std::string>);
static_assert(!IsToldOfRestart<Vec3>);

}  // namespace abrade::detail
