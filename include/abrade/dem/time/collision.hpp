#pragma once
// One collision of two spheres, alone: what a contact law loses in it, by any stepper. For those who write or
// choose a law; the engine is in sim/.

#include <abrade/dem/laws/contact_law.hpp>
#include <abrade/dem/time/phase_point.hpp>

#include <cmath>

namespace abrade {

/// Two solid spheres, i and j, that meet in a plane without gravity, seen by j's centre.
struct Collision {
    Real radius_i = 0, radius_j = 0;  ///< [m]
    Real mass_i = 0, mass_j = 0;      ///< [kg]
    Real speed = 0;                   ///< of i relative to j [m/s]
    Real angle = 0;               ///< between that velocity and the line of centres at first touch [degree]
    Real spin_i = 0, spin_j = 0;  ///< about the normal of the plane [rad/s]

    void validate() const {
        require_positive(radius_i, "Collision.radius_i", "m");
        require_positive(radius_j, "Collision.radius_j", "m");
        require_positive(mass_i, "Collision.mass_i", "kg");
        require_positive(mass_j, "Collision.mass_j", "kg");
        require_positive(speed, "Collision.speed", "m/s");
        require(angle > -90 && angle < 90, {"Collision.angle", "in (-90, 90)", "degree", "0 is head-on"},
                angle);
        require_finite(spin_i, "Collision.spin_i", "rad/s");
        require_finite(spin_j, "Collision.spin_j", "rad/s");
    }
    Real effective_mass() const noexcept { return mass_i * mass_j / (mass_i + mass_j); }
    Real effective_radius() const noexcept { return radius_i * radius_j / (radius_i + radius_j); }
    Real normal_speed() const noexcept { return speed * std::cos(radians(angle)); }
    Real tangential_speed() const noexcept { return speed * std::sin(radians(angle)); }
    Real inertia_i() const noexcept { return 0.4 * mass_i * square(radius_i); }
    Real inertia_j() const noexcept { return 0.4 * mass_j * square(radius_j); }
    /// Kinetic energy in the frame of the centre of mass: all that can be lost [J].
    Real brought() const noexcept {
        return 0.5 * (effective_mass() * square(speed) + inertia_i() * square(spin_i) +
                      inertia_j() * square(spin_j));
    }
};

/// What a collision left. Energies are works on the spheres over the whole contact.
struct CollisionResult {
    Real lost_normal = 0, lost_tangential = 0;  ///< [J]
    Real normal_speed = 0;                      ///< of separation, along the line of centres at the end [m/s]
    Real tangential_speed = 0;                  ///< of the centres, across it [m/s]
    Real spin_i = 0, spin_j = 0;                ///< [rad/s]
    Real duration = 0;                          ///< from the first step that touches to the last [s]
    Real largest_force = 0, deepest = 0;        ///< where steps ended [N], [m]
    long steps = 0;                             ///< that ended in touch
    long evaluations = 0;                       ///< of the law, in touch

    Real lost() const noexcept { return lost_normal + lost_tangential; }
};

/// The forces of one contact as a TrialSystem. Degrees of freedom: x, y of i relative to j [m], turns of i
/// and j [rad].
///
/// The law's memory is frozen through the stages of a step: each evaluation hands the law the memory
/// committed last and the way travelled since, and keeps the answer's memory as a trial. Of the step in which
/// the contact begins only that part of the way counts in which the spheres overlapped. Stages are instants,
/// so the law is told a time step of 0; only `acceleration_after`, which serves Verlet's methods, passes a
/// step on.
template <ContactLaw Law>
class PairForces {
public:
    static constexpr std::size_t degrees = 4;
    using Vector = std::array<Real, degrees>;

    PairForces(const Law& law, const Collision& collision, const Vector& start)
        : law_(law), collision_(collision), base_(start) {}

    Vector acceleration(const Vector& x, const Vector& v) noexcept {
        const Frame now(x, collision_), then(base_, collision_);
        // Along the arc between the two frames: exact to second order however the line of centres turns.
        const Real arc = 0.5 * (now.distance + then.distance) * cross(then.normal, now.normal);
        const Real way = arc - 0.5 * (now.arm_i + then.arm_i) * (x[2] - base_[2]) -
                         0.5 * (now.arm_j + then.arm_j) * (x[3] - base_[3]);
        const bool begins = then.overlap < 0 && now.overlap > 0;
        const Real share = begins ? now.overlap / (now.overlap - then.overlap) : 1;
        return respond(x, v, now, share * way * now.tangent(), 0);
    }

    /// With the way really travelled in the step, as the engine has it.
    Vector acceleration_after(Real dt, const Vector& x, const Vector& v) noexcept {
        const Frame now(x, collision_);
        const Vec3 moved(x[0] - base_[0], x[1] - base_[1], 0);
        const Real turned = now.arm_i * (x[2] - base_[2]) + now.arm_j * (x[3] - base_[3]);
        return respond(x, v, now, moved - turned * now.tangent(), dt);
    }

    void commit() noexcept {
        memory_ = trial_;
        base_ = trial_at_;
    }

    Real overlap() const noexcept { return overlap_; }  ///< of the last evaluation [m]
    Real force() const noexcept { return force_; }      ///< of the last evaluation, along the normal [N]
    long evaluations() const noexcept { return evaluations_; }

    /// Kinetic energy in the frame of the centre of mass [J].
    Real kinetic_energy(const Vector& v) const noexcept {
        return 0.5 * (collision_.effective_mass() * (square(v[0]) + square(v[1])) +
                      collision_.inertia_i() * square(v[2]) + collision_.inertia_j() * square(v[3]));
    }

private:
    using Memory = typename Law::template Memory<Real>;

