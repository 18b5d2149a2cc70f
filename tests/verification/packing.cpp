// Crystals of touching spheres in periodic space: the engine finds each sphere's neighbours, no more and no
// fewer, and the solid fraction is the known one (dem14).
#include "reference_table.hpp"

#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <algorithm>

using namespace abrade;

namespace {

struct Crystal {
    std::string name;         ///< in the table
    Vec3 cell;                ///< period [d]
    std::vector<Vec3> sites;  ///< in the cell, as shares of the period
    int neighbours = 0;
};

std::vector<Crystal> crystals() {
    const Real bcc = 2 / std::sqrt(3.), fcc = std::sqrt(2.), root3 = std::sqrt(3.);
    return {
        {"simple_cubic", {1, 1, 1}, {{0, 0, 0}}, 6},
        {"bcc", {bcc, bcc, bcc}, {{0, 0, 0}, {0.5, 0.5, 0.5}}, 8},
        {"fcc_hcp", {fcc, fcc, fcc}, {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}}, 12},
        {"fcc_hcp",
         {1, root3, std::sqrt(8. / 3)},
         {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 5. / 6, 0.5}, {0, 1. / 3, 0.5}},
         12},
    };
}

Real published(const std::string& name) {
    for (const auto& row : reference_table("dem14_packing_constants.csv"))
        if (row.is("quantity", name)) return row.at("value");
    throw std::runtime_error("dem14 has no " + name);
}

}  // namespace

TEST_CASE("crystals: solid fraction and number of neighbours are exact (dem14)") {
    const Real d = 0.02, pressed = 1e-6;  // overlap over d, so that spheres which should touch do
    for (const Crystal& crystal : crystals()) {
        CAPTURE(crystal.name);
        const int cells = 5;
        Scene scene;
        scene.gravity.setZero();
        scene.bounds = {Vec3::Zero(), cells * d * crystal.cell};
        scene.periodic_along = {true, true, true};
        for (int i = 0; i < cells; ++i)
            for (int j = 0; j < cells; ++j)
                for (int k = 0; k < cells; ++k)
                    for (const Vec3& site : crystal.sites)
                        scene.add_sphere(0.5 * d * (1 + pressed),
                                         {.position = d * crystal.cell.cwiseProduct(
                                                              Vec3(i + 0.1, j + 0.1, k + 0.1) + site)});
        auto sim = simulate(std::move(scene)).contact(LinearSpring{{.stiffness = 1e5}});
        sim.run({.end_time = 0});
        const Particles& p = sim.particles();
        Real solid = 0;
        for (const Real volume : p.volume) solid += volume;
        const Vec3 size = cells * d * crystal.cell;
        // To the six digits of the table.
        CHECK(solid / cube(1 + pressed) / size.prod() ==
              doctest::Approx(published(crystal.name)).epsilon(2e-6).scale(0));
        std::vector<int> neighbours(p.position.size());
        sim.world().each_contact([&](Index first, Index second, const auto& contact, const auto&) {
            CHECK(contact.overlap == doctest::Approx(pressed * d).epsilon(1e-6).scale(0));
            ++neighbours[static_cast<std::size_t>(first)], ++neighbours[static_cast<std::size_t>(second)];
        });
        CHECK(std::all_of(neighbours.begin(), neighbours.end(),
                          [&](int n) { return n == crystal.neighbours; }));
        // Pushed alike from all sides, nothing moves.
        sim.run({.end_time = 0.01});
        for (const Vec3& v : p.velocity) CHECK(v.norm() < 1e-12);
    }
}
