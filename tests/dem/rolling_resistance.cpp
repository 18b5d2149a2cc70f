// Resistance to rolling: one contact at a time.
#include <abrade/dem/contacts/contact_list.hpp>
#include <abrade/dem/contacts/contact_observer.hpp>
#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/laws/rolling_resistance.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

using Linear = RollingResistance<LinearSpring>;
using Hertz = RollingResistance<HertzMindlin>;

static_assert(ContactLaw<Linear> && ContactLaw<Hertz>);
static_assert(ResistsRolling<Linear> && !ResistsRolling<LinearSpring>);
static_assert(AnswersPacks<Linear> && AnswersPacks<Hertz>);
// What resists no rolling keeps nothing for it.
static_assert(sizeof(SeenMotion<LinearSpring, Real>) == sizeof(Vec3));
static_assert(sizeof(SeenMotion<Linear, Real>) == 2 * sizeof(Vec3));

namespace {

Linear linear(Real friction = 0.3, Linear::Model model = Linear::Model::elastic_plastic, Real damping = 0.3) {
    return Linear{{.contact = {.stiffness = 1e6, .restitution = 0.6, .friction = 0.5},
                   .friction = friction,
                   .damping = damping,
                   .model = model}};
}
Hertz hertz() {
    return Hertz{{.contact = {.youngs = 1e8, .restitution = 0.6, .friction = 0.5}, .friction = 0.3}};
}

/// A contact under `overlap` [m] that rolls about x; effective radius 1/200 m, k_r = 2.25 k_n (mu_r/200)^2.
ContactKinematics<Real> rolling_at(Real overlap, Real spin, Real dt = 1e-6) {
    ContactKinematics<Real> contact{Vec3(0, 0, 1), overlap, Vec3::Zero(), 100, 200, dt};
    contact.spin = Vec3(spin, 0, 0);
    contact.rotation = dt * contact.spin;
    contact.inverse_turning = 1e6;
    return contact;
}
constexpr Real stiffness = 2.25 * 1e6 * 0.3 / 200 * 0.3 / 200;  // k_r of `linear()` [N m]

}  // namespace

TEST_CASE("the spring holds k_r theta up to mu_r R f_n, along what rolls, and slips beyond") {
    const Linear law = linear(0.3, Linear::Model::elastic_plastic, 0);
    Linear::Memory<Real> memory{};
    const Real limit = 0.3 / 200 * 1e6 * 1e-4, dt = 1e-6, spin = 5;
    Real theta = 0, lost = 0;
    for (int n = 0; n < 20'000; ++n) {
        const auto [load, next] = law.respond(rolling_at(1e-4, spin, dt), memory);
        theta += spin * dt;
        lost += load.lost_rolling;
        memory = next;
        REQUIRE(load.couple.x() ==
                doctest::Approx(-std::min(stiffness * theta, limit)).epsilon(1e-9).scale(0));
        REQUIRE(load.couple.tail<2>().norm() == 0);
    }
    CHECK(stiffness * theta > 2 * limit);
    // It yields at theta_m = delta / (2.25 mu_r R), and loses the limit times the rest of the way.
    const Real yields = 1e-4 / (2.25 * 0.3 / 200);
    CHECK(limit / stiffness == doctest::Approx(yields).scale(0));
    CHECK(lost / (limit * (theta - yields)) == doctest::Approx(1).epsilon(1e-6).scale(0));
}

TEST_CASE("spin about the normal is not resisted; nor is anything when the spheres are apart") {
    const Linear law = linear();
    ContactKinematics<Real> drilling = rolling_at(1e-4, 0);
    drilling.spin = Vec3(0, 0, 50), drilling.rotation = 1e-6 * drilling.spin;
    CHECK(law.respond(drilling, Linear::Memory<Real>{}).load.couple.norm() == 0);

    const auto held = law.respond(rolling_at(1e-4, 5), Linear::Memory<Real>{});
    CHECK(held.load.couple.norm() > 0);
    const auto apart = law.respond(rolling_at(-1e-9, 5), held.memory);
    CHECK(apart.load.couple.norm() == 0);
    CHECK(apart.load.stored == 0);
    CHECK(apart.memory.rotation.norm() == 0);
    CHECK(apart.memory.stiffness == 0);
    // What the spring held is lost, once.
    CHECK(apart.load.lost_rolling / (0.5 * stiffness * held.memory.rotation.squaredNorm()) ==
          doctest::Approx(1).epsilon(1e-12).scale(0));
    CHECK(law.respond(rolling_at(-1e-9, 5), apart.memory).load.lost_rolling == 0);
}

