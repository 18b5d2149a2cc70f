// Depth-averaged water that feels bodies: momentum, what they displace, the drag of a row of them.
#include <abrade/coupling/averaging/two_way_shallow.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real g = 9.81;

struct Ball {
    Sphere sphere;
    FlowBody body;
    Ball(const Vec3& centre, Real radius, Real density, Index id = 0) : sphere{centre, radius} {
        body.id = id, body.position = centre, body.volume = 4.0 / 3 * pi * cube(radius);
        if (density > 0) body.inverse_mass = 1 / (density * body.volume);
    }
};

TwoWayShallow<>::Params box(ShallowBoundary side, Real depth, Real speed) {
    return {.low = {0, -0.5},
            .high = {4, 0.5},
            .cells = {80, 20},
            .boundaries = {{{side, side}, {ShallowBoundary::wall(), ShallowBoundary::wall()}}},
            .surface = [depth](Real, Real) { return depth; },
            .speed = {[speed](Real, Real) { return speed; }, nullptr},
            .gravity = {0, 0, -g},
            .manning = 0,
            .density = 1000,
            .viscosity = 1e-3};
}
Real momentum(const TwoWayShallow<>& flow) {
    Real sum = 0;
    for (Index i = 0; i < 80; ++i) sum += 1000 * 0.05 * flow.water().discharge(i);
    return sum;
}

}  // namespace

TEST_CASE("momentum goes from the water to a ball: what is lost is a fiftieth, in the slope of the surface") {
    TwoWayShallow<> flow(box(ShallowBoundary::periodic(), 0.3, 2));
    std::vector<Ball> balls{{Vec3(1, 0.1, 0.1), 0.05, 2650}};
    FlowBody& ball = balls[0].body;
    const Real start = momentum(flow), mass = 1 / ball.inverse_mass;
    for (int k = 0; k < 50; ++k) {
        ball.velocity.x() += 0.01 * ball.load.force.x() / mass, ball.position.x() += 0.01 * ball.velocity.x();
        flow.advance(flow.time() + 0.01, {&ball, 1});
        CHECK(std::abs(momentum(flow) + mass * ball.velocity.x() - start) <
              0.02 * mass * ball.velocity.x() + 1e-9);
    }
    CHECK(ball.velocity.x() > 0.5);
}

TEST_CASE("a ball at a periodic side takes from both ends, and beyond the water nothing acts on it") {
    std::vector<Vec3> loads;
    for (const Real x : {2.02, 0.02, -0.03, 4.02}) {
        TwoWayShallow<> flow(box(ShallowBoundary::periodic(), 0.3, 2));
        Ball ball(Vec3(x, 0.1, 0.1), 0.05, 0);
        const Real start = momentum(flow);
        flow.advance(0.01, {&ball.body, 1});
        loads.push_back(ball.body.load.force);
        const Real differs = (loads.back() - loads[0]).norm() / loads[0].norm();
        MESSAGE("at " << x << " m: load differs by " << differs);
        CHECK(differs < 0.02);  // shallow water is sampled at a side as at the edge
        CHECK(start - momentum(flow) == doctest::Approx(0.01 * loads[0].x()).epsilon(1e-3));
    }
    TwoWayShallow<> lake(box(ShallowBoundary::wall(), 0.3, 0));
    Ball beyond(Vec3(4.5, 0.1, 0.1), 0.05, 0);
    lake.advance(0.01, {&beyond.body, 1});
    CHECK(beyond.body.load.force.norm() == 0);
}

