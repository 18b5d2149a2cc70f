#pragma once
// Errors that name the field, the rule, the value with its unit, and the remedy.

#include <abrade/core/types.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

namespace abrade {

/// Bad input: something the user gave cannot be used. The run has not started.
struct InputError : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

/// The shortest text that reads back as the same number: "0.3", "5e+06", "nan".
inline std::string to_text(Real value) {
    if (std::isnan(value)) return "nan";  // whatever its sign
    char buffer[40];
    for (int digits = 6; digits <= 17; ++digits) {
        std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
        if (std::strtod(buffer, nullptr) == value) break;
    }
    return buffer;
}

/// Four digits, for the eye: "0.06085", "1.234e-05".
inline std::string short_text(Real value) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.4g", value);
    return buffer;
}

/// What a requirement says when it is broken. `field` is `Type.member`; `rule` continues "must be ...".
struct Requirement {
    std::string_view field;
    std::string_view rule;
    std::string_view unit{};    ///< "m", "Pa"; empty when dimensionless
    std::string_view remedy{};  ///< what to do about it
};

[[noreturn]] inline void fail(const Requirement& r, std::string_view value) {
    std::string text{r.field};
    text.append(" must be ").append(r.rule).append(", got ").append(value);
    if (!r.unit.empty()) text.append(" ").append(r.unit);
    if (!r.remedy.empty()) text.append("; ").append(r.remedy);
    throw InputError(text);
}

/// Throws InputError "field must be rule, got value unit; remedy" unless `ok`.
inline void require(bool ok, const Requirement& r, Real value) {
    if (!ok) fail(r, to_text(value));
}

namespace detail {

/// What helps against a value that is refused, where the caller knows nothing better.
inline std::string_view usual_remedy(Real value) {
    if (!std::isfinite(value)) return "look for a division by 0 or an uninitialised number where it is set";
    return value == 0 ? "was it left unset? give a number above 0" : "check its sign";
}

[[noreturn]] inline void fail_usual(Requirement r, Real value) {
    if (r.remedy.empty()) r.remedy = usual_remedy(value);
    fail(r, to_text(value));
}

}  // namespace detail

/// The commonest rules. NaN satisfies none of them. Where no remedy is given the message has one that fits
/// the value.
inline void require_positive(Real value, std::string_view field, std::string_view unit = {},
                             std::string_view remedy = {}) {
    if (!(value > 0 && std::isfinite(value)))
        detail::fail_usual({field, "finite and > 0", unit, remedy}, value);
}
inline void require_not_negative(Real value, std::string_view field, std::string_view unit = {},
                                 std::string_view remedy = {}) {
    if (!(value >= 0 && std::isfinite(value)))
        detail::fail_usual({field, "finite and >= 0", unit, remedy}, value);
}
inline void require_finite(Real value, std::string_view field, std::string_view unit = {},
                           std::string_view remedy = {}) {
    if (!std::isfinite(value)) detail::fail_usual({field, "finite", unit, remedy}, value);
}
/// Names the component: "Scene.stones[3].velocity.y must be finite, got nan m/s; look for ...".
inline void require_finite(const Vec3& value, std::string_view field, std::string_view unit = {},
                           std::string_view remedy = {}) {
    for (int a = 0; a < 3; ++a)
        if (!std::isfinite(value[a]))
            require_finite(value[a], std::string(field) + '.' + "xyz"[a], unit, remedy);
}

}  // namespace abrade
