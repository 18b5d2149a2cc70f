#pragma once
// A step of water below a surface.

#include <abrade/fluid/height/thin_water.hpp>
#include <abrade/fluid/navier_stokes/changed_boundary.hpp>
#include <abrade/fluid/navier_stokes/flow_fields.hpp>
#include <abrade/fluid/navier_stokes/outflows.hpp>
#include <abrade/fluid/navier_stokes/state_backup.hpp>
#include <abrade/fluid/navier_stokes/surface_heights.hpp>
#include <abrade/fluid/navier_stokes/surface_water.hpp>

#include <optional>
#include <utility>

namespace abrade::detail {

/// A step of dt: the liquid moves with the velocity (VolumeOfFluid or HeightOfFluid); momentum goes with the
/// same fluxes, in the two stages of Heun's method; the pressure is found below the new surface, where it is
/// 0 (F. Gibou et al., doi:10.1006/jcph.2001.6977); velocities are carried on outward. Liquid and velocity
/// leap over each other, the velocity half a step ahead, so waves do not decay by the time step.
template <int Dim, FlowOptions Options>
class FreeSurfaceStepper {
    using Flow = FlowFields<Dim, Options>;
    using Velocity = FaceField<Dim>;
    using Solids = typename Flow::Solids;
    using Liquid = typename Flow::Liquid;
    using Water = SurfaceWater<Dim, Liquid>;
    static constexpr bool is_height = Flow::is_height;
    static constexpr std::string_view step_cause = is_height ? "height of fluid" : "volume of fluid";

public:
    explicit FreeSurfaceStepper(Flow& flow) : water_(*flow.grid, flow.params) {
        check_inflows(flow.params, water_.liquid(), water_.walls());
        water_.find(flow.projection, flow.pressure);
        outflows_ = Outflows<Dim>(*flow.grid, flow.params);
        look_at_walls(flow);
    }

    const Liquid& liquid() const noexcept { return water_.liquid(); }
    const EmbeddedBoundary<Dim>* walls() const noexcept { return water_.walls(); }
    /// Rows that hold water, and liquid of whole cells [-].
    const WetRows<Dim>* rows() const noexcept { return &water_.rows(); }
    const Field<Real>* liquid_fraction() const noexcept { return &water_.liquid_fraction(); }
    const SurfaceHeights<Dim>& heights() const noexcept { return heights_; }
    const Velocity& velocity_before() const noexcept { return backup_.velocity(); }

    /// Once the flow has the velocity of its start: makes it one.
    void begin(Flow& flow) {
        give_discharge(flow);
        if (flow.params.velocity) flow.free_of_divergence(1e-12);
        extend(flow, flow.velocity);
        find_pressure_of_weight(flow, 1e-12);
        first_step_ = std::sqrt(2 * water_.liquid().stable_step(flow.stage));
    }
    /// Once all of the flow is there; `expected`: its first step [s].
    void begin_history(Flow& flow, Real expected) {
        backup_ = {*flow.grid, flow.velocity, flow.stage, water_};
        flow.history.expect(expected);
        find_heights(flow);
    }

    /// What the surface, and gravity before the first step, leave of a step.
    FluidStep limit(const Flow& flow, FluidStep step) const {
        step.lower(water_.liquid().stable_step(flow.velocity), step_cause);
        if (flow.steps == 0) step.lower(first_step_, step_cause);
        return step;
    }

    /// Solids that stand in the water as it was given.
    void stand_solids(Flow& flow, std::span<const FlowBody> bodies) {
        flow.solids.place(*flow.grid, flow.params.boundaries, bodies, water_.aperture(), flow.params.density);
        water_.stand_solids(flow.solids.parts());
    }

    void step(Flow& flow, Real dt) {
        place_solids(flow);  // first, since a step that goes wrong takes it back
        lead_velocity(flow, dt);
        move_liquid(flow, dt);
        predict(flow, dt);
        find_surface(flow, dt);
        push_solids(flow, dt);
        flow.project(
            {dt, flow.params.tolerance, true, volume_defect(flow, dt), flow.history.relaxation_time(dt)});
        if constexpr (is_height) slow_thin_water(flow.velocity, water_.liquid(), dt, flow.nu());
        if constexpr (Solids::present) flow.solids.settle(flow.velocity, flow.pressure);
        extend(flow, flow.velocity);
    }

