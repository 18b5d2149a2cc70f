#pragma once
// Time stepping in Boost.Odeint's terms: of odeint only the tag. Its steppers are in
// dem/time/odeint_steppers.hpp.

#include <abrade/core/types.hpp>

#include <boost/numeric/odeint/stepper/stepper_categories.hpp>

#include <concepts>

namespace abrade {

/// What a state must offer: velocities that can be kicked by its forces, positions that can drift.
template <class S>
concept MechanicalState = requires(S& state, Real dt) {
    kick(state, dt);   // v += a dt, from the forces that the state holds
    drift(state, dt);  // x += v dt
};

/// Velocity Verlet as an odeint stepper: `do_step(system, state, t, dt)`, usable with `integrate_const`.
///
///   v += a dt/2;  x += v dt;  a = system(x, t + dt);  v += a dt/2
///
/// odeint's own `velocity_verlet` hands the force the velocity of the step before: dashpots and
/// tangential springs then act half a step late. Here `system(state, t, dt)` runs exactly once a step,
/// on a state that has drifted and knows its last acceleration, so it can predict v(t + dt) to second
/// order and commit the contact memory. Each half kick's work, f . (v_before + v_after)/2 dt/2, is
/// exactly the change in kinetic energy. L. Verlet, Phys. Rev. 159 (1967) 98, doi:10.1103/PhysRev.159.98;
/// W. C. Swope et al., J. Chem. Phys. 76 (1982) 637, doi:10.1063/1.442716.
template <MechanicalState State>
class VelocityVerlet {
public:
    using state_type = State;
    using deriv_type = State;
    using value_type = Real;
    using time_type = Real;
    using order_type = unsigned short;
    using stepper_category = boost::numeric::odeint::stepper_tag;

    order_type order() const noexcept { return 2; }

    template <std::invocable<State&, Real, Real> System>
    void do_step(System&& system, State& state, Real t, Real dt) {
        kick(state, 0.5 * dt);
        drift(state, dt);
        system(state, t + dt, dt);
        kick(state, 0.5 * dt);
    }
};

}  // namespace abrade
