#pragma once
// Named columns: what is saved, restored and drawn, without the writer knowing what it means. And how a class
// lists what it is made of.

#include <abrade/core/types.hpp>

#include <concepts>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace abrade {

/// A read-only view of one column. Shape of `values`: [count x components], row after row.
struct FieldView {
    std::string_view name;  ///< "fracture_rate"
    std::string_view unit;  ///< "m/s"; "-" when dimensionless
    int components = 1;     ///< 1 scalar, 3 vector, 4 quaternion
    std::span<const Real> values;

    std::size_t count() const noexcept { return values.size() / static_cast<std::size_t>(components); }
};

/// How a member lies in a file.
enum class FieldForm : std::uint8_t {
    numbers,  ///< as the numbers that it is made of
    bytes,    ///< what is no such number in it as it lies in memory: packs, and what laws remember
};

/// One member of a class that lasts from step to step.
template <class Class, class Type, FieldForm Form = FieldForm::numbers>
struct MemberField {
    static constexpr FieldForm form = Form;
    std::string_view name, unit;
    Type Class::*member;
};

template <class Class, class Type>
constexpr MemberField<Class, Type> field(std::string_view name, std::string_view unit, Type Class::*member) {
    return {name, unit, member};
}
template <class Class, class Type>
constexpr MemberField<Class, Type> field(std::string_view name, Type Class::*member) {
    return {name, "-", member};
}
template <class Class, class Type>
constexpr MemberField<Class, Type, FieldForm::bytes> bytes_field(std::string_view name, Type Class::*member) {
    return {name, "-", member};
}

/// A class that lists, once, what of it lasts from step to step:
///     static auto fields() { return std::tuple(field("velocity", "m/s", &X::velocity_), ...); }
/// What it makes of its parameters as it is built is not among them, nor what each step finds anew. Output,
/// checkpoints and restarts read that list; a member may be a number, a vector or array of numbers, a class
/// that lists its own fields, and a container of these.
template <class T>
concept ListsFields = requires {
    { std::tuple_size<decltype(T::fields())>::value } -> std::convertible_to<std::size_t>;
};

/// Calls `visit(field)` for each field that a class lists.
template <ListsFields T, class Visit>
void for_each_field(Visit&& visit) {
    std::apply([&](const auto&... field) { (visit(field), ...); }, T::fields());
}

static_assert(!ListsFields<FieldView> && !ListsFields<Real>);

}  // namespace abrade
