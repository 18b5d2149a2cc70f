#pragma once
// The scenes of docs/verification/ledger.md, and a law that counts the contacts that begin.

#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/sim/simulation.hpp>

#include <atomic>
#include <memory>
#include <random>

namespace ledger_scenes {

using namespace abrade;

/// A contact law that behaves as `Law` does and counts the contacts that begin: those that touch and did not
/// when last seen. The memory that says so lives through renewals of the lists, as all memory does.
template <ContactLaw Law>
class Counted {
public:
    static constexpr std::string_view name = Law::name;
    using Params = typename Law::Params;

    template <class Number>
    struct Memory {
        typename Law::template Memory<Number> of_law{};
        Number touched = Number(0);
    };

    explicit Counted(Params params) : law_(params) {}
    const Params& params() const noexcept { return law_.params(); }

    template <class Number>
    ContactResponse<Number, Memory<Number>> respond(const ContactKinematics<Number>& contact,
                                                    const Memory<Number>& memory) const noexcept {
        const auto touching = contact.overlap > Number(0);
        const auto begins = touching & (memory.touched == Number(0));
        if (any(begins)) note(begins, contact.velocity.dot(contact.normal));
        const auto [load, next] = law_.respond(contact, memory.of_law);
        return {load, {next, select(touching, Number(1), Number(0))}};
    }
    Real stable_dt(Real mass, Real radius) const noexcept { return law_.stable_dt(mass, radius); }
    ContactRigidity rigidity(Real radius) const noexcept { return law_.rigidity(radius); }

    long begun() const noexcept { return seen_->begun; }
    /// Sum of the fourth powers of the normal speeds with which contacts began [m4/s4].
    Real speed4() const noexcept { return seen_->speed4; }

private:
    struct Seen {
        std::atomic<long> begun = 0;
        std::atomic<Real> speed4 = 0;
    };

    void note(bool, Real speed) const noexcept { ++seen_->begun, seen_->speed4 += square(square(speed)); }
    void note(PackMask begins, const Pack& speed) const noexcept {
        for (int lane = 0; lane < pack_lanes; ++lane)
            if (begins[lane]) note(true, speed[lane]);
    }

    Law law_;
    std::shared_ptr<Seen> seen_ = std::make_shared<Seen>();
};

/// Numbers that are the same on every machine.
struct Random {
    explicit Random(std::uint64_t seed) : engine(seed) {}
    std::mt19937_64 engine;
    Real uniform(Real low, Real high) {
        return low + (high - low) * std::generate_canonical<Real, 53>(engine);
    }
    Vec3 in_cube() {
        const Real x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
        return {x, y, z};
    }
    Quaternion turned() {
        const Vec3 axis = in_cube();
        return Quaternion(uniform(-1, 1), axis.x(), axis.y(), axis.z()).normalized();
    }
};

/// side^3 spheres of radius 0.8 to 1.2 cm that fly and spin at random between two plates, in space that
/// repeats itself sideways. No weight.
inline Scene gas(int side) {
    constexpr Real cell = 0.032;
    Random random(17);
    Scene scene;
    scene.gravity.setZero();
    scene.periodic_along = {true, true, false};
    scene.bounds = {Vec3::Constant(-cell), Vec3::Constant((side + 1) * cell)};
    scene.bounds.low.head<2>().setZero(), scene.bounds.high.head<2>().setConstant(side * cell);
    for (int n = 0; n < side * side * side; ++n) {
        const Vec3 corner = cell * Vec3(n % side, n / side % side, n / (side * side));
        const Real radius = random.uniform(0.008, 0.012);
        const Vec3 velocity = random.in_cube(), spin = 40 * random.in_cube();
        scene.add_sphere(radius, {.position = corner + Vec3::Constant(0.5 * cell),
                                  .velocity = velocity,
                                  .angular_velocity = spin});
    }
    scene.add_wall({0, 0, 0}, {0, 0, 1}).add_wall({0, 0, side * cell}, {0, 0, -1});
    return scene;
}

/// Pebbles and crushed stones let go above the floor of a box, side x side in each layer, to come to rest.
inline Scene bed(int side, int layers) {
    constexpr Real size = 0.04, cell = 0.064;  // longer than the pebble
    const Clump pebble = make_stone(StoneShape::ellipsoid, size),
                crushed = make_stone(StoneShape::angular, size);
    Random random(23);
    Scene scene;
    for (int n = 0; n < side * side * layers; ++n) {
        const Vec3 corner = cell * Vec3(n % side, n / side % side, n / (side * side));
        const Vec3 velocity = 0.3 * random.in_cube();
        scene.add_stone(n % 2 == 0 ? pebble : crushed, {.position = corner + Vec3::Constant(0.5 * cell),
                                                        .velocity = velocity,
                                                        .orientation = random.turned()});
    }
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    for (int axis = 0; axis < 2; ++axis)
        scene.add_wall(Vec3::Zero(), Vec3::Unit(axis))
            .add_wall(side * cell * Vec3::Unit(axis), -Vec3::Unit(axis));
    return scene;
}

/// Adds the six walls of a cube from 0 to `side` [m].
inline void add_cube(Scene& scene, Real side) {
    for (int axis = 0; axis < 3; ++axis)
        scene.add_wall(Vec3::Zero(), Vec3::Unit(axis)).add_wall(side * Vec3::Unit(axis), -Vec3::Unit(axis));
}

/// Five spheres that fly about in a box, without weight.
inline Scene handful() {
    Random random(5);
    Scene scene;
    scene.gravity.setZero();
    for (int n = 0; n < 5; ++n) {
        const Vec3 corner = 0.04 * Vec3(n % 2, n / 2 % 2, n / 4);
        scene.add_sphere(0.01 + 0.002 * n,
                         {.position = corner + Vec3::Constant(0.02), .velocity = random.in_cube()});
    }
    add_cube(scene, 0.08);
    return scene;
}

/// Eight spheres in a box that is too small for them by 0.1 mm a contact: they swing, and never part.
inline Scene squeezed() {
    constexpr Real radius = 0.01, overlap = 1e-4;
    Random random(29);
    Scene scene;
    scene.gravity.setZero();
    for (int n = 0; n < 8; ++n) {
        const Vec3 at =
            Vec3::Constant(radius - overlap) + (2 * radius - overlap) * Vec3(n % 2, n / 2 % 2, n / 4);
        scene.add_sphere(radius, {.position = at, .velocity = 0.1 * random.in_cube()});
    }
    add_cube(scene, 4 * radius - 3 * overlap);
    return scene;
}

}  // namespace ledger_scenes
