// Pairs in slots, their memory over renewals of the list, and the loads on spheres.
#include <abrade/dem/contacts/contact_list.hpp>
#include <abrade/dem/contacts/contact_observer.hpp>
#include <abrade/dem/laws/linear_spring.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e6, .restitution = 0.8, .friction = 0.4}};

std::vector<Index> identity(Index n) {
    std::vector<Index> same(static_cast<std::size_t>(n));
    for (Index i = 0; i < n; ++i) same[static_cast<std::size_t>(i)] = i;
    return same;
}

/// Bodies and their contacts, without anything that moves them.
struct Rig {
    Particles p;
    std::vector<Plane> walls{};
    Vec3 period = Vec3::Zero();
    SphereStore store{};
    ContactList<LinearSpring> contacts{};
    std::vector<BodyMark> marks{};
    Real went = 0;  ///< elastic energy of pairs that went with a body [J]

    /// Renews lists after `gone` [body] left; the moved places of the rest are those of the lines.
    void list(std::vector<char> gone = {}) {
        std::vector<Index> moved = identity(store.spheres());
        Particles rest = p;
        if (!gone.empty()) moved = rest.remove(gone);
        went += contacts.keep(law, store, walls, moved);
        p = rest;
        store.arrange(p, moved, 0.002, {Vec3::Zero(), period});
        const std::vector<SearchRole> role(static_cast<std::size_t>(p.spheres()), SearchRole::all);
        contacts.rebuild(store, {p, walls, role, marks, {}, 0.002, period}, {},
                         [](Index, Index) { return false; });
        contacts.refine(store.lines, walls, 0.002);
    }
    template <ContactObserver Observer = NoObserver>
    ContactSums respond(Real dt = 1e-5, const Observer& observer = {}) {
        for (SphereLoad& load : store.lines.load) load.force.setZero(), load.torque_over_radius.setZero();
        ContactSums sums;
        for (Index slab = 0; slab < store.slabs.count(); ++slab)
            sums += contacts.section(slab).respond(law, observer, walls, store.lines, {dt, 0.5});
        for (Index slab = 0; slab < store.slabs.count(); ++slab)
            for (const SphereImage& image : store.images_of(slab)) store.collect(image);
        return sums;
    }
    SphereLoad& load(Index sphere) {
        return store.lines.load[static_cast<std::size_t>(store.slot_of(sphere))];
    }
    SpherePlace& place(Index sphere) {
        return store.lines.place[static_cast<std::size_t>(store.slot_of(sphere))];
    }
};

/// Three spheres in a row: the last two touch and slip over each other, the first is far away.
Rig row() {
    const Clump ball = make_clump("ball", {{Vec3::Zero(), 0.01}});
    Rig rig;
    rig.p.add(ball, 2650, {.position = {5, 0, 0}}, Kind::stone);
    rig.p.add(ball, 2650, {.position = {0, 0, 0}, .velocity = {0, 0.02, 0}}, Kind::stone);
    rig.p.add(ball, 2650,
              {.position = {0.0199, 0, 0}, .velocity = {0, -0.02, 0.01}, .angular_velocity = {0, 0, 3}},
              Kind::stone);
    rig.list();
    return rig;
}

}  // namespace

TEST_CASE("memory survives renewal of the list, with spheres renumbered") {
    Rig kept = row(), renewed = row();
    for (int step = 0; step < 5; ++step) kept.respond(), renewed.respond();
    REQUIRE(std::abs(kept.load(1).force.y()) > 0.01);
    renewed.list({1, 0, 0});
    CHECK(renewed.went == 0);
    CHECK(renewed.p.spheres() == 2);
    const ContactSums a = kept.respond(), b = renewed.respond();
    CHECK(renewed.load(0).force == kept.load(1).force);
    CHECK(renewed.load(1).torque_over_radius == kept.load(2).torque_over_radius);
    CHECK(a.stored == b.stored);

    // The twin that forgets answers differently, so the test can fail.
    Rig forgets = row();
    forgets.respond();
    CHECK(forgets.load(1).force != kept.load(1).force);
}

