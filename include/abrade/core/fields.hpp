#pragma once
// Named columns: what is saved, restored and drawn, without the writer knowing what it means.

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

}  // namespace abrade