TEST_CASE("a lake with a ball in it: its mean level is higher by what the ball displaces, and only swings") {
    TwoWayShallow<> flow(box(ShallowBoundary::wall(), 0.3, 0));
    Ball ball(Vec3(2, 0.03, 0.12), 0.1, 0);
    std::array<Real, 4> mean{};
    constexpr std::array<Index, 4> places{0, 20, 40, 79};
    for (int k = 1; k <= 4000; ++k) {  // as it was put in at once the water swings, and for long
        flow.advance(flow.time() + 0.02, {&ball.body, 1});
        for (std::size_t n = 0; n < 4; ++n) mean[n] += (flow.water().surface(places[n], 9) - mean[n]) / k;
    }
    for (const Real level : mean) CHECK(level == doctest::Approx(0.3 + ball.body.volume / 4).epsilon(3e-4));
    CHECK(flow.water().volume() == doctest::Approx(1.2).epsilon(1e-13));
    CHECK(ball.body.load.force.z() == doctest::Approx(1000 * g * ball.body.volume).epsilon(1e-3));
    CHECK(flow.water().bed(40, 9) == 0);
}

TEST_CASE("a row of fixed balls takes from a stream what their drag adds up to") {
    auto params = box(ShallowBoundary::inflow(0.6, 0.3), 0.3, 2);
    params.boundaries[0][1] = ShallowBoundary::outflow();
    TwoWayShallow<> flow(std::move(params));
    std::vector<Ball> balls;
    for (int n = 0; n < 10; ++n) balls.emplace_back(Vec3(2, -0.45 + 0.1 * n, 0.15), 0.04, 0, n);
    std::vector<FlowBody> bodies;
    for (const Ball& ball : balls) bodies.push_back(ball.body);
    for (int k = 0; k < 500; ++k) flow.advance(flow.time() + 0.02, bodies);
    Real drag = 0;
    for (const FlowBody& body : bodies) drag += body.load.force.x();
    const auto carried = [&](Index i) {  // momentum and pressure through a section
        Real sum = 0;
        for (Index j = 0; j < 20; ++j) {
            const Real h = flow.water().depth(i, j), u = flow.water().speed(0, i, j);
            sum += 1000 * 0.05 * (h * u * u + 0.5 * g * h * h);
        }
        return sum;
    };
    MESSAGE("drag " << drag << " N, the stream loses " << carried(20) - carried(60) << " N");
    CHECK(carried(20) - carried(60) == doctest::Approx(drag).epsilon(0.05));
    CHECK(drag > 20);
}

TEST_CASE("a ball ahead of the wet front feels no water, one in it does, and it goes on as it is") {
    auto params = box(ShallowBoundary::wall(), 0.3, 0);
    params.surface = [](Real x, Real) { return x < 1 ? 0.3 : -1; };  // a dam that breaks on a dry bed
    params.bed = [](Real, Real y) { return 0.2 * y * y; };
    TwoWayShallow<> flow(params);
    Ball ahead(Vec3(3, 0.1, 0.03), 0.05, 2650), behind(Vec3(0.8, 0.1, 0.1), 0.05, 2650, 1);
    ahead.body.velocity = behind.body.velocity = {2, 0, 0};
    std::vector<FlowBody> bodies{ahead.body, behind.body};
    for (int k = 0; k < 40; ++k) {  // until the front is at 2 m
        flow.advance(flow.time() + 0.005, bodies);
        CHECK(bodies[0].load.force.isZero());
        CHECK(bodies[0].velocity == Vec3(2, 0, 0));
        CHECK(bodies[1].load.force.z() > 1);
    }
    REQUIRE(flow.water().depth(28, 10) > params.dry_depth);
    REQUIRE(flow.water().depth(55, 10) == 0);
    const Real volume = flow.water().volume();
    for (int k = 0; k < 400; ++k) flow.advance(flow.time() + 0.005, bodies);  // the water has come there
    CHECK(bodies[0].load.force.z() > 1);
    CHECK(bodies[0].velocity.allFinite());
    CHECK(flow.water().volume() == doctest::Approx(volume).epsilon(1e-12));
    // What reaches below a dry bed is as dry as what lies on it.
    const FluidSample dry = TwoWayShallow<>(params).sample({3, 0.4, 0.01}, 0);
    CHECK(submerged_share(dry.depth, 0.1) == 0);
}

TEST_CASE("bad input is refused") {
    TwoWayShallow<> flow(box(ShallowBoundary::wall(), 0.3, 0));
    CHECK_THROWS_AS(flow.advance(std::nan(""), {}), InputError);
}