    struct Frame {
        Vec3 normal;
        Real distance, overlap, arm_i, arm_j;
        Frame(const Vector& x, const Collision& c) noexcept
            : distance(std::sqrt(square(x[0]) + square(x[1]))), overlap(c.radius_i + c.radius_j - distance) {
            normal = Vec3(x[0], x[1], 0) / distance;
            arm_i = c.radius_i * distance / (c.radius_i + c.radius_j);
            arm_j = distance - arm_i;
        }
        Vec3 tangent() const noexcept { return {-normal.y(), normal.x(), 0}; }
    };

    static Real cross(const Vec3& a, const Vec3& b) noexcept { return a.x() * b.y() - a.y() * b.x(); }

    Vector respond(const Vector& x, const Vector& v, const Frame& now, const Vec3& displacement,
                   Real dt) noexcept {
        const Vec3 tangent = now.tangent();
        ContactKinematics<Real> contact{};
        contact.normal = now.normal;
        contact.overlap = now.overlap;
        contact.velocity = Vec3(v[0], v[1], 0) - (now.arm_i * v[2] + now.arm_j * v[3]) * tangent;
        contact.inverse_mass = 1 / collision_.mass_i + 1 / collision_.mass_j;
        contact.curvature = 1 / collision_.radius_i + 1 / collision_.radius_j;
        contact.time_step = dt;
        contact.displacement = displacement;
        const auto [load, memory] = law_.respond(contact, memory_);
        trial_ = memory;
        trial_at_ = x;
        overlap_ = now.overlap;
        force_ = load.force.dot(now.normal);
        if (now.overlap > 0) ++evaluations_;
        const Real along = load.force.dot(tangent);
        return {load.force.x() * contact.inverse_mass, load.force.y() * contact.inverse_mass,
                -now.arm_i * along / collision_.inertia_i(), -now.arm_j * along / collision_.inertia_j()};
    }

    const Law& law_;
    const Collision& collision_;
    Memory memory_{}, trial_{};
    Vector base_, trial_at_{};
    Real overlap_ = 0, force_ = 0;
    long evaluations_ = 0;
};

/// Runs a collision by steps of dt [s]; the spheres touch first when the share `phase`, in [0, 1), of a step
/// is over; with 0 a step begins at first touch. Throws InputError for input that cannot be used, and where
/// they have not parted after 1e7 steps.
///
/// The energy lost is the kinetic energy that is gone, whatever the stepper. It is split by the work along
/// the line of centres, -d(1/2 m v_n^2) plus what the turning of that line exchanges (m v_t^2 / distance d
/// distance), and the rest.
template <Method M, ContactLaw Law>
CollisionResult collide(const Law& law, const Collision& collision, Real dt, Real phase = 0.5) {
    collision.validate();
    require_positive(dt, "collide.dt", "s", "a fiftieth of the time of contact resolves it");
    require(phase >= 0 && phase < 1, {"collide.phase", "in [0, 1)", "", "0.5 touches halfway through a step"},
            phase);

    const Real vn = collision.normal_speed(), vt = collision.tangential_speed(),
               mass = collision.effective_mass();
    // Forces may begin with a jump: a step that begins at first touch must see what comes after it.
    const Real before = phase > 0 ? (1 + phase) * dt : -1e-9 * dt;
    PhasePoint<4> point;
    point.position = {collision.radius_i + collision.radius_j + before * vn, -before * vt, 0, 0};
    point.velocity = {-vn, vt, collision.spin_i, collision.spin_j};
    PairForces<Law> forces(law, collision, point.position);
    typename M::template Stepper<PairForces<Law>, 4> stepper(forces, point);

    struct Radial {
        Real distance, speed, turning;  ///< turning: m v_t^2 / distance, what a turning line exchanges [N]
    };
    const auto radial = [&]() -> Radial {
        const auto& [x, v] = point;
        const Real distance = std::sqrt(square(x[0]) + square(x[1]));
        const Real across = (x[0] * v[1] - x[1] * v[0]) / distance;
        return {distance, (x[0] * v[0] + x[1] * v[1]) / distance, mass * square(across) / distance};
    };
    CollisionResult result;
    const Real kinetic = forces.kinetic_energy(point.velocity);
    Radial last = radial();
    const Real reach = collision.radius_i + collision.radius_j, radial_start = last.speed;
    Real exchanged = 0;
    for (long n = 0; result.steps == 0 || last.distance < reach; ++n) {
        if (n == 10'000'000)
            fail({"collide.dt", "such that the spheres part within 1e7 steps", "s",
                  "take a larger step, or a law that pushes them apart"},
                 to_text(dt));
        stepper.step(dt);
        const Radial now = radial();
        exchanged += 0.5 * (last.turning + now.turning) * (now.distance - last.distance);
        last = now;
        if (now.distance < reach) {
            ++result.steps;
            if (forces.force() > 0) result.duration += dt;
            result.largest_force = std::max(result.largest_force, forces.force());
            result.deepest = std::max(result.deepest, forces.overlap());
        } else if (n > 2) {
            break;  // grazing: too short for a step to end in it
        }
    }
    const auto& [x, v] = point;
    const Real lost = kinetic - forces.kinetic_energy(v);
    result.lost_normal = 0.5 * mass * (square(radial_start) - square(last.speed)) + exchanged;
    result.lost_tangential = lost - result.lost_normal;
    result.normal_speed = last.speed;
    result.tangential_speed = (x[0] * v[1] - x[1] * v[0]) / last.distance;
    result.spin_i = v[2];
    result.spin_j = v[3];
    result.evaluations = forces.evaluations();
    return result;
}

}  // namespace abrade
