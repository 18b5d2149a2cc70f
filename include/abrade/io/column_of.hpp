#pragma once
// Which numbers the rows of a column are made of.

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace abrade::detail {

/// Kinds of numbers.
enum class NumberKind : std::uint8_t { real, whole, natural };
/// Which numbers a column holds, so many a row.
struct ColumnOf {
    NumberKind kind = NumberKind::real;
    std::size_t bytes = 8;  ///< of a number
    int numbers = 1;        ///< of a row

    std::size_t row() const noexcept { return bytes * static_cast<std::size_t>(numbers); }
};
template <class Number>
constexpr ColumnOf column_of(int numbers) noexcept {
    return {std::is_floating_point_v<Number> ? NumberKind::real
            : std::is_signed_v<Number>       ? NumberKind::whole
                                             : NumberKind::natural,
            sizeof(Number), numbers};
}

}  // namespace abrade::detail
