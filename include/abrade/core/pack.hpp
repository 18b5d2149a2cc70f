#pragma once
// The few operations beside arithmetic that a law's source needs, so that one source serves a plain
// number and, where a type offers its own overloads, a SIMD pack of contacts or a dual number.

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
