#pragma once
// The two spheres and the laws of docs/verification/steppers.md. Shared by the tests and by bench/charts/collision.cpp.

#include "../../bench/charts/collision_reference.hpp"

namespace collision_problem {

using namespace abrade;

inline Real sphere_mass(Real radius) { return 4.0 / 3 * pi * cube(radius) * 2650; }

inline Collision spheres(Real angle) {
    return {.radius_i = 0.02,
            .radius_j = 0.03,
            .mass_i = sphere_mass(0.02),
            .mass_j = sphere_mass(0.03),
            .speed = 1,
            .angle = angle};
}

inline LinearSpring linear(Real restitution, Real friction = 0.5, Real stiffness = 1e7) {
    return LinearSpring{{.stiffness = stiffness, .restitution = restitution, .friction = friction}};
}
inline HertzMindlin hertz(Real restitution, Real friction = 0.5) {
    return HertzMindlin{{.youngs = 1e9, .restitution = restitution, .friction = friction}};
}

}  // namespace collision_problem
