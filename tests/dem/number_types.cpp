// One source of the contact law for several number types.
#include <abrade/core/simd.hpp>
#include <abrade/dem/contacts/contact_kernel.hpp>
#include <abrade/dem/laws/elastic_plastic_hertz.hpp>
#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>

#include <doctest/doctest.h>

#include <random>
#include <vector>

using namespace abrade;

static_assert(AnswersPacks<LinearHysteretic> && AnswersPacks<ElasticPlasticHertz>);

namespace {

const LinearSpring law{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.5}};

}  // namespace

TEST_CASE("float answers as double does, to float's precision") {
    std::mt19937 random(23);
    std::uniform_real_distribution<Real> u(-1, 1);
    for (int n = 0; n < 1000; ++n) {
        const Vec3 normal = Vec3(u(random), u(random), u(random)).normalized(),
                   velocity(u(random), u(random), u(random));
        const Vec3 held = 1e-6 * Vec3(u(random), u(random), u(random));
        const Real overlap = 5e-4 + 4e-4 * u(random);
        const auto wide = law.respond(ContactKinematics<Real>{normal, overlap, velocity, 100, 200, 1e-5},
                                      LinearSpring::Memory<Real>{held});
        const auto narrow =
            law.respond(ContactKinematics<float>{normal.cast<float>(), static_cast<float>(overlap),
                                                 velocity.cast<float>(), 100, 200, 1e-5},
                        LinearSpring::Memory<float>{held.cast<float>()});
        const Real size = 1e6 * overlap;
        // Float's 6e-8, times what is cancelled: the tangential part of a velocity, a root of a difference.
        REQUIRE((narrow.load.force.cast<Real>() - wide.load.force).norm() < 1e-4 * size);
        REQUIRE(std::abs(static_cast<Real>(narrow.load.lost_tangential) - wide.load.lost_tangential) <
                1e-4 * size * 1e-5 * velocity.norm());
        REQUIRE(std::abs(static_cast<Real>(narrow.load.stored) - wide.load.stored) < 1e-4 * size * overlap);
    }
}

TEST_CASE("at rest float's smaller range makes no 0/0") {
    const auto still = law.respond(ContactKinematics<float>{{0, 0, 1}, 1e-4f, {0, 0, 0}, 100, 200, 1e-5},
                                   LinearSpring::Memory<float>{});
    CHECK(static_cast<Real>(still.load.force.z()) == doctest::Approx(100).epsilon(1e-5));
    CHECK(still.load.force.head<2>().norm() == 0.0f);
    CHECK(still.load.lost_tangential == 0.0f);
}

TEST_CASE("a pack of contacts answers as its contacts do one by one") {
    std::mt19937 random(5);
    std::uniform_real_distribution<Real> u(-1, 1);
    const auto anything = [&] { return Vec3(u(random), u(random), u(random)); };
    int sliding = 0, apart = 0;
    for (int n = 0; n < 2000; ++n) {
        std::vector<ContactKinematics<Real>> one;
        std::vector<LinearSpring::Memory<Real>> held;
        ContactKinematics<Pack> all{};
        LinearSpring::Memory<Pack> held_by_all{};
        all.time_step = 1e-6;
        // Every other pack sticks in all lanes, and so stays out of the rarer branches.
        const Real speed = n % 2 ? 1 : 1e-3;
        for (int lane = 0; lane < pack_lanes; ++lane) {
            const Vec3 normal = anything().normalized();
            // Some contacts have just begun, some are apart.
            const Real overlap = n % 2 ? 5e-5 * u(random) * u(random) : 5e-5;
            one.push_back({normal, overlap, speed * anything(), 100, 200, 1e-6, speed * 1e-6 * anything()});
            held.push_back({1e-6 * anything()});
            for (int a = 0; a < 3; ++a) {
                all.normal[a].set(lane, normal[a]);
                all.velocity[a].set(lane, one.back().velocity[a]);
                all.displacement[a].set(lane, one.back().displacement[a]);
                held_by_all.spring[a].set(lane, held.back().spring[a]);
            }
            all.overlap.set(lane, overlap), all.inverse_mass.set(lane, 100), all.curvature.set(lane, 200);
        }
        const auto answer = law.respond(all, held_by_all);
        for (int lane = 0; lane < pack_lanes; ++lane) {
            const auto k = static_cast<std::size_t>(lane);
            const auto alone = law.respond(one[k], held[k]);
            const Real push = 1e6 * std::abs(one[k].overlap) + 10 * speed;
            // rsqrt and reciprocal are good to 2 units in the last place; a root of a difference loses half.
            for (int a = 0; a < 3; ++a) {
                REQUIRE(answer.load.force[a][lane] ==
                        doctest::Approx(alone.load.force[a]).scale(push).epsilon(1e-9));
                REQUIRE(answer.memory.spring[a][lane] ==
                        doctest::Approx(alone.memory.spring[a]).scale(1e-6).epsilon(1e-9));
            }
            REQUIRE(answer.load.stored[lane] ==
                    doctest::Approx(alone.load.stored).scale(push * 5e-5).epsilon(1e-9));
            REQUIRE(answer.load.lost_normal[lane] ==
                    doctest::Approx(alone.load.lost_normal).scale(push * speed * 1e-6).epsilon(1e-9));
            REQUIRE(answer.load.lost_tangential[lane] ==
                    doctest::Approx(alone.load.lost_tangential).scale(push * 1e-6).epsilon(1e-9));
            sliding += alone.load.lost_tangential > 0, apart += one[k].overlap <= 0;
        }
    }
    CHECK(sliding > 1000);
    CHECK(apart > 1000);
}

