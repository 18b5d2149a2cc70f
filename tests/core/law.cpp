// What a law and its parameters must have, and how a law prints itself.
#include <abrade/core/law.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

struct SpringParams {
    Real stiffness = 5e6, restitution = 0.6;
    std::string label = "";
    void validate() const { require_positive(stiffness, "Spring.stiffness", "N/m"); }
    void visit(auto&& f) const {
        f("stiffness", stiffness, "N/m");
        f("restitution", restitution, "-");
        f("count", 3, "");
    }
};

struct Spring {
    static constexpr std::string_view name = "Spring";
    using Params = SpringParams;
    explicit Spring(Params params) : params_(params) { params_.validate(); }
    const Params& params() const { return params_; }

private:
    Params params_;
};

struct Bare {
    static constexpr std::string_view name = "Bare";
    using Params = NoParams;
    explicit Bare(Params) {}
    const Params& params() const {
        static const Params none{};
        return none;
    }
};

struct NoValidate {
    void visit(auto&&) const {}
};
struct NoVisit {
    void validate() const {}
};
struct ValidateChanges {
    void validate() {}
    void visit(auto&&) const {}
};
struct NotCopyable {
    NotCopyable() = default;
    NotCopyable(const NotCopyable&) = delete;
    void validate() const {}
    void visit(auto&&) const {}
};

struct NoName {
    using Params = NoParams;
    explicit NoName(Params) {}
    const Params& params() const;
};
struct NoParamsMember {
    [[maybe_unused]] static constexpr std::string_view name = "x";
    explicit NoParamsMember(NoParams) {}
    const NoParams& params() const;
};
struct NotFromParams {
    [[maybe_unused]] static constexpr std::string_view name = "x";
    using Params = NoParams;
    const Params& params() const;
};
struct ParamsByValue {
    [[maybe_unused]] static constexpr std::string_view name = "x";
    using Params = NoParams;
    explicit ParamsByValue(Params) {}
    Params params() const;
};
struct NameIsNumber {
    [[maybe_unused]] static constexpr int name = 3;
    using Params = NoParams;
    explicit NameIsNumber(Params) {}
    const Params& params() const;
};

static_assert(ParamSet<SpringParams> && ParamSet<NoParams>);
static_assert(!ParamSet<NoValidate>);
static_assert(!ParamSet<NoVisit>);
static_assert(!ParamSet<ValidateChanges>);
static_assert(!ParamSet<NotCopyable>);
static_assert(!ParamSet<int> && !ParamSet<void*>);

static_assert(Law<Spring> && Law<Bare>);
static_assert(!Law<NoName>);
static_assert(!Law<NoParamsMember>);
static_assert(!Law<NotFromParams>);
static_assert(!Law<ParamsByValue>);
static_assert(!Law<NameIsNumber>);
static_assert(!Law<SpringParams>);

}  // namespace

TEST_CASE("a law prints its name and its parameters with their units") {
    CHECK(describe(Spring{{}}) == "Spring(stiffness = 5e+06 N/m, restitution = 0.6, count = 3)");
    CHECK(describe(Bare{{}}) == "Bare");
}

TEST_CASE("a law that exists can be used: its constructor validates") {
    CHECK_THROWS_WITH_AS(Spring({.stiffness = -1}),
                         "Spring.stiffness must be finite and > 0, got -1 N/m; check its sign", InputError);
}
