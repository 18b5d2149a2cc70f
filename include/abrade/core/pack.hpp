#pragma once
// The few operations beside arithmetic that a law's source needs, so that one source serves a plain
// number, a SIMD pack of contacts (core/simd.hpp), or a dual number.

#include <abrade/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>

namespace abrade {

using std::max;
using std::min;
using std::sqrt;

/// `condition ? yes : no`, lane by lane for packs.
template <std::floating_point Number>
constexpr Number select(bool condition, Number yes, Number no) noexcept {
    return condition ? yes : no;
}

/// Whether a condition holds in any lane: what `if` asks before the rarer branch of a law. Lanes that do not
/// need that branch must come out of it unchanged, by `select`.
constexpr bool any(bool condition) noexcept { return condition; }

/// 1 / sqrt(x).
template <std::floating_point Number>
Number rsqrt(Number x) noexcept {
    return 1 / std::sqrt(x);
}

/// 1 / x.
template <std::floating_point Number>
constexpr Number reciprocal(Number x) noexcept {
    return 1 / x;
}

/// About 1 / x, to four digits at least, where that is enough and cheaper.
template <std::floating_point Number>
constexpr Number rough_reciprocal(Number x) noexcept {
    return 1 / x;
}

/// The smallest positive normal number: what a divisor is kept above.
template <class Number>
inline constexpr Number tiny = std::numeric_limits<Number>::min();

/// The same, for vectors; both sides are evaluated.
template <class Mask, class Number>
Vec3Of<Number> select(Mask condition, const Vec3Of<Number>& yes, const Vec3Of<Number>& no) noexcept {
    return {select(condition, yes.x(), no.x()), select(condition, yes.y(), no.y()),
            select(condition, yes.z(), no.z())};
}

}  // namespace abrade
