#pragma once
// A walk through what classes list as their fields, to the numbers that they are made of.

#include <abrade/core/fields.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <string>
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
concept IsBlock = !IsResizable<T> && requires(T& all) { all.data(); all.size(); requires IsRow<std::remove_cvref_t<decltype(*all.data())>>; };
template <class T>
concept IsPerAxis = !IsBlock<T> && !IsResizable<T> && requires(T& all) { all.begin(); all.end(); };
template <class T>
concept IsOptional = requires(T& one) { one.has_value(); one.reset(); *one; };
template <class T>
concept IsEngine = requires(T& engine, std::ostream& out) { typename T::result_type; engine.discard(1); out << engine; };
/// Has something to do once its fields have been read.
template <class T>
concept IsToldOfRestart = requires(T& one) { one.restored(); };
// clang-format on

/// Goes through fields in the order in which they are listed, of all objects of a kind at once, by pointers
/// to them: so one column holds a field of all of them. `Port` is what becomes of the numbers: it writes them
/// (objects are const) or reads them.
template <class Port>
class FieldWalk {
public:
    explicit FieldWalk(Port& port) : port_(port) {}

    template <FieldForm Form = FieldForm::numbers, class T>
    void go(const std::string& path, std::string_view unit, const std::vector<T*>& all) {
        using Plain = std::remove_const_t<T>;
        if constexpr (IsRow<Plain>) {
            port_.template rows<typename RowOf<Plain>::Number>(path, unit, RowOf<Plain>::numbers, all);
        } else if constexpr (ListsFields<Plain>) {
            for_each_field<Plain>([&](const auto& field) {
                go<std::remove_cvref_t<decltype(field)>::form>(
                    path + "/" + std::string(field.name), field.unit,
                    pointers(all, [&](T& one) { return &(one.*field.member); }));
            });
            if constexpr (!std::is_const_v<T> && IsToldOfRestart<Plain>)
                for (T* one : all) one->restored();
        } else if constexpr (IsResizable<Plain>) {
            port_.resize(path, all);
            if constexpr (IsRow<typename Plain::value_type>)
                blocks(path, unit, all);
            else
                go<Form>(path + "/each", unit, elements(all));
        } else if constexpr (IsBlock<Plain>) {
            blocks(path, unit, all);
        } else if constexpr (IsOptional<Plain>) {
            port_.emplace(path, all);
            std::vector<decltype(&**all.front())> there;
            for (T* one : all)
                if (*one) there.push_back(&**one);
            go<Form>(path + "/each", unit, there);
        } else if constexpr (IsEngine<Plain>) {
            for (T* one : all) port_.engine(path, *one);
        } else if constexpr (IsPerAxis<Plain>) {
            if (all.size() != 1) return go<Form>(path, unit, elements(all));
            int axis = 0;  // each for itself: the largest columns there are need no copy
            for (auto& one : *all.front())
                go<Form>(path + "/" + std::to_string(axis++), unit, std::vector{&one});
        } else {
            static_assert(Form == FieldForm::bytes && std::is_trivially_destructible_v<Plain>,
                          "a field that cannot be saved: let its class list its fields");
            if constexpr (!std::is_empty_v<Plain>)
                port_.template rows<std::uint8_t>(path, unit, static_cast<int>(sizeof(Plain)), all);
        }
    }

private:
    template <class T, class Of>
    static auto pointers(const std::vector<T*>& all, Of&& of) {
        std::vector<decltype(of(*all.front()))> found;
        found.reserve(all.size());
        for (T* one : all) found.push_back(of(*one));
        return found;
    }
    template <class T>
    static auto elements(const std::vector<T*>& all) {
        std::vector<decltype(&*all.front()->begin())> found;
        for (T* one : all)
            for (auto& element : *one) found.push_back(&element);
        return found;
    }
    template <class T>
    void blocks(const std::string& path, std::string_view unit, const std::vector<T*>& all) {
        using Row = RowOf<std::remove_cvref_t<decltype(*all.front()->data())>>;
        port_.template blocks<typename Row::Number>(path, unit, Row::numbers, all);
    }

    Port& port_;
};

}  // namespace abrade::detail
