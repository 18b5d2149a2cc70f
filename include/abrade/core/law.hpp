#pragma once
// What every law has: checked parameters, a name, and a way to list itself.

#include <abrade/core/require.hpp>

#include <concepts>
#include <string>
#include <string_view>

namespace abrade {

namespace detail {
struct AnyParameterSink {
    void operator()(std::string_view, Real, std::string_view) const {}
};
}  // namespace detail

/// Parameters of a law: a copyable aggregate that checks itself (`validate()` throws InputError)
/// and lists its members (`visit(f)` calls `f(name, value, unit)` for each).
template <class P>
concept ParamSet = std::copyable<P> && requires(const P& p) {
    p.validate();
    p.visit(detail::AnyParameterSink{});
};

/// A law is made from its parameters, gives them back, and has a name.
/// Its constructor validates, so a law that exists is a law that can be used.
template <class L>
concept Law = std::copyable<L> && ParamSet<typename L::Params> &&
    std::constructible_from<L, typename L::Params> && requires(const L& law) {
    { law.params() } -> std::same_as<const typename L::Params&>;
    { L::name } -> std::convertible_to<std::string_view>;
};

/// For laws without parameters.
struct NoParams {
    void validate() const noexcept {}
    void visit(auto&&) const noexcept {}
};

/// "LinearSpring(stiffness = 5e+06 N/m, restitution = 0.6)"; of a law that was chosen options at compile time
/// these come first, "GridFluid[height, Koren, ...](...)".
template <Law L>
std::string describe(const L& law) {
    std::string text{L::name};
    if constexpr (requires { law.options(); }) text.append("[").append(law.options()).append("]");
    std::string_view separator = "(";
    law.params().visit([&](std::string_view name, Real value, std::string_view unit) {
        text.append(separator).append(name).append(" = ").append(to_text(value));
        if (!unit.empty() && unit != "-") text.append(" ").append(unit);
        separator = ", ";
    });
    if (separator != "(") text.append(")");
    return text;
}

static_assert(ParamSet<NoParams>);
static_assert(!ParamSet<int>);

}  // namespace abrade