TEST_CASE("the force is that of the law alone, bit for bit") {
    std::mt19937 random(3);
    std::uniform_real_distribution<Real> u(-1, 1);
    const auto anything = [&] { return Vec3(u(random), u(random), u(random)); };
    const LinearSpring alone{linear().params().contact};
    for (int n = 0; n < 1000; ++n) {
        ContactKinematics<Real> contact{anything().normalized(), 1e-4 * u(random), anything(), 100, 200, 1e-6,
                                        1e-6 * anything()};
        contact.spin = 30 * anything(), contact.rotation = 1e-6 * contact.spin, contact.inverse_turning = 1e6;
        const Vec3 held = 1e-6 * anything();
        const auto with =
            linear().respond(contact, Linear::Memory<Real>{{held}, 1e-3 * anything(), stiffness});
        const auto without = alone.respond(contact, LinearSpring::Memory<Real>{held});
        REQUIRE(with.load.force == without.load.force);
        REQUIRE(with.load.lost_tangential == without.load.lost_tangential);
        REQUIRE(with.memory.contact.spring == without.memory.spring);
    }
}

TEST_CASE_TEMPLATE("a pack answers as its contacts do; limit and losses hold for whatever comes", Law, Linear,
                   Hertz) {
    std::mt19937 random(7);
    std::uniform_real_distribution<Real> u(-1, 1);
    const auto anything = [&] { return Vec3(u(random), u(random), u(random)); };
    const Law law = [] {
        if constexpr (std::same_as<Law, Linear>)
            return linear();
        else
            return hertz();
    }();
    const Law constant = [&] {
        typename Law::Params params = law.params();
        params.model = Law::Model::constant_torque;
        return Law{params};
    }();
    int slipping = 0, holding = 0, apart = 0;
    for (int n = 0; n < 2000; ++n) {
        const Law& chosen = n % 3 ? law : constant;
        std::vector<ContactKinematics<Real>> one;
        std::vector<typename Law::template Memory<Real>> held;
        ContactKinematics<Pack> all{};
        typename Law::template Memory<Pack> held_by_all{};
        all.time_step = 1e-6;
        const Real speed = n % 2 ? 1 : 1e-3;
        for (int lane = 0; lane < pack_lanes; ++lane) {
            ContactKinematics<Real>& c = one.emplace_back();
            c = {anything().normalized(),
                 n % 2 ? 5e-5 * u(random) * u(random) : 5e-5,
                 speed * anything(),
                 100,
                 200,
                 1e-6,
                 speed * 1e-6 * anything()};
            c.spin = 100 * speed * anything(), c.rotation = 1e-6 * c.spin;
            c.inverse_turning = 1e6 * (1.5 + u(random));
            auto& m = held.emplace_back();
            m.rotation = 1e-3 * speed * anything();
            m.stiffness = std::same_as<Law, Linear> ? stiffness : stiffness * (1 + 0.5 * u(random));
            for (int a = 0; a < 3; ++a) {
                all.normal[a].set(lane, c.normal[a]), all.velocity[a].set(lane, c.velocity[a]);
                all.displacement[a].set(lane, c.displacement[a]), all.spin[a].set(lane, c.spin[a]);
                all.rotation[a].set(lane, c.rotation[a]);
            }
            all.overlap.set(lane, c.overlap), all.inverse_mass.set(lane, 100), all.curvature.set(lane, 200);
            all.inverse_turning.set(lane, c.inverse_turning);
            detail::set_memory_of_lane(held_by_all, lane, m);
        }
        const auto answer = chosen.respond(all, held_by_all);
        for (int lane = 0; lane < pack_lanes; ++lane) {
            const auto k = static_cast<std::size_t>(lane);
            const auto alone = chosen.respond(one[k], held[k]);
            const auto memory =
                detail::memory_of_lane<typename Law::template Memory<Real>>(answer.memory, lane);
            // rsqrt and reciprocal are good to 2 units in the last place; a root of a difference loses half.
            const Real couple = stiffness * 1e-3 * speed + 0.1 * speed, energy = couple * 1e-3;
            for (int a = 0; a < 3; ++a) {
                REQUIRE(answer.load.couple[a][lane] ==
                        doctest::Approx(alone.load.couple[a]).scale(couple).epsilon(1e-9));
                REQUIRE(memory.rotation[a] ==
                        doctest::Approx(alone.memory.rotation[a]).scale(1e-3).epsilon(1e-9));
            }
            REQUIRE(memory.stiffness == doctest::Approx(alone.memory.stiffness).epsilon(1e-9));
            REQUIRE(answer.load.stored[lane] ==
                    doctest::Approx(alone.load.stored).scale(energy).epsilon(1e-9));
            REQUIRE(answer.load.lost_rolling[lane] ==
                    doctest::Approx(alone.load.lost_rolling).scale(energy).epsilon(1e-9));

            const Real limit = 0.3 / 200 * std::max(alone.load.force.dot(one[k].normal), 0.0);
            REQUIRE(alone.load.couple.norm() <= limit * (1 + 1e-9));
            REQUIRE(std::abs(alone.load.couple.dot(one[k].normal)) <= 1e-9 * limit);
            REQUIRE(alone.load.lost_rolling >= 0);
            REQUIRE(answer.load.lost_rolling[lane] >= 0);
            apart += one[k].overlap <= 0;
            (alone.load.couple.norm() > (1 - 1e-9) * limit ? slipping : holding) += one[k].overlap > 0;
        }
    }
    CHECK(slipping > 500);
    CHECK(holding > 500);
    CHECK(apart > 500);
}

