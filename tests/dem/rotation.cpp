// Free rotation of an asymmetric body: what is conserved, the order, the flip about the middle axis.
#include <abrade/dem/time/rotation.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace abrade;

namespace {

const Vec3 moments(1.0, 2.0, 3.5);
const Vec3 inverse = moments.cwiseInverse();

Vec3 in_body(const Quaternion& q, const Vec3& momentum) { return q.conjugate() * momentum; }
Real energy(const Quaternion& q, const Vec3& momentum) {
    const Vec3 pi_body = in_body(q, momentum);
    return 0.5 * pi_body.dot(inverse.cwiseProduct(pi_body));
}

/// A free body of that angular momentum in world axes, after one step.
Quaternion turn_freely(const Quaternion& q, const Vec3& momentum, const Vec3& inverse_inertia, Real dt) {
    return turned(q, midpoint_spin(in_body(q, momentum), inverse_inertia, dt), dt);
}
Quaternion after(Real time, int steps, Quaternion q, const Vec3& momentum) {
    for (int n = 0; n < steps; ++n) q = turn_freely(q, momentum, inverse, time / steps);
    return q;
}

}  // namespace

TEST_CASE("energy, momentum in the body and unit length are conserved to round-off over 1e4 steps") {
    const Vec3 momentum(1, 0.5, -2);
    for (const Real dt : {0.001, 0.05, 0.3}) {
        CAPTURE(dt);
        Quaternion q = Quaternion(1, 0.2, -0.3, 0.4).normalized();
        const Real start = energy(q, momentum);
        for (int n = 0; n < 10'000; ++n) q = turn_freely(q, momentum, inverse, dt);
        // 1e4 steps of round-off 1e-16 at random add up to 1e-14; 1e-12 is a bound on a drift of one sign.
        CHECK(std::abs(energy(q, momentum) / start - 1) < 1e-12);
        CHECK(std::abs(in_body(q, momentum).norm() / momentum.norm() - 1) < 1e-13);
        CHECK(std::abs(q.norm() - 1) < 1e-15);
    }
}

TEST_CASE("rotation about a principal axis is steady, at the rate L/I") {
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 momentum = 1.7 * Vec3::Unit(axis);
        const Real rate = 1.7 / moments[axis], dt = 0.01;
        const Quaternion q = turn_freely(Quaternion::Identity(), momentum, inverse, dt);
        // The Cayley transform turns by 2 atan(w dt / 2).
        CHECK(q.vec()[axis] / q.w() == doctest::Approx(0.5 * rate * dt).epsilon(1e-14).scale(0));
    }
}

TEST_CASE("second order in dt") {
    const Vec3 momentum(1, 0.5, -2);
    const Quaternion start = Quaternion(1, 0.2, -0.3, 0.4).normalized(),
                     exact = after(2, 200'000, start, momentum);
    const auto error = [&](int steps) { return after(2, steps, start, momentum).angularDistance(exact); };
    CHECK(std::log2(error(100) / error(200)) == doctest::Approx(2).epsilon(0.02));
    CHECK(std::log2(error(400) / error(800)) == doctest::Approx(2).epsilon(0.02));
}

TEST_CASE("about the middle axis the body flips over; about the others it does not") {
    const auto turns_over = [](int axis) {
        Vec3 momentum = Vec3::Unit(axis) + 1e-3 * Vec3(1, 1, 1);
        Quaternion q = Quaternion::Identity();
        const Real rate = momentum.norm() / moments[axis];
        Real lowest = 1;
        for (int n = 0; n < 20'000; ++n) {
            q = turn_freely(q, momentum, inverse, 0.02 / rate);
            lowest = std::min(lowest, in_body(q, momentum)[axis] / momentum.norm());
        }
        return lowest;
    };
    CHECK(turns_over(1) < -0.99);
    CHECK(turns_over(0) > 0.99);
    CHECK(turns_over(2) > 0.99);
}

TEST_CASE("the flip's period is that of the elliptic integral") {
    // Momentum nearly along the middle axis: half-period T = K(k) 2 / (rate factor), by quadrature of the
    // exact motion of the body momentum: d Pi_2/dt = (1/I1 - 1/I3) Pi_1 Pi_3 with both invariants given.
    const Vec3 momentum = Vec3(0.02, 1, 0.03);
    const Real l2 = momentum.squaredNorm(), twice_energy = momentum.cwiseProduct(momentum).dot(inverse);
    // Eliminate: Pi_1^2 = (2T - l2/I3 - Pi_2^2 (1/I2 - 1/I3)) / (1/I1 - 1/I3), likewise Pi_3^2.
    const auto pi1 = [&](Real p2) {
        return (twice_energy - l2 * inverse[2] - p2 * (inverse[1] - inverse[2])) / (inverse[0] - inverse[2]);
    };
    const auto pi3 = [&](Real p2) {
        return (l2 * inverse[0] - twice_energy - p2 * (inverse[0] - inverse[1])) / (inverse[0] - inverse[2]);
    };
    const Real top2 = std::min((twice_energy - l2 * inverse[2]) / (inverse[1] - inverse[2]),
                               (l2 * inverse[0] - twice_energy) / (inverse[0] - inverse[1]));
    // Pi_2 = top sin(a): a smooth integrand once the root at the end is taken out.
    Real half_period = 0;
    constexpr int points = 200'000;
    for (int n = 0; n < points; ++n) {
        const Real a = -pi / 2 + pi * (n + 0.5) / points, p2 = top2 * square(std::sin(a));
        half_period += pi / points * std::sqrt(top2) * std::cos(a) /
                       ((inverse[0] - inverse[2]) * std::sqrt(pi1(p2) * pi3(p2)));
    }
    Quaternion q = Quaternion::Identity();
    const Real dt = 0.002;
    Real last = 1, first_zero = -1, second_zero = -1;
    for (int n = 1; second_zero < 0 && n < 1'000'000; ++n) {
        q = turn_freely(q, momentum, inverse, dt);
        const Real now = in_body(q, momentum)[1];
        if (last * now < 0) {
            const Real at = (n - 1 + last / (last - now)) * dt;
            (first_zero < 0 ? first_zero : second_zero) = at;
        }
        last = now;
    }
    CHECK(second_zero - first_zero ==
          doctest::Approx(half_period)
              .epsilon(1e-4));  // second order: (w dt)^2/12 = 1e-7, times ln(1/0.03) of growth
}
