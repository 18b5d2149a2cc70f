// Bonds over long random histories: pulled, pressed, sheared, bent and twisted while their strength goes from
// 1 to 0, broken on the way, and sliding on as contacts.
#include <abrade/bond/elastic_brittle.hpp>
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/parallel_bond.hpp>
#include <abrade/bond/twist_resistance.hpp>
#include <abrade/dem/laws/linear_spring.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

constexpr Real radius = 0.01, length = 0.02, tensile = 2.7e6, shear_strength = 4e6, stiffness = 4e8;
const Real area = pi * radius * radius;
constexpr Real friction_angle = 35;
const Real stretch_at_break = tensile * area / stiffness;  ///< [m]
constexpr Real mass = 0.005, inertia = 2e-7;               ///< effective [kg], [kg m2]
constexpr Real duration = 1e-3;                            ///< of a history [s]

template <class Law>
Law bond_law(Real damping) {
    if constexpr (std::same_as<Law, ParallelBond>)
        return Law{{.youngs = stiffness * length / area,
                    .tensile = tensile,
                    .cohesion = shear_strength,
                    .friction_angle = friction_angle,
                    .damping = damping}};
    else if constexpr (std::same_as<Law, ElasticBrittle>)
        return Law{{.tensile = tensile,
                    .shear = shear_strength,
                    .stiffness = stiffness,
                    .friction = std::tan(radians(friction_angle)),
                    .damping = damping}};
    else if constexpr (CarriesMoments<Law>)
        return Law{{.bond = bond_law<MohrCoulomb>(damping).params()}};
    else
        return Law{{.tensile = tensile,
                    .friction_angle = friction_angle,
                    .stiffness = stiffness,
                    .damping = damping}};
}

/// A few swings of random size, period and direction about a random mean.
class Swings {
public:
    Swings(std::mt19937& random, Real size) {
        std::uniform_real_distribution<Real> u(-1, 1);
        const auto any = [&] {
            const Real x = u(random), y = u(random), z = u(random);
            return Vec3(size * Vec3(x, y, z));
        };
        mean_ = 0.3 * any();
        for (Swing& s : swings_) s = {any(), 2 * pi * (3 + 2.5 * u(random)) / duration, pi * u(random)};
    }
    Vec3 at(Real t) const {
        Vec3 x = mean_;
        for (const Swing& s : swings_) x += s.amplitude * std::sin(s.frequency * t + s.phase);
        return x;
    }
    Vec3 rate(Real t) const {
        Vec3 v = Vec3::Zero();
        for (const Swing& s : swings_) v += s.amplitude * s.frequency * std::cos(s.frequency * t + s.phase);
        return v;
    }

private:
    struct Swing {
        Vec3 amplitude = Vec3::Zero();
        Real frequency = 0, phase = 0;
    };
    Vec3 mean_;
    std::array<Swing, 3> swings_;
};

/// Two spheres whose places and spins are given at any time; the bond sees what it sees in the engine.
struct History {
    History(std::mt19937& random, Real size)
        : apart(random, size * stretch_at_break), rolled(random, size * stretch_at_break / radius),
          bent(random, size * stretch_at_break / radius) {}

    Swings apart;         ///< place of i relative to j, less the bond at rest [m]
    Swings rolled, bent;  ///< half the sum of both spheres' turns, and their difference [rad]

    Vec3 place(Real t) const { return length * Vec3(0, 0.6, 0.8) + apart.at(t); }
    /// Of i relative to j, halfway between them.
    Vec3 velocity(Real t) const { return apart.rate(t) - rolled.rate(t).cross(place(t)); }
    BondKinematics at(Real t, Real dt) const {
        const Vec3 x = place(t);
        return {.normal = x.normalized(),
                .compression = length - x.norm(),
                .velocity = velocity(t),
                .radius = radius,
                .length = length,
                .effective_mass = mass,
                .time_step = dt,
                .displacement = dt * velocity(t - 0.5 * dt),
                .spin = bent.rate(t),
                .rotation = dt * bent.rate(t - 0.5 * dt),
                .effective_inertia = inertia};
    }
};

/// What came of one history.
struct Outcome {
    FailureMode failure = FailureMode::intact;
    Real put_in = 0;    ///< by the work of both spheres, and at the start [J]
    Real moved = 0;     ///< all works, whatever their sign [J]
    Real stored = 0;    ///< in the end [J]
    Real lost = 0;      ///< in all, ...
    Real slid = 0;      ///< ... of that by sliding [J]
    Real least = 0;     ///< loss or stored energy of any step [J]
    bool sound = true;  ///< fates are told once, what is broken stays so and is a contact with friction
};

