// Many bodies at once: how many iterations the pressure takes among them, water between stones whose gaps no
// cell knows, and pockets that stones cut off.
#include "exchange_checks.hpp"

#include <abrade/coupling/exchange/one_fluid.hpp>

#include <doctest/doctest.h>

#include <string>

using namespace resolved;

namespace {

struct Effort {
    Real mean = 0, most = 0;  ///< iterations in a step
    Real per_digit = 0;       ///< over the decimals that they take from what is wrong
    Real left = 0;            ///< share of a cell's volume, root mean square
    Real solid = 0;           ///< share of the box
};

void tell(const std::string& what, const Effort& e) {
    MESSAGE(what << ", " << short_text(100 * e.solid) << " % solid: " << e.mean << " iterations, at most "
                 << e.most << ", " << e.per_digit << " for a decimal; left " << e.left);
}

/// Vortices that break up in a box of 24 cells, among n x n x n balls on a lattice that is as much out of
/// order as it has room for.
template <class Solids>
Effort vortices_among(int n, Real diameter, Real density) {
    constexpr int cells = 24;
    constexpr Real size = 1, h = size / cells, k = 2 * pi / size;
    auto params = box(cells, h, Boundary::free_slip);
    params.gravity.setZero(), params.tolerance = 1e-6;
    params.velocity = [](const Vec3& x) {
        const Real up = std::cos(k * x.z());
        return Vec3(std::sin(k * x.x()) * std::cos(k * x.y()) * up,
                    -std::cos(k * x.x()) * std::sin(k * x.y()) * up, 0);
    };
    WaterAmong<Solids> water(params);
    std::vector<Ball> balls;
    Effort found;
    const Real room = n > 0 ? size / n - diameter : 0;
    for (int i = 0; i < n * n * n; ++i) {
        const Vec3 place(i % n, i / n % n, i / (n * n));
        const Vec3 aside(std::sin(7.0 * i), std::sin(11.0 * i + 1), std::sin(13.0 * i + 2));
        balls.emplace_back((place + Vec3::Constant(0.5)) * size / n + 0.49 * room * aside, 0.5 * diameter,
                           density, i);
        found.solid += balls.back().body.volume / cube(size);
    }
    constexpr int steps = 20;
    Real decimals = 0;
    for (int s = 0; s < steps; ++s) {
        step(water, balls, std::min(0.2 * h, water.stable_step().seconds));
        const auto& report = water.last_projection();
        const Real iterations = report.iterations;
        found.mean += iterations / steps, found.most = std::max(found.most, iterations);
        found.left = std::max(found.left, report.after);
        if (report.iterations > 0)
            found.per_digit += iterations, decimals += std::log10(report.before / report.after);
    }
    found.per_digit /= decimals;
    return found;
}

/// Spheres all over a shell: the water in it has no way out.
std::vector<Sphere> shell(const Vec3& centre, Real radius, Real thick) {
    std::vector<Sphere> spheres;
    constexpr int count = 200;
    for (int i = 0; i < count; ++i) {
        const Real z = 1 - (2.0 * i + 1) / count, around = i * pi * (3 - std::sqrt(5.0));
        const Real across = std::sqrt(1 - square(z));
        spheres.push_back(
            {centre + radius * Vec3(across * std::cos(around), across * std::sin(around), z), thick});
    }
    return spheres;
}

}  // namespace

TEST_CASE_TEMPLATE("up to 4 % of solids: at most 1.5 times clear water's iterations", Solids,
                   MonolithicSolids<>, MixtureSolids) {
    const Effort clear = vortices_among<Solids>(0, 0, 0);
    tell("clear water", clear);
    for (const Real density : {0.0, 2650.0})
        for (const Real diameter : {0.125, 0.167, 0.21}) {  // 3, 4 and 5 cells
            const Effort few = vortices_among<Solids>(2, diameter, density);
            tell(density > 0 ? "free" : "fixed", few);
            CHECK(few.mean < 1.5 * clear.mean);
            CHECK(few.per_digit < 1.5 * clear.per_digit);
            CHECK(few.left < 1e-6);
        }
}

