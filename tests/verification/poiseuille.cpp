// Laminar flow between two plates, J. Poiseuille: order of convergence with walls on the sides, off the grid
// planes and at an angle. docs/verification/viscous_flow.md has the table and the causes.
#include "viscous_flow.hpp"

#include <doctest/doctest.h>

using namespace viscous;

TEST_CASE("between two sides: second order in velocity and discharge") {
    const Errors coarse = between_sides(16), fine = between_sides(32);
    MESSAGE("16 and 32 cells: velocity " << coarse.profile << " and " << fine.profile << ", resistance "
                                         << coarse.resistance << " and " << fine.resistance);
    CHECK(order(coarse.profile, fine.profile) > 1.9);
    CHECK(order(coarse.resistance, fine.resistance) > 1.9);
    CHECK(std::abs(fine.resistance) < 0.005);
}

TEST_CASE("between level walls: resistance of second order") {
    struct Case {
        Real share, profile, resistance;  ///< bounds on 16 cells are what was measured and a tenth more
    };
    for (const Case& wall : {Case{1, 0.00136, 0.0086}, Case{0.75, 0.0096, 0.0087}, Case{0.6, 0.0141, 0.0091},
                             Case{0.25, 0.0021, 0.0101}}) {
        const Errors coarse = Channel{.cells = 8, .share = wall.share}.errors(),
                     fine = Channel{.cells = 16, .share = wall.share}.errors();
        CAPTURE(wall.share);
        MESSAGE("open share " << wall.share << ": velocity " << fine.profile << ", order "
                              << order(coarse.profile, fine.profile) << "; resistance " << fine.resistance
                              << ", order " << order(coarse.resistance, fine.resistance));
        CHECK(fine.profile < wall.profile);
        CHECK(std::abs(fine.resistance) < wall.resistance);
        CHECK(order(coarse.resistance, fine.resistance) > 1.9);
        CHECK(order(coarse.profile, fine.profile) > 1.4);
        CHECK(order(coarse.middle, fine.middle) > 1.9);
        if (wall.share == 1)
            CHECK(order(coarse.profile, fine.profile) > 1.9);
        else
            WARN(order(coarse.profile, fine.profile) > 1.9);
    }
}

TEST_CASE("between walls at an angle to the grid, 8 to 16 cells: resistance of order 1.8") {
    struct Case {
        Real degrees, profile, resistance;  ///< as above
    };
    for (const Case& wall : {Case{10, 0.0075, 0.0066}, Case{30, 0.0056, 0.0038}, Case{45, 0.0045, 0.0021}}) {
        const Real angle = wall.degrees * pi / 180;
        const Errors coarse = Channel{.cells = 8, .angle = angle}.errors(),
                     fine = Channel{.cells = 16, .angle = angle}.errors();
        CAPTURE(wall.degrees);
        MESSAGE(wall.degrees << " degrees: velocity " << fine.profile << ", order "
                             << order(coarse.profile, fine.profile) << "; in the middle of what is open "
                             << fine.middle << ", order " << order(coarse.middle, fine.middle)
                             << "; resistance " << fine.resistance << ", order "
                             << order(coarse.resistance, fine.resistance));
        CHECK(fine.profile < wall.profile);
        CHECK(std::abs(fine.resistance) < wall.resistance);  // below 1 % on 16 cells already
        CHECK(order(coarse.resistance, fine.resistance) > 1.8);
        CHECK(order(coarse.profile, fine.profile) > 1.35);
        CHECK(order(coarse.middle, fine.middle) > 1.6);
    }
}

TEST_CASE("between walls at 45 degrees, 32 cells: resistance below 0.1 %, and of order 1.5 from 8 cells on") {
    // Half a time is enough: what is left of the start is exp(-pi^2 / 2) of its errors, which are those of
    // the exact profile.
    const auto errors = [](int cells) {
        return Channel{.cells = cells, .angle = pi / 4, .end = 0.5}.errors();
    };
    const Errors coarse = errors(8), fine = errors(32);
    const Real of_two = 0.5 * order(coarse.resistance, fine.resistance);  // cells are halved twice
    MESSAGE("resistance " << coarse.resistance << ", " << fine.resistance << ", order " << of_two);
    CHECK(std::abs(fine.resistance) < 0.001);
    CHECK(of_two > 1.5);
}
