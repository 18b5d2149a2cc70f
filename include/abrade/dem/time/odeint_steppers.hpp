#pragma once
// Boost.Odeint's steppers for small systems with memory: to compare with, and for reference solutions. Not
// part of abrade.hpp, for they take long to compile (docs/verification/steppers.md); dem/time/stepper.hpp takes from
// odeint a tag only.

#include <abrade/dem/time/phase_point.hpp>
#include <abrade/dem/time/stepper.hpp>

#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/symplectic_euler.hpp>
// These two need what those above have included.
#include <boost/numeric/odeint/stepper/dense_output_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/symplectic_rkn_sb3a_m4_mclachlan.hpp>
#include <boost/numeric/odeint/stepper/velocity_verlet.hpp>

namespace abrade {

/// Each method: `Stepper<System, N> s(system, point); s.step(dt)` moves `point`, which it refers to, and
/// commits the memory of `system` once.
///
/// Our velocity Verlet (dem/time/stepper.hpp): the system is handed the velocity predicted for the time of
/// its positions, v + a dt/2, and the length of the step. 1 evaluation a step.
struct PredictingVerlet {
    static constexpr const char* name = "velocity Verlet";
    static constexpr int order = 2;

    template <class System, std::size_t N>
    requires TrialSystem<System, N>
    class Stepper {
    public:
        Stepper(System& system, PhasePoint<N>& point) : system_(system), moving_{point, {}} {
            moving_.acceleration = system.acceleration(point.position, point.velocity);
            system.commit();
        }
        void step(Real dt) {
            stepper_.do_step(
                [this](Moving& m, Real, Real length) {
                    auto predicted = m.point.velocity;
                    for (std::size_t k = 0; k < N; ++k) predicted[k] += 0.5 * length * m.acceleration[k];
                    m.acceleration = system_.acceleration_after(length, m.point.position, predicted);
                    system_.commit();
                },
                moving_, 0, dt);
        }

    private:
        struct Moving {
            PhasePoint<N>& point;
            std::array<Real, N> acceleration;
            friend void kick(Moving& m, Real dt) {
                for (std::size_t k = 0; k < N; ++k) m.point.velocity[k] += dt * m.acceleration[k];
            }
            friend void drift(Moving& m, Real dt) {
                for (std::size_t k = 0; k < N; ++k) m.point.position[k] += dt * m.point.velocity[k];
            }
        };
        System& system_;
        Moving moving_;
        VelocityVerlet<Moving> stepper_;
    };
};

/// odeint's own velocity Verlet. It hands the forces the velocity of the step before; that is all that sets
/// it apart from ours on a system that takes no notice of dt. 1 evaluation a step.
struct LaggedVerlet {
    static constexpr const char* name = "Verlet, lagged velocity";
    static constexpr int order = 2;

    template <class System, std::size_t N>
    requires TrialSystem<System, N>
    class Stepper {
    public:
        Stepper(System& system, PhasePoint<N>& point) : system_(system), point_(point) {
            acceleration_ = system.acceleration(point.position, point.velocity);
            system.commit();
        }
        void step(Real dt) {
            const auto forces = [&](const Vector& x, const Vector& v, Vector& a, Real) {
                a = system_.acceleration_after(dt, x, v);
            };
            const Vector x = point_.position, v = point_.velocity, a = acceleration_;
            stepper_.do_step(forces, x, v, a, point_.position, point_.velocity, acceleration_, 0.0, dt);
            system_.commit();
        }

    private:
        using Vector = std::array<Real, N>;
        System& system_;
        PhasePoint<N>& point_;
        Vector acceleration_;
        boost::numeric::odeint::velocity_verlet<Vector> stepper_;
    };
};

namespace detail {

/// odeint's symplectic steppers hand the forces positions only. Forces that depend on velocities, too, are
/// given those of the stage, before its kick: exact splitting, and so the order, holds for forces of
/// positions only.
template <template <std::size_t> class Scheme>
struct SymplecticStages {
    template <class System, std::size_t N>
    requires TrialSystem<System, N>
    class Stepper {
    public:
        Stepper(System& system, PhasePoint<N>& point) : system_(system), point_(point) {
            system.acceleration(point.position, point.velocity);
            system.commit();
        }
        void step(Real dt) {
            const auto forces = [this](const Vector& x, Vector& a) {
                a = system_.acceleration(x, point_.velocity);
            };
            stepper_.do_step(forces, point_.position, point_.velocity, 0.0, dt);
            system_.commit();  // the last stage stands where the step ends
        }

