// One collision alone, by our stepper and by odeint's.
#include "scene_list.hpp"

#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/dem/time/collision.hpp>
#include <abrade/dem/time/odeint_steppers.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

template <class Method>
Numbers oblique() {
    Numbers numbers;
    const HertzMindlin law{{.youngs = 1e8, .restitution = 0.7, .friction = 0.3}};
    for (const Real angle : {5.0, 30.0, 60.0}) {
        const auto found = collide<Method>(law,
                                           {.radius_i = 0.01,
                                            .radius_j = 0.015,
                                            .mass_i = 0.011,
                                            .mass_j = 0.037,
                                            .speed = 2,
                                            .angle = angle,
                                            .spin_i = 20},
                                           2e-6);
        numbers.kind("lost").add(found.lost_normal), numbers.add(found.lost_tangential);
        numbers.kind("speed").add(found.normal_speed), numbers.add(found.tangential_speed);
        numbers.kind("spin").add(found.spin_i), numbers.add(found.spin_j);
        numbers.kind("force").add(found.largest_force);
        numbers.kind("time").add(found.duration), numbers.add(static_cast<Real>(found.evaluations));
        numbers.figure("lost_tangential", found.lost_tangential);
    }
    return std::move(numbers).with({"lost_tangential"});
}

const Register ours{"steppers.verlet", oblique<PredictingVerlet>};
const Register lagged{"steppers.odeint_verlet", oblique<LaggedVerlet>};
const Register runge_kutta{"steppers.runge_kutta", oblique<RungeKutta4>};

}  // namespace
