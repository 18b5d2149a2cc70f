#pragma once
// What the cells and the columns of a lattice add up to.

#include <abrade/geometry/lattice.hpp>

inline abrade::Real sum_of_cells(const abrade::Lattice& lattice) {
    abrade::Real sum = 0;
    for (const abrade::LatticeSite& site : lattice.sites) sum += site.cell_volume;
    return sum;
}
inline abrade::Real sum_of_areas(const abrade::Lattice& lattice) {
    abrade::Real sum = 0;
    for (const abrade::Real area : lattice.column_area) sum += area;
    return sum;
}
