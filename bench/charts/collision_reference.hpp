#pragma once
// A collision as continuous-time equations, piecewise smooth, integrated from event to event: what the laws
// mean in the limit of small steps, written down a second time and without their code.

#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/time/collision.hpp>
#include <abrade/dem/time/odeint_steppers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace abrade::charts {

/// A law at one overlap: normal push [N], tangential stiffness [N/m], dashpots [N s/m], elastic energy of the
/// normal spring [J].
struct ContactPieces {
    Real push, stiffness, normal_dashpot, tangential_dashpot, held;
};

/// LinearSpring and HertzMindlin from their parameters alone:
///   f_n = push + c_n v_n, no tension unless the law has it;   L = mu max(f_n, 0)
///   f_t = -(k s + c_t v_t) cut off at +-L
///   ds/dt = v_t - s max(dk/dt, 0) / k (second term: HertzMindlin only) while k |s| < L or where that leads
///   inwards; else k |s| = L.
class ContinuousLaw {
public:
    ContinuousLaw(const LinearSpring& law, const Collision& c)
        : friction_(law.params().friction), mass_(c.effective_mass()),
          zeta_(damping_ratio_without_tension(law.params().restitution)), kn_(law.params().stiffness),
          kt_(kn_ * law.params().tangential_ratio) {}
    ContinuousLaw(const HertzMindlin& law, const Collision& c)
        : friction_(law.params().friction), mass_(c.effective_mass()),
          zeta_(law.params().tension ? damping_ratio_with_tension(law.params().restitution)
                                     : damping_ratio_without_tension(law.params().restitution)),
          root_radius_(std::sqrt(c.effective_radius())), tension_(law.params().tension) {
        const auto& p = law.params();
        const bool same = p.youngs_other == 0;
        const Real e2 = same ? p.youngs : p.youngs_other, nu2 = same ? p.poisson : p.poisson_other;
        const auto shear = [](Real e, Real nu) { return e / (2 * (1 + nu)); };
        youngs_ = 1 / ((1 - square(p.poisson)) / p.youngs + (1 - square(nu2)) / e2);
        shear_ = 1 / ((2 - p.poisson) / shear(p.youngs, p.poisson) + (2 - nu2) / shear(e2, nu2));
    }

    ContactPieces at(Real overlap) const {
        if (root_radius_ == 0)
            return {kn_ * overlap, kt_, 2 * zeta_ * std::sqrt(kn_ * mass_),
                    2 * zeta_ * std::sqrt(kt_ * mass_), 0.5 * kn_ * square(overlap)};
        // A trial step may end beyond the end of the contact.
        const Real half_width = root_radius_ * std::sqrt(std::max(overlap, 1e-30));
        const Real sn = 2 * youngs_ * half_width, st = 8 * shear_ * half_width;
        const Real push = 4.0 / 3 * youngs_ * half_width * overlap;
        const Real c = 2 * std::sqrt(5.0 / 6) * zeta_;
        return {push, st, c * std::sqrt(sn * mass_), c * std::sqrt(st * mass_), 0.4 * push * overlap};
    }
    /// d ln(k) / d overlap, of a spring that keeps its force while it stiffens [1/m].
    Real stiffening(Real overlap) const { return root_radius_ == 0 ? 0 : 0.5 / overlap; }
    Real friction() const { return friction_; }
    bool damped() const { return zeta_ > 0; }
    bool tension() const { return tension_; }
    /// Duration of the contact without damping and friction [s].
    Real elastic_duration(Real normal_speed) const {
        if (root_radius_ == 0) return pi * std::sqrt(mass_ / kn_);
        return 2 * std::sqrt(pi) / 2.5 * std::tgamma(0.4) / std::tgamma(0.9) * elastic_overlap(normal_speed) /
               normal_speed;
    }
    /// Greatest overlap without damping [m].
    Real elastic_overlap(Real normal_speed) const {
        if (root_radius_ == 0) return normal_speed * std::sqrt(mass_ / kn_);
        return std::pow(15 * mass_ * square(normal_speed) / (16 * youngs_ * root_radius_), 0.4);
    }

private:
    Real friction_ = 0, mass_ = 0, zeta_ = 0, kn_ = 0, kt_ = 0, youngs_ = 0, shear_ = 0, root_radius_ = 0;
    bool tension_ = false;
};

