// Modulus and strength of bonded bodies as a whole, against what their bonds have: blocks that hang.
#include "ageing.hpp"

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

constexpr Real spacing = 0.02, stiffness = 4e6, tensile = 2.7e6, ratio = 0.2;
const MohrCoulomb law{{.tensile = tensile, .stiffness = stiffness, .stiffness_ratio = ratio, .damping = 0.3}};
const Real capacity = law.capacity(0.5 * spacing);

/// Along z, in units of the bonds: k_n / d and A sigma_t / d^2.
struct Whole {
    Real modulus;
    Real first;     ///< stress across the held section under which the first bond breaks
    Real strength;  ///< under which more than half of the spheres come off, if it went that far
    Real unaccounted;
};

/// A block of section `area` [m2] that gravity pulls away from its held spheres, held at height `base` [m].
Whole hang(Lattice lattice, Real area, Real base, bool until_apart = true) {
    std::vector<Vec3> start;
    std::vector<char> held;
    for (const LatticeSite& site : lattice.sites) start.push_back(site.centre), held.push_back(site.held);
    Scene scene;
    scene.concrete = ConcreteBlock{std::move(lattice)};
    scene.gravity = {0, 0, 10};
    Real left = 1;
    auto sim = simulate(scene)
                   .contact(LinearSpring{{.stiffness = stiffness}})
                   .bond(law)
                   .wear(Ageing{{.left = &left}});
    const Real mass = 2400 * pi / 6 * cube(spacing), unit = std::sqrt(mass / stiffness);
    sim.run({.end_time = 2500 * unit});
    REQUIRE(sim.bonds_broken() == 0);
    const Particles& now = sim.particles();

    // The stress at z is the weight beyond it over the section; du/dz = stress / E, so that u is its integral
    // over E: fitted where neither end is near.
    Real top = base, load = 0;
    std::vector<Real> heights;
    for (std::size_t b = 0; b < start.size(); ++b)
        if (!held[b]) heights.push_back(start[b].z() - base), top = std::max(top, start[b].z());
    load = static_cast<Real>(heights.size()) * mass * 10 / area;
    Real x = 0, y = 0, xx = 0, xy = 0, n = 0;
    for (std::size_t b = 0; b < start.size(); ++b) {
        const Real z = start[b].z() - base, share = z / (top - base);
        if (held[b] || share < 0.3 || share > 0.8) continue;
        Real integral = 0;
        for (const Real height : heights) integral += std::min(height, z) * mass * 10 / area;
        const Real u = now.position[b].z() - start[b].z();
        x += integral, y += u, xx += square(integral), xy += integral * u, ++n;
    }
    const Real youngs = (xx - x * x / n) / (xy - x * y / n);

    // The strength that each bond needs, at rest.
    Real needed = 0;
    auto network = sim.world().network();  // a copy, for what bonds remember is in packs
    network.unpack();
    for (const auto& bond : network.bonds()) {
        const auto i = static_cast<std::size_t>(bond.bodies.first),
                   j = static_cast<std::size_t>(bond.bodies.second);
        const Real pull = stiffness * ((now.position[i] - now.position[j]).norm() - bond.rest_length);
        const Real shear = ratio * stiffness * bond.memory.spring.norm() / std::tan(radians(35));
        needed = std::max(needed, pull + shear);
    }
    const Real first = needed / capacity;
    const auto loose = [&] {
        Index grains = 0;
        for (const Kind kind : now.kind) grains += kind == Kind::grain;
        return 2 * grains > static_cast<Index>(heights.size());
    };
    for (left = 1.005 * first; until_apart && !loose() && left > 0.3 * first; left *= 0.99)
        sim.run({.end_time = sim.time() + 20 * unit});
    const Real per_area = load * square(spacing) / capacity;
    return {youngs / (stiffness / spacing), per_area / first, until_apart ? per_area / left : NAN,
            sim.ledger().residual_relative()};
}

void report(const std::string& what, const Whole& seen) {
    MESSAGE(what << ": E " << seen.modulus << " k_n/d, first bond at " << seen.first << ", apart at "
                 << seen.strength << " A sigma_t/d^2; residual " << seen.unaccounted);
    CHECK(seen.unaccounted < 1e-12);
}

