// Concrete that stands: who is a body, what equilibrium holds, what is let go and what vanishes.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/core/parallel.hpp>
#include <abrade/sim/print.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include "../message_of.hpp"

#include <cstring>
#include <sstream>

using namespace abrade;

namespace {

constexpr Real d = 0.02, cell = cube(d), coefficient = 1.1e-7;
const LinearSpring law{{.stiffness = 1e6, .restitution = 0.5, .friction = 0.4}};
const MohrCoulomb strong{{.tensile = 2.7e6, .stiffness = 4e6}}, weak{{.tensile = 1, .stiffness = 4e6}};

SubParticleAbrasion abrasion(Real beta) {
    return SubParticleAbrasion{{.coefficient = coefficient, .acceleration = beta}};
}

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Scene slab(Real side, Index layers, ConcreteLevel level) {
    Scene scene;
    scene.concrete = ConcreteBlock{
        .lattice = flat_lattice(side, side, {.sphere_diameter = d, .layers = layers}), .level = level};
    return scene;
}

/// One on the other, the lower one held, and no weight.
Scene pillar(Index cluster = 0) {
    Lattice lattice = lattice_of({{0, 0, -1.5 * d}, {0, 0, -0.5 * d}}, 0.5 * d, 2 * cell);
    lattice.sites[0].held = true;
    Scene scene;
    scene.gravity.setZero();
    scene.concrete =
        ConcreteBlock{.lattice = lattice, .level = ConcreteLevel::quasi_static, .cluster = cluster};
    return scene;
}

/// A row of spheres that sticks out of a wall, and a stone that falls on the second from `height` [m].
Scene bar(Index spheres, Real height) {
    std::vector<Vec3> centres;
    for (Index n = 0; n < spheres; ++n) centres.push_back({d * static_cast<Real>(n), 0, 0});
    Scene scene;
    scene.concrete =
        ConcreteBlock{.lattice = lattice_of(centres, 0.5 * d, cell), .level = ConcreteLevel::quasi_static};
    scene.concrete->lattice.sites[0].held = true;
    scene.add_sphere(0.5 * d, {.position = {d, 0, height}, .velocity = {0, 0, -1}});
    return scene;
}

template <class Sim>
Index gone(const Sim& sim) {
    Index count = 0;
    for (Index s = 0; s < sim.concrete().sites(); ++s) count += sim.concrete().gone(s);
    return count;
}
template <class Sim>
Index count(const Sim& sim, Kind kind) {
    const auto& kinds = sim.particles().kind;
    return static_cast<Index>(std::count(kinds.begin(), kinds.end(), kind));
}
/// The only stone; what else is a body changes with where it is.
std::size_t stone_in(const Particles& p) {
    return static_cast<std::size_t>(std::find(p.kind.begin(), p.kind.end(), Kind::stone) - p.kind.begin());
}
Vec3 momentum(const Particles& p) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t b = 0; b < p.mass.size(); ++b)
        if (p.inverse_mass[b] > 0) sum += p.mass[b] * p.velocity[b];
    return sum;
}

/// What its contacts with concrete lost has worn, to round-off, wherever it went.
template <class Sim>
void check_volumes(const Sim& sim, Real beta) {
    const Ledger& e = sim.ledger();
    const Concrete& c = sim.concrete();
    CHECK(c.worn_volume() + c.overflow_volume() + c.waiting_volume() ==
          doctest::Approx(0.5 * coefficient * beta * (e.concrete_lost_normal + e.concrete_lost_sliding))
              .epsilon(1e-12)
              .scale(0));
    CHECK(e.residual_relative() < 1e-12);
}

/// The path of the only stone, every millisecond.
struct Path {
    std::vector<Vec3> position, velocity, angular_momentum;
    Real worn = 0, lost = 0, lowest = std::numeric_limits<Real>::infinity();

    bool operator==(const Path&) const = default;
};

