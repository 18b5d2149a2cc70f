// A disc pressed between two plates (the Brazilian test): one layer of a triangular lattice.
#include "bonded_bodies.hpp"

#include <doctest/doctest.h>

using namespace bonded_bodies;

namespace {

/// A layer without end, as a sheet of thickness d, in units of k_n / d: isotropic in its plane.
struct Sheet {
    explicit Sheet(Real ratio) : poisson((1 - ratio) / (3 + ratio)) {
        youngs = std::sqrt(0.75) * (3 + ratio) / 2 * (1 - square(poisson));
    }
    Real poisson, youngs;
    /// Stress across the load at which a bond along x breaks, A sigma_t / d^2; `along` is the stress along
    /// the load over that across. Bonds along x bear no shear: they break at the stretch A sigma_t / k_n.
    Real strength(Real along) const { return youngs / (1 - poisson * along); }
};

}  // namespace

TEST_CASE("rows across the load: stress at the centre, first crack on the loaded diameter, strength") {
    const Sheet sheet(0.2);
    const Real radius = 15 * d;
    const Pressed disc = press(triangular_sheet(2.1 * radius, 2.1 * radius, false), {.radius = radius});
    const Loaded& seen = disc.seen;
    // Bonds on the loaded diameter against the closed form, away from the plates.
    const Real load = 2 * seen.strained_load / (pi * 2 * radius * d) / (tensile * pi / 4);
    Real worst = 0, worst_at = 0, error = 0, bonds = 0;
    for (const Strained& bond : seen.strained) {
        if (bond.needed > worst) worst = bond.needed, worst_at = bond.place.z() / radius;
        if (std::abs(bond.place.x()) > 0.6 * d || std::abs(bond.place.z()) > 0.5 * radius ||
            std::abs(bond.along.z()) > 0.1)
            continue;
        const auto [across, along] = two_forces(bond.place, radius);
        const Real expected = load * across / sheet.strength(along / across);
        error = std::max(error, std::abs(bond.needed / expected - 1)), ++bonds;
    }
    Real aside = 0, together = 0;
    for (const Crack& crack : seen.cracks)
        if (crack.load == seen.cracks[0].load) aside = std::max(aside, std::abs(crack.place.x())), ++together;
    MESSAGE("at the centre: tension over 2 P / (pi D t) "
            << disc.tension << ", pressure over three times that " << disc.pressure << "; " << bonds
            << " bonds along the diameter differ by " << error
            << " at most from what they should bear; 2 P / (pi D t) as the first breaks " << load / worst
            << " to " << disc.first << " A sigma_t/d^2, at z = " << worst_at << " R, most " << disc.strength
            << "; the first " << together << " cracks are within " << aside / d
            << " d of the diameter; without end: drawn along a row " << sheet.strength(0)
            << ", under three times the pressure across " << sheet.strength(-3) << "; residual "
            << seen.end.residual_relative() << ", residue over losses "
            << seen.end.integration_residue() / seen.end.lost());
    // Plates on an arc of +-0.15 rad: (sin 0.3 - 0.15) / 0.15 = 0.970 (Hondros).
    CHECK(disc.tension == doctest::Approx(0.970).epsilon(0.02).scale(0));
    CHECK(disc.pressure == doctest::Approx(1).epsilon(0.02).scale(0));
    CHECK(bonds > 10);
    CHECK(error < 0.05);
    CHECK(disc.first == doctest::Approx(load / worst).epsilon(0.02).scale(0));
    CHECK(disc.strength < 1.05 * disc.first);  // once it has begun the crack runs
    CHECK(together > 5);
    CHECK(aside < 1.1 * d);
    CHECK(seen.end.residual_relative() < 1e-12);
    CHECK(std::abs(seen.end.integration_residue()) < 0.02 * seen.end.lost());
}