TEST_CASE(
    "Hertz-Mindlin in each of its forms: a pack answers as its contacts do, and loses nothing negative") {
    std::mt19937 random(7);
    std::uniform_real_distribution<Real> u(-1, 1);
    const auto anything = [&] { return Vec3(u(random), u(random), u(random)); };
    for (const auto spring : {HertzMindlin::Spring::incremental, HertzMindlin::Spring::total})
        for (const auto slider : {HertzMindlin::Slider::whole_force, HertzMindlin::Slider::springs})
            for (const bool tension : {false, true}) {
                const HertzMindlin hertz{{.youngs = 1e8,
                                          .restitution = 0.6,
                                          .friction = 0.5,
                                          .tension = tension,
                                          .spring = spring,
                                          .slider = slider}};
                const Real stiffness = 8 * hertz.effective_shear() * std::sqrt(5e-5 / 200);
                int sliding = 0, apart = 0;
                for (int n = 0; n < 400; ++n) {
                    std::vector<ContactKinematics<Real>> one;
                    std::vector<HertzMindlin::Memory<Real>> held;
                    ContactKinematics<Pack> all{};
                    HertzMindlin::Memory<Pack> held_by_all{};
                    all.time_step = 1e-6;
                    const Real speed = n % 2 ? 1 : 1e-3;
                    for (int lane = 0; lane < pack_lanes; ++lane) {
                        const Real overlap = n % 2 ? 5e-5 * u(random) * u(random) : 5e-5;
                        one.push_back({anything().normalized(), overlap, speed * anything(), 100, 200, 1e-6,
                                       speed * 1e-6 * anything()});
                        held.push_back({1e-6 * anything(), stiffness * (1 + 0.5 * u(random))});
                        for (int a = 0; a < 3; ++a) {
                            all.normal[a].set(lane, one.back().normal[a]);
                            all.velocity[a].set(lane, one.back().velocity[a]);
                            all.displacement[a].set(lane, one.back().displacement[a]);
                            held_by_all.spring[a].set(lane, held.back().spring[a]);
                        }
                        held_by_all.stiffness.set(lane, held.back().stiffness);
                        all.overlap.set(lane, overlap), all.inverse_mass.set(lane, 100);
                        all.curvature.set(lane, 200);
                    }
                    const auto answer = hertz.respond(all, held_by_all);
                    for (int lane = 0; lane < pack_lanes; ++lane) {
                        const auto k = static_cast<std::size_t>(lane);
                        const auto alone = hertz.respond(one[k], held[k]);
                        const Real push = stiffness * (5e-5 + 1e-6) + 10 * speed, energy = push * 1e-6;
                        for (int a = 0; a < 3; ++a) {
                            REQUIRE(answer.load.force[a][lane] ==
                                    doctest::Approx(alone.load.force[a]).scale(push).epsilon(1e-9));
                            REQUIRE(answer.memory.spring[a][lane] ==
                                    doctest::Approx(alone.memory.spring[a]).scale(1e-6).epsilon(1e-9));
                        }
                        REQUIRE(answer.memory.stiffness[lane] ==
                                doctest::Approx(alone.memory.stiffness).epsilon(1e-9));
                        REQUIRE(answer.load.stored[lane] ==
                                doctest::Approx(alone.load.stored).scale(energy).epsilon(1e-9));
                        REQUIRE(answer.load.lost_tangential[lane] ==
                                doctest::Approx(alone.load.lost_tangential).scale(energy).epsilon(1e-9));
                        REQUIRE(alone.load.lost_tangential >= 0);
                        REQUIRE(alone.load.lost_normal >= 0);
                        REQUIRE(answer.load.lost_tangential[lane] >= 0);
                        sliding += alone.load.lost_tangential > 0, apart += one[k].overlap <= 0;
                    }
                }
                CHECK(sliding > 100);
                CHECK(apart > 100);
            }
}