    void took(Flow& flow) {
        backup_.took(), outflows_.took();
        find_heights(flow);
    }
    /// After a step that threw, and after one that was taken and is wrong.
    void take_back(Flow& flow) { restore(flow); }
    void restore(Flow& flow) {
        if constexpr (Solids::present) water_.take_back_solids();
        backup_.restore(flow.velocity, flow.pressure, water_);
        water_.find(flow.projection, flow.pressure);
        flow.boundaries.back(flow.velocity);
        extend(flow, flow.velocity);  // what the step reached, too
        water_.rows().copy(backup_.velocity(), flow.velocity);
        flow.boundaries.fill(flow.velocity);
    }

    /// Puts the wall of the flow's params in the place of the one that stands there, unless it is that, to
    /// the bit. Throws InputError where water has no room; then neither flow nor this is of any use.
    void change_walls(Flow& flow) {
        auto dry = flow.params;
        dry.water = {};
        Water before = std::exchange(water_, Water(*flow.grid, dry));
        if (water_.has_walls_of(before)) {
            water_ = std::move(before);
            return;
        }
        water_.find(flow.projection, flow.stage[0]);  // nowhere, so that nothing stays of the old
        ChangedBoundary<Dim, Liquid> change(before.liquid(), before.walls(), water_.walls(),
                                            flow.params.gravity);
        const auto [fraction, volume_defect] = change.run();
        water_.restore(fraction, volume_defect, WetRows<Dim>::whole(flow.layout()), before.liquid().steps());
        water_.make_room();
        check_inflows(flow.params, water_.liquid(), water_.walls());
        water_.find(flow.projection, flow.pressure);
        find_pressure_of_weight(flow, 1e-3);  // the old one knows nothing of where the surface is now
        if (flow.params.steady_boundaries) give_discharge(flow);
        flow.enters = flow.boundaries.rate_of_inflow(flow.velocity);
        look_at_walls(flow);
        find_heights(flow);
        extend(flow, flow.velocity);
        flow.free_of_divergence(1e-6);  // or the liquid would flow into the new walls
        extend(flow, flow.velocity);
        flow.find_eddies(rows(), liquid_fraction());
        flow.look_at_forcing();
        if (flow.energy) flow.energy->reshaped(energy_view(flow));
    }

    typename Flow::Account::View energy_view(const Flow& flow) const {
        typename Flow::Account::View view{.grid = *flow.grid,
                                          .params = flow.params,
                                          .friction = water_.friction(),
                                          .faces = water_.faces(),
                                          .before = backup_.velocity(),
                                          .stage = flow.stage,
                                          .velocity = flow.velocity,
                                          .pressure = flow.pressure,
                                          .time = flow.time,
                                          .eddies = flow.eddy_viscosity(),
                                          .liquid = &water_.liquid(),
                                          .flux = &water_.flux(),
                                          .walls = water_.walls(),
                                          .rows = &water_.rows(),
                                          .liquid_fraction_before = &water_.liquid_fraction_before(),
                                          .liquid_fraction = &water_.liquid_fraction(),
                                          .wet = &water_.wet(),
                                          .open_friction = water_.open_friction()};
        flow.add_forcing(view), flow.add_solids(view, &water_.liquid().fraction());
        return view;
    }
    /// The velocity by which the liquid came to where it is, ghosts filled [m/s].
    Velocity velocity_that_carried(const Flow& flow) const {
        Velocity before = flow.velocity;
        if (flow.steps > 0) water_.rows().copy(backup_.velocity(), before), flow.boundaries.fill(before);
        return before;
    }

    static void fields(auto&& field) {
        field("backup", &FreeSurfaceStepper::backup_), field("water", &FreeSurfaceStepper::water_);
        field("heights", &FreeSurfaceStepper::heights_), field("outflows", &FreeSurfaceStepper::outflows_);
        field("first_step", "s", &FreeSurfaceStepper::first_step_);
    }
    void restored(Flow& flow) const { water_.show(flow.projection); }

private:
    /// What the pressure is to drive out; none: nothing.
    const Field<Real>* volume_defect([[maybe_unused]] const Flow& flow, [[maybe_unused]] Real dt) {
        const Liquid& liquid = water_.liquid();
        if constexpr (is_height && Flow::has_sources) {  // columns have had theirs, cells are to drive it out
            sources_ = liquid.volume_defect();
            const Real within = std::max(dt, flow.history.relaxation_time(dt));
            for (const CellSource& s : flow.forced->sources())
                if (s.volume != 0) sources_[s.cell] += s.rate * within;
            return &sources_;
        }
        if constexpr (is_height)
            if (!liquid.has_volume_defect()) return nullptr;
        return &liquid.volume_defect();
    }

    /// Velocities of the air beside the water, ghosts.
    void extend(const Flow& flow, Velocity& u) {
        water_.extend(u);
        flow.boundaries.fill(u, rows());
    }