template <class Sim>
Path follow(Sim& sim, const RunOptions& options) {
    Path path;
    sim.run(options, [&](const auto& now) {
        const Particles& p = now.particles();
        const std::size_t stone = stone_in(p);
        path.position.push_back(p.position[stone]), path.velocity.push_back(p.velocity[stone]);
        path.angular_momentum.push_back(p.angular_momentum[stone]);
        path.lowest = std::min(path.lowest, p.position[stone].z());
    });
    path.worn = sim.concrete().worn_volume(), path.lost = sim.ledger().lost();
    return path;
}
/// Steps of one length, so that runs are the same step by step.
const RunOptions briefly{.end_time = 0.05, .time_step = 1e-5, .observe_every = 1e-3};

}  // namespace

TEST_CASE("a stone bounces on quasi-static concrete as on rigid, bit for bit, while nothing loosens") {
    const auto thrown = [](ConcreteLevel level) {
        Scene scene = slab(0.1, 3, level);
        scene.add_sphere(
            0.025,
            {.position = {0.003, -0.004, 0.0255}, .velocity = {0.3, 0, -1}, .angular_velocity = {3, 20, 1}});
        return scene;
    };
    auto stands = simulate(thrown(ConcreteLevel::quasi_static)).contact(law).bond(strong).wear(abrasion(100));
    const Path path = follow(stands, briefly);
    CHECK(gone(stands) == 0);
    CHECK(stands.bonds_broken() == 0);
    CHECK(path.worn > 0);
    CHECK(std::any_of(path.velocity.begin(), path.velocity.end(), [](const Vec3& v) { return v.z() > 0.2; }));
    CHECK(stands.ledger().stored_bonds == 0);

    auto rigid = simulate(thrown(ConcreteLevel::rigid)).contact(law).bond(strong).wear(abrasion(100));
    CHECK(follow(rigid, briefly) == path);
    auto unbonded = simulate(thrown(ConcreteLevel::rigid)).contact(law).wear(abrasion(100));
    CHECK(follow(unbonded, briefly) == path);
    // Bodies that do not move, all of them: sums have another order.
    auto fixed = simulate(thrown(ConcreteLevel::dynamic)).contact(law).wear(abrasion(100));
    CHECK((follow(fixed, briefly).velocity.back() - path.velocity.back()).norm() < 1e-11);
}

TEST_CASE("untouched concrete is no body, and changes nothing") {
    // As many columns more on either side of the one that is hit.
    const auto bounce = [](int columns, Index& most, Index& sites, Index& steps) {
        Scene scene = slab(d * columns, 3, ConcreteLevel::quasi_static);
        scene.add_sphere(0.025, {.position = {0.003, 0.002, 0.2}});
        auto sim = simulate(scene).contact(law).bond(strong).wear(abrasion(100));
        sim.run({.end_time = 0.01});
        CHECK(sim.particles().bodies() == 1);  // the stone, on its way
        CHECK(sim.particles().kind[0] == Kind::stone);
        sim.run({.end_time = 0.4, .observe_every = 1e-3},
                [&](const auto& now) { most = std::max(most, now.particles().bodies()); });
        for (Index s = 0; s < sim.concrete().sites(); ++s)
            REQUIRE(sim.concrete_place(s) == sim.concrete().lattice().sites[at(s)].centre);
        sites = sim.concrete().sites(), steps = sim.steps();
        CHECK(sim.ledger().residual_relative() < 1e-12);
        return sim.concrete().worn_volume();
    };
    Index most[2]{}, sites[2]{}, steps[2]{};
    const Real small = bounce(15, most[0], sites[0], steps[0]),
               large = bounce(59, most[1], sites[1], steps[1]);
    CHECK(sites[1] == 59 * 59 * 3);
    CHECK(most[1] > 1);  // it touches some
    CHECK(most[1] < 100);
    CHECK(most[1] == most[0]);
    CHECK(steps[1] == steps[0]);
    CHECK(small > 0);
    CHECK(large == doctest::Approx(small).epsilon(1e-9).scale(0));  // columns' places differ by round-off
}

