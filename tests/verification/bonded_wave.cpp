// The front of a plane wave through slabs of bonded spheres: hexagonal against its closed form, random
// against the modulus of a bar.
#include "bonded_bodies.hpp"

#include <doctest/doctest.h>

using namespace bonded_bodies;

TEST_CASE("hexagonal: sqrt(M / rho) across the layers") {
    // Layers stand h = sqrt(2/3) d apart; three bonds at cos^2 = 2/3 lead to the next: 2 k_n + k_s a sphere.
    for (const Real ratio : {0.2, 1.0}) {
        constexpr int layers = 20, width = 26;
        const Real layer = d * std::sqrt(2.0 / 3), c = layer / unit * std::sqrt(2 + ratio);
        const Real row = d * std::sqrt(0.75);
        const Lattice lattice =
            hexagonal_lattice((width + 0.5) * d, d + (width / std::sqrt(0.75) - 1 + 1 / 3.0) * row + 1e-6 * d,
                              {.sphere_diameter = d, .layers = layers + 1});
        const Real seen =
            front_speed(lattice, -0.5 * d - layers * layer, c, 2 * layer, 0.6 * layers * layer, 2 * d, ratio);
        MESSAGE("ks/kn " << ratio << ": " << seen << " m/s, closed form " << c << " m/s ("
                         << 100 * (seen / c - 1)
                         << " %), M = " << square(c) * mass / (layer * row * d) / (kn / d) << " k_n/d");
        CHECK(seen == doctest::Approx(c).epsilon(0.01).scale(0));
    }
}

TEST_CASE("random: sqrt(M / rho) with M of a bar") {
    const Bar shape{.neck_width = 4, .root_width = 5.5, .head_width = 9, .head_height = 3};
    const Drawn bar =
        draw_apart(random_packing({shape.head_width, shape.head_width, shape.height()}), shape, 0.2);
    const Real solid = 0.63, c = std::sqrt(bar.solid.constrained() / (solid * density));
    const Material packing = random_packing({13, 13, 8}, solid, 2);
    const Lattice slab = cut(
        packing, [](const Vec3&) { return true; }, -3.2 * d);
    const Real seen = front_speed(slab, -3.2 * d, c, 1.5 * d, 4.5 * d, 3 * d, 0.2);
    MESSAGE("random: " << seen << " m/s, by the bar's modulus " << c << " m/s");
    CHECK(seen == doctest::Approx(c).epsilon(0.15).scale(0));
}
