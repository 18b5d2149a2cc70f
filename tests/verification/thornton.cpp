// Oblique impacts of Thornton, Cummins & Cleary with the law that `HertzMindlin` is by default: the
// incremental spring, dashpots, no tension. Powder Technol. 233 (2013) 30, doi:10.1016/j.powtec.2012.08.012.
#include "chung_ooi.hpp"

#include <doctest/doctest.h>

using namespace chung_ooi;

namespace {

/// Greatest departure from a series, over its range.
template <class MakeLaw>
Real departure(const std::string& quantity, Real restitution, const MakeLaw& form) {
    Real low = 1e300, high = -1e300, worst = 0;
    for (const auto& row : reference_table("dem15_thornton2013_oblique_hertz.csv")) {
        if (!row.is("quantity", quantity) || row.at("restitution") != restitution) continue;
        const Impact t = impact_thornton(row.at("psi"), restitution);
        const Real value = figure_thornton(quantity, t, off_plane(t, form, 100)), reference = row.at("value");
        low = std::min(low, reference), high = std::max(high, reference);
        worst = std::max(worst, std::abs(value - reference));
    }
    return worst / (high - low);
}

}  // namespace

TEST_CASE("the incremental spring meets its own paper's curves, sticking and sliding (dem15)") {
    for (const Real e : {0.9, 0.75, 0.5, 0.25})
        for (const std::string quantity : {"spin", "patch"}) {
            const Real ours = departure(quantity, e, own_form), theirs = departure(quantity, e, OtherForm{});
            CAPTURE(e);
            CAPTURE(quantity);
            MESSAGE("e = " << e << ", " << quantity << ": " << 100 * ours << " % of its range; "
                           << 100 * theirs << " % with a slider whose spring takes the whole limit");
            CHECK(theirs <= 0.05);
            // The paper's slider stretches the spring by what the dashpot had of the limit, which books a
            // negative loss as a contact begins; ours does not. Where damping is strong that shows in the
            // slow recoil: up to 0.26 of psi's unit, 8.3 % of the range, at e = 0.5.
            CHECK(ours <= (e <= 0.5 && quantity == "patch" ? 0.09 : 0.05));
        }
}