TEST_CASE("a stone meets standing concrete across a period as it meets any") {
    const auto run = [](ConcreteLevel level) {
        Scene scene = slab(0.3, 2, level);
        scene.periodic_along = {true, true, false};
        scene.bounds = {{-0.15, -0.15, -1}, {0.15, 0.15, 1}};
        scene.add_sphere(0.025, {.position = {0.14, 0.148, 0.03}, .velocity = {2, 0.2, -1}});
        auto sim = simulate(scene).contact(law).wear(abrasion(1));
        return follow(sim, briefly);
    };
    const Path stands = run(ConcreteLevel::rigid), fixed = run(ConcreteLevel::dynamic);
    CHECK(stands.worn > 0);
    for (std::size_t n = 0; n < stands.velocity.size(); ++n)
        CHECK((stands.velocity[n] - fixed.velocity[n]).norm() < 1e-9);
}

TEST_CASE("a sphere that is pressed sideways on weak bonds is let go, and no momentum is lost from then on") {
    for (const Index cluster : {0, 1}) {
        CAPTURE(cluster);
        Scene scene = pillar(cluster);
        scene.add_sphere(0.5 * d, {.position = {-1.001 * d, 0, -0.5 * d}, .velocity = {1, 0, 0}});
        auto sim = simulate(scene).contact(law).bond(weak);
        Real together = 0, worst = 0;  // [kg m/s]
        sim.run({.end_time = 2e-3, .time_step = 2e-6, .observe_every = 2e-6}, [&](const auto& now) {
            if (!now.concrete().gone(1)) return;
            const Vec3 p = momentum(now.particles());
            if (together == 0) together = p.x();
            worst = std::max(worst, (p - Vec3(together, 0, 0)).norm());
        });
        const Particles& p = sim.particles();
        const std::size_t stone = stone_in(p),
                          grain = static_cast<std::size_t>(
                              std::find(p.kind.begin(), p.kind.end(), Kind::grain) - p.kind.begin());
        REQUIRE(grain < p.kind.size());
        CHECK(gone(sim) == 1);
        CHECK(sim.bonds_broken() == 1);
        CHECK(sim.concrete().detached_volume() == doctest::Approx(cell).scale(0));
        CHECK(worst < 1e-12 * together);
        // Before, a step or two of the load went into the ground.
        CHECK(together == doctest::Approx(p.mass[stone]).epsilon(0.02).scale(0));
        // The collision of two that are free, in a hundred steps.
        CHECK(p.velocity[grain].x() - p.velocity[stone].x() == doctest::Approx(0.5).epsilon(0.02).scale(0));
        CHECK(sim.ledger().residual_relative() < 1e-12);
        CHECK(std::abs(sim.ledger().integration_residue()) < 0.01 * sim.ledger().throughput());
    }
}

TEST_CASE("pressed straight down into its seat it stays, however weak its bonds are") {
    for (const Index cluster : {0, 1}) {
        CAPTURE(cluster);
        Scene scene = pillar(cluster);
        scene.add_sphere(0.5 * d, {.position = {0, 0, 0.51 * d}, .velocity = {0, 0, -1}});
        auto sim = simulate(scene).contact(law).bond(weak);
        sim.run({.end_time = 5e-3});
        CHECK(gone(sim) == 0);
        CHECK(sim.particles().velocity[stone_in(sim.particles())].z() > 0.4);  // it has bounced

        // Between neighbours bonds to the sides are sheared and break; what is left of them and the bond
        // below hold the sphere.
        Scene block = slab(0.06, 2, ConcreteLevel::quasi_static);
        block.concrete->cluster = cluster;
        block.add_sphere(0.5 * d, {.position = {0, 0, 0.51 * d}, .velocity = {0, 0, -1}});
        auto between = simulate(block).contact(law).bond(weak);
        between.run({.end_time = 5e-3});
        CHECK(between.bonds_broken() >= 4);
        CHECK(gone(between) == 0);
        CHECK(between.concrete().detached_volume() == 0);
        CHECK(between.ledger().residual_relative() < 1e-12);
        std::ostringstream text;
        text << between;
        CHECK(text.str().find("warning  blows broke bonds") != std::string::npos);
        auto sound = simulate(block).contact(law).bond(strong);
        sound.run({.end_time = 5e-3});
        CHECK(!breaks_by_blows(sound));
    }
}

