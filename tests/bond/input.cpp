// What no bond law can use is refused, with field, rule, value and remedy.
#include <abrade/bond/elastic_brittle.hpp>
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/parallel_bond.hpp>

#include "../message_of.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <vector>

using namespace abrade;

namespace {

constexpr Real nan_ = std::numeric_limits<Real>::quiet_NaN(),
               infinite = std::numeric_limits<Real>::infinity();

/// A parameter, what its message says, and where it ends.
template <class Law>
struct Field {
    Real Law::Params::*member;
    std::string name, rule;
    std::string unit_and_remedy;
    std::vector<Real> bad, allowed;
};

template <class Law>
void check(const typename Law::Params& good, const std::vector<Field<Law>>& fields) {
    for (const Field<Law>& field : fields) {
        const auto said = [&](Real value) {
            typename Law::Params params = good;
            params.*field.member = value;
            return message_of([&] { Law{params}; });
        };
        for (const Real value : field.bad)
            CHECK(said(value) == std::string(Law::name) + "." + field.name + " must be " + field.rule +
                                     ", got " + to_text(value) + field.unit_and_remedy);
        for (const Real value : field.allowed) CHECK(said(value) == "nothing was thrown");
    }
}

const std::vector<Real> not_positive{0, -1, nan_, infinite}, no_angle{-0.1, 90, 135, nan_, infinite},
    no_share{-0.1, 1.1, nan_, infinite};
const std::string positive = "finite and > 0", share = "; it is a share of critical damping, 0 for none",
                  angle = " degrees; concrete has 30 to 40",
                  strength = " Pa; a few times the tensile strength",
                  stiffness = " N/m; E A / d is about 4e8 N/m for concrete, softer is cheaper";

}  // namespace

TEST_CASE("MohrCoulomb") {
    using P = MohrCoulomb::Params;
    check<MohrCoulomb>(
        {.tensile = 2.7e6, .stiffness = 4e8},
        {{&P::tensile, "tensile", positive, " Pa; concrete has 2e6 to 5e6 Pa", not_positive, {1}},
         {&P::stiffness, "stiffness", positive, stiffness, not_positive, {1}},
         {&P::stiffness_ratio, "stiffness_ratio", positive, "; the default is 0.2", not_positive, {1}},
         {&P::friction_angle, "friction_angle", "in [0, 90)", angle, no_angle, {0, 89.9}},
         {&P::damping, "damping", "in [0, 1]", share, no_share, {0, 1}}});
}

TEST_CASE("ElasticBrittle") {
    using P = ElasticBrittle::Params;
    const std::string friction = "; tan of 30 to 40 degrees for concrete, 0 for none";
    check<ElasticBrittle>(
        {.tensile = 2.7e6, .shear = 8e6, .stiffness = 4e8},
        {{&P::tensile, "tensile", positive, " Pa; concrete has 1e6 to 5e6", not_positive, {1}},
         {&P::shear, "shear", positive, strength, not_positive, {1}},
         {&P::stiffness, "stiffness", positive, stiffness, not_positive, {1}},
         {&P::stiffness_ratio, "stiffness_ratio", positive, "; the default is 0.2", not_positive, {1}},
         {&P::friction, "friction", "finite and >= 0", friction, {-0.1, nan_, infinite}, {0, 2}},
         {&P::damping, "damping", "in [0, 1]", share, no_share, {0, 1}}});
}

TEST_CASE("ParallelBond") {
    using P = ParallelBond::Params;
    const std::string thick = "; 1 is a beam as thick as the spheres, its area goes with the square";
    check<ParallelBond>(
        {.youngs = 2.7e10, .tensile = 2.7e6, .cohesion = 8e6},
        {{&P::youngs, "youngs", positive, " Pa; concrete has 2e10 to 4e10", not_positive, {1}},
         {&P::tensile, "tensile", positive, " Pa; concrete has 1e6 to 5e6", not_positive, {1}},
         {&P::cohesion, "cohesion", positive, strength, not_positive, {1}},
         {&P::stiffness_ratio, "stiffness_ratio", positive, "; the default is 0.4", not_positive, {1}},
         {&P::radius_factor, "radius_factor", positive, thick, not_positive, {0.5, 1}},
         {&P::friction_angle, "friction_angle", "in [0, 90)", angle, no_angle, {0, 89.9}},
         {&P::damping, "damping", "in [0, 1]", share, no_share, {0, 1}}});
}