    /// What walls decide once, beside the water.
    void look_at_walls(Flow& flow) {
        heights_ = SurfaceHeights<Dim>(*flow.grid, flow.params.boundaries.periodic_axes(), water_.walls());
        flow.build_eddies(water_.walls());
        flow.build_forcing(water_.walls());
    }
    void find_heights(const Flow& flow) {
        heights_.find(*flow.grid, water_.rows(), water_.liquid_fraction());
    }

    /// Walls, and cells that are too small to stay open, take some of the faces that water comes through.
    void give_discharge(Flow& flow) {
        if (flow.params.inflow_discharge == 0) return;
        const Real carried =
            inflow_of(flow.velocity, flow.params.boundaries, water_.liquid(), water_.walls());
        require(carried > 0,
                {"GridFluid.boundary_velocity: what it carries in", "> 0 where inflow_discharge is given",
                 Dim == 3 ? "m3/s" : "m2/s", "point it into the box"},
                carried);
        flow.boundaries.scale_inflow(flow.params.inflow_discharge / carried);
        flow.boundaries.fill(flow.velocity);
    }

    /// The pressure that holds the water's weight: so the first step is none of falling. Leaves in `stage`
    /// how water at rest is accelerated [m/s2].
    void find_pressure_of_weight(Flow& flow, Real tolerance) {
        flow.pressure.fill(0);
        for (auto& component : flow.stage) component.fill(0);
        if constexpr (Solids::present) water_.show(flow.projection);  // as if solids were water
        const Point<Dim> falls = flow.params.acceleration(flow.time);
        if (falls.isZero()) return;
        flow.let_all_fall(falls);
        water_.clear_walls(flow.stage);
        carry_weight(flow, flow.stage, falls);
        outflows_.push(flow.stage, flow.pressure, flow.projection, {1, -falls[Dim - 1], true});
        flow.projection.project(flow.stage, flow.pressure, {1, tolerance});
        water_.clear_air(flow.stage);
        extend(flow, flow.stage);
    }

    /// Takes back from open faces the fall of what is not below the surface.
    static void carry_weight(const Flow& flow, Velocity& u, const Point<Dim>& fall) {
        for (const OpenFace& open : flow.projection.open_faces())
            u[open.axis][open.face] -= (1 - open.weight) * fall[open.axis];
    }

    void place_solids(Flow& flow) {
        if constexpr (Solids::present) {
            flow.solids.place(*flow.grid, flow.params.boundaries, std::exchange(flow.arriving, {}),
                              water_.aperture(), flow.params.density);
            water_.set_solids(flow.solids.parts(), flow.solids.fluxes());
        }
    }

    /// Keeps what there is, and moves the velocity on to where this step wants it.
    void lead_velocity(Flow& flow, Real dt) {
        if (backup_.keep_and_lead(flow.velocity, flow.pressure, water_, flow.history, dt)) {
            extend(flow, flow.velocity);
            bool can = true;
            while_superficial(flow, [&] { can = water_.liquid().can_advance(flow.velocity, dt); });
            if (flow.steps > 0 && !can)  // too long a first one is told
                backup_.stay(flow.velocity), extend(flow, flow.velocity);
        }
        if (flow.history.grows(dt)) {
            find_pressure_of_weight(flow, 1e-3);
            backup_.add_excess(flow.pressure, flow.history.last / dt);
        }
        flow.boundaries.join(flow.pressure);
    }

    void move_liquid(Flow& flow, Real dt) {
        std::span<CellSource> sources;
        if constexpr (Flow::has_sources) sources = flow.forced->find_sources(flow.forcing, flow.time + dt);
        while_superficial(flow, [&] { water_.move(flow.velocity, dt, sources); });
        if constexpr (Flow::has_sources) flow.forced->know_taken(*flow.grid, liquid_fraction(), dt);
        if (flow.energy) flow.energy->liquid_moved(energy_view(flow));
    }

