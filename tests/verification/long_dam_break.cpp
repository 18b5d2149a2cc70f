// The front of a collapsing column on finer cells and with shorter steps.
#include "reference_table.hpp"
#include "water_column.hpp"

#include <doctest/doctest.h>

using namespace abrade;
using namespace water_column;

TEST_CASE("the front of Martin and Moyce, finer in space and in time") {
    constexpr Real width = 0.05715;
    struct Run {
        int cells;
        Real courant;
    };
    for (const auto& [cells, courant] : {Run{20, 0.125}, Run{40, 0.5}}) {
        auto params = column(cells, width, 6).params();
        params.courant = courant;
        GridFluid<2> flow(params);
        const std::vector<Front> fronts = run(flow, width, 5);
        const Real wide = worst_of_series(fronts, "MM_n2eq2_a2.25in_pysph");
        const Real narrow = worst_of_series(fronts, "MM_n2eq2_a1.125in_pysph");
        MESSAGE(cells << " cells, Courant number " << courant << ": off the wider column by " << 100 * wide
                      << " %, off the narrower by " << 100 * narrow << " %");
        CHECK(wide < 0.02);
        WARN(narrow < 0.05);
        CHECK(narrow < 0.06);
    }
}