TEST_CASE("beds of 30 and 52 % of solids: the pressure converges") {
    for (const Real density : {0.0, 2650.0})
        for (const int n : {4, 6})  // 6 and 4 cells to a diameter
            for (const Real of : {0.83, 1.0}) {
                const Effort bed = vortices_among<MonolithicSolids<>>(n, of / n, density);
                tell(density > 0 ? "free" : "fixed", bed);
                CHECK(bed.left < 1e-6);
                CHECK(bed.most <= 8);
            }
}

TEST_CASE("water that a body shuts in goes with it: a null space of its own does no harm") {
    for (const Real density : {0.0, 2650.0}) {
        auto params = box(20, 0.05, Boundary::free_slip);
        Water water(params);
        Ball hull(Vec3(0.51, 0.49, 0.52), 0.3, density);
        const auto spheres = shell(hull.body.position, 0.22, 0.08);
        hull.body.volume = 4.0 / 3 * pi * (cube(0.3) - cube(0.14));  // nearly: it has dents
        Real most = 0, fastest = 0;
        for (int k = 0; k < 60; ++k) {
            FlowBody& body = hull.body;
            std::vector<Sphere> now = spheres;
            hull.move(0.005, params.gravity);
            for (Sphere& s : now) s.centre += body.position - Vec3(0.51, 0.49, 0.52);
            body.spheres = now;
            water.advance(water.time() + 0.005, {&body, 1});
            most = std::max(most, water.last_projection().after);
            FaceField<3> passes = water.velocity();  // with what covers faces
            water.solids().mix_last(passes);
            for (int a = 0; a < 3; ++a)
                water.grid().for_each(
                    [&](const auto&, Offset c) { fastest = std::max(fastest, std::abs(passes[a][c])); });
        }
        MESSAGE("density " << density << ": fell " << 0.52 - hull.body.position.z() << " m, at "
                           << -hull.body.velocity.z() << " m/s; fastest water " << fastest << " m/s, left "
                           << most);
        CHECK(most < 1e-7);
        if (density == 0) CHECK(fastest < 1e-5);
        if (density > 0) CHECK(hull.body.velocity.z() < -0.2);
        // Beside a body that closes a quarter of the box.
        CHECK(fastest < 2 * std::max(-hull.body.velocity.z(), 1e-5));
    }
}

TEST_CASE("water driven through a bed of touching balls: the bed takes all that drives it") {
    for (const Real diameter : {0.15, 0.2, 0.25}) {
        auto params = box(16, 1.0 / 16, Boundary::periodic);
        params.gravity.setZero(), params.viscosity = 100, params.tolerance = 1e-7;
        params.body_force = [](Real) { return Vec3(1, 0, 0); };
        Water water(params);
        std::vector<Ball> balls;
        for (int i = 0; i < 64; ++i)  // 4 cells each
            balls.emplace_back(0.25 * Vec3(i % 4 + 0.5, i / 4 % 4 + 0.5, i / 16 + 0.5), 0.5 * diameter, 0, i);
        Real most = 0, iterations = 0, solid = 0;
        while (water.time() < 1) {
            step(water, balls, std::min(0.01, water.stable_step().seconds));
            most = std::max(most, water.last_projection().after);
            iterations = std::max(iterations, Real(water.last_projection().iterations));
        }
        Vec3 force = Vec3::Zero();
        for (const Ball& ball : balls) force += ball.body.load.force, solid += ball.body.volume;
        MESSAGE("at most " << iterations << " iterations, left " << most << "; force on the bed " << force.x()
                           << " N, on the water " << 1000 * (1 - solid) << " N");
        CHECK(force.x() == doctest::Approx(1000 * (1 - solid)).epsilon(1e-3));
        CHECK(force.tail<2>().norm() < 1e-3 * force.x());
        CHECK(most < 1e-7);
        CHECK(iterations <= 8);
    }
}
