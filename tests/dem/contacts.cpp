// Pairs, their memory over renewals of the list, and the loads on spheres.
#include <abrade/dem/contacts.hpp>
#include <abrade/dem/linear_spring.hpp>
#include <abrade/wear/wear_law.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e6, .restitution = 0.8, .friction = 0.4}};
const std::vector<Plane> no_walls;

/// Three spheres in a row that touch and slip over each other, the first of them far away.
Particles row() {
    const Clump ball = make_clump("ball", {{Vec3::Zero(), 0.01}});
    Particles p;
    p.add(ball, 2650, {.position = {5, 0, 0}}, Kind::stone);
    p.add(ball, 2650, {.position = {0, 0, 0}, .velocity = {0, 0.02, 0}}, Kind::stone);
    p.add(ball, 2650,
          {.position = {0.0199, 0, 0}, .velocity = {0, -0.02, 0.01}, .angular_velocity = {0, 0, 3}},
          Kind::stone);
    return p;
}

std::vector<Index> identity(Index n) {
    std::vector<Index> same(static_cast<std::size_t>(n));
    for (Index i = 0; i < n; ++i) same[static_cast<std::size_t>(i)] = i;
    return same;
}

}  // namespace

TEST_CASE("memory survives renewal of the list, with spheres renumbered") {
    Particles p = row(), q = row();
    Contacts<LinearSpring> kept, renewed;
    kept.rebuild({{1, 2}}, 3, {});
    renewed.rebuild({{1, 2}}, 3, {});
    for (int step = 0; step < 5; ++step)
        kept.respond(law, NoWear{}, p, no_walls, 1e-5), renewed.respond(law, NoWear{}, q, no_walls, 1e-5);
    REQUIRE(kept.loads()[0].active);
    REQUIRE(std::abs(kept.loads()[0].force.y()) > 0.01);

    const auto moved = q.remove({1, 0, 0});
    CHECK(renewed.rebuild({{0, 1}}, 2, moved) == 0);
    CHECK(renewed.loads()[0].force == kept.loads()[0].force);  // the first half kick after a renewal uses it
    CHECK(renewed.stored() == kept.stored());
    kept.respond(law, NoWear{}, p, no_walls, 1e-5);
    renewed.respond(law, NoWear{}, q, no_walls, 1e-5);
    CHECK(renewed.loads()[0].force == kept.loads()[0].force);
    CHECK(renewed.loads()[0].stored == kept.loads()[0].stored);

    // The twin that forgets answers differently, so the test can fail.
    Contacts<LinearSpring> forgets;
    forgets.rebuild({{0, 1}}, 2, {});
    forgets.respond(law, NoWear{}, q, no_walls, 1e-5);
    CHECK(forgets.loads()[0].force != kept.loads()[0].force);
}

TEST_CASE("the energy of a pair that goes with its body is handed back") {
    Particles p = row();
    Contacts<LinearSpring> contacts;
    contacts.rebuild({{0, 2}, {1, 2}}, 3, {});
    contacts.respond(law, NoWear{}, p, no_walls, 1e-5);
    const Real stored = contacts.stored();
    REQUIRE(stored > 0);
    const auto moved = p.remove({0, 1, 0});
    CHECK(contacts.rebuild({}, 2, moved) == stored);
    CHECK(contacts.stored() == 0);
}

TEST_CASE("memory goes to the right pair among many, and walls keep theirs") {
    const Clump ball = make_clump("ball", {{Vec3::Zero(), 0.01}});
    const std::vector<Plane> floor{{{0, 0, 0}, {0, 0, 1}}};
    Particles p;
    for (int n = 0; n < 6; ++n)
        p.add(ball, 2650, {.position = {0.0199 * n, 0, 0.0099}, .velocity = {0, 0.01 * (n + 1), 0}},
              Kind::stone);
    std::vector<Pair> pairs;
    for (Index n = 0; n < 6; ++n) {
        pairs.push_back({n, -1});
        if (n < 5) pairs.push_back({n, n + 1});
    }
    std::sort(pairs.begin(), pairs.end());
    Contacts<LinearSpring> contacts;
    contacts.rebuild(pairs, 6, {});
    for (int step = 0; step < 3; ++step) contacts.respond(law, NoWear{}, p, floor, 1e-5);
    const auto before = contacts.loads();
    const auto moved = p.remove({0, 0, 1, 0, 0, 0});
    std::vector<Pair> fewer;
    std::vector<Vec3> expected;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const Index first = moved[static_cast<std::size_t>(pairs[k].first)];
        const Index second =
            pairs[k].second < 0 ? pairs[k].second : moved[static_cast<std::size_t>(pairs[k].second)];
        if (first < 0 || (pairs[k].second >= 0 && second < 0)) continue;
        fewer.push_back({first, second});
        expected.push_back(before[k].force);
    }
    fewer.insert(std::lower_bound(fewer.begin(), fewer.end(), Pair{0, 4}),
                 Pair{0, 4});  // and one that is only near
    contacts.rebuild(fewer, 5, moved);
    std::size_t k = 0;
    for (std::size_t n = 0; n < fewer.size(); ++n) {
        if (fewer[n] == Pair{0, 4})
            CHECK(!contacts.loads()[n].active);
        else
            CHECK(contacts.loads()[n].force == expected[k++]);
    }
}

