// Hulls of wet cells in rows: found, grown, joined.
#include <abrade/fluid/mesh/wet_rows.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

template <int Dim>
Grid<Dim> box(const CellNumber<Dim>& cells) {
    return Grid<Dim>({.cells = cells, .spacing = Point<Dim>::Constant(1)});
}

/// Row and place of a cell.
template <int Dim>
std::array<int, 3> place(const CellNumber<Dim>& c) {
    if constexpr (Dim == 3)
        return {c[0], c[2], c[1]};
    else
        return {c[0], 0, c[1]};
}

/// A few wet cells; and whether any lies within `reach` of a cell, across periodic ends too.
template <int Dim>
struct Drops {
    Grid<Dim> grid;
    std::vector<CellNumber<Dim>> wet;
    Field<Real> fraction{grid.layout().total, 0};

    explicit Drops(const CellNumber<Dim>& cells, int count) : grid(box<Dim>(cells)) {
        std::mt19937 random(2);
        for (int k = 0; k < count; ++k) {
            CellNumber<Dim> c;
            for (std::size_t a = 0; a < Dim; ++a)
                c[a] = static_cast<int>(random() % static_cast<unsigned>(cells[a]));
            wet.push_back(c);
            fraction[grid.layout().at(c)] = 0.5;
        }
    }
    bool near(const CellNumber<Dim>& cell, int reach, const PerAxis<bool, Dim>& periodic) const {
        for (const auto& w : wet) {
            bool all = true;
            for (std::size_t a = 0; a < Dim; ++a) {
                int d = std::abs(w[a] - cell[a]);
                if (periodic[a]) d = std::min(d, grid.layout().cells[a] - d);
                all = all && d <= reach;
            }
            if (all) return true;
        }
        return false;
    }
};

template <int Dim>
void check_drops(const CellNumber<Dim>& cells, const PerAxis<bool, Dim>& periodic) {
    const Drops<Dim> drops(cells, 4);
    WetRows<Dim> rows(drops.grid.layout());
    rows.find(drops.fraction);
    for (const int reach : {0, 1, 2}) {
        const WetRows<Dim> grown = rows.dilated(reach, periodic);
        std::int64_t missed = 0;
        drops.grid.for_each([&](const CellNumber<Dim>& c, Offset) {
            const auto [plane, row, i] = place<Dim>(c);
            const RowRange& range = grown.row(plane, row);
            missed += drops.near(c, reach, periodic) && !(i >= range.begin && i < range.end);
        });
        CHECK(missed == 0);
    }
    // What was found anew within grown ranges is what was found in whole rows.
    WetRows<Dim> again(drops.grid.layout());
    again.find_within(rows.dilated(2, periodic), drops.fraction);
    CHECK(again.cells() == rows.cells());
}

}  // namespace

TEST_CASE("ranges join to their hull") {
    CHECK(hull(RowRange{2, 4}, {7, 9}) == RowRange{2, 9});
    CHECK(hull(RowRange{}, {7, 9}) == RowRange{7, 9});
    CHECK(hull(RowRange{2, 4}, {5, 5}) == RowRange{2, 4});
    CHECK(hull(RowRange{}, {}).empty());
}

TEST_CASE("nothing wet, all wet") {
    const Grid<3> grid = box<3>({4, 5, 6});
    Field<Real> fraction(grid.layout().total, 0);
    WetRows<3> rows(grid.layout());
    rows.find(fraction);
    CHECK(rows.cells() == 0);
    CHECK(rows.dilated(2).cells() == 0);
    fraction.fill(1);
    rows.find(fraction);
    CHECK(rows.cells() == 4 * 5 * 6);
    CHECK(rows.dilated(2).cells() == 4 * 5 * 6);
}

TEST_CASE("no wet cell and none near one is missed") {
    check_drops<2>({9, 12}, {false, false});
    check_drops<2>({9, 12}, {true, false});
    check_drops<2>({9, 12}, {true, true});
    check_drops<3>({9, 12, 7}, {false, false, false});
    check_drops<3>({9, 12, 7}, {true, false, true});
    check_drops<3>({9, 12, 7}, {false, true, false});
}

TEST_CASE("cost follows the water: one drop is one cell") {
    const Drops<3> drops({40, 40, 40}, 1);
    WetRows<3> rows(drops.grid.layout());
    rows.find(drops.fraction);
    CHECK(rows.cells() == 1);
    int visited = 0;
    rows.for_each_row([&](int, int, const RowRange& range) { visited += range.length(); });
    CHECK(visited == 1);
}
