#pragma once
// What a step of GridFluid does, and what it goes back to where it goes wrong. Users include grid_fluid.hpp.

#include <abrade/fluid/navier_stokes/grid_fluid_class.hpp>
#include <abrade/fluid/navier_stokes/lost_bodies.hpp>

namespace abrade {

template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::step(Real dt) {
    require_positive(dt, "GridFluid.step: dt", "s");
    refuse_beyond_stable(dt);
    boundaries_.keep(velocity_);
    try {
        if constexpr (has_surface)
            step_below_surface(dt);
        else
            step_full(dt);
    } catch (const std::exception& wrong) {  // more than a cell would leave it, a given function fails
        take_back();
        throw FluidError(detail::place_in_time(steps_, time_, dt) + wrong.what());
    } catch (...) {
        take_back();
        throw;
    }
    check(dt);
    if (energy_) energy_->took(energy_view(), dt);
    find_eddies();
    time_ += dt, history_.took(dt);
    ++steps_;
    if constexpr (has_surface) backup_.took(), outflows_.took();
    if (!params_.steady_boundaries) enters_ = boundaries_.rate_of_inflow(velocity_);
    fastest_ = std::max(report_.courant / dt, enters_);
    if constexpr (has_surface) heights_.find(*grid_, water_->rows(), water_->liquid_fraction());
}

template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::advance(
    Real to_time, std::span<FlowBody> bodies) requires Solids::present {
    require_finite(to_time, "GridFluid.advance: to_time", "s");
    if (!(time_ < to_time)) return;
    detail::refuse_lost(*grid_, params_.boundaries, bodies, has_surface);
    std::vector<FlowBody> now(bodies.begin(), bodies.end());
    std::vector<Sphere> spheres;
    Real fastest = 0;  // one that had not been among the water may be faster than all in it
    for (const FlowBody& body : bodies) {
        spheres.insert(spheres.end(), body.spheres.begin(), body.spheres.end());
        fastest = std::max(fastest, body.velocity.norm());
    }
    const auto stand = [&](Real before) {  // where they were, that long before
        auto sphere = spheres.begin();
        for (std::size_t b = 0; b < now.size(); ++b) {
            const Vec3 back = -before * bodies[b].velocity;
            now[b].position = bodies[b].position + back;
            now[b].spheres = {sphere, bodies[b].spheres.size()};
            for (const Sphere& s : bodies[b].spheres) *sphere++ = {s.centre + back, s.radius};
        }
    };
    if constexpr (has_surface)
        if (steps_ == 0) {  // what stands in the water that was given
            stand(to_time - time_);
            solids_.place(*grid_, params_.boundaries, now, water_->aperture(), params_.density);
            water_->stand_solids(solids_.parts());
        }
    while (time_ < to_time) {
        const Real left = to_time - time_;
        const Real own = std::min(stable_step().seconds, step_of_body(fastest));
        const Real steps = std::max(std::ceil(left / own - 1e-9), 1.0), dt = left / steps;
        stand(left - dt);
        arriving_ = now;
        step(dt);
        for (std::size_t b = 0; b < now.size(); ++b) {
            const FlowBody& found = solids_.bodies()[b];
            now[b].velocity = found.velocity, now[b].angular_velocity = found.angular_velocity;
        }
        if (steps <= 1) time_ = to_time;
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        bodies[b].velocity = now[b].velocity, bodies[b].angular_velocity = now[b].angular_velocity;
        bodies[b].load = solids_.bodies()[b].load;
    }
}

template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::refuse_beyond_stable(Real dt) const {
    std::string cause;
    try {
        const FluidStep stable = stable_step();
        constexpr Real round_off = 1e-9;
        if (dt <= stable.seconds * (1 + round_off)) return;
        cause = "beyond stable_step(), which " + std::string(stable.limit) + " limits to " +
                short_text(stable.seconds) + " s; advance() takes as many steps as it needs";
    } catch (const std::exception& wrong) {  // a given function fails
        cause = wrong.what();
    }
    throw FluidError(detail::place_in_time(steps_, time_, dt) + cause);
}

template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::give_discharge() {
    if (params_.inflow_discharge == 0) return;
    const Real carried = detail::inflow_of(velocity_, params_.boundaries, water_->liquid(), water_->walls());
    require(carried > 0,
            {"GridFluid.boundary_velocity: what it carries in", "> 0 where inflow_discharge is given",
             Dim == 3 ? "m3/s" : "m2/s", "point it into the box"},
            carried);
    boundaries_.scale_inflow(params_.inflow_discharge / carried);
    boundaries_.fill(velocity_);
}

template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::free_of_divergence(Real tolerance) {
    Field<State> potential(layout().total);
    report_ = projection_.project(velocity_, potential, {1, tolerance});
    fastest_ = std::max(report_.courant, enters_);
    finish(velocity_);
}

/// The pressure that holds the water's weight: so the first step is none of falling. Leaves in `stage_`
/// how water at rest is accelerated [m/s2].
template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::find_pressure_of_weight(Real tolerance) {
    pressure_.fill(0);
    for (auto& component : stage_) component.fill(0);
    if constexpr (Solids::present && has_surface) water_->show(projection_);  // as if solids were water
    const Point<Dim> falls = params_.acceleration(time_);
    if (falls.isZero()) return;
    for (int a = 0; a < Dim; ++a) {
        stage_[a].fill(falls[a]);
        boundaries_.close(stage_[a], a);
    }
    if constexpr (has_surface) {
        water_->clear_walls(stage_);
        carry_weight(stage_, falls);
        outflows_.push(stage_, pressure_, projection_, {1, -falls[Dim - 1], true});
    }
    projection_.project(stage_, pressure_, {1, tolerance});
    if constexpr (has_surface) water_->clear_air(stage_);
    finish(stage_);
}

template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::step_full(Real dt) {
    const Point<Dim> falls = params_.acceleration(time_ + 0.5 * dt);
    if (!params_.steady_boundaries) boundaries_.set_time(time_ + dt);
    saved_pressure_ = pressure_;  // the velocity is kept by the second stage
    if constexpr (Solids::present) {
        mix(velocity_, [&] { solids_.mix_last(mixture_); });
        solids_.place(*grid_, params_.boundaries, std::exchange(arriving_, {}), nullptr, params_.density);
        projection_.fill_box(solids_);
    }
    boundaries_.fill_cells(pressure_);
    const auto stage = [&](const FaceField<Dim, State>& by, FaceField<Dim, State>& result, Real kept) {
        const FaceField<Dim, State>* advecting_flux = &by;
        if constexpr (Solids::present) {
            if (kept > 0) mix(by, [&] { solids_.mix(mixture_); });
            advecting_flux = &mixture_;
        }
        Stage s{by, *advecting_flux, velocity_, result, pressure_, dt, kept, -dt * (1 - kept), nu(), falls};
        advance(projection_.faces(), s);
        boundaries_.leave(result);
    };
    stage(velocity_, stage_, 0);
    if (!side_friction_.empty()) boundaries_.join(stage_);
    const auto taken = side_friction_.apply(stage_, nullptr, dt, nu());
    if (energy_) energy_->walls_took(taken);
    if constexpr (Solids::present) solids_.slow(stage_, {.dt = dt, .viscosity = nu()});
    boundaries_.fill(stage_);
    stage(stage_, saved_velocity_, 0.5);
    side_friction_.take(saved_velocity_, nullptr, taken, 0.5);
    if constexpr (Solids::present) solids_.give_back(saved_velocity_, 0.5);
    std::swap(velocity_, saved_velocity_);
    if (!params_.steady_boundaries) boundaries_.fill(velocity_);
    if constexpr (Solids::present)
        solids_.force(velocity_, pressure_,
                      {.density = params_.density,
                       .dt = dt,
                       .viscosity = nu(),
                       .pushed = true,
                       .falls = falls,
                       .relaxation_time = steps_ < 2 ? dt : history_.relaxation_time(dt)});
    project({dt, params_.tolerance, false, nullptr, history_.relaxation_time(dt)});
    if constexpr (Solids::present) solids_.settle(velocity_, pressure_);
    finish(velocity_);
    if (history_.is_sub_step(dt))
        pressure_ = saved_pressure_;  // what pushes so briefly is none to go on with
}

template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::step_below_surface(Real dt) {
    auto& water = *water_;
    if constexpr (Solids::present) {  // first, since a step that goes wrong takes it back
        solids_.place(*grid_, params_.boundaries, std::exchange(arriving_, {}), water.aperture(),
                      params_.density);
        water.set_solids(solids_.parts(), solids_.fluxes());
    }
    if (backup_.keep(velocity_, pressure_, water, history_, dt)) {
        finish(velocity_);
        bool can = true;
        while_seeping([&] { can = water.liquid().can_advance(velocity_, dt); });
        if (steps_ > 0 && !can)  // too long a first one is told
            backup_.stay(velocity_), finish(velocity_);
    }
    if (history_.grows(dt)) {
        find_pressure_of_weight(1e-3);
        backup_.add_excess(pressure_, history_.last / dt);
    }
    boundaries_.join(pressure_);
    while_seeping([&] { water.move(velocity_, dt); });
    if (energy_) energy_->liquid_moved(energy_view());
    // The velocity goes from half a step before the new surface to half a step behind it.
    const Point<Dim> falls = params_.acceleration(time_ + dt);
    const auto stage = [&](FaceField<Dim>& by, FaceField<Dim>& result, Real kept, Real push) {
        water.fill_closed(by);
        Stage s{by, water.advecting_flux(), velocity_, result, pressure_, dt, kept, push, nu(), falls};
        s.carried_in = dt, s.liquid_fraction_before = &water.liquid_fraction_before(),
        s.liquid_fraction = &water.liquid_fraction();
        s.aperture = water.aperture(), s.open_friction = water.open_friction();
        if constexpr (is_height) s.bounded_below = Liquid::bounded_below;
        s.surface_push = &water.surface_push(), s.wet = &water.wet();
        advance(water.faces(), s);
        water.clear_closed(by);
        for (const WaterFace& f : water.still()) result[f.axis][f.face] = 0;
        boundaries_.leave(result, water.aperture());
    };
    water.find_surface_push(projection_.open_faces(), pressure_, dt, falls);
    stage(velocity_, stage_, 0, -dt);
    water.extend(stage_);
    // The second stage takes the same: a steady flow feels just what drives it, whatever the step.
    const auto taken = water.slow(stage_, dt, nu());
    if constexpr (Solids::present)
        solids_.slow(stage_, {.dt = dt, .viscosity = nu(), .liquid_fraction = &water.liquid_fraction()});
    if (energy_) energy_->walls_took(taken);
    if (!params_.steady_boundaries) boundaries_.set_time(time_ + dt);
    boundaries_.fill(stage_, rows());
    if constexpr (Solids::present) {
        solids_.mix(stage_);
        boundaries_.enter(stage_);
        water.carry_by(stage_, dt);
        solids_.unmix(stage_);
    } else {
        water.carry_by(stage_, dt);
    }
    // The old pressure is taken back: below the new surface it pushes anew.
    stage(stage_, velocity_, 0.5, 0.5 * dt);
    water.clear_surface_push(projection_.open_faces());
    water.friction().take(velocity_, &water.rows(), taken, 0.5);
    if constexpr (Solids::present) solids_.give_back(velocity_, 0.5);
    water.let_go(velocity_);
    water.find(projection_, pressure_, solids_);
    water.load_masters(velocity_, backup_.wet());
    carry_weight(velocity_, dt * falls);
    for (const WaterFace& f : water.still()) velocity_[f.axis][f.face] = 0;
    outflows_.push(velocity_, pressure_, projection_, {dt, -falls[Dim - 1]});
    // Whole sides: where they change there may not have been water before.
    if (!params_.steady_boundaries) boundaries_.fill(velocity_);
    if constexpr (Solids::present)
        solids_.force(velocity_, pressure_,
                      {.density = params_.density,
                       .dt = dt,
                       .viscosity = nu(),
                       .liquid_fraction = &water.liquid_fraction(),
                       .falls = falls,
                       .relaxation_time = steps_ < 2 ? dt : history_.relaxation_time(dt)});
    project({dt, params_.tolerance, true, volume_defect(), history_.relaxation_time(dt)});
    if constexpr (is_height) detail::slow_thin_water(velocity_, water.liquid(), dt, nu());
    if constexpr (Solids::present) solids_.settle(velocity_, pressure_);
    finish(velocity_);
}

/// What is left beyond `most_left` is solved for once more: single precision may have lost its way.
template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::project(
    typename Projection<Dim, State>::Demand demand) {
    report_ = projection_.project(velocity_, pressure_, demand, solids_);
    if (report_.after <= most_left()) return;
    demand.push = false;
    const auto first = std::exchange(report_, projection_.project(velocity_, pressure_, demand, solids_));
    report_.iterations += first.iterations, report_.rounds += first.rounds;
}

/// Back to what a step that went wrong began with.
template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::restore() {
    if constexpr (has_surface) {
        if constexpr (Solids::present) water_->take_back_solids();
        backup_.restore(velocity_, pressure_, *water_);
        water_->find(projection_, pressure_);
    } else {
        std::swap(velocity_, saved_velocity_), std::swap(pressure_, saved_pressure_);
    }
    boundaries_.back(velocity_);
    if constexpr (has_surface) {
        finish(velocity_);  // what the step reached, too
        rows()->copy(backup_.velocity(), velocity_);
        boundaries_.fill(velocity_);
    }
}

template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::check(Real dt) {
    Real size = 0;
    for (int a = 0; a < Dim; ++a) size = std::max(size, grid_->largest(a));
    // Without a surface and an outflow the pressure is known but for a constant, and takes no volume.
    const bool found = report_.after <= most_left();
    const bool brimful = !found && (enters_ > 0 || has_surface) && projection_.multigrid().floating();
    // The bound is cheap, the speed itself is not.
    if (found && (report_.courant / dt * size <= params_.velocity_limit ||
                  detail::FastFace<Dim>(*grid_, velocity_).speed <= params_.velocity_limit))
        return;
    const std::string cause =
        brimful ? "more flows in than out, or solids take more room, and no surface is left to rise; make a "
                  "side that it reaches an outflow, or leave air above it"
                : detail::wrong_flow(*grid_, velocity_, report_.after, most_left(), enters_ > 0);
    restore();
    throw FluidError(detail::place_in_time(steps_, time_, dt) + cause);
}

template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::open_energy_account() {
    FaceField<Dim, State> before = velocity_;
    if constexpr (has_surface)
        if (steps_ > 0) rows()->copy(backup_.velocity(), before), boundaries_.fill(before);
    energy_.emplace(energy_view(), std::move(before));
}

template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
void GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::solids_took(
    Real work) requires Solids::present {
    const Real before = std::exchange(given_, work);
    if (energy_) energy_->solids_took(work - before);
}

template <int Dim, class Surface, AdvectionScheme Scheme, class State, TurbulenceModel Turbulence,
          SolidsInFlow Solids>
typename GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::EnergyAccount::View
GridFluid<Dim, Surface, Scheme, State, Turbulence, Solids>::energy_view() const {
    const Field<State>* eddies = nullptr;
    if constexpr (Turbulence::has_eddies) eddies = &eddies_->field();
    const auto with_solids = [&](typename EnergyAccount::View view) {
        if constexpr (Solids::present) {
            view.solids = solids_.volumes(false), view.new_solids = solids_.volumes(true);
            view.solid_fluxes = solids_.fluxes();
            if constexpr (!has_surface) view.advecting_flux = &mixture_;
            view.solid_friction = solids_.lost_to_friction();
            const Field<Real>* fraction = nullptr;
            if constexpr (has_surface) fraction = &water_->liquid().fraction();
            view.solid_moment = solids_.moment(*grid_, fraction, false);
            view.new_solid_moment = solids_.moment(*grid_, fraction, true);
        }
        return view;
    };
    if constexpr (has_surface) {
        const auto& water = *water_;
        return with_solids({.grid = *grid_,
                            .params = params_,
                            .friction = water.friction(),
                            .faces = water.faces(),
                            .before = backup_.velocity(),
                            .stage = stage_,
                            .velocity = velocity_,
                            .pressure = pressure_,
                            .time = time_,
                            .eddies = eddies,
                            .liquid = &water.liquid(),
                            .walls = water.walls(),
                            .rows = &water.rows(),
                            .liquid_fraction_before = &water.liquid_fraction_before(),
                            .liquid_fraction = &water.liquid_fraction(),
                            .wet = &water.wet(),
                            .open_friction = water.open_friction()});
    } else {
        return with_solids({.grid = *grid_,
                            .params = params_,
                            .friction = side_friction_,
                            .faces = projection_.faces(),
                            .before = saved_velocity_,
                            .stage = stage_,
                            .velocity = velocity_,
                            .pressure = pressure_,
                            .time = time_,
                            .eddies = eddies});
    }
}

static_assert(AdvancingFluid<GridFluid<2>> && AdvancingFluid<GridFluid<3>>);
static_assert(AccountsForEnergy<GridFluid<2>> && AccountsForEnergy<GridFluid<3, FullBox>>);
static_assert(AdvancingFluid<GridFluid<2, HeightSurface>> && AdvancingFluid<GridFluid<3, HeightSurface>>);

}  // namespace abrade
