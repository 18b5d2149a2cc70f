#pragma once
// Velocity and pressure of water on a grid, and what both ways of stepping do with them.

#include <abrade/fluid/energy/energy_account.hpp>
#include <abrade/fluid/fluid_model.hpp>
#include <abrade/fluid/height/height_of_fluid.hpp>
#include <abrade/fluid/momentum/eddy_viscosity.hpp>
#include <abrade/fluid/momentum/momentum.hpp>
#include <abrade/fluid/navier_stokes/flow_options.hpp>
#include <abrade/fluid/navier_stokes/step_history.hpp>
#include <abrade/fluid/pressure/projection.hpp>

#include <memory>
#include <optional>
#include <span>
#include <utility>

namespace abrade::detail {

/// What of a Forcing a flow keeps.
template <int Dim, class F>
struct AppliedOf {
    using type = std::optional<AppliedForcing<Dim, F>>;
};
template <int Dim>
struct AppliedOf<Dim, NoForcing> {
    struct type {};
};

/// What lasts from step to step, whatever fills the box. `stage` is the velocity after a step's first stage.
template <int Dim, FlowOptions Options>
struct FlowFields {
    using Number = typename Options::Number;
    using Scheme = typename Options::Scheme;
    using Turbulence = typename Options::Turbulence;
    using Solids = typename Options::Solids;
    using Forcing = typename Options::Forcing;
    using Params = GridFluidParams<Dim>;
    using Velocity = FaceField<Dim, Number>;
    using Stage = MomentumStage<Dim, Number>;
    static constexpr bool is_height = Options::surface == SurfaceKind::height;
    using Liquid = std::conditional_t<is_height, HeightOfFluid<Dim>, VolumeOfFluid<Dim>>;
    using Account = EnergyAccount<Dim, Number, Scheme, Liquid>;
    using Eddies = EddyViscosity<Dim, Number, Turbulence>;
    using Projects = Projection<Dim, Number, typename Options::template Pressure<Dim>>;
    struct Nothing {};
    static constexpr bool has_forcing = !std::same_as<Forcing, NoForcing>;
    static constexpr bool has_sources = HasSource<Forcing, Dim>;

    FlowFields(Params asked, Turbulence model, Solids among, Forcing acts)
        : params((asked.validate(), std::move(asked))), turbulence(std::move(model)),
          solids(std::move(among)), forcing(std::move(acts)),
          grid(std::make_shared<const Grid<Dim>>(params.grid)),
          boundaries(*grid, with_free_slip(params.boundaries, params.wall_law), params.boundary_velocity,
                     params.start_time),
          projection(*grid, params.boundaries), velocity(face_field<Dim, Number>(grid->layout())),
          stage(velocity), pressure(grid->layout().total), time(params.start_time) {}

    Params params;
    [[no_unique_address]] Turbulence turbulence;
    [[no_unique_address]] Solids solids;
    [[no_unique_address]] Forcing forcing;
    std::shared_ptr<const Grid<Dim>> grid;  ///< shared among copies, parts of which point to it
    VelocityBoundaries<Dim> boundaries;
    Projects projection;
    Velocity velocity, stage;            ///< [m/s]
    std::span<const FlowBody> arriving;  ///< bodies of the step to come
    Field<Number> pressure;              ///< over density [m2/s2]
    std::conditional_t<Turbulence::has_eddies, std::optional<Eddies>, Nothing> eddies{};
    typename AppliedOf<Dim, Forcing>::type forced{};
    std::optional<Account> energy;  ///< none: nobody asks
    typename Projects::Report report;
    Real time = 0, fastest = 0, enters = 0;  ///< [s]; largest sum |u_a| / h_a, inside and at inflows [1/s]
    Real given = 0;                          ///< to solids [J]
    StepHistory history;                     ///< when steps grow is told from them
    Index steps = 0;

    static void fields(auto&& field) {
        field("boundaries", &FlowFields::boundaries), field("velocity", "m/s", &FlowFields::velocity);
        field("stage", "m/s", &FlowFields::stage), field("pressure", "m2/s2", &FlowFields::pressure);
        field("energy", &FlowFields::energy), field.bytes("report", &FlowFields::report);
        field("time", "s", &FlowFields::time), field("fastest", "1/s", &FlowFields::fastest);
        field("enters", "1/s", &FlowFields::enters), field("history", &FlowFields::history);
        field("given", "J", &FlowFields::given), field("steps", &FlowFields::steps);
        if constexpr (Turbulence::has_eddies) field("eddies", &FlowFields::eddies);
        if constexpr (Solids::present) field("solids", &FlowFields::solids);
        if constexpr (has_forcing) field("forced", &FlowFields::forced);
    }