TEST_CASE_TEMPLATE(
    "each step accounts for its energy, to second order, while the contact stiffens and softens", Law, Linear,
    Hertz) {
    // A prescribed path, as in dem.linear_spring: press, roll, release.
    const auto mismatch = [](Real friction, int steps) {
        typename Law::Params params;
        if constexpr (std::same_as<Law, Linear>)
            params.contact = {.stiffness = 1e6};
        else
            params.contact = {.youngs = 1e8};
        params.friction = friction;
        const Law law(params);
        const Real period = 1e-3, dt = period / steps;
        const auto spin = [&](Real t) {
            return 20 * std::sin(pi * t / period) * std::cos(2.3 * pi * t / period);
        };
        typename Law::template Memory<Real> memory{};
        Real work = 0, lost = 0;
        for (int n = 0; n <= steps; ++n) {
            const Real t = n * dt, overlap = 1e-4 * square(std::sin(pi * t / period)) + 1e-12;
            ContactKinematics<Real> contact = rolling_at(overlap, spin(t), dt);
            contact.velocity.z() = -1e-4 * pi / period * std::sin(2 * pi * t / period);
            contact.rotation = Vec3(dt * spin(t - 0.5 * dt), 0, 0);
            const auto [load, next] = law.respond(contact, memory);
            work -= load.couple.x() * spin(t) * dt;
            lost += load.lost_rolling;
            memory = next;
        }
        return std::abs(work - lost - 0.5 * memory.stiffness * memory.rotation.squaredNorm()) /
               std::abs(work);
    };
    for (const Real friction : {0.05, 0.5}) {
        const Real coarse = mismatch(friction, 200), fine = mismatch(friction, 800);
        CAPTURE(friction);
        CHECK(fine < 2e-3);
        CHECK(coarse / fine > 8);  // 16 at second order; slipping begins within a step
    }
}

