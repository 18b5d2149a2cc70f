// The network: who is tied to the ground, what is pruned, and one bonded chain in tension.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/network.hpp>
#include <abrade/wear/wear_law.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real d = 0.02;
const MohrCoulomb law{{.tensile = 2.7e6, .stiffness = 4e8, .damping = 0}};
const auto sound = [](Index) { return 1.0; };

/// A chain of spheres along x, the first of them fixed.
Particles chain(Index count) {
    const Clump ball = make_clump("ball", {{Vec3::Zero(), 0.5 * d}});
    Particles p;
    for (Index n = 0; n < count; ++n) {
        p.add(ball, 2400, {.position = {n * d, 0, 0}}, n == 0 ? Kind::fixed : Kind::concrete);
        p.site.back() = n;
    }
    return p;
}

Network<MohrCoulomb> bonded(const Particles& p) {
    Network<MohrCoulomb> network;
    std::vector<Pair> pairs;
    for (Index n = 0; n + 1 < p.bodies(); ++n) pairs.push_back({n, n + 1});
    network.build(p, pairs);
    return network;
}

void move(Particles& p, std::size_t body, const Vec3& by) {
    p.position[body] += by;
    p.place_spheres(static_cast<Index>(body), p.velocity[body], p.angular_velocity(static_cast<Index>(body)));
}

std::vector<Index> identity(Index n) {
    std::vector<Index> same;
    for (Index i = 0; i < n; ++i) same.push_back(i);
    return same;
}

}  // namespace

TEST_CASE("bonds rest where they were built") {
    const Particles p = chain(4);
    Network<MohrCoulomb> network = bonded(p);
    network.respond(law, NoWear{}, p, sound, 1e-6);
    CHECK(network.pairs().size() == 3);
    CHECK(network.stored() == 0);
    for (const PairLoad& load : network.loads()) CHECK(load.force == Vec3::Zero());
    CHECK(network.holds({1, 2}));
    CHECK(!network.holds({0, 2}));
}

TEST_CASE("a broken link cuts off what hangs on it, and only that") {
    Particles p = chain(5);
    Network<MohrCoulomb> network = bonded(p);
    network.respond(law, NoWear{}, p, sound, 1e-6);
    CHECK(network.tied_to_ground(p) == std::vector<char>{1, 1, 1, 1, 1});
    for (std::size_t b = 3; b < 5; ++b) move(p, b, {1e-4, 0, 0});
    const BondSums sums = network.respond(law, NoWear{}, p, sound, 1e-6);
    CHECK(sums.broken_tension == 1);
    CHECK(sums.broken_shear == 0);
    CHECK(sums.lost_bond == doctest::Approx(0.5 * 4e8 * 1e-8));
    CHECK(network.broken(2));
    CHECK(network.tied_to_ground(p) == std::vector<char>{1, 1, 1, 0, 0});
}

TEST_CASE("a way around keeps a body tied") {
    Particles p = chain(4);
    Network<MohrCoulomb> network;
    network.build(p, {{0, 1}, {1, 2}, {2, 3}, {0, 3}});  // a ring
    move(p, 2, {0, 1e-4, 0});  // breaks 1-2 and 2-3 in shear or tension; 3 hangs on 0
    network.respond(law, NoWear{}, p, sound, 1e-6);
    const auto tied = network.tied_to_ground(p);
    CHECK(tied[1] == 1);
    CHECK(tied[3] == 1);
}

TEST_CASE(
    "pruning drops open broken bonds with a loose end, keeps the others, renumbers, and hands back energy") {
    Particles p = chain(5);
    Network<MohrCoulomb> network = bonded(p);
    for (std::size_t b = 3; b < 5; ++b) move(p, b, {1e-4, 0, 0});
    network.respond(law, NoWear{}, p, sound, 1e-6);
    // Both ends standing: a broken bond stays as a contact.
    CHECK(network.prune(p, identity(5)) == 0);
    CHECK(network.pairs().size() == 4);
    // One end loose: dropped, so that ordinary contacts may take over.
    p.kind[3] = p.kind[4] = Kind::grain;
    CHECK(network.prune(p, identity(5)) == 0);
    CHECK(network.pairs() == std::vector<Pair>{{0, 1}, {1, 2}, {3, 4}});
    CHECK(!network.holds({2, 3}));
    // A loose end but closed: stays, its overlap is against its own rest length.
    move(p, 4, {-1e-6, 0, 0});
    network.respond(law, NoWear{}, p, sound, 1e-6);
    const Real held = network.stored();
    CHECK(held > 0);
    CHECK(network.prune(p, identity(5)) == 0);
    CHECK(network.pairs().size() == 3);
    // A body that leaves takes its bond's energy along; the rest is renumbered.
    const auto moved = p.remove({0, 0, 0, 0, 1});
    CHECK(network.prune(p, moved) == held);
    CHECK(network.pairs() == std::vector<Pair>{{0, 1}, {1, 2}});
    const auto again = p.remove({0, 0, 0, 1});
    CHECK(network.prune(p, again) == 0);
    CHECK(network.respond(law, NoWear{}, p, sound, 1e-6).broken_tension == 0);
}

TEST_CASE("memory of bonds survives renumbering") {
    const auto sheared = [](bool remove_first) {
        const Clump ball = make_clump("ball", {{Vec3::Zero(), 0.5 * d}});
        Particles p;
        p.add(ball, 2650, {.position = {9, 9, 9}}, Kind::stone);
        for (Index n = 0; n < 3; ++n)
            p.add(ball, 2400, {.position = {n * d, 0, 0}, .velocity = {0, 0.01 * n, 0}},
                  n == 0 ? Kind::fixed : Kind::concrete);
        Network<MohrCoulomb> network;
        network.build(p, {{1, 2}, {2, 3}});
        for (int n = 0; n < 5; ++n) network.respond(law, NoWear{}, p, sound, 1e-6);
        if (remove_first) {
            const auto moved = p.remove({1, 0, 0, 0});
            network.prune(p, moved);
        }
        network.respond(law, NoWear{}, p, sound, 1e-6);
        return network.loads()[1].force;
    };
    CHECK(sheared(true).y() != 0);
    CHECK(sheared(true) == sheared(false));
}

TEST_CASE("the weaker of two spheres weakens the bond") {
    Particles p = chain(3);
    const Real stretch = 0.8 * law.capacity(0.5 * d) / 4e8;  // 80 % of what a sound bond holds
    move(p, 1, {stretch, 0, 0});
    move(p, 2, {2 * stretch, 0, 0});
    const auto broken = [&](Real left_of_last) {
        Network<MohrCoulomb> network;
        Particles rest = chain(3);
        network.build(rest, {{0, 1}, {1, 2}});
        const BondSums sums = network.respond(
            law, NoWear{}, p, [&](Index body) { return body == 2 ? left_of_last : 1.0; }, 1e-6);
        CHECK(!network.broken(0));
        return sums.broken_tension;
    };
    CHECK(broken(1) == 0);
    CHECK(broken(0.7) == 0);  // mean 0.85
    CHECK(broken(0.5) == 1);  // mean 0.75
}