    const Layout<Dim>& layout() const noexcept { return grid->layout(); }
    Real nu() const noexcept { return params.viscosity / params.density; }  ///< [m2/s]

    /// One stage of momentum on `faces`.
    void advance(const PerAxis<WetRows<Dim>, Dim>& faces, Stage& s) const {
        if constexpr (Turbulence::has_eddies) s.eddy_viscosity = &eddies->field();
        advance_momentum<Scheme, Turbulence::has_eddies>(*grid, faces, s);
    }

    /// What walls decide of eddies; `walls` may be none.
    void build_eddies([[maybe_unused]] const EmbeddedBoundary<Dim>* walls) {
        if constexpr (Turbulence::has_eddies)
            eddies.emplace(*grid, params, turbulence, walls, Solids::present);
    }
    /// From the velocity as it is; of water in `rows`, none: everywhere.
    void find_eddies([[maybe_unused]] const WetRows<Dim>* rows,
                     [[maybe_unused]] const Field<Real>* liquid_fraction) {
        if constexpr (Solids::present && ModelsMeanFlow<Turbulence>)
            eddies->make_way(*grid, params.boundaries, solids.resolved_parts());
        if constexpr (Turbulence::has_eddies) eddies->find(velocity, boundaries, rows, liquid_fraction);
    }

    /// Where the forcing acts; `walls` may be none.
    void build_forcing([[maybe_unused]] const EmbeddedBoundary<Dim>* walls) {
        if constexpr (has_forcing) forced.emplace(*grid, params.boundaries, forcing, walls);
    }
    /// What it does to the water as it is, without a step: that limits the first one.
    void look_at_forcing() {
        if constexpr (has_forcing) {
            forced->find_sources(forcing, time);
            forced->find(forcing, velocity, {params.density, 0, time});
        }
    }
    /// In the first stage of a step; `middle`: the time that it stands for [s].
    void force_stage([[maybe_unused]] Real dt, [[maybe_unused]] Real middle,
                     [[maybe_unused]] const Field<Real>* liquid_fraction) {
        if constexpr (has_forcing) {
            forced->find(forcing, stage, {params.density, dt, middle, liquid_fraction});
            forced->give(stage, 1);
        }
    }
    /// In the second: half of the same, for the mean of both stages has the other half.
    void force_second_stage([[maybe_unused]] Velocity& u) const {
        if constexpr (has_forcing) forced->give(u, 0.5);
    }

    /// How long a push upon solids has lasted of late [s].
    Real relaxation_time_of_solids(Real dt) const noexcept {
        return steps < 2 ? dt : history.relaxation_time(dt);
    }

    /// Share of its volume that a cell may gain or lose in a step, root mean square, or the step fails [-].
    Real most_left() const noexcept { return std::max(10 * params.tolerance, Real(1e-5)); }
    bool is_projected() const noexcept { return report.after <= most_left(); }

    /// What is left beyond `most_left` is solved for once more: single precision may have lost its way.
    void project(typename Projects::Demand demand) {
        report = projection.project(velocity, pressure, demand, solids);
        if (is_projected()) return;
        demand.push = false;
        const auto first = std::exchange(report, projection.project(velocity, pressure, demand, solids));
        report.iterations += first.iterations, report.rounds += first.rounds;
    }

    /// Takes a velocity's divergence; ghosts and what is beside the water are then those of before.
    void free_of_divergence(Real tolerance) {
        Field<Number> potential(layout().total);
        report = projection.project(velocity, potential, {1, tolerance});
        fastest = std::max(report.courant, enters);
    }
    /// Before the pressure of the water's weight is found: `stage` is how all would fall [m/s2].
    void let_all_fall(const Point<Dim>& falls) {
        for (int a = 0; a < Dim; ++a) {
            stage[a].fill(falls[a]);
            boundaries.close(stage[a], a);
        }
    }

    /// Of what an energy account asks, what does not depend on what fills the box.
    const Field<Number>* eddy_viscosity() const noexcept {
        if constexpr (Turbulence::has_eddies) return &eddies->field();
        return nullptr;
    }
    void add_forcing([[maybe_unused]] typename Account::View& view) const {
        if constexpr (has_forcing) view.gains = &forced->gains(), view.sources = forced->sources();
    }
    /// The same of solids, in water that is `fraction` of each cell; none: all of it.
    void add_solids(typename Account::View& view, [[maybe_unused]] const Field<Real>* fraction) const {
        if constexpr (Solids::present) {
            view.solids = solids.volumes(false), view.new_solids = solids.volumes(true);
            view.solid_fluxes = solids.fluxes();
            view.solid_friction = solids.lost_to_friction();
            view.solid_moment = solids.moment(*grid, fraction, false);
            view.new_solid_moment = solids.moment(*grid, fraction, true);
        }
    }
};

}  // namespace abrade::detail