TEST_CASE("the energy of a pair that goes with its body is handed back") {
    Rig rig = row();
    const Real stored = rig.respond(0).stored;
    REQUIRE(stored > 0);
    rig.list({0, 1, 0});
    CHECK(rig.went == doctest::Approx(stored).epsilon(1e-12).scale(0));
    CHECK(rig.respond().stored == 0);
}

TEST_CASE("memory goes to the right pair among many, and walls keep theirs") {
    const Clump ball = make_clump("ball", {{Vec3::Zero(), 0.01}});
    const auto many = [&] {
        Rig rig;
        rig.walls = {{{0, 0, 0}, {0, 0, 1}}, {{0, -0.0099, 0}, {0, 1, 0}}};
        for (int n = 0; n < 60; ++n)
            rig.p.add(
                ball, 2650,
                {.position = {0.0199 * (n * 7 % 60), 0, 0.0099}, .velocity = {0.001 * n, 0.01 * n, 0.003}},
                Kind::stone);
        rig.list();
        return rig;
    };
    Rig kept = many(), renewed = many();
    for (int step = 0; step < 4; ++step) kept.respond(), renewed.respond();
    std::vector<char> gone(60, 0);
    gone[8] = gone[16] = 1;
    renewed.list(gone);
    kept.respond(), renewed.respond();
    Index to = 0, same = 0;
    for (Index s = 0; s < 60; ++s) {
        if (gone[static_cast<std::size_t>(s)]) continue;
        same += (renewed.load(to).force - kept.load(s).force).norm() < 1e-9 * kept.load(s).force.norm();
        ++to;
    }
    CHECK(same == 54);  // all but the four that lost a neighbour
}

TEST_CASE("opposite forces, and torques that conserve angular momentum") {
    Rig rig = row();
    rig.respond();
    const Vec3 force = rig.load(1).force;
    CHECK(rig.load(2).force == -force);
    CHECK(force.x() < 0);  // the second stands at +x and pushes the first to -x
    const Vec3 about = rig.place(1).centre.cross(force) - rig.place(2).centre.cross(force) +
                       0.01 * (rig.load(1).torque_over_radius + rig.load(2).torque_over_radius);
    CHECK(about.norm() < 1e-15 * force.norm());
    CHECK(rig.load(0).force == Vec3::Zero());
}

TEST_CASE("a contact that opens books what its spring held, once") {
    Rig rig = row();
    for (int step = 0; step < 5; ++step) rig.respond();
    rig.place(2).centre.x() = 0.03;
    const ContactSums opening = rig.respond();
    CHECK(opening.lost_tangential > 0);
    CHECK(opening.stored == 0);
    CHECK(rig.load(1).force == Vec3::Zero());
    const ContactSums none = rig.respond();
    CHECK(none.lost_tangential == 0);
    CHECK(none.deepest <= 0);
}

TEST_CASE("losses count once for each watched side") {
    const auto lost = [](Index sides) {
        Rig rig = row();
        rig.marks.resize(3);
        for (Index s = 0; s < sides; ++s) rig.marks[static_cast<std::size_t>(1 + s)].watched = true;
        rig.list();
        rig.store.lines.motion[static_cast<std::size_t>(rig.store.slot_of(1))].velocity.x() = 1;
        return rig.respond();
    };
    CHECK(lost(0).lost_normal > 0);
    CHECK(lost(0).watched_lost_normal == 0);
    CHECK(lost(1).watched_lost_normal == lost(1).lost_normal);
    CHECK(lost(2).watched_lost_normal == 2 * lost(2).lost_normal);
    CHECK(lost(2).watched_lost_tangential == 2 * lost(2).lost_tangential);
}

/// The force of a contact; the first sees one at a time, the second a pack of them.
struct SeesOne {
    Real observe(const ContactKinematics<Real>&, const ContactLoad<Real>& load) const noexcept {
        return load.force.dot(load.force);
    }
};
struct SeesPacks {
    template <class Number>
    Number observe(const ContactKinematics<Number>&, const ContactLoad<Number>& load) const noexcept {
        return load.force.dot(load.force);
    }
};
static_assert(ContactObserver<SeesOne> && ContactObserver<SeesPacks>);