template <class Law>
Outcome go_through(const Law& law, const History& history, int steps) {
    const Real dt = duration / steps, tan_phi = std::tan(radians(friction_angle));
    typename Law::Memory memory{};
    Outcome all;
    for (int n = 0; n <= steps; ++n) {
        const Real t = n * dt;
        const BondKinematics now = history.at(t, n == 0 ? 0 : dt);
        const bool was_broken = memory.broken > 0;
        const auto [load, next, failure] = law.respond(now, 1 - t / duration, memory);
        const bool is_broken = next.broken > 0;
        all.least =
            std::min({all.least, load.stored, load.lost_bond, load.lost_normal, load.lost_tangential});
        all.sound &= is_broken == (was_broken || failure != FailureMode::intact);
        all.sound &= !was_broken || (failure == FailureMode::intact && load.lost_bond == 0);
        if (is_broken) {
            const Real push = load.force.dot(now.normal), across = (load.force - push * now.normal).norm();
            all.sound &= load.couple == Vec3::Zero() && push >= 0;
            all.sound &= across <= tan_phi * push + 1e-9 * tensile * area;
            all.sound &= now.compression > 0 || load.force == Vec3::Zero();
        }
        const Real work = -(load.force.dot(now.velocity) + load.couple.dot(now.spin)) * now.time_step;
        const Real lost = load.lost_bond + load.lost_normal + load.lost_tangential;
        // What the bond is given at the start it may break under at once; of the last step counts the first
        // half.
        all.put_in += n == 0 ? load.stored + lost : n == steps ? 0.5 * work : work;
        all.moved += std::abs(work);
        all.lost += lost;
        all.slid += load.lost_tangential;
        all.stored = load.stored;
        if (failure != FailureMode::intact) all.failure = failure;
        memory = next;
    }
    return all;
}

}  // namespace