struct ReferenceResult {
    Real lost_normal = 0, lost_tangential = 0;  ///< works [J]
    Real dissipated_normal = 0;   ///< by the dashpot, and what the spring held when the contact ended [J]
    Real kinetic_lost = 0;        ///< by the velocities at the end [J]
    Real normal_speed = 0;        ///< where the force ends [m/s]
    Real tangential_speed = 0;    ///< of the centres [m/s]
    Real spin_i = 0, spin_j = 0;  ///< [rad/s]
    Real duration = 0;            ///< [s]
    Real deepest = 0, turning_force = 0;  ///< overlap, and normal force there [m], [N]
    long evaluations = 0;                 ///< of the equations
    int events = 0;                       ///< found, the end included

    Real lost() const { return lost_normal + lost_tangential; }
};

/// Dormand-Prince with adapted steps from one event to the next: turning point, slider and dashpot's limit
/// reached or left, end. Each event is found by bisection on the dense output; the step that leads to it is
/// then taken anew to its very time.
class ReferenceCollision {
public:
    template <class Law>
    ReferenceCollision(const Law& law, const Collision& collision)
        : law_(law, collision), c_(collision), mass_(collision.effective_mass()) {
        collision.validate();
        time_ = law_.elastic_duration(c_.normal_speed());
        const Real v = c_.speed, length = v * time_, energy = mass_ * square(v);
        scale_ = {length, v, v, v / c_.radius_i, v / c_.radius_j, length, energy, energy, energy};
    }

    const ContinuousLaw& law() const { return law_; }

    ReferenceResult solve(Real tolerance = 1e-13) {
        // The force may start like t^(1/4): the first steps are tiny. What comes before them is left out.
        const Real start = std::clamp(1e-2 * tolerance, 1e-12, 1e-4);
        mode_ = {};
        evaluations_ = 0;
        State y{};
        const Real slip = c_.tangential_speed() - c_.radius_i * c_.spin_i - c_.radius_j * c_.spin_j;
        y[overlap] = c_.normal_speed() * start * time_ / scale_[overlap];
        y[approach] = c_.normal_speed() / scale_[approach];
        y[across] = c_.tangential_speed() / scale_[across];
        y[turn_i] = c_.spin_i / scale_[turn_i];
        y[turn_j] = c_.spin_j / scale_[turn_j];
        y[spring] = slip * start * time_ / scale_[spring] / (law_.stiffening(1) > 0 ? 1.5 : 1);
        settle(y);
        y = projected(y);

        ReferenceResult result;
        auto stepper = adaptive_dormand_prince<State>(1e-2 * tolerance, tolerance);
        const auto rate = [this](const State& s, State& out, Real) { out = derivative(s); };
        Real t = start, dt = start;
        stepper.initialize(y, t, dt);
        for (int steps = 0; steps < 1'000'000; ++steps) {
            stepper.do_step(rate);
            const Real t0 = stepper.previous_time(), t1 = stepper.current_time();
            const auto state_at = [&](Real time) {
                State s;
                stepper.calc_state(time, s);
                return s;
            };
            // Four looks into a step: what comes and goes between them lies within the tolerance of a step.
            Real good = t0, bad = -1;
            for (int part = 1; part <= 4 && bad < 0; ++part) {
                const Real time = part == 4 ? t1 : t0 + 0.25 * part * (t1 - t0);
                (worst(state_at(time)).value < -noise ? bad : good) = time;
            }
            if (bad < 0) continue;
            for (int n = 0; n < 60 && bad - good > 1e-15 * bad; ++n) {
                const Real middle = 0.5 * (good + bad);
                (worst(state_at(middle)).value < -noise ? bad : good) = middle;
            }
            const int which = worst(state_at(bad)).which;
            State before = stepper.previous_state(), at_event;
            DormandPrince<State> one;
            one.do_step(rate, before, t0, at_event, bad - t0);
            y = projected(at_event);
            t = bad;
            ++result.events;
            if (which == force_ends || which == overlap_ends) break;
            if (which == turns) {
                result.deepest = y[overlap] * scale_[overlap];
                result.turning_force = pieces(y).normal;
            }
            change(which, y);
            settle(y);
            y = projected(y);
            stepper.initialize(y, t, std::min(stepper.current_time_step(), 1e-3));
        }
        const auto si = [&](Component k) { return y[k] * scale_[k]; };
        result.lost_normal = si(work_normal);
        result.lost_tangential = si(work_tangential);
        result.dissipated_normal = si(dissipated) + (si(overlap) > 0 ? law_.at(si(overlap)).held : 0.0);
        // Where the force ends before the overlap does, they fly on until their surfaces part.
        const Real reach = c_.radius_i + c_.radius_j, distance = reach - si(overlap);
        const Real out = -si(approach), along = si(across), v2 = square(out) + square(along);
        const Real p = distance * out, gap2 = square(reach) - square(distance);
        result.normal_speed = std::sqrt(square(p) + v2 * gap2) / reach;
        result.tangential_speed = along * distance / reach;
        result.spin_i = si(turn_i);
        result.spin_j = si(turn_j);
        result.kinetic_lost =
            c_.brought() - 0.5 * (mass_ * (square(si(approach)) + square(si(across))) +
                                  c_.inertia_i() * square(si(turn_i)) + c_.inertia_j() * square(si(turn_j)));
        result.duration = t * time_;
        result.evaluations = evaluations_;
        return result;
    }

private:
    /// In units of speed, elastic duration, and mass: of order 1.
    enum Component {
        overlap,
        approach,
        across,
        turn_i,
        turn_j,
        spring,
        work_normal,
        work_tangential,
        dissipated
    };
    using State = std::array<Real, 9>;