TEST_CASE("an observer's answer goes to the watched spheres, whether it sees one contact or a pack") {
    const auto seen = [](const auto& observer, bool watched) {
        Rig rig = row();
        rig.marks.resize(3);
        for (BodyMark& mark : rig.marks) mark.watched = watched;
        rig.list();
        rig.respond(1e-5, observer);
        CHECK(rig.load(0).observed == 0);
        CHECK(rig.load(1).observed == rig.load(2).observed);
        return std::pair(rig.load(1).observed, rig.load(1).force.squaredNorm());
    };
    const auto [one, force2] = seen(SeesOne{}, true);
    CHECK(one > 0);
    CHECK(one == doctest::Approx(force2).epsilon(1e-14).scale(0));
    CHECK(seen(SeesPacks{}, true).first == doctest::Approx(one).epsilon(1e-14).scale(0));
    CHECK(seen(SeesPacks{}, false).first == 0);
}

TEST_CASE(
    "pairs that do not touch are seen with a load of 0, and both spheres of a contact get what was seen") {
    Rig rig = row();
    rig.marks.resize(3);
    rig.marks[1].watched = true;
    rig.place(0).centre = rig.place(1).centre - Vec3(0, 0.0211, 0);  // within the skin, apart
    rig.list();
    rig.respond(1e-5, SeesOne{});
    CHECK(rig.load(0).observed == 0);
    CHECK(rig.load(1).observed > 0);
    CHECK(rig.load(2).observed == rig.load(1).observed);  // who is not watched is no concern of its
}

TEST_CASE("slabs, chunks and images: the same forces as pair by pair, in open and in periodic space") {
    const Clump ball = make_clump("ball", {{Vec3::Zero(), 0.01}});
    const Clump twin = make_clump("twin", {{{-0.006, 0, 0}, 0.009}, {{0.006, 0, 0}, 0.01}});
    std::mt19937 random(4);
    const auto uniform = [&] { return std::uniform_real_distribution<Real>(0, 1)(random); };
    for (const Vec3& period : {Vec3(0, 0, 0), Vec3(0.3, 0, 0), Vec3(0, 0.1, 0), Vec3(0.3, 0.1, 0.12)}) {
        Rig rig;
        rig.period = period;
        for (int n = 0; n < 1125; ++n) {
            const Vec3 at(0.3 * uniform(), 0.1 * uniform(), 0.12 * uniform());
            rig.p.add(n % 5 == 0 ? twin : ball, 2650,
                      {.position = at, .velocity = {uniform() - 0.5, uniform() - 0.5, 0}}, Kind::stone);
        }
        rig.list();
        CHECK(rig.store.slabs.count() >= 6);
        CHECK(rig.store.slabs.chunks() > 1);
        rig.respond(0);
        const auto count = static_cast<std::size_t>(rig.p.spheres());
        std::vector<Vec3> expected(count, Vec3::Zero());
        const std::vector<SearchRole> role(count, SearchRole::all);
        const std::vector<Vec3> centre = rig.p.centre;
        for (const VerletPair& pair :
             verlet_pairs_brute_force({centre, rig.p.radius, rig.p.body, role, 0, period})) {
            HotArrays two;
            two.resize(2);
            const auto i = static_cast<std::size_t>(pair.first), j = static_cast<std::size_t>(pair.second);
            for (const auto& [slot, sphere] :
                 {std::pair(std::size_t{0}, pair.first), std::pair(std::size_t{1}, pair.second)}) {
                two.place[slot] = rig.place(sphere);
                two.motion[slot] =
                    rig.store.lines.motion[static_cast<std::size_t>(rig.store.slot_of(sphere))];
            }
            two.place[1].centre += pair.shift.times(period);
            const Vec3 force = law.respond(contact_between(two, {}, {0, 1}, 0), {}).load.force;
            expected[i] += force, expected[j] -= force;
        }
        Real worst = 0, largest = 0;
        for (std::size_t s = 0; s < count; ++s) {
            worst = std::max(worst, (rig.load(static_cast<Index>(s)).force - expected[s]).norm());
            largest = std::max(largest, expected[s].norm());
        }
        CHECK(largest > 100);
        CHECK(worst < 1e-11 * largest);
    }
}