    /// Both stages of momentum: all but the new pressure. The velocity goes from half a step before the new
    /// surface to half a step after it. The second stage takes half of what friction took from the first:
    /// a steady flow feels just what drives it, whatever the step.
    void predict(Flow& flow, Real dt) {
        falls_ = flow.params.acceleration(flow.time + dt);
        water_.find_surface_push(flow.projection.open_faces(), flow.pressure, dt, falls_);
        stage(flow, {flow.velocity, flow.stage, dt, 0, -dt});
        water_.extend(flow.stage);
        const auto taken = water_.slow(flow.stage, dt, flow.nu());
        if constexpr (Solids::present)
            flow.solids.slow(flow.stage,
                             {.dt = dt, .viscosity = flow.nu(), .liquid_fraction = liquid_fraction()});
        if constexpr (Flow::has_forcing)
            water_.of_its_own(flow.stage, [&] { flow.force_stage(dt, flow.time + dt, liquid_fraction()); });
        if (flow.energy) flow.energy->walls_took(taken);
        if (!flow.params.steady_boundaries) flow.boundaries.set_time(flow.time + dt);
        flow.boundaries.fill(flow.stage, rows());
        carry_by_stage(flow, dt);
        // The old pressure is taken back: below the new surface it pushes anew.
        stage(flow, {flow.stage, flow.velocity, dt, 0.5, 0.5 * dt});
        water_.clear_surface_push(flow.projection.open_faces());
        water_.friction().take(flow.velocity, &water_.rows(), taken, 0.5);
        if constexpr (Solids::present) flow.solids.give_back(flow.velocity, 0.5);
        flow.force_second_stage(flow.velocity);
        water_.let_go(flow.velocity);
    }

    struct StageOf {
        Velocity &by, &result;
        Real dt, kept, push;
    };
    void stage(Flow& flow, const StageOf& s) {
        water_.fill_closed(s.by);
        typename Flow::Stage momentum{s.by, water_.flux(), flow.velocity, s.result,  flow.pressure,
                                      s.dt, s.kept,        s.push,        flow.nu(), falls_};
        momentum.carried_in = s.dt, momentum.liquid_fraction_before = &water_.liquid_fraction_before(),
        momentum.liquid_fraction = &water_.liquid_fraction();
        momentum.aperture = water_.aperture(), momentum.open_friction = water_.open_friction();
        if constexpr (is_height) momentum.bounded_below = Liquid::bounded_below;
        momentum.surface_push = &water_.surface_push(), momentum.wet = &water_.wet();
        flow.advance(water_.faces(), momentum);
        water_.clear_closed(s.by);
        for (const WaterFace& f : water_.still()) s.result[f.axis][f.face] = 0;
        flow.boundaries.leave(s.result, water_.aperture());
    }

    /// The second stage's advecting flux, of water and solids.
    void carry_by_stage(Flow& flow, Real dt) {
        if constexpr (Solids::present) {
            flow.solids.mix(flow.stage);
            flow.boundaries.enter(flow.stage);
            water_.carry_by(flow.stage, dt);
            flow.solids.unmix(flow.stage);
        } else {
            water_.carry_by(flow.stage, dt);
        }
    }

    /// Which cells have a pressure below the new surface, and what faces at it have been given.
    void find_surface(Flow& flow, Real dt) {
        water_.find(flow.projection, flow.pressure, flow.solids);
        water_.load_masters(flow.velocity, backup_.wet());
        carry_weight(flow, flow.velocity, dt * falls_);
        for (const WaterFace& f : water_.still()) flow.velocity[f.axis][f.face] = 0;
        outflows_.push(flow.velocity, flow.pressure, flow.projection, {dt, -falls_[Dim - 1]});
        // Whole sides: where they change there may not have been water before.
        if (!flow.params.steady_boundaries) flow.boundaries.fill(flow.velocity);
    }

    void push_solids([[maybe_unused]] Flow& flow, [[maybe_unused]] Real dt) {
        if constexpr (Solids::present)
            flow.solids.force(flow.velocity, flow.pressure,
                              {.density = flow.params.density,
                               .dt = dt,
                               .viscosity = flow.nu(),
                               .liquid_fraction = liquid_fraction(),
                               .falls = falls_,
                               .relaxation_time = flow.relaxation_time_of_solids(dt)});
    }

    /// Calls use() while the velocity is what moves the water alone.
    void while_superficial([[maybe_unused]] Flow& flow, auto&& use) {
        if constexpr (Solids::present) {
            struct Back {  // a step that goes wrong takes it back, too
                Flow& flow;
                ~Back() { flow.solids.to_interstitial(flow.velocity), flow.boundaries.join(flow.velocity); }
            };
            flow.solids.to_superficial(flow.velocity);
            const Back back{flow};
            flow.boundaries.enter(flow.velocity), flow.boundaries.join(flow.velocity);
            use();
        } else {
            use();
        }
    }

    Water water_;
    StateBackup<Dim, Liquid> backup_;
    SurfaceHeights<Dim> heights_;
    Outflows<Dim> outflows_;
    std::conditional_t<is_height && Flow::has_sources, Field<Real>, typename Flow::Nothing>
        sources_{};                          ///< [-]
    Point<Dim> falls_ = Point<Dim>::Zero();  ///< acceleration by gravity and body force in the step [m/s2]
    Real first_step_ = 0;                    ///< in which what first moves it does not cross a cell [s]
};

}  // namespace abrade::detail
