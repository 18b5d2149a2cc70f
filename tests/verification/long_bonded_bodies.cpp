// Random dense packings that are larger than the quick ones: bars drawn apart, a disc pressed, a wave's
// front.
#include "bonded_bodies.hpp"

#include <doctest/doctest.h>

using namespace bonded_bodies;

namespace {

constexpr Real solid = 0.63;

void tell(const std::string& what, const Drawn& bar) {
    const Loaded& seen = bar.seen;
    std::vector<Real> heights;
    for (const Crack& crack : seen.cracks) heights.push_back(std::abs(crack.place.z()) / d);
    std::sort(heights.begin(), heights.end());
    MESSAGE("half of the broken bonds within " << heights[heights.size() / 2] << " d of the neck's middle");
    MESSAGE(what << ": " << bar);
    CHECK(seen.end.residual_relative() < 1e-12);
    CHECK(std::abs(seen.end.integration_residue()) < 0.02 * seen.end.lost());
    CHECK(seen.load.size() < 900);  // it came apart
}

const Bar shape{.neck_width = 6, .root_width = 10, .head_width = 14};
const Material& packing_of_bar() {
    static const Material material =
        random_packing({shape.head_width, shape.head_width, shape.height()}, solid);
    return material;
}

}  // namespace

TEST_CASE("bars: modulus and strength against the bonds' shear stiffness; the front of a wave") {
    for (const Real ratio : {0.2, 0.5, 1.0}) {
        const Drawn bar = draw_apart(packing_of_bar(), shape, ratio);
        tell("ks/kn " + to_text(ratio), bar);
        const Real c = std::sqrt(bar.solid.constrained() / (solid * density));
        static const Lattice slab = cut(
            random_packing({22, 22, 13}, solid, 2), [](const Vec3&) { return true; }, -5.7 * d);
        const Real seen = front_speed(slab, -5.7 * d, c, 2 * d, 7 * d, 4 * d, ratio);
        MESSAGE("front: " << seen << " m/s, by the bar's modulus " << c << " m/s (" << 100 * (seen / c - 1)
                          << " %)");
        CHECK(seen == doctest::Approx(c).epsilon(0.05).scale(0));
    }
}

TEST_CASE("a random disc") {
    const Disc shape_of_disc{.radius = 15 * d, .thickness = 5 * d, .half_arc = 0.2};
    const Pressed disc = press(random_packing({30.5, 5, 30.5}, solid), shape_of_disc);
    const Loaded& seen = disc.seen;
    MESSAGE("tension at the centre over 2 P / (pi D t) "
            << disc.tension << ", pressure over three times that " << disc.pressure << "; first bond at "
            << disc.first << ", most " << disc.strength << " A sigma_t/d^2; " << seen.cracks.size()
            << " bonds broken; residual " << seen.end.residual_relative() << ", residue over losses "
            << seen.end.integration_residue() / seen.end.lost());
    // How far from the loaded diameter, for cracks and for all bonds, away from the plates.
    const auto spread = [](const auto& places) {
        Real n = 0, aside2 = 0;
        for (const auto& one : places)
            if (std::abs(one.place.z()) < 0.75 * 15 * d) aside2 += square(one.place.x()), ++n;
        return std::pair(std::sqrt(aside2 / n) / (15 * d), n);
    };
    const auto [cracks, count] = spread(seen.cracks);
    const auto [bonds, all] = spread(seen.strained);
    const Vec3 first = seen.cracks.at(0).place / (15 * d);
    MESSAGE("the first bond stood at x "
            << first.x() << " R, z " << first.z() << " R; nearer the middle than 0.75 R " << count << " of "
            << seen.cracks.size() << " broke, " << cracks
            << " R from the diameter (root of the mean square; of all bonds there " << bonds << " R)");
    CHECK(cracks < 0.5 * bonds);
    CHECK(disc.tension == doctest::Approx(0.946).epsilon(0.1).scale(0));
    CHECK(disc.pressure == doctest::Approx(1).epsilon(0.1).scale(0));
    CHECK(seen.end.residual_relative() < 1e-12);
    CHECK(std::abs(seen.end.integration_residue()) < 0.02 * seen.end.lost());
}
