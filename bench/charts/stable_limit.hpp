#pragma once
// The largest stable step, measured: small disturbances of bodies that press each other just grow or do not.

#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/geometry/stone_shapes.hpp>
#include <abrade/sim/simulation.hpp>

#include <random>

namespace abrade::charts {

constexpr Real ball_diameter = 0.02, pressed_by = 1e-9, stone_density = 2650;  ///< [m], [m], [kg/m3]

/// Bodies at rest, pressed together only just: contacts are as good as linear, and a row does not buckle.
struct Bed {
    struct Body {
        Clump clump{};
        BodyState state{};
        Kind kind = Kind::stone;
        Real mass() const { return stone_density * clump.volume; }  ///< [kg]
    };
    std::vector<Body> bodies{};
    std::vector<Plane> walls{};
    Vec3 gravity = Vec3::Zero();
    Real shaking = 1e-10;  ///< speed of the disturbance [m/s]

    Scene scene() const {
        Scene scene;
        scene.gravity = gravity, scene.walls = walls;
        return scene;
    }
};

inline Bed::Body ball_at(const Vec3& position, Kind kind = Kind::stone) {
    return {make_clump("ball", {{Vec3::Zero(), 0.5 * ball_diameter}}), {.position = position}, kind};
}

/// A pair alone is pressed together by nothing. So a ball stands between two fixed ones instead: it has the
/// pair's stiffness, 2 k on m.
inline Bed pair_bed() {
    Bed bed;
    for (int n = 0; n < 3; ++n)
        bed.bodies.push_back(
            ball_at({n * (ball_diameter - pressed_by), 0, 0}, n == 1 ? Kind::stone : Kind::fixed));
    return bed;
}
/// `count` balls in a row, the first and the last fixed.
inline Bed row_bed(int count) {
    Bed bed;
    for (int n = 0; n < count; ++n)
        bed.bodies.push_back(ball_at({n * (ball_diameter - pressed_by), 0, 0},
                                     n == 0 || n + 1 == count ? Kind::fixed : Kind::stone));
    return bed;
}
/// A face-centred cubic crystal, `cells` wide, its outermost balls fixed: each other one touches twelve.
inline Bed crystal_bed(int cells) {
    Bed bed;
    const Real step = (ball_diameter - pressed_by) / std::sqrt(2.0);
    const int last = 2 * cells;
    for (int x = 0; x <= last; ++x)
        for (int y = 0; y <= last; ++y)
            for (int z = 0; z <= last; ++z) {
                if ((x + y + z) % 2 != 0) continue;
                const bool rim = std::min({x, y, z}) == 0 || std::max({x, y, z}) == last;
                bed.bodies.push_back(ball_at(step * Vec3(x, y, z), rim ? Kind::fixed : Kind::stone));
            }
    return bed;
}

/// Bricks of eight overlapping balls, stacked five wide, deep and high, the outermost fixed: each other one
/// touches its neighbours with 24 balls, none of them on a line through its centre.
inline Bed clump_bed() {
    std::vector<Sphere> balls;
    const Real r = 0.5 * ball_diameter;
    for (int n = 0; n < 8; ++n)
        balls.push_back({r * Vec3(n % 2 ? 1 : -1, n / 2 % 2 ? 0.9 : -0.9, n / 4 ? 0.8 : -0.8), r});
    const Clump clump = make_clump("brick", balls);  // its axes may have changed places
    const Vec3 pitch = (2 * (clump.members[0].centre.cwiseAbs().array() + r) - pressed_by).matrix();
    Bed bed;
    for (int x = 0; x < 5; ++x)
        for (int y = 0; y < 5; ++y)
            for (int z = 0; z < 5; ++z) {
                const bool rim = std::min({x, y, z}) == 0 || std::max({x, y, z}) == 4;
                bed.bodies.push_back({clump,
                                      {.position = pitch.cwiseProduct(Vec3(x, y, z))},
                                      rim ? Kind::fixed : Kind::stone});
            }
    return bed;
}

/// `layers` of nine bodies, poured into a box and brought to rest under their weight: they are stopped again
/// and again until they hardly start to move any more. They keep no tangential springs.
template <class Settling>
Bed poured_bed(const Clump& clump, Real width, int layers, const Settling& law) {
    Scene scene;
    std::mt19937 random(7);
    std::uniform_real_distribution<Real> u(-1, 1);
    // One by one: in which order arguments are evaluated is up to the compiler.
    const auto shift = [&] {
        const Real z = u(random), y = u(random), x = u(random);
        return Vec3(x, y, z);
    };
    const Real side = 3 * width;
    for (int n = 0; n < 9 * layers; ++n) {
        const Vec3 at((n % 3 + 0.5) * width, (n / 3 % 3 + 0.5) * width, (n / 9 + 0.6) * width);
        const Vec3 axis = shift();
        const Quaternion turned = Quaternion(u(random), axis.x(), axis.y(), axis.z()).normalized();
        scene.add_stone(clump, {.position = at + 0.02 * width * shift(), .orientation = turned},
                        stone_density);
    }
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())})
        scene.add_wall(Vec3::Zero(), axis).add_wall(side * axis, -axis);
    for (int stop = 0; stop < 12; ++stop) {
        auto sim = simulate(scene).contact(law);
        sim.run({.end_time = stop == 0 ? 0.6 : 0.02});
        const Particles& p = sim.particles();
        for (std::size_t b = 0; b < p.position.size(); ++b)
            scene.stones[b].state = {.position = p.position[b], .orientation = p.orientation[b]};
    }
    Bed bed{.bodies = {}, .walls = scene.walls, .gravity = scene.gravity, .shaking = 1e-6};
    for (const Scene::Stone& stone : scene.stones) bed.bodies.push_back({clump, stone.state, Kind::stone});
    return bed;
}

