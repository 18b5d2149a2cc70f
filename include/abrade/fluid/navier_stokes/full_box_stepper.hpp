#pragma once
// A step of water that fills its box.

#include <abrade/fluid/embedded_boundary/wall_friction.hpp>
#include <abrade/fluid/navier_stokes/flow_fields.hpp>
#include <abrade/fluid/navier_stokes/initial_condition.hpp>

#include <utility>

namespace abrade::detail {

/// Heun's method with one projection a step; the pressure of the step before goes into both stages:
///   u* = u + dt R(u, p),  u** = (u + u* + dt R(u*, p)) / 2,  u' = u** - dt/rho grad p',  div u' = 0,
/// R advection, friction, gravity and the old pressure's push, p' what the pressure grows by.
template <int Dim, FlowOptions Options>
class FullBoxStepper {
    using Flow = FlowFields<Dim, Options>;
    using Velocity = typename Flow::Velocity;
    using Solids = typename Flow::Solids;

public:
    explicit FullBoxStepper(Flow& flow)
        : friction_(*flow.grid, flow.params.boundaries, friction_of_sides(flow.params.wall_law), nullptr) {
        refuse_in_full_box(flow.params);
    }

    // All cells are full.
    static const WetRows<Dim>* rows() noexcept { return nullptr; }
    static const Field<Real>* liquid_fraction() noexcept { return nullptr; }
    /// Before the last step [m/s].
    const Velocity& velocity_before() const noexcept { return velocity_before_; }

    /// Once the flow has the velocity of its start: makes it one.
    void begin(Flow& flow) {
        flow.build_forcing(nullptr);
        if (flow.params.velocity) flow.free_of_divergence(1e-12);
        fill_ghosts(flow, flow.velocity);
        velocity_before_ = flow.velocity;
    }
    /// The pressure that bodies feel first.
    void begin_pressure(Flow& flow) {
        if constexpr (Solids::present) {
            mixture_ = flow.stage;
            find_pressure_of_weight(flow, 1e-12);
        }
    }

    void step(Flow& flow, Real dt) {
        const Point<Dim> falls = flow.params.acceleration(flow.time + 0.5 * dt);
        if (!flow.params.steady_boundaries) flow.boundaries.set_time(flow.time + dt);
        pressure_before_ = flow.pressure;  // the velocity is kept by the second stage
        const Field<Real>* const sources = find_sources(flow, dt);  // first, since they may be no number
        place_solids(flow);
        predict(flow, dt, falls);
        push_solids(flow, dt, falls);
        flow.project({dt, flow.params.tolerance, false, sources, flow.history.relaxation_time(dt)});
        if constexpr (Solids::present) flow.solids.settle(flow.velocity, flow.pressure);
        fill_ghosts(flow, flow.velocity);
        if (flow.history.is_sub_step(dt))
            flow.pressure = pressure_before_;  // what pushes so briefly is none to go on with
    }

    void took(Flow&) noexcept {}
    /// After a step that threw: nothing has changed by then but sides.
    void take_back(Flow& flow) { flow.boundaries.back(flow.velocity); }
    /// After one that was taken, and is wrong.
    void restore(Flow& flow) {
        std::swap(flow.velocity, velocity_before_), std::swap(flow.pressure, pressure_before_);
        flow.boundaries.back(flow.velocity);
    }

    typename Flow::Account::View energy_view(const Flow& flow) const {
        typename Flow::Account::View view{.grid = *flow.grid,
                                          .params = flow.params,
                                          .friction = friction_,
                                          .faces = flow.projection.faces(),
                                          .before = velocity_before_,
                                          .stage = flow.stage,
                                          .velocity = flow.velocity,
                                          .pressure = flow.pressure,
                                          .time = flow.time,
                                          .eddies = flow.eddy_viscosity()};
        flow.add_forcing(view), flow.add_solids(view, nullptr);
        if constexpr (Solids::present) view.advecting_flux = &mixture_;
        return view;
    }
    /// The velocity by which the water came to where it is, ghosts filled [m/s].
    Velocity velocity_that_carried(const Flow& flow) const { return flow.velocity; }

    static void fields(auto&& field) { field("velocity_before", "m/s", &FullBoxStepper::velocity_before_); }
    void restored(Flow&) const noexcept {}

private:
    /// Where they are logarithmic; no-slip sides are the ghosts' business.
    static WallLaw friction_of_sides(const WallLaw& law) {
        return law.kind == WallLaw::Kind::logarithmic ? law : WallLaw{WallLaw::Kind::slip};
    }

    static void fill_ghosts(const Flow& flow, Velocity& u) { flow.boundaries.fill(u, nullptr); }