    /// Which of the smooth pieces. `slider`: 0 the spring follows the slip, +-1 it is held at the limit.
    /// `cut`: 0 spring and dashpot act in full, +-1 their sum is cut off at the limit.
    struct Mode {
        int slider = 0, cut = 0;
        bool loading = true;
    };
    /// Each is > 0 inside a piece.
    enum Indicator {
        force_ends,
        overlap_ends,
        turns,
        limit_above,
        limit_below,
        leaves,
        cut_above,
        cut_below,
        count
    };
    using Indicators = std::array<Real, count>;
    struct Worst {
        Real value;
        int which;
    };
    struct Pieces {
        ContactPieces law;
        Real normal, limit, slip, arm_i, arm_j, distance;  ///< SI
    };

    static constexpr Real noise = 1e-11;
    static constexpr Real never = 1;

    Pieces pieces(const State& y) const {
        Pieces p;
        const Real d = y[overlap] * scale_[overlap], a = y[approach] * scale_[approach];
        p.law = law_.at(d);
        p.normal = p.law.push + p.law.normal_dashpot * a;
        p.limit = law_.friction() * p.normal;
        p.distance = c_.radius_i + c_.radius_j - d;
        p.arm_i = c_.radius_i * p.distance / (c_.radius_i + c_.radius_j);
        p.arm_j = p.distance - p.arm_i;
        p.slip = y[across] * scale_[across] - p.arm_i * y[turn_i] * scale_[turn_i] -
                 p.arm_j * y[turn_j] * scale_[turn_j];
        return p;
    }
    Real spring_of(const State& y, const Pieces& p) const {
        return mode_.slider == 0 ? y[spring] * scale_[spring] : mode_.slider * p.limit / p.law.stiffness;
    }
    /// Of the spring, where it follows the slip [m/s].
    Real elastic_rate(const State& y, const Pieces& p) const {
        const Real a = y[approach] * scale_[approach];
        return p.slip - spring_of(y, p) * std::max(a, 0.0) * law_.stiffening(y[overlap] * scale_[overlap]);
    }
    State projected(State y) const {
        y[spring] = spring_of(y, pieces(y)) / scale_[spring];
        return y;
    }