/// A bed under a law, stepped by the engine without its guards on the step.
template <ContactLaw C>
class Shaken {
public:
    using P = Policies<C, NoBond, NoWear, NoFluid, NoDrag>;

    Shaken(const Bed& bed, const C& law) : world_(state_of(bed, law)) {
        world_.set_skin(0.05 * ball_diameter);
        world_.open(0);
    }
    /// What `StableStepNow` says [s].
    Real predicted() const {
        return StableStepNow(world_.state()).of_touching(std::numeric_limits<Real>::infinity()).seconds;
    }
    /// Normal stiffness of the stiffest contact [N/m].
    Real stiffest() const {
        Real most = 0;
        world_.each_contact([&](Index, Index, const ContactKinematics<Real>& contact, const auto&) {
            if constexpr (requires { world_.state().policies.contact.rigidity(contact); })
                most = std::max(most, world_.state().policies.contact.rigidity(contact).normal);
            else
                most = world_.state().policies.contact.rigidity(0.0).normal;
        });
        return most;
    }
    /// Whether kinetic energy grows a thousandfold over what it started with, or had fallen to by damping;
    /// but not over less than a millionth of the start, where round-off lies.
    bool grows(Real dt, int steps) {
        constexpr int window = 12;
        const Real start = world_.publish().kinetic;
        Real least = start, most = 0;
        for (int n = 0; n < steps; ++n) {
            world_.step(n * dt, dt, false);
            const Real now = world_.publish().kinetic;
            if (!(now < 1e3 * least)) return true;
            most = std::max(most, now);
            if (n % window == window - 1) least = std::clamp(most, 1e-6 * start, least), most = 0;
        }
        return false;
    }

private:
    static State<P> state_of(const Bed& bed, const C& law) {
        State<P> state(bed.scene(), P{law, {}, {}, {}, {}});
        Real phase = 0;
        for (const Bed::Body& body : bed.bodies) {
            BodyState start = body.state;
            phase += 1.7;  // each body another way: all modes are in it
            start.velocity =
                bed.shaking * Vec3(std::sin(phase), std::cos(2.1 * phase), std::sin(3.3 * phase));
            start.angular_velocity = bed.shaking / ball_diameter *
                                     Vec3(std::cos(1.3 * phase), std::sin(0.7 * phase), std::cos(phase));
            state.particles.add(body.clump, stone_density, start, body.kind);
        }
        return state;
    }

    World<P> world_;
};

/// The largest step that is stable [s], by bisection between half of what is predicted and four times that.
template <ContactLaw C>
Real measured_limit(const Bed& bed, const C& law, Real predicted, int steps = 1500) {
    Real low = 0.5 * predicted, high = 4 * predicted;
    if (Shaken<C>(bed, law).grows(low, steps)) return 0;
    while (high > 1.005 * low) {
        const Real middle = std::sqrt(low * high);
        (Shaken<C>(bed, law).grows(middle, steps) ? high : low) = middle;
    }
    return low;
}

inline LinearSpring linear_law(Real restitution, Real friction) {
    return LinearSpring{{.stiffness = 1e6, .restitution = restitution, .friction = friction}};
}
inline HertzMindlin hertz_law(Real restitution, Real friction) {
    return HertzMindlin{{.youngs = 1e9, .restitution = restitution, .friction = friction}};
}

}  // namespace abrade::charts