TEST_CASE("a piece that comes loose falls as a whole, and so do those of its spheres that nobody was near") {
    // Its first bond breaks under the stone, and most of it was no body.
    constexpr Index count = 40;
    const Scene scene = bar(count, 1.01 * d);
    auto sim = simulate(scene).contact(law).bond(weak);
    const Real end = 0.02;
    sim.run({.end_time = end});
    REQUIRE(gone(sim) == count - 1);
    for (Index s = 2; s < count; ++s) {
        CAPTURE(s);
        CHECK((sim.concrete_place(s) - d * static_cast<Real>(s) * Vec3::UnitX()).norm() <
              0.5 * standard_gravity * square(end));
    }
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

TEST_CASE("what comes loose begins from rest, however long nothing has been near it") {
    // The stone has been under way for 40 ms as it breaks the bar, in one flight of many steps.
    const Scene scene = bar(4, 3 * d);
    auto sim = simulate(scene).contact(law).bond(weak);
    Real last_whole = 0;
    sim.run({.end_time = 0.05, .observe_every = 1e-4, .skin = 2 * d}, [&](const auto& now) {
        if (gone(now) == 0) last_whole = now.time();
        const Particles& p = now.particles();
        for (std::size_t b = 0; b < p.kind.size(); ++b)
            if (p.site[b] >= 2)  // nothing strikes these
                CHECK(p.velocity[b].norm() <= standard_gravity * (now.time() - last_whole) + 1e-12);
    });
    CHECK(last_whole > 0.03);
    CHECK(gone(sim) == 3);
}

TEST_CASE("a sphere whose bonds broke is let go where it is pressed out of its seat") {
    Scene scene = slab(0.06, 2, ConcreteLevel::quasi_static);
    // The corner sphere, struck from above its inner neighbours: nothing is in its way outwards, and friction
    // on the sphere below, tan(phi) = 0.7, does not hold what is pressed half as much again outwards as down.
    const Index corner = scene.concrete->lattice.site(2, 2, 0);
    const Vec3 inwards = Vec3(-1, -1, 0.95).normalized();
    const Real radius = 0.3 * d, apart = 1.01 * (radius + 0.5 * d);
    scene.add_sphere(radius, {.position = scene.concrete->lattice.sites[at(corner)].centre + apart * inwards,
                              .velocity = -2 * inwards});
    auto sim = simulate(scene).contact(law).bond(weak);
    sim.run({.end_time = 5e-3});
    CHECK(sim.concrete().gone(corner));
    CHECK(count(sim, Kind::grain) == gone(sim));
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

namespace {

/// A stone that fits between spheres falls straight on the middle one of 5 x 5, and wears more than it has.
Scene on_the_middle(WornOut worn_out, Index layers = 4) {
    Scene scene = slab(0.1, layers, ConcreteLevel::quasi_static);
    scene.concrete->worn_out = worn_out;
    scene.add_sphere(0.008, {.position = {0, 0, 0.0085}, .velocity = {0, 0, -2}});
    return scene;
}
/// A cell and a half by the first impact, which loses three quarters of 0.0114 J.
constexpr Real beta = 2.5e4;
const RunOptions until_it_fell{.end_time = 0.35, .observe_every = 1e-3};

}  // namespace

TEST_CASE("a sphere that is worn out vanishes as fines, and the stone falls into the hole") {
    auto sim = simulate(on_the_middle(WornOut::fines)).contact(law).bond(strong).wear(abrasion(beta));
    const Path path = follow(sim, until_it_fell);
    const Concrete& c = sim.concrete();
    const Index middle = c.lattice().site(2, 2, 0);
    CHECK(c.gone(middle));
    CHECK(c.fracture(middle) == 1);
    CHECK(c.worn_volume() >= c.capacity(middle));
    CHECK(c.detached_volume() == 0);
    CHECK(count(sim, Kind::grain) == 0);
    for (const Index site : sim.particles().site) CHECK(site != middle);
    CHECK(path.lowest < -0.25 * d);
    check_volumes(sim, beta);
    // What stands, what was worn off and what broke off make up the block.
    Real standing = 0;
    for (Index s = 0; s < c.sites(); ++s)
        if (!c.gone(s)) standing += c.capacity(s) * (1 - c.fracture(s));
    CHECK(standing + c.worn_volume() + c.detached_volume() ==
          doctest::Approx(static_cast<Real>(c.sites()) * cell).epsilon(1e-12).scale(0));
}

TEST_CASE("as a grain it stays, in its seat and in the stone's way") {
    auto sim = simulate(on_the_middle(WornOut::grain)).contact(law).bond(strong).wear(abrasion(beta));
    const Path path = follow(sim, until_it_fell);
    CHECK(sim.concrete().gone(sim.concrete().lattice().site(2, 2, 0)));
    CHECK(count(sim, Kind::grain) >= 1);
    CHECK(count(sim, Kind::grain) == gone(sim));
    CHECK(path.lowest > 0);
    check_volumes(sim, beta);
}

TEST_CASE("where wear is recorded only, nothing vanishes and nothing overflows") {
    auto sim = simulate(on_the_middle(WornOut::recorded)).contact(law).bond(strong).wear(abrasion(10 * beta));
    RunOptions options = until_it_fell;
    options.time_step = 1e-5;
    const Path path = follow(sim, options);
    const Concrete& c = sim.concrete();
    CHECK(gone(sim) == 0);
    CHECK(sim.bonds_broken() == 0);
    CHECK(c.fracture(c.lattice().site(2, 2, 0)) == 1);
    CHECK(c.worn_volume() > 10 * cell);
    CHECK(c.overflow_volume() == 0);
    CHECK(!c.worn_through());
    check_volumes(sim, 10 * beta);
    // The same motion as where nothing wears.
    auto whole = simulate(on_the_middle(WornOut::fines)).contact(law).bond(strong);
    CHECK(follow(whole, options).velocity == path.velocity);
}

TEST_CASE("a run ends where the concrete is worn through, and says so") {
    auto sim = simulate(on_the_middle(WornOut::fines, 1)).contact(law).bond(strong).wear(abrasion(beta));
    Real seen = 0;
    sim.run({.end_time = 1}, [&](const auto& now) { seen = now.time(); });
    CHECK(sim.concrete().worn_through());
    CHECK(sim.time() > 0);
    CHECK(sim.time() < 0.1);
    CHECK(seen == sim.time());  // the end was observed
    CHECK(!sim.stopped());
    check_volumes(sim, beta);
    const Index steps = sim.steps();
    sim.run({.end_time = 2});  // nor does it go on
    CHECK(sim.steps() == steps);

    auto recorded =
        simulate(on_the_middle(WornOut::recorded, 1)).contact(law).bond(strong).wear(abrasion(beta));
    recorded.run({.end_time = 0.02});
    CHECK(recorded.time() == 0.02);
}

TEST_CASE("bits do not depend on the number of threads") {
    const auto run = [](int threads) {
        set_thread_count(threads);
        Scene scene;
        scene.concrete = ConcreteBlock{.lattice = flat_lattice(3.2, 0.6, {.sphere_diameter = d, .layers = 3}),
                                       .level = ConcreteLevel::quasi_static};
        for (const Vec3& wall : {Vec3(1.6, 0, 0), Vec3(-1.6, 0, 0), Vec3(0, 0.3, 0), Vec3(0, -0.3, 0)})
            scene.add_wall(wall, -wall);
        for (int n = 0; n < 384; ++n)
            scene.add_sphere(n % 2 ? 0.02 : 0.015,
                             {.position = {0.098 * (n % 32) - 1.52, 0.046 * (n / 32) - 0.253, 0.025},
                              .velocity = {n % 3 - 1.0, 0.1 * (n % 5), -2}});
        auto sim = simulate(scene)
                       .contact(law)
                       .bond(MohrCoulomb{{.tensile = 1e3, .stiffness = 4e6}})
                       .wear(abrasion(2000));
        Index chunks = 0;
        sim.run({.end_time = 0.06, .observe_every = 2e-3, .skin = 0.02}, [&](const auto& now) {
            chunks = std::max(chunks, now.world().state().store.slabs.chunks());
        });
        CHECK(chunks > 1);  // threads have something to share
        CHECK(sim.bonds_broken() > 10);
        CHECK(gone(sim) > 0);
        MESSAGE(gone(sim) << " spheres gone, of them " << count(sim, Kind::grain) << " grains");
        CHECK(sim.ledger().residual_relative() < 1e-12);
        std::vector<Real> all{static_cast<Real>(sim.bonds_broken()), static_cast<Real>(sim.steps())};
        const Particles& p = sim.particles();
        for (std::size_t b = 0; b < p.position.size(); ++b) {
            all.push_back(static_cast<Real>(p.id[b]));
            for (const Vec3* v : {&p.position[b], &p.velocity[b], &p.angular_momentum[b]})
                all.insert(all.end(), v->data(), v->data() + 3);
        }
        sim.ledger().visit([&](std::string_view, Real value) { all.push_back(value); });
        for (Index s = 0; s < sim.concrete().sites(); ++s)
            all.push_back(sim.concrete().gone(s) ? -1 : sim.concrete().fracture(s));
        return all;
    };
    const int before = thread_count();
    const std::vector<Real> one = run(1);
    for (const int threads : {2, 3}) {
        const std::vector<Real> other = run(threads);
        REQUIRE(other.size() == one.size());
        CHECK(std::memcmp(one.data(), other.data(), one.size() * sizeof(Real)) == 0);
    }
    set_thread_count(before);
}

TEST_CASE("what does not go together is named before the first step") {
    const auto said = [](auto change, const auto&... bond) {
        Scene scene = slab(0.06, 2, ConcreteLevel::quasi_static);
        scene.add_sphere(0.01, {.position = {0, 0, 0.02}});
        change(*scene.concrete);
        const auto run = [](auto sim) { return message_of([&] { sim.run({.end_time = 1e-4}); }); };
        if constexpr (sizeof...(bond) > 0)
            return run(simulate(scene).contact(law).bond(bond...));
        else
            return run(simulate(scene).contact(law));
    };
    const auto has = [](const std::string& text, const std::string& part) {
        return text.find(part) != std::string::npos;
    };
    const auto as_it_is = [](ConcreteBlock&) {};
    CHECK(said(as_it_is, strong) == "nothing was thrown");
    CHECK(has(said(as_it_is), "Scene.concrete.level"));
    CHECK(has(said(as_it_is), "bond"));
    CHECK(said([](ConcreteBlock& block) { block.level = ConcreteLevel::rigid; }) == "nothing was thrown");
    // A cluster of 1 bond is three spheres wide, one of 2 is five; the block has three.
    CHECK(said([](ConcreteBlock& block) { block.cluster = 1; }, strong) == "nothing was thrown");
    for (const Index cluster : {-1, 2, 1000})
        CHECK(has(said([=](ConcreteBlock& block) { block.cluster = cluster; }, strong),
                  "Scene.concrete.cluster"));
    CHECK(has(said([](ConcreteBlock& block) { block.fragments = Fragments::clumps; }, strong),
              "Scene.concrete.fragments"));
    CHECK(has(said([](ConcreteBlock& block) { block.overflow = SpreadOverPatch{.length = -1, .width = 1}; },
                   strong),
              "SpreadOverPatch.length"));
}
