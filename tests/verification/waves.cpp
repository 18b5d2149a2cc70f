// Grid water with a free surface against closed solutions: the frequency of standing waves and what they
// lose, a solitary wave over twenty depths, the depth behind a bore.
#include "waves.hpp"
#include "reference_table.hpp"

#include <doctest/doctest.h>

using namespace waves;

namespace {

/// omega of a tank as the table has it [rad/s].
Real published_frequency(const StandingWave& wave) {
    for (const ReferenceRow& row : reference_table("flu13_sloshing_frequency_analytic.csv"))
        if (row.at("L") == wave.length && row.at("h") == wave.depth && row.at("mode") == wave.mode)
            return row.at("omega");
    return 0;
}

}  // namespace

TEST_CASE("the first two frequencies of a deep and of a shallow tank") {
    for (const Real depth : {0.5, 0.1})
        for (const int mode : {1, 2}) {
            const StandingWave wave{.depth = depth, .mode = mode, .amplitude = 0.1 * depth / 5};
            CHECK(wave.frequency() == doctest::Approx(published_frequency(wave)).epsilon(1e-5));
            auto flow = wave.tank<2>(32);
            const Real volume = flow.liquid().volume();
            const Swing found = swing(wave, flow, 5);
            const Real error = found.frequency / wave.frequency() - 1;
            MESSAGE("depth " << depth << " m, mode " << mode << ": frequency " << 100 * error
                             << " %, energy lost per period " << 100 * found.lost_per_period << " %");
            CHECK(std::abs(error) < (mode == 1 ? 0.01 : 0.02));
            CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-8).scale(0));
        }
}

TEST_CASE("a wave along the diagonal of a square tank") {
    const StandingWave wave;
    auto flow = wave.tank<3>(20);
    const Swing found = swing(wave, flow, 3);
    const Real error = found.frequency / wave.frequency(2) - 1;
    MESSAGE("frequency " << 100 * error << " %, energy lost per period " << 100 * found.lost_per_period
                         << " %");
    CHECK(std::abs(error) < 0.01);
}

TEST_CASE("short steps: what is left of a standing wave's energy is the grid's") {
    StandingWave wave;
    wave.largest_step = 2 * pi / wave.frequency() / 240;
    auto flow = wave.tank<2>(32);
    const Swing found = swing(wave, flow, 5);
    MESSAGE("energy lost per period " << 100 * found.lost_per_period << " %");
    // No gate is published: a wave that gives up its energy in a hundred periods is a wave.
    CHECK(std::abs(found.lost_per_period) < 0.01);
}

TEST_CASE("a wave that runs around a periodic box three times") {
    for (const int n : {24, 48}) {
        const RunningWave wave;
        auto flow = wave.box(n);
        flow.advance(3 * 2 * pi / wave.frequency());
        const RunningWave::Found found = wave.found_in(flow);
        const Real speed_error = found.phase / (6 * pi), left = found.amplitude / wave.amplitude;
        MESSAGE(n << " cells: speed " << 100 * speed_error << " %, amplitude left " << left);
        CHECK(std::abs(speed_error) < 0.01);
        CHECK(std::abs(left - 1) < 0.1);
    }
}

TEST_CASE("a solitary wave keeps height, energy and speed over twenty depths") {
    // What it loses is proportional to the time step.
    for (const Real part : {1.0, 0.5}) {
        const SolitaryWave wave;
        auto flow = wave.channel(10);
        const Real energy = wave_energy(flow), way = 20 * wave.depth;
        const Crest begins = crest(flow, wave.depth);
        advance_by_parts(flow, way / wave.speed(), part);
        const Crest ends = crest(flow, wave.depth);
        const Real height = ends.height / begins.height;
        const Real speed = (ends.place - begins.place) / way;
        MESSAGE("steps of " << part << " of the stable one: height " << 100 * (height - 1) << " %, energy "
                            << 100 * (wave_energy(flow) / energy - 1) << " %, speed " << 100 * (speed - 1)
                            << " % of the third order's");
        // The start is of third order: its own error is e^4 = 0.0016 of the depth, 0.8 % of the height.
        CHECK(std::abs(height - 1) < (part == 1 ? 0.025 : 0.02));
        CHECK(std::abs(wave_energy(flow) / energy - 1) < (part == 1 ? 0.035 : 0.02));
        CHECK(std::abs(speed - 1) < 0.01);
        // sqrt(g (h + a)) is 0.1 % more at this height.
        CHECK(wave.speed() / std::sqrt(gravity * (wave.depth + wave.height)) ==
              doctest::Approx(0.999).epsilon(1e-3));
    }
}

TEST_CASE("the depth behind a bore is Belanger's") {
    const Bore bore{.froude = 2};
    for (const ReferenceRow& row : reference_table("flu11_hydraulic_jump_belanger.csv"))
        if (row.at("F1") == bore.froude)
            CHECK(bore.sequent() == doctest::Approx(row.at("h2_over_h1")).epsilon(1e-5));
    const Bore::Found found = bore.run(6, 12);
    MESSAGE("depth " << 100 * (found.depth - 1) << " %, speed " << 100 * (found.speed - 1) << " %");
    CHECK(std::abs(found.depth - 1) < 0.05);
}
