// Drag of a sphere on coarse grids, fixed and led across them, and added mass on 8 cells: the table of
// docs/verification/resolved_bodies.md. Bounds are what was measured and some more, not what is wanted.
#include "resolved_bodies.hpp"

#include <abrade/coupling/exchange/one_fluid.hpp>

#include <doctest/doctest.h>

using namespace resolved;

TEST_CASE("drag over Reynolds number and cells to a diameter") {
    struct Case {
        /// Drag: of a grid that fits the sphere at Re 20 and 100, then Schiller & Naumann, from Re 1000 on
        /// Clift & Gauvin; [-]
        Real cells, reynolds, drag, off;
    };
    constexpr Real at_20 = fitted_drag_at_20, at_100 = fitted_drag_at_100;
    for (const Case& c : {Case{2, 20, at_20, 0.13}, Case{3, 20, at_20, 0.02}, Case{4, 20, at_20, 0.02},
                          Case{6, 20, at_20, 0.02}, Case{8, 20, at_20, 0.02}, Case{2, 100, at_100, 0.35},
                          Case{3, 100, at_100, 0.05}, Case{4, 100, at_100, 0.05}, Case{6, 100, at_100, 0.05},
                          Case{8, 100, at_100, 0.05}, Case{4, 300, 0.684, 0.08}, Case{6, 300, 0.684, 0.06},
                          Case{4, 1000, 0.466, 0.21}, Case{4, 10000, 0.42, 0.12}}) {
        const Drag drag = drag_in({.cells = c.cells, .reynolds = c.reynolds, .off = 0.3}, 12);
        MESSAGE(c.cells << " cells, Re " << c.reynolds << ": " << drag.mean << ", exact " << c.drag);
        CHECK(std::abs(drag.mean / c.drag - 1) < c.off);
    }
}

TEST_CASE(
    "in faster flow drag depends on the place on the grid: its mean over six, with and without eddies") {
    const auto mean = [](Real cells, Real reynolds, const auto& eddies) {
        Real sum = 0, least = 1e9, most = 0;
        for (const Real off : {0.0, 0.15, 0.3, 0.45, 0.6, 0.75}) {
            const Real drag = drag_in({.cells = cells, .reynolds = reynolds, .off = off}, 16,
                                      MonolithicSolids<>({.resolved_from = 0}), eddies)
                                  .mean /
                              CliftGauvin().coefficient(reynolds);
            sum += drag / 6, least = std::min(least, drag), most = std::max(most, drag);
        }
        MESSAGE(cells << " cells, Re " << reynolds << ": " << sum << " of the curve's, " << least << " to "
                      << most);
        return sum;
    };
    struct Off {
        Real reynolds, without, with_eddies;
    };
    for (const Real cells : {3.0, 4.0, 5.0})
        for (const Off& o :
             {Off{300, 0.06, 0.11}, Off{1e3, 0.18, 0.29}, Off{1e4, 0.16, 0.29}, Off{1e5, 0.13, 0.08}}) {
            CHECK(std::abs(mean(cells, o.reynolds, NoTurbulence{}) - 1) < o.without);
            CHECK(std::abs(mean(cells, o.reynolds, Smagorinsky({.constant = 0.1})) - 1) < o.with_eddies);
        }
}

TEST_CASE(
    "a fixed sphere with a wake is pushed to where a shear is slower, not lifted to where it is faster") {
    for (const auto& [cells, reynolds] :
         {std::pair{6.0, 20.0}, std::pair{8.0, 100.0}, std::pair{6.0, 300.0}}) {
        const Real lift = drag_in({.cells = cells, .reynolds = reynolds, .off = 0.3, .shear = 0.2}, 16).lift;
        MESSAGE("Re " << reynolds << ", " << cells << " cells: C_L " << lift);
        CHECK(lift < -0.1);
        CHECK(lift > -0.25);
    }
}

TEST_CASE("a sphere that is led along the stream: its drag varies little as it crosses the grid") {
    for (const auto& [cells, most] : {std::pair{4.0, 0.02}, std::pair{6.0, 0.008}}) {
        const Drag drag = drag_in({.cells = cells, .led = 0.2}, 12);
        MESSAGE(cells << " cells, Re 80: " << drag.mean << ", varies by " << 100 * drag.varies << " %");
        CHECK(drag.mean == doctest::Approx(1.23).epsilon(0.05));
        CHECK(drag.varies < most);
    }
}

TEST_CASE("added mass on 8 cells, of a ball of a hundredth of the water's density") {
    Water water({.grid = {.cells = {32, 32, 32}, .spacing = Vec3::Constant(1.0 / 32)},
                 .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                 .gravity = {0, 0, -9.81},
                 .density = 1000,
                 .viscosity = 0,
                 .tolerance = 1e-8});
    std::vector<Ball> balls{{Vec3(0.51, 0.495, 0.507), 4.0 / 32, 10}};
    step(water, balls, 1e-3);
    const Real a = balls[0].body.velocity.z() / 1e-3, exact = 9.81 * 0.99 / 0.51;
    MESSAGE("off by " << 100 * (a / exact - 1) << " %");
    CHECK(a == doctest::Approx(exact).epsilon(0.03));
}

TEST_CASE("direct forcing, mean over three places on the grid") {
    struct Measured {
        Real reynolds, cells, drag;
    };
    for (const Measured& m :
         {Measured{100, 2, 1.49}, Measured{100, 3, 1.38}, Measured{100, 4, 1.42}, Measured{100, 6, 1.29},
          Measured{20, 2, 1.91}, Measured{20, 3, 2.07}, Measured{20, 4, 2.33}, Measured{20, 6, 2.44}}) {
        Real mean = 0;
        for (const Real off : {0.0, 0.25, 0.5})
            mean += drag_in({.cells = m.cells, .reynolds = m.reynolds, .off = off}, m.reynolds == 20 ? 6 : 10,
                            DirectForcing())
                        .mean /
                    3;
        MESSAGE("Re " << m.reynolds << ", " << m.cells << " cells: " << mean);
        CHECK(mean == doctest::Approx(m.drag).epsilon(0.02));
    }
}
