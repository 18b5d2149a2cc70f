#pragma once
// Shape errors that others have published, and what ours must keep.

#include "reference_table.hpp"
#include "volume_of_fluid.hpp"

#include <doctest/doctest.h>

#include <algorithm>

namespace returning_shapes {

struct Published {
    Real smallest = 0, median = 0, largest = 0;
};

inline Real published(const std::string& test, int cells, Real Published::*which) {
    std::vector<Real> errors;
    for (const ReferenceRow& row : reference_table("vof01_published_shape_errors.csv"))
        if (row.is("test", test) && row.at("cells") == cells) errors.push_back(row.at("error"));
    REQUIRE(!errors.empty());
    std::sort(errors.begin(), errors.end());
    const std::size_t n = errors.size();
    const Published all{errors.front(), 0.5 * (errors[(n - 1) / 2] + errors[n / 2]), errors.back()};
    return all.*which;
}

/// Volume to round-off, no fraction beyond its bounds, nothing moved aside: the velocity has no divergence.
inline void check_conserved(const Returned& r) {
    CHECK(r.lost < 1e-12);
    CHECK(r.outside == 0);
    CHECK(r.redistributed < 1e-9);
}

}  // namespace returning_shapes