TEST_CASE_TEMPLATE(
    "no loss is ever negative, and work put in is stored or lost: intact, breaking and sliding", Law,
    MohrCoulomb, ElasticBrittle, ParallelBond, TwistResistance<MohrCoulomb>) {
    std::mt19937 random(11);
    std::uniform_real_distribution<Real> u(0, 1);
    constexpr int histories = 60;
    int tension = 0, shear = 0, slid = 0;
    Real coarse = 0, fine = 0;
    for (int n = 0; n < histories; ++n) {
        const Law law = bond_law<Law>(n % 2 ? 0.5 * u(random) : 0);
        const History history(random, std::pow(10, 1.5 * u(random) - 1));
        const Outcome seen = go_through(law, history, 4000), finer = go_through(law, history, 16'000);
        tension += seen.failure == FailureMode::tension, shear += seen.failure == FailureMode::shear,
            slid += seen.slid > 0;
        const auto missing = [](const Outcome& o) { return (o.put_in - o.stored - o.lost) / o.moved; };
        coarse += std::abs(missing(seen)) / histories, fine += std::abs(missing(finer)) / histories;
        for (const Outcome* each : {&seen, &finer}) {
            CHECK(each->least == 0);
            CHECK(each->sound);
            CHECK(std::abs(missing(*each)) < 0.01);
        }
    }
    MESSAGE(Law::name << ": " << tension << " broke in tension, " << shear << " in shear, " << slid
                      << " slid; work neither stored nor lost, of all, on average: " << coarse
                      << " in 4000 steps, " << fine << " in 16 000");
    CHECK(tension + shear >= histories - 2);  // nothing is left of the strength in the end
    CHECK(tension >= 5);
    CHECK(shear > 5);
    CHECK(slid > histories / 2);
    CHECK(fine < 0.5 * coarse);
}

TEST_CASE_TEMPLATE("random jumps, as no engine makes them: no loss is negative", Law, ElasticBrittle,
                   ParallelBond, TwistResistance<MohrCoulomb>) {
    std::mt19937 random(37);
    std::uniform_real_distribution<Real> u(-1, 1);
    const auto any = [&](Real size) {
        const Real x = u(random), y = u(random), z = u(random);
        return Vec3(size * Vec3(x, y, z));
    };
    int broken = 0;
    Real least = 0;
    bool heals = false;
    for (int n = 0; n < 100; ++n) {
        const Law law = bond_law<Law>(0.5 + 0.5 * u(random));
        typename Law::Memory memory{};
        Vec3 normal = any(1).normalized();
        const Real size = std::pow(10, 2 * std::abs(u(random)) - 2) * stretch_at_break, dt = 1e-6;
        for (int step = 0; step < 2000; ++step) {
            normal = (normal + any(0.01)).normalized();
            const auto answer = law.respond({.normal = normal,
                                             .compression = size * u(random),
                                             .velocity = any(size / dt),
                                             .radius = radius,
                                             .length = length,
                                             .effective_mass = mass,
                                             .time_step = dt,
                                             .displacement = any(size),
                                             .spin = any(size / dt / radius),
                                             .rotation = any(size / radius),
                                             .effective_inertia = inertia},
                                            1 - step / 2000., memory);
            const BondLoad& load = answer.load;
            least = std::min({least, load.stored, load.lost_bond, load.lost_normal, load.lost_tangential});
            heals |= answer.memory.broken < memory.broken;
            memory = answer.memory;
        }
        broken += memory.broken > 0;
    }
    CHECK(least == 0);
    CHECK(!heals);
    CHECK(broken > 90);
}

TEST_CASE_TEMPLATE("a broken bond of no strength is a contact with Coulomb's friction", Law, MohrCoulomb,
                   ElasticBrittle, ParallelBond) {
    std::mt19937 random(5);
    std::uniform_real_distribution<Real> u(-1, 1);
    const auto any = [&](Real size) {
        const Real x = u(random), y = u(random), z = u(random);
        return Vec3(size * Vec3(x, y, z));
    };
    int sliding = 0, pressed = 0;
    for (const Real restitution : {1.0, 0.4}) {
        const Real ratio = bond_law<Law>(0).params().stiffness_ratio;
        const LinearSpring contact{{.stiffness = stiffness,
                                    .restitution = restitution,
                                    .friction = std::tan(radians(friction_angle)),
                                    .tangential_ratio = ratio}};
        const Law law = bond_law<Law>(contact.damping_ratio());
        for (int n = 0; n < 10'000; ++n) {
            const Vec3 normal = any(1).normalized();
            const BondKinematics now{.normal = normal,
                                     .compression = 1e-6 * u(random),
                                     .velocity = any(1e-2),
                                     .radius = radius,
                                     .length = length,
                                     .effective_mass = mass,
                                     .time_step = 1e-6,
                                     .displacement = any(1e-8)};
            typename Law::Memory memory{};
            memory.broken = 1, memory.spring = any(2e-6);
            const auto answer = law.respond(now, 0, memory);
            if (now.compression <= 0) {
                CHECK(answer.load.force == Vec3::Zero());
                CHECK(answer.load.stored == 0);
                continue;
            }
            // A contact that has only just begun acts for a part of the step; these have not.
            if (now.compression < 2e-8) continue;
            const auto twin = contact.respond(ContactKinematics<Real>{.normal = normal,
                                                                      .overlap = now.compression,
                                                                      .velocity = now.velocity,
                                                                      .inverse_mass = 1 / mass,
                                                                      .curvature = 2 / radius,
                                                                      .time_step = now.time_step,
                                                                      .displacement = now.displacement},
                                              {memory.spring});
            const Real size = twin.load.force.norm() + 1e-6;
            REQUIRE((answer.load.force - twin.load.force).norm() < 1e-9 * size);
            REQUIRE((answer.memory.spring - twin.memory.spring).norm() < 1e-9 * 2e-6);
            REQUIRE(answer.load.stored == doctest::Approx(twin.load.stored).epsilon(1e-9).scale(0));
            REQUIRE(std::abs(answer.load.lost_normal - twin.load.lost_normal) < 1e-15);
            REQUIRE(std::abs(answer.load.lost_tangential - twin.load.lost_tangential) < 1e-15);
            REQUIRE(answer.load.lost_bond == 0);
            ++pressed;
            sliding += answer.load.lost_tangential > 0;
        }
    }
    CHECK(pressed > 5000);
    CHECK(sliding > 1000);
}

TEST_CASE_TEMPLATE("where no strength is left, the first pull breaks a bond; pressed, it still holds a shear",
                   Law, MohrCoulomb, ParallelBond) {
    const Law law = bond_law<Law>(0);
    const BondRigidity k = law.rigidity(radius, length);
    const auto failure = [&](Real compression, Real shear) {
        typename Law::Memory memory{};
        memory.spring = Vec3(shear, 0, 0);
        return law
            .respond({.compression = compression,
                      .radius = radius,
                      .length = length,
                      .effective_mass = mass,
                      .time_step = 1e-6,
                      .effective_inertia = inertia},
                     0, memory)
            .failure;
    };
    const Real pressed = 1e-7, line = k.normal * pressed * std::tan(radians(friction_angle)) / k.tangential;
    CHECK(failure(-1e-15, 0) == FailureMode::tension);
    CHECK(failure(pressed, 0.999 * line) == FailureMode::intact);
    CHECK(failure(pressed, 1.001 * line) == FailureMode::shear);
}