namespace {

/// Packs of random contacts, some of which have just begun, some apart, some within their dent: each lane
/// answers as its contact does alone, in double and in float.
template <class Law>
void lanes_answer_alone(const Law& yields, Real stiffness) {
    std::mt19937 random(11);
    std::uniform_real_distribution<Real> u(-1, 1);
    const auto anything = [&] { return Vec3(u(random), u(random), u(random)); };
    int sliding = 0, apart = 0, dented = 0, again = 0;
    for (int n = 0; n < 1000; ++n) {
        ContactKinematics<Pack> all{};
        typename Law::template Memory<Pack> held_by_all{};
        all.time_step = 1e-6;
        const Real speed = n % 2 ? 1 : 1e-3;
        for (int lane = 0; lane < pack_lanes; ++lane) {
            const Vec3 normal = anything().normalized(), velocity = speed * anything(),
                       displacement = speed * 1e-6 * anything(), spring = 1e-6 * anything();
            for (int a = 0; a < 3; ++a) {
                all.normal[a].set(lane, normal[a]), all.velocity[a].set(lane, velocity[a]);
                all.displacement[a].set(lane, displacement[a]), held_by_all.spring[a].set(lane, spring[a]);
            }
            all.overlap.set(lane, n % 2 ? 5e-5 * u(random) * u(random) : 5e-5);
            all.inverse_mass.set(lane, 100), all.curvature.set(lane, 200);
            held_by_all.deepest.set(lane, 6e-5 * std::max(u(random), 0.0));
            if constexpr (requires { held_by_all.stiffness; })
                held_by_all.stiffness.set(lane, stiffness * (1 + 0.5 * u(random)));
        }
        const auto answer = yields.respond(all, held_by_all);
        for (int lane = 0; lane < pack_lanes; ++lane) {
            using Memory = typename Law::template Memory<Real>;
            const auto contact = detail::lane_of(all, lane);
            const auto held = detail::memory_of_lane<Memory>(held_by_all, lane);
            const auto alone = yields.respond(contact, held);
            const auto load = detail::lane_of(answer.load, lane);
            const auto memory = detail::memory_of_lane<Memory>(answer.memory, lane);
            const Real push = stiffness * 6e-5 + 10 * speed, energy = push * 6e-5;
            const auto is = [](Real value, Real size) {
                return doctest::Approx(value).scale(size).epsilon(1e-9);
            };
            for (int a = 0; a < 3; ++a) {
                REQUIRE(load.force[a] == is(alone.load.force[a], push));
                REQUIRE(memory.spring[a] == is(alone.memory.spring[a], 1e-6));
            }
            REQUIRE(memory.deepest == alone.memory.deepest);
            REQUIRE(load.stored == is(alone.load.stored, energy));
            REQUIRE(load.lost_normal == is(alone.load.lost_normal, energy));
            REQUIRE(load.lost_tangential == is(alone.load.lost_tangential, energy));
            REQUIRE(std::min(load.lost_normal, load.lost_tangential) >= 0);
            sliding += alone.load.lost_tangential > 0, apart += contact.overlap <= 0;
            dented += alone.memory.deepest > held.deepest;
            again += alone.load.lost_normal > 0 && alone.memory.deepest == held.deepest;
        }
        ContactKinematics<float> narrow{};
        const auto wide = detail::lane_of(all, 0);
        narrow.normal = wide.normal.template cast<float>(),
        narrow.velocity = wide.velocity.template cast<float>();
        narrow.overlap = static_cast<float>(wide.overlap);
        narrow.inverse_mass = 100, narrow.curvature = 200, narrow.time_step = 1e-6;
        const auto in_float = yields.respond(narrow, {}).load;
        const auto in_double = yields.respond(detail::lane_of(all, 0), {}).load;
        REQUIRE(std::abs(static_cast<Real>(in_float.force.dot(narrow.normal)) -
                         in_double.force.dot(wide.normal)) < 1e-4 * stiffness * 6e-5);
    }
    CHECK(sliding > 500);
    CHECK(apart > 200);
    CHECK(dented > 100);
    CHECK(again > 50);
}

}  // namespace

TEST_CASE("laws that yield: a pack answers as its contacts do, and loses nothing negative") {
    lanes_answer_alone(LinearHysteretic{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.5}}, 3e6);
    // Most of these contacts yield, and few.
    for (const Real pressure : {1e6, 3e6})
        lanes_answer_alone(ElasticPlasticHertz{{.youngs = 1e8, .yield_pressure = pressure, .friction = 0.5}},
                           1e5);
}