TEST_CASE("both sides feel opposite forces and torques that conserve angular momentum") {
    Particles p = row();
    Contacts<LinearSpring> contacts;
    contacts.rebuild({{1, 2}}, 3, {});
    contacts.respond(law, NoWear{}, p, no_walls, 1e-5);
    const PairLoad& load = contacts.loads()[0];
    // About the origin: x1 x f + x2 x (-f) + (arm1 + arm2) f x n = 0.
    const Vec3 about = p.position[1].cross(load.force) - p.position[2].cross(load.force) +
                       (load.arm_first + load.arm_second) * load.twist;
    CHECK(about.norm() < 1e-15 * load.force.norm());
    CHECK(load.force.x() < 0);  // the second stands at +x and pushes the first to -x
    const auto sides = contacts.incidence().of(2);
    REQUIRE(sides.size() == 1);
    CHECK(!sides[0].first);
    CHECK(contacts.incidence().of(0).empty());
    CHECK(contacts.incidence().of(99).empty());
}

TEST_CASE("a contact that opens books what its spring held, once") {
    Particles p = row();
    Contacts<LinearSpring> contacts;
    contacts.rebuild({{1, 2}}, 3, {});
    for (int step = 0; step < 5; ++step) contacts.respond(law, NoWear{}, p, no_walls, 1e-5);
    p.position[2].x() = 0.03;
    p.place_spheres(2, p.velocity[2], p.angular_velocity(2));
    CHECK(contacts.respond(law, NoWear{}, p, no_walls, 1e-5).lost_tangential > 0);
    CHECK(contacts.loads()[0].stored == 0);
    CHECK(!contacts.loads()[0].active);
    const ContactSums none = contacts.respond(law, NoWear{}, p, no_walls, 1e-5);
    CHECK(none.lost_tangential == 0);
    CHECK(none.deepest_pair == -1);
}

TEST_CASE("the deepest overlap is found, a NaN before all") {
    ContactSums sums;
    sums += {0, 0, 0, 0, 0.1, 4};
    sums += {0, 0, 0, 0, 0.3, 7};
    sums += {0, 0, 0, 0, 0.2, 8};
    CHECK(sums.deepest_pair == 7);
    sums += {0, 0, 0, 0, std::numeric_limits<Real>::quiet_NaN(), 9};
    sums += {0, 0, 0, 0, 0.5, 10};
    CHECK(sums.deepest_pair == 9);
}

TEST_CASE("concrete counts its losses once for each concrete side") {
    Particles p = row();
    Contacts<LinearSpring> contacts;
    contacts.rebuild({{1, 2}}, 3, identity(3));
    p.velocity[1].x() = 1;
    p.place_spheres(1, p.velocity[1], p.angular_velocity(1));
    ContactSums sums = contacts.respond(law, NoWear{}, p, no_walls, 1e-5);
    CHECK(sums.lost_normal > 0);
    CHECK(sums.concrete_lost_normal == 0);
    p.site[1] = 0;
    sums = contacts.respond(law, NoWear{}, p, no_walls, 1e-5);
    CHECK(sums.concrete_lost_normal == sums.lost_normal);
    p.site[2] = 1;
    sums = contacts.respond(law, NoWear{}, p, no_walls, 1e-5);
    CHECK(sums.concrete_lost_normal == 2 * sums.lost_normal);
    CHECK(sums.concrete_lost_tangential == 2 * sums.lost_tangential);
}