/// Spheres poured into a box without friction; the section of the box [m2].
std::vector<Vec3> poured(Real side, int layers) {
    Scene scene;
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    for (const Real s : {-1.0, 1.0}) {
        scene.add_wall({0.5 * s * side, 0, 0}, {-s, 0, 0});
        scene.add_wall({0, 0.5 * s * side, 0}, {0, -s, 0});
    }
    std::mt19937 random(7);
    std::uniform_real_distribution<Real> jitter(-0.04, 0.04);
    const int across = static_cast<int>(side / (1.1 * spacing));
    const Real place = side / across;
    for (int k = 0; k < layers; ++k)
        for (int i = 0; i < across; ++i)
            for (int j = 0; j < across; ++j) {
                const Real x = jitter(random), y = jitter(random), z = jitter(random);
                scene.add_sphere(0.5 * spacing, {.position = {(i + 0.5) * place - 0.5 * side + x * spacing,
                                                              (j + 0.5) * place - 0.5 * side + y * spacing,
                                                              (1.1 * k + 0.6 + z) * spacing}});
            }
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e5, .restitution = 0.3, .friction = 0}});
    sim.run({.end_time = 0.6});
    return sim.particles().position;
}

}  // namespace

TEST_CASE("cubic: E = k_n / d along an axis, and all bonds of the held section break under A sigma_t each") {
    const Whole seen =
        hang(flat_lattice(4 * spacing, 4 * spacing, {.sphere_diameter = spacing, .layers = 11}),
             square(4 * spacing), -10.5 * spacing);
    report("cubic, 4 d wide", seen);
    CHECK(seen.modulus == doctest::Approx(1).epsilon(2e-3));
    CHECK(seen.first == doctest::Approx(1).epsilon(2e-3));
    CHECK(seen.strength == doctest::Approx(1).epsilon(0.02));
}

TEST_CASE("hexagonal: E along z and the first bond, of the crystal without ends and sides") {
    // Six bonds lie in the layer, six stand at cos^2 = 2/3 to z; strains follow the whole, by symmetry.
    // W = 3/(2 V) d^2 [a e_z^2 + 2 b e_z e_r + c e_r^2] in units of k_n, V = d^3 / sqrt(2):
    const Real a = 4 / 9.0 + ratio * 2 / 9, b = (1 - ratio) * 2 / 9, c = 10 / 9.0 + ratio * 2 / 9;
    const Real modulus = 3 * std::sqrt(2.0) * (a - b * b / c), radial = -b / c;
    const Real pull = 2 / 3.0 + radial / 3, shear = ratio * (1 - radial) * std::sqrt(2.0) / 3;
    const Real first = modulus / (pull + shear / std::tan(radians(35)));
    MESSAGE("crystal: E " << modulus << " k_n/d, Poisson's ratio " << -radial << ", first bond at " << first
                          << " A sigma_t/d^2");
    const Real layer = spacing * std::sqrt(2.0 / 3);
    Real found[2] = {};
    for (const int width : {4, 6}) {
        // Rows fill this rectangle without being spread.
        const Real x = (width + 0.5) * spacing, y = (1 + (width - 1 + 1 / 3.0) * std::sqrt(0.75)) * spacing;
        // Of the crystal each sphere has sqrt(3)/2 d^2 of a layer.
        const Real area = square(width * spacing) * std::sqrt(0.75);
        const Whole seen = hang(hexagonal_lattice(x, y, {.sphere_diameter = spacing, .layers = 11}), area,
                                -0.5 * spacing - 10 * layer);
        report(width == 4 ? "hexagonal, 4 d wide" : "hexagonal, 6 d wide", seen);
        CHECK(seen.modulus < modulus);  // sides lack bonds
        found[width / 6] = seen.modulus;
    }
    // What sides lack goes as 1 / width.
    const Real wide = 3 * found[1] - 2 * found[0];
    MESSAGE("hexagonal, E led on to infinite width: " << wide << " k_n/d");
    CHECK(wide == doctest::Approx(modulus).epsilon(0.01).scale(0));
}

TEST_CASE("poured: modulus and strength of a random packing whose touching spheres are bonded") {
    const Real side = 6 * spacing;
    const std::vector<Vec3> centres = poured(side, 14);
    Real top = 0;
    for (const Vec3& x : centres) top = std::max(top, x.z());
    const Real height = top + 0.5 * spacing;
    Lattice lattice = lattice_of(centres, 0.5 * spacing, square(side) * height, 0.05, 0.8 * spacing);
    MESSAGE("solid fraction " << static_cast<Real>(centres.size()) * pi / 6 * cube(spacing) /
                                     (square(side) * height)
                              << ", bonds a sphere "
                              << 2.0 * static_cast<Real>(lattice.bonds.size()) /
                                     static_cast<Real>(centres.size()));
    const Whole seen = hang(std::move(lattice), square(side), 0.5 * spacing, false);
    report("poured, 6 d wide", seen);
    CHECK(seen.modulus > 0.3);
    CHECK(seen.modulus < 2);
}