    private:
        using Vector = std::array<Real, N>;
        System& system_;
        PhasePoint<N>& point_;
        Scheme<N> stepper_;
    };
};

template <std::size_t N>
using EulerScheme = boost::numeric::odeint::symplectic_euler<std::array<Real, N>>;
template <std::size_t N>
using McLachlanScheme = boost::numeric::odeint::symplectic_rkn_sb3a_m4_mclachlan<std::array<Real, N>>;

template <std::size_t N>
class ForestRuthScheme
    : public boost::numeric::odeint::symplectic_nystroem_stepper_base<
          4, 4, std::array<Real, N>, std::array<Real, N>, Real, std::array<Real, N>, std::array<Real, N>,
          Real, boost::numeric::odeint::array_algebra, boost::numeric::odeint::default_operations,
          boost::numeric::odeint::initially_resizer> {
    using Base = typename ForestRuthScheme::internal_stepper_base_type;
    static constexpr Real theta = 1.3512071919596576340;  // 1 / (2 - 2^(1/3))

public:
    ForestRuthScheme()
        : Base({0.5 * theta, 0.5 * (1 - theta), 0.5 * (1 - theta), 0.5 * theta},
               {theta, 1 - 2 * theta, theta, 0}) {}
};

}  // namespace detail

/// x += v dt; v += a(x) dt, odeint's `symplectic_euler`. Order 1, 1 evaluation a step.
struct SymplecticEuler : detail::SymplecticStages<detail::EulerScheme> {
    static constexpr const char* name = "symplectic Euler";
    static constexpr int order = 1;
};

/// odeint's `symplectic_rkn_sb3a_m4_mclachlan`. Order 4, 5 evaluations a step. R. I. McLachlan, SIAM J. Sci.
/// Comput. 16 (1995) 151, doi:10.1137/0916010.
struct McLachlan4 : detail::SymplecticStages<detail::McLachlanScheme> {
    static constexpr const char* name = "symplectic, 4th order";
    static constexpr int order = 4;
};

/// Order 4, 3 evaluations a step and one to commit. E. Forest, R. D. Ruth, Physica D 43 (1990) 105,
/// doi:10.1016/0167-2789(90)90019-L.
struct ForestRuth : detail::SymplecticStages<detail::ForestRuthScheme> {
    static constexpr const char* name = "Forest-Ruth";
    static constexpr int order = 4;
};

/// The classical Runge-Kutta method. Order 4, 4 evaluations a step: the one that commits is the first of the
/// next step.
struct RungeKutta4 {
    static constexpr const char* name = "Runge-Kutta 4";
    static constexpr int order = 4;

    template <class System, std::size_t N>
    requires TrialSystem<System, N>
    class Stepper {
    public:
        Stepper(System& system, PhasePoint<N>& point) : system_(system), point_(point) {
            rate_ = rate(flat());
            system.commit();
        }
        void step(Real dt) {
            Flat state = flat();
            stepper_.do_step([this](const Flat& y, Flat& dydt, Real) { dydt = rate(y); }, state, rate_, 0.0,
                             dt);
            for (std::size_t k = 0; k < N; ++k)
                point_.position[k] = state[k], point_.velocity[k] = state[N + k];
            rate_ = rate(state);
            system_.commit();
        }

    private:
        using Flat = std::array<Real, 2 * N>;
        Flat flat() const {
            Flat y;
            for (std::size_t k = 0; k < N; ++k) y[k] = point_.position[k], y[N + k] = point_.velocity[k];
            return y;
        }
        Flat rate(const Flat& y) {
            std::array<Real, N> x, v;
            for (std::size_t k = 0; k < N; ++k) x[k] = y[k], v[k] = y[N + k];
            const auto a = system_.acceleration(x, v);
            Flat dydt;
            for (std::size_t k = 0; k < N; ++k) dydt[k] = v[k], dydt[N + k] = a[k];
            return dydt;
        }
        System& system_;
        PhasePoint<N>& point_;
        Flat rate_;
        boost::numeric::odeint::runge_kutta4<Flat> stepper_;
    };
};

/// Dormand-Prince 5(4), for smooth equations and reference solutions. J. R. Dormand, P. J. Prince, J. Comput.
/// Appl. Math. 6 (1980) 19, doi:10.1016/0771-050X(80)90013-3.
template <class State>
using DormandPrince = boost::numeric::odeint::runge_kutta_dopri5<State>;
/// The same with its step adapted, and dense output between steps, which is what events are found on.
template <class State>
using AdaptiveDormandPrince = boost::numeric::odeint::dense_output_runge_kutta<
    boost::numeric::odeint::controlled_runge_kutta<DormandPrince<State>>>;
/// One with these tolerances on the error of a step.
template <class State>
AdaptiveDormandPrince<State> adaptive_dormand_prince(Real absolute, Real relative) {
    using Checker = typename boost::numeric::odeint::controlled_runge_kutta<DormandPrince<State>>;
    return AdaptiveDormandPrince<State>(Checker(typename Checker::error_checker_type(absolute, relative)));
}

static_assert(Method<PredictingVerlet> && Method<LaggedVerlet> && Method<SymplecticEuler>);
static_assert(Method<McLachlan4> && Method<ForestRuth> && Method<RungeKutta4>);

}  // namespace abrade
