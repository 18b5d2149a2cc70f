// The network: who is tied to the ground, what is pruned, and one bonded chain in tension.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/network.hpp>
#include <abrade/dem/contacts/contact_observer.hpp>

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

std::vector<Index> identity(Index n) {
    std::vector<Index> same;
    for (Index i = 0; i < n; ++i) same.push_back(i);
    return same;
}

/// Bodies in their slots and the bonds between them.
struct Rig {
    Particles p;
    SphereStore store{};
    Network<MohrCoulomb> network{};

    explicit Rig(Particles from, std::vector<BondedPair> pairs = {}) : p(std::move(from)) {
        if (pairs.empty())
            for (Index n = 0; n + 1 < p.bodies(); ++n) pairs.push_back({n, n + 1});
        network.build(p, pairs);
        arrange({});
    }
    void arrange(const std::vector<Index>& moved) {
        store.arrange(p, moved, 0, {});
        network.arrange(store);
        network.pack(store.phantom(), [&](const auto& bond, Index) {
            return SlotPair{store.slot_of(bond.spheres.first), store.slot_of(bond.spheres.second)};
        });
    }
    void move(Index body, const Vec3& by) {
        store.lines.place[static_cast<std::size_t>(store.slot_of(body))].centre += by;
        p.centre[static_cast<std::size_t>(body)] += by;
    }
    template <class StrengthLeft>
    BondSums respond(const StrengthLeft& left) {
        for (SphereLoad& load : store.lines.load) load.force.setZero(), load.torque_over_radius.setZero();
        BondSums sums;
        for (Index slab = 0; slab < store.slabs.count(); ++slab)
            sums += network.respond(slab, law, NoObserver{}, store.lines, left, {1e-6, 0});
        return sums;
    }
    BondSums respond() { return respond(sound); }
    Real prune(const std::vector<Index>& moved) { return network.prune(p, moved, p.centre); }
    Vec3 force(Index body) const {
        return store.lines.load[static_cast<std::size_t>(store.slot_of(body))].force;
    }
    std::vector<BondedPair> pairs() const {
        std::vector<BondedPair> all;
        network.each_bond([&](const auto& bond) { all.push_back(bond.spheres); });
        std::sort(all.begin(), all.end());
        return all;
    }
    bool broken(const BondedPair& pair) const {
        for (const auto& bond : network.bonds())
            if (bond.spheres == pair) return bond.broken();
        FAIL("no such bond");
        return false;
    }
};

}  // namespace

TEST_CASE("bonds rest where they were built") {
    Rig rig(chain(4));
    CHECK(rig.respond().stored == 0);
    CHECK(rig.pairs().size() == 3);
    for (Index b = 0; b < 4; ++b) CHECK(rig.force(b) == Vec3::Zero());
    CHECK(rig.network.holds({1, 2}));
    CHECK(!rig.network.holds({0, 2}));
}

TEST_CASE("a broken link cuts off what hangs on it, and only that") {
    Rig rig(chain(5));
    rig.respond();
    CHECK(rig.network.take_loose().empty());
    for (Index b = 3; b < 5; ++b) rig.move(b, {1e-4, 0, 0});
    const BondSums sums = rig.respond();
    CHECK(sums.broken_tension == 1);
    CHECK(sums.broken_shear == 0);
    CHECK(sums.lost_bond == doctest::Approx(0.5 * 4e8 * 1e-8));
    CHECK(rig.broken({2, 3}));
    CHECK(rig.network.take_loose() == std::vector<BondGraph::Component>{{3, 4}});
    CHECK(rig.network.take_loose().empty());  // told once
}

TEST_CASE("a way around keeps a body tied") {
    Rig rig(chain(4), {{0, 1}, {1, 2}, {2, 3}, {0, 3}});  // a ring
    rig.move(2, {0, 1e-3, 0});                            // breaks 1-2 and 2-3; 3 hangs on 0
    rig.respond();
    CHECK(rig.broken({1, 2}));
    CHECK(rig.broken({2, 3}));
    CHECK(rig.network.take_loose() == std::vector<BondGraph::Component>{{2}});
}

TEST_CASE(
    "pruning drops open broken bonds with a loose end, keeps the others, renumbers, and hands back energy") {
    Rig rig(chain(5));
    for (Index b = 3; b < 5; ++b) rig.move(b, {1e-4, 0, 0});
    rig.respond();
    // Both ends standing: a broken bond stays as a contact.
    CHECK(rig.prune(identity(5)) == 0);
    CHECK(rig.pairs().size() == 4);
    // One end loose: dropped, so that ordinary contacts may take over.
    rig.p.kind[3] = rig.p.kind[4] = Kind::grain;
    CHECK(rig.prune(identity(5)) == 0);
    CHECK(rig.pairs() == std::vector<BondedPair>{{0, 1}, {1, 2}, {3, 4}});
    // A loose end but closed: stays, its overlap is against its own rest length.
    rig.arrange(identity(5));
    CHECK(!rig.network.holds({2, 3}));
    rig.move(4, {-1e-6, 0, 0});
    const Real held = rig.respond().stored;
    CHECK(held > 0);
    CHECK(rig.prune(identity(5)) == 0);
    CHECK(rig.pairs().size() == 3);
    // A body that leaves takes its bond's energy along; the rest is renumbered.
    auto moved = rig.p.remove({0, 0, 0, 0, 1});
    CHECK(rig.prune(moved) == held);
    CHECK(rig.pairs() == std::vector<BondedPair>{{0, 1}, {1, 2}});
    rig.arrange(moved);
    moved = rig.p.remove({0, 0, 0, 1});
    CHECK(rig.prune(moved) == 0);
    rig.arrange(moved);
    CHECK(rig.respond().broken_tension == 0);
}

TEST_CASE("memory of bonds survives renumbering") {
    const auto sheared = [](bool remove_first) {
        const Clump ball = make_clump("ball", {{Vec3::Zero(), 0.5 * d}});
        Particles p;
        p.add(ball, 2650, {.position = {9, 9, 9}}, Kind::stone);
        for (Index n = 0; n < 3; ++n)
            p.add(ball, 2400, {.position = {n * d, 0, 0}, .velocity = {0, 0.01 * n, 0}},
                  n == 0 ? Kind::fixed : Kind::concrete);
        Rig rig(p, {{1, 2}, {2, 3}});
        for (int n = 0; n < 5; ++n) rig.respond();
        if (remove_first) {
            const auto moved = rig.p.remove({1, 0, 0, 0});
            rig.prune(moved);
            rig.arrange(moved);
        }
        rig.respond();
        return rig.force(remove_first ? 2 : 3);
    };
    CHECK(sheared(true).y() != 0);
    CHECK(sheared(true) == sheared(false));
}

TEST_CASE("the weaker of two spheres weakens the bond") {
    const Real stretch = 0.8 * law.capacity(0.5 * d) / 4e8;  // 80 % of what a sound bond holds
    const auto broken = [&](Real left_of_last) {
        Rig rig(chain(3));
        rig.move(1, {stretch, 0, 0});
        rig.move(2, {2 * stretch, 0, 0});
        const BondSums sums = rig.respond([&](Index body) { return body == 2 ? left_of_last : 1.0; });
        CHECK(!rig.broken({0, 1}));
        return sums.broken_tension;
    };
    CHECK(broken(1) == 0);
    CHECK(broken(0.7) == 0);  // mean 0.85
    CHECK(broken(0.5) == 1);  // mean 0.75
}
