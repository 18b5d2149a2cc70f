#pragma once
// Named columns: what is saved, restored and drawn, without the writer knowing what it means. And how a class
// lists what it is made of.

#include <abrade/core/types.hpp>

#include <span>
#include <string_view>

namespace abrade {

/// A read-only view of one column. Shape of `values`: [count x components], row after row.
struct FieldView {
    std::string_view name;  ///< "fracture_rate"
    std::string_view unit;  ///< "m/s"; "-" when dimensionless
    int components = 1;     ///< 1 scalar, 3 vector, 4 quaternion
    std::span<const Real> values;

    std::size_t count() const noexcept { return values.size() / static_cast<std::size_t>(components); }
};

/// Takes a list of fields, for the concept below.
struct AnyField {
    void operator()(std::string_view /*name*/, auto /*member*/) const noexcept {}
    void operator()(std::string_view /*name*/, std::string_view /*unit*/, auto /*member*/) const noexcept {}
    void bytes(std::string_view /*name*/, auto /*member*/) const noexcept {}
};

/// A class that lists, once, what of it lasts from step to step:
///     static void fields(auto&& field) { field("velocity", "m/s", &X::velocity_); }
/// What it makes of its parameters as it is built is not among them, nor what each step finds anew.
/// Checkpoints, restarts and what is kept of a run that failed read that list. A member may be a number, a
/// vector or array of numbers, a class that lists its own fields, a text, a random engine, and a vector,
/// array or optional of these; with `field.bytes(name, member)` also what is to lie in a file as it lies in
/// memory: packs, and what laws remember.
template <class T>
concept ListsFields = requires {
    T::fields(AnyField{});
};

static_assert(!ListsFields<FieldView> && !ListsFields<Real>);

}  // namespace abrade