TEST_CASE("unequal spheres feel opposite torques, not opposite levers") {
    Particles p;
    p.add(make_clump("small", {{Vec3::Zero(), 0.01}}), 2650,
          {.position = {0, 0, 0}, .angular_velocity = {0, 0, 40}}, Kind::stone);
    p.add(make_clump("large", {{Vec3::Zero(), 0.03}}), 2650,
          {.position = {0.0399, 0, 0}, .angular_velocity = {0, 10, 0}}, Kind::stone);
    SphereStore store;
    ContactList<Linear> contacts;
    const std::vector<Index> nothing;
    const std::vector<SearchRole> role(2, SearchRole::all);
    store.arrange(p, nothing, 0.002, {});
    contacts.rebuild(store, {p, {}, role, {}, {}, 0.002}, {}, [](Index, Index) { return false; });
    contacts.refine(store.lines, {}, 0.002);
    // Without friction what is left of the levers is the couple.
    const Linear law{{.contact = {.stiffness = 1e6}, .friction = 0.3}};
    ContactSums sums;
    for (Index slab = 0; slab < store.slabs.count(); ++slab)
        sums += contacts.section(slab).respond(law, NoObserver{}, {}, store.lines, {1e-5, 0.5});
    const auto torque_over_radius = [&](Index sphere) {
        return store.lines.load[static_cast<std::size_t>(store.slot_of(sphere))].torque_over_radius;
    };
    const Vec3 torque = 0.01 * torque_over_radius(0);
    CHECK((torque + 0.03 * torque_over_radius(1)).norm() < 1e-15);
    const auto alone = law.respond(
        contact_between(store.lines, {}, {store.slot_of(0), store.slot_of(1)}, 1e-5), Linear::Memory<Real>{});
    CHECK((torque - alone.load.couple).norm() < 1e-12 * torque.norm());
    CHECK(torque.normalized().dot(Vec3(0, 10, -40).normalized()) ==
          doctest::Approx(1).epsilon(1e-9).scale(0));
    CHECK(sums.lost_rolling / alone.load.lost_rolling == doctest::Approx(1).epsilon(1e-9).scale(0));
}

TEST_CASE("the stable step falls with the rolling spring, and is the law's own without it") {
    const LinearSpring alone{linear().params().contact};
    CHECK(linear(0).stable_dt(0.1, 0.01) == alone.stable_dt(0.1, 0.01));
    CHECK(linear(0.3, Linear::Model::constant_torque).stable_dt(0.1, 0.01) == alone.stable_dt(0.1, 0.01));
    CHECK(linear(1).stable_dt(0.1, 0.01) < 0.6 * alone.stable_dt(0.1, 0.01));
    CHECK(linear(1).rigidity(0.01).rolling == doctest::Approx(2.25e6));
}

TEST_CASE("parameters that make no sense are refused; the law says what it is") {
    for (const Real bad : {-0.1, std::numeric_limits<Real>::quiet_NaN()}) {
        CHECK_THROWS_AS(linear(bad), InputError);
        CHECK_THROWS_AS(linear(0.3, Linear::Model::elastic_plastic, bad), InputError);
    }
    CHECK_THROWS_WITH_AS(
        (Linear{{.contact = {.stiffness = 1e6}, .friction = 0.1, .stiffness_factor = 0}}),
        "RollingResistance.stiffness_factor must be finite and > 0, got 0; 2.25 for spheres, 3 for discs",
        InputError);
    CHECK_THROWS_AS((Linear{{.friction = 0.1}}), InputError);  // the contact's own parameters count
    CHECK(describe(linear()) ==
          "RollingResistance(stiffness = 1e+06 N/m, restitution = 0.6, friction = 0.5, tangential_ratio = "
          "0.2857142857142857, damping_mass_free = 0, rolling_friction = 0.3, rolling_damping = 0.3, "
          "rolling_stiffness_factor = "
          "2.25, rolling_constant_torque = 0)");
}
