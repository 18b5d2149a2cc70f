// Waves on finer grids and with other steps; stronger bores; a dam that breaks over shallow water.
#include "reference_table.hpp"
#include "waves.hpp"

#include <doctest/doctest.h>

using namespace waves;

TEST_CASE("standing waves: frequency and energy over cells and steps") {
    for (const int n : {16, 32, 64})
        for (const int steps : {0, 60, 240}) {
            StandingWave wave;
            if (steps > 0) wave.largest_step = 2 * pi / wave.frequency() / steps;
            auto flow = wave.tank<2>(n);
            const Swing found = swing(wave, flow, 5);
            const Real error = found.frequency / wave.frequency() - 1;
            MESSAGE(n << " cells, "
                      << (steps > 0 ? std::to_string(steps) + " steps a period" : "steps of its own")
                      << ": frequency " << 100 * error << " %, energy lost per period "
                      << 100 * found.lost_per_period << " %");
            CHECK(std::abs(error) < 0.01);
            CHECK(std::abs(found.lost_per_period) < 0.01);
        }
}

TEST_CASE("solitary waves over twenty depths, by half of the stable step") {
    for (const Real height : {0.1, 0.2, 0.3})
        for (const int n : {10, 20}) {
            const SolitaryWave wave{.height = height};
            auto flow = wave.channel(n);
            const Real energy = wave_energy(flow), way = 20 * wave.depth;
            const Crest begins = crest(flow, wave.depth);
            advance_by_parts(flow, way / wave.speed(), 0.5);
            const Crest ends = crest(flow, wave.depth);
            const Real kept = ends.height / begins.height;
            const Real speed = (ends.place - begins.place) / way;
            MESSAGE("height " << height << ", " << n << " cells to the depth: height " << 100 * (kept - 1)
                              << " %, energy " << 100 * (wave_energy(flow) / energy - 1) << " %, speed "
                              << 100 * (speed - 1) << " %");
            CHECK(std::abs(kept - 1) < 0.05);
            CHECK(std::abs(wave_energy(flow) / energy - 1) < 0.03);
            CHECK(std::abs(speed - 1) < 0.01);
        }
}

TEST_CASE("bores: the depth behind them") {
    for (const Real froude : {1.5, 2.0, 3.0}) {
        const Bore bore{.froude = froude};
        const Bore::Found found = bore.run(6, 20);
        MESSAGE("Froude number " << froude << ": depth " << 100 * (found.depth - 1) << " %, speed "
                                 << 100 * (found.speed - 1) << " %");
        CHECK(std::abs(found.depth - 1) < 0.05);
    }
}

TEST_CASE("a dam breaks over shallow water: the depth between the waves is Stoker's") {
    for (const ReferenceRow& row : reference_table("flu10_dambreak_ritter_stoker_analytic.csv")) {
        const bool deep = row.is("case", "stoker_hl=1_hr=0.5_middle_state");
        if (!deep && !row.is("case", "stoker_hl=1_hr=0.1_middle_state")) continue;
        const DamBreak dam{.right = deep ? 0.5 : 0.1};
        auto flow = dam.channel(20, 40);
        const Real middle = 20, time = 5;
        flow.advance(time);
        // Between the tail of the rarefaction and the shock, a quarter of the way from either.
        const Real tail = row.at("u") - std::sqrt(gravity * row.at("h"));
        const Real shock = row.at("h") * row.at("u") / (row.at("h") - dam.right);
        const Real from = middle + time * (0.75 * tail + 0.25 * shock),
                   to = middle + time * (0.25 * tail + 0.75 * shock);
        const Grid<2>& grid = flow.grid();
        const auto height = [&](int i) { return flow.surface_at({grid.centre(0, i), 0}); };
        Real depth = 0, half_way_up = 0;
        int counted = 0;
        for (int i = 0; i < grid.cells(0); ++i) {
            if (grid.centre(0, i) > from && grid.centre(0, i) < to) depth += height(i), ++counted;
            if (height(i) > 0.5 * (dam.right + row.at("h"))) half_way_up = grid.centre(0, i);
        }
        depth /= counted;
        // The front breaks: it is where water that has come as far as half way between the waves would end
        // were it sharp. How far its roller reaches ahead of that is not Stoker's.
        Real come = 0;
        const int inside = static_cast<int>((0.5 * (from + to)) / grid.size(0, 0));
        for (int i = inside; i < grid.cells(0); ++i) come += (height(i) - dam.right) * grid.size(0, 0);
        const Real front = inside * grid.size(0, 0) + come / (row.at("h") - dam.right);
        const Real speed = (front - middle) / time;
        MESSAGE("onto " << dam.right << " m: depth " << 100 * (depth / row.at("h") - 1) << " %, front "
                        << 100 * (speed / shock - 1) << " %, half way up "
                        << 100 * ((half_way_up - middle) / time / shock - 1) << " %");
        WARN(std::abs((half_way_up - middle) / time / shock - 1) < 0.03);
        CHECK(std::abs(depth / row.at("h") - 1) < 0.03);
        CHECK(std::abs(speed / shock - 1) < 0.03);
    }
}