    State derivative(const State& y) {
        ++evaluations_;
        return rate_of(y);
    }
    State rate_of(const State& y) const {
        const Pieces p = pieces(y);
        const Real s = spring_of(y, p), a = y[approach] * scale_[approach], v = y[across] * scale_[across];
        const Real along = mode_.cut != 0 ? -mode_.cut * p.limit
                                          : -(p.law.stiffness * s + p.law.tangential_dashpot * p.slip);
        State rate{};
        rate[overlap] = a;
        rate[approach] = -p.normal / mass_ - square(v) / p.distance;
        rate[across] = along / mass_ + a * v / p.distance;
        rate[turn_i] = -p.arm_i * along / c_.inertia_i();
        rate[turn_j] = -p.arm_j * along / c_.inertia_j();
        rate[spring] = mode_.slider == 0 ? elastic_rate(y, p) : 0;
        rate[work_normal] = p.normal * a;
        rate[work_tangential] = -along * p.slip;
        rate[dissipated] = p.law.normal_dashpot * square(a);
        for (std::size_t k = 0; k < rate.size(); ++k) rate[k] *= time_ / scale_[k];
        return rate;
    }
    State moved(State y, const State& rate, Real dt) const {
        for (std::size_t k = 0; k < y.size(); ++k) y[k] += dt * rate[k];
        return y;
    }
    /// A time over which the state hardly changes.
    Real small(const State& y, Real at_most) const {
        return std::min(at_most, 0.1 * y[overlap] / std::max(std::abs(y[approach]), 1e-30));
    }

    Indicators indicators(const State& y) const {
        Indicators g;
        g.fill(never);
        const Pieces p = pieces(y);
        const Real force = mass_ * c_.speed / time_, s = spring_of(y, p), pull = p.law.stiffness * s;
        if (!law_.tension()) g[force_ends] = p.normal / force;
        g[overlap_ends] = y[overlap];
        if (mode_.loading) g[turns] = y[approach];
        const Real limit = std::max(p.limit, 0.0) / force;
        const Real full = (pull + p.law.tangential_dashpot * p.slip) / force;
        if (mode_.slider == 0) {
            g[limit_above] = limit - pull / force;
            g[limit_below] = limit + pull / force;
        } else {
            const State rate = rate_of(y);
            const Real dt = small(y, 1e-5);
            const auto held = [&](const State& at) {
                const Pieces q = pieces(at);
                return q.limit / q.law.stiffness;
            };
            const Real limit_rate = (held(moved(y, rate, dt)) - held(moved(y, rate, -dt))) / (2 * dt * time_);
            g[leaves] = (mode_.slider * elastic_rate(y, p) - limit_rate) / c_.speed;
        }
        if (!law_.damped() || law_.friction() == 0) return g;
        if (mode_.slider != 0 && mode_.cut == mode_.slider) {
            g[mode_.slider > 0 ? cut_above : cut_below] = mode_.slider * p.slip / c_.speed;
        } else if (mode_.cut != 0) {
            g[mode_.cut > 0 ? cut_above : cut_below] = mode_.cut * full - limit;
        } else if (mode_.slider != 0) {
            // At the limit the spring alone fills it: in full only while the dashpot works against the
            // spring.
            g[mode_.slider > 0 ? cut_above : cut_below] = -mode_.slider * p.slip / c_.speed;
            g[mode_.slider > 0 ? cut_below : cut_above] = limit + mode_.slider * full;
        } else {
            g[cut_above] = limit - full;
            g[cut_below] = limit + full;
        }
        return g;
    }
    Worst worst(const State& y) const {
        const Indicators g = indicators(y);
        const auto least = std::min_element(g.begin(), g.end());
        return {*least, static_cast<int>(least - g.begin())};
    }

    void change(int which, const State& y) {
        const Real slip = pieces(y).slip;
        const bool damped = law_.damped();
        switch (which) {
            case turns:
                mode_.loading = false;
                break;
            case limit_above:
            case limit_below:
                mode_.slider = which == limit_above ? 1 : -1;
                mode_.cut = damped && mode_.slider * slip > 0 ? mode_.slider : 0;
                break;
            case leaves:
                mode_.cut = damped && mode_.slider * slip > 0 ? mode_.slider : 0;
                mode_.slider = 0;
                break;
            default:
                mode_.cut = mode_.cut != 0 ? 0 : which == cut_above ? 1 : -1;
        }
    }
    /// After an event more than one piece may have ended: looks a little ahead.
    void settle(const State& y) {
        for (int n = 0; n < 4; ++n) {
            const State start = projected(y);
            const State ahead = moved(start, rate_of(start), small(start, 1e-6));
            const Worst g = worst(ahead);
            if (g.value > -1e-15 || g.which == force_ends || g.which == overlap_ends || g.which == turns)
                return;
            change(g.which, ahead);
        }
    }

    ContinuousLaw law_;
    Collision c_;
    Real mass_, time_ = 0;
    State scale_{};
    Mode mode_;
    long evaluations_ = 0;
};

}  // namespace abrade::charts