    /// The pressure that holds the water's weight, as if solids were water.
    void find_pressure_of_weight(Flow& flow, Real tolerance) {
        flow.pressure.fill(0);
        for (auto& component : flow.stage) component.fill(0);
        const Point<Dim> falls = flow.params.acceleration(flow.time);
        if (falls.isZero()) return;
        flow.let_all_fall(falls);
        flow.projection.project(flow.stage, flow.pressure, {1, tolerance});
        fill_ghosts(flow, flow.stage);
    }

    void place_solids(Flow& flow) {
        if constexpr (Solids::present) {
            mix(flow, flow.velocity, [&] { flow.solids.mix_last(mixture_); });
            flow.solids.place(*flow.grid, flow.params.boundaries, std::exchange(flow.arriving, {}), nullptr,
                              flow.params.density);
            flow.projection.fill_box(flow.solids);
        }
    }

    /// Both stages: all but the new pressure. The second takes half of what friction took from the first.
    void predict(Flow& flow, Real dt, const Point<Dim>& falls) {
        flow.boundaries.fill_cells(flow.pressure);
        stage(flow, {flow.velocity, flow.stage, 0, dt, falls});
        if (!friction_.empty() || Flow::has_forcing) flow.boundaries.join(flow.stage);
        const auto taken = friction_.apply(flow.stage, nullptr, dt, flow.nu());
        if (flow.energy) flow.energy->walls_took(taken);
        if constexpr (Solids::present) flow.solids.slow(flow.stage, {.dt = dt, .viscosity = flow.nu()});
        flow.force_stage(dt, flow.time + 0.5 * dt, nullptr);
        flow.boundaries.fill(flow.stage);
        stage(flow, {flow.stage, velocity_before_, 0.5, dt, falls});
        friction_.take(velocity_before_, nullptr, taken, 0.5);
        if constexpr (Solids::present) flow.solids.give_back(velocity_before_, 0.5);
        flow.force_second_stage(velocity_before_);
        std::swap(flow.velocity, velocity_before_);
        if (!flow.params.steady_boundaries) flow.boundaries.fill(flow.velocity);
    }

    struct StageOf {
        Velocity &by, &result;
        Real kept, dt;
        const Point<Dim>& falls;
    };
    void stage(Flow& flow, const StageOf& s) {
        const Velocity* advecting_flux = &s.by;
        if constexpr (Solids::present) {
            if (s.kept > 0) mix(flow, s.by, [&] { flow.solids.mix(mixture_); });
            advecting_flux = &mixture_;
        }
        typename Flow::Stage momentum{s.by, *advecting_flux, flow.velocity,        s.result,  flow.pressure,
                                      s.dt, s.kept,          -s.dt * (1 - s.kept), flow.nu(), s.falls};
        flow.advance(flow.projection.faces(), momentum);
        flow.boundaries.leave(s.result);
    }

    /// What the pressure is to drive out of cells; none: nothing.
    const Field<Real>* find_sources([[maybe_unused]] Flow& flow, [[maybe_unused]] Real dt) {
        if constexpr (Flow::has_sources) {
            if (sources_.size() == 0) sources_ = Field<Real>(flow.layout().total);
            const Real within = std::max(dt, flow.history.relaxation_time(dt));
            for (CellSource& s : flow.forced->find_sources(flow.forcing, flow.time + dt)) {
                s.volume = s.rate * dt * flow.grid->volume(flow.layout().number(s.cell));
                sources_[s.cell] = s.rate * within;
            }
            flow.forced->know_taken(*flow.grid, nullptr, dt);
            return &sources_;
        }
        return nullptr;
    }

    /// The advecting velocity of water and solids, from the water's.
    void mix(Flow& flow, const Velocity& u, auto&& with_solids) {
        flow.boundaries.copy(u, mixture_, nullptr);
        with_solids();
        flow.boundaries.fill(mixture_, nullptr);
    }

    void push_solids([[maybe_unused]] Flow& flow, [[maybe_unused]] Real dt,
                     [[maybe_unused]] const Point<Dim>& falls) {
        if constexpr (Solids::present)
            flow.solids.force(flow.velocity, flow.pressure,
                              {.density = flow.params.density,
                               .dt = dt,
                               .viscosity = flow.nu(),
                               .pushed = true,
                               .falls = falls,
                               .relaxation_time = flow.relaxation_time_of_solids(dt)});
    }

    WallFriction<Dim> friction_;  ///< of sides
    Velocity velocity_before_;
    Field<typename Flow::Number> pressure_before_;
    std::conditional_t<Flow::has_sources, Field<Real>, typename Flow::Nothing> sources_{};  ///< [-]
    std::conditional_t<Solids::present, Velocity, typename Flow::Nothing> mixture_{};       ///< at work
};

}  // namespace abrade::detail
