#pragma once
// Water on a staggered Cartesian grid.

#include <abrade/core/compiled_as.hpp>
#include <abrade/fluid/mesh/fastest_face.hpp>
#include <abrade/fluid/navier_stokes/free_surface_stepper.hpp>
#include <abrade/fluid/navier_stokes/full_box_stepper.hpp>
#include <abrade/fluid/navier_stokes/lost_bodies.hpp>
#include <abrade/fluid/navier_stokes/step_limits.hpp>

#include <string>
#include <utility>

namespace abrade {

/// Incompressible flow,  du/dt + div(u u) = g - grad p / rho + nu laplace(u),  div u = 0, on a MAC grid (F.
/// Harlow and J. Welch, doi:10.1063/1.1761178): pressures in cells, velocities on their faces. Heun's method
/// in time, one projection a step; velocity and pressure are of second order.
///
/// `Options` say what fills the box and what is solved there (FlowOptions): FullBox, FreeSurface,
/// HeightSurface, or one derived from these. What a step does stands in FullBoxStepper and in
/// FreeSurfaceStepper. Walls of any shape may stand in a box with a surface.
///
/// With a TurbulenceModel the viscosity grows by that of eddies, found at the end of each step from the
/// velocity as the pressure left it.
template <int Dim = 3, FlowOptions Options = FreeSurface>
class GridFluid {
    using Flow = detail::FlowFields<Dim, Options>;
    static constexpr bool has_surface = Options::surface != SurfaceKind::none;
    using Stepper = std::conditional_t<has_surface, detail::FreeSurfaceStepper<Dim, Options>,
                                       detail::FullBoxStepper<Dim, Options>>;

public:
    using Number = typename Options::Number;
    using Turbulence = typename Options::Turbulence;
    using Solids = typename Options::Solids;
    using Forcing = typename Options::Forcing;
    using Params = GridFluidParams<Dim>;
    using Liquid = typename Flow::Liquid;
    static_assert(!has_surface || std::same_as<Number, Real>, "a surface is kept in double precision");
    static_assert(!Solids::present || (Dim == 3 && std::same_as<Number, Real>),
                  "solids that move: in 3-D, in double precision");
    static_assert(!Flow::has_forcing || abrade::Forcing<Forcing, Dim>,
                  "GridFluid: a Forcing has a name, acts_at(x) and force(x, u, t), which gives a "
                  "FlowForce<Dim>; see fluid/momentum/forcing.hpp");

    static constexpr std::string_view name = "GridFluid";
    /// What it was made of at compile time, in words, with what its turbulence was given.
    std::string options() const { return describe_options<Options>(flow_.turbulence); }

    /// Throws InputError where parameters make no flow, and what given functions throw.
    explicit GridFluid(Params params, Turbulence turbulence = {}, Solids solids = {}, Forcing forcing = {});

    // --- what it is ------------------------------------------------------------------------------

    const Params& params() const noexcept { return flow_.params; }
    const Grid<Dim>& grid() const noexcept { return *flow_.grid; }
    /// Component a of a cell on its lower face along a [m/s].
    const FaceField<Dim, Number>& velocity() const noexcept { return flow_.velocity; }
    const Field<Number>& pressure() const noexcept { return flow_.pressure; }  ///< over density [m2/s2]
    const Liquid& liquid() const noexcept requires has_surface { return stepper_.liquid(); }
    const EmbeddedBoundary<Dim>* walls() const noexcept requires has_surface { return stepper_.walls(); }
    /// nu_t of cells, as the velocity makes it now [m2/s].
    const Field<Number>& eddy_viscosity() const noexcept requires Turbulence::has_eddies {
        return flow_.eddies->field();
    }
    const Solids& solids() const noexcept { return flow_.solids; }
    const Forcing& forcing() const noexcept { return flow_.forcing; }
    Index wet_cells() const noexcept { return flow_.projection.wet_cells(); }
    Real time() const noexcept { return flow_.time; }  ///< [s]
    const auto& last_projection() const noexcept { return flow_.report; }
    Index steps() const noexcept { return flow_.steps; }

    // --- in time ---------------------------------------------------------------------------------

    /// The longest step that is stable from here.
    FluidStep stable_step() const;

    /// In which a body crosses as much of a cell as it may in a step [s].
    Real step_of_body(Real speed) const { return flow_.params.courant * flow_.grid->smallest() / speed; }

    /// Goes on to exactly `to_time` [s] in own steps. Throws FluidError; InputError for no finite time.
    void advance(Real to_time) {
        require_finite(to_time, "GridFluid.advance: to_time", "s");
        while (flow_.time < to_time) {
            const Real left = to_time - flow_.time;
            const Real steps = std::ceil(left / stable_step().seconds - 1e-9);
            step(steps <= 1 ? left : left / steps);
            if (steps <= 1) flow_.time = to_time;
        }
    }

    /// The same among bodies that stand at `to_time` as they are given, and came there straight
    /// (ResolvedFluid). Throws as that does, and leaves the flow as it was before the step that went wrong.
    void advance(Real to_time, std::span<FlowBody> bodies) requires Options::Solids::present;

    /// One step of dt [s]. Throws FluidError where it is longer than `stable_step` or goes wrong, and leaves
    /// the flow as it was.
    void step(Real dt);

    /// Puts another wall in the box, between steps: one that has worn, for instance. No water is lost, and
    /// columns settle at once (ChangedBoundary): so let a cell change by little at a time. Takes as long as
    /// building does. Throws as that does, and InputError where water has no room; the flow is as it was.
    void set_wall(PlaceFunction<Dim> wall) requires has_surface {
        GridFluid next(*this);
        next.flow_.params.wall = std::move(wall);
        next.stepper_.change_walls(next.flow_);
        *this = std::move(next);
    }

    // --- what it is asked ------------------------------------------------------------------------

    /// Water at a point; in two dimensions at its x and z. Beyond the box as at its edge or, where sides are
    /// periodic, where it comes in again. t is not asked: what is known is the present.
    FluidSample sample(const Vec3& x, Real /*t*/) const noexcept {
        const Point<Dim> at = detail::in_plane<Dim>(x);
        const PerAxis<bool, Dim> periodic = params().boundaries.periodic_axes();
        FluidSample sample{Vec3::Zero(), std::numeric_limits<Real>::infinity(), params().density,
                           params().viscosity};
        for (int a = 0; a < Dim; ++a)
            sample.velocity[a == Dim - 1 ? 2 : a] = face_value(grid(), periodic, velocity()[a], a, at);
        if constexpr (has_surface) sample.depth = surface_at(at) - x[2];
        return sample;
    }

    /// Differences over a cell, and over the last step.
    FlowChange change(const Vec3& x, Real /*t*/) const noexcept;

    /// Height of the water's surface at a place in the plane: floor and what stands on it [m].
    Real surface_at(const Point<Dim>& x) const noexcept requires has_surface {
        return stepper_.heights().at(grid(), x);
    }

    Real kinetic_energy() const {  ///< [J]; in two dimensions per width
        return params().density * detail::kinetic_energy(grid(), velocity(), stepper_.liquid_fraction());
    }

    // --- the energy account ----------------------------------------------------------------------

    /// Opens the energy account (WaterEnergy), or opens it anew: terms count from here. Without it steps do
    /// nothing for it.
    void open_energy_account();
    bool has_energy_account() const noexcept { return flow_.energy.has_value(); }
    /// Throws std::logic_error where no account was opened.
    const WaterEnergy& energy() const {
        if (!flow_.energy) throw std::logic_error("GridFluid.energy: call open_energy_account() first");
        return flow_.energy->energy();
    }
    /// All that solids were given so far, by the ledger of who moves them [J].
    void solids_took(Real work) requires Options::Solids::present {
        const Real before = std::exchange(flow_.given, work);
        if (flow_.energy) flow_.energy->solids_took(work - before);
    }

    static void fields(auto&& field) {
        field("flow", &GridFluid::flow_), field("stepper", &GridFluid::stepper_);
    }
    void restored() { stepper_.restored(flow_); }

private:
    void refuse_beyond_stable(Real dt) const;
    /// Ends a step that is wrong, as it was before it.
    void check(Real dt);
    void find_eddies() { flow_.find_eddies(stepper_.rows(), stepper_.liquid_fraction()); }

    Flow flow_;
    Stepper stepper_;
};

template <int Dim, FlowOptions Options>
GridFluid<Dim, Options>::GridFluid(Params params, Turbulence turbulence, Solids solids, Forcing forcing)
    : flow_(std::move(params), std::move(turbulence), std::move(solids), std::move(forcing)),
      stepper_(flow_) {
    if constexpr (!has_surface) flow_.build_eddies(nullptr);
    detail::give_velocity(*flow_.grid, flow_.params, flow_.velocity);
    flow_.boundaries.fill(flow_.velocity);
    stepper_.begin(flow_);
    flow_.enters = flow_.boundaries.rate_of_inflow(flow_.velocity);
    flow_.fastest = std::max(flow_.fastest, flow_.enters);
    find_eddies();
    flow_.look_at_forcing();
    if constexpr (has_surface)
        stepper_.begin_history(flow_, stable_step().seconds);
    else
        stepper_.begin_pressure(flow_);
}

template <int Dim, FlowOptions Options>
FluidStep GridFluid<Dim, Options>::stable_step() const {
    detail::StepCauses<Dim> causes{.viscosity = flow_.nu(), .fastest = flow_.fastest};
    if constexpr (Turbulence::has_eddies)
        causes.viscosity += flow_.eddies->largest(), causes.combined = flow_.eddies->rate();
    Point<Dim> gravity;
    if constexpr (has_surface) gravity = flow_.params.acceleration(flow_.time), causes.gravity = &gravity;
    if constexpr (Flow::has_forcing) causes.push_per_cell = flow_.forced->push_per_cell();
    FluidStep step = detail::limit_of_step<Dim>(*flow_.grid, flow_.params, causes);
    if constexpr (Flow::has_sources) step.lower(0.5 / flow_.forced->largest_rate(), "source");
    if constexpr (has_surface) step = stepper_.limit(flow_, step);
    if constexpr (Solids::present)
        step = detail::step_among_solids(step, *flow_.grid, flow_.params, flow_.solids.fastest());
    return detail::step_of_body_force(step, flow_.params, flow_.time);
}

template <int Dim, FlowOptions Options>
FlowChange GridFluid<Dim, Options>::change(const Vec3& x, Real /*t*/) const noexcept {
    const Real last = flow_.history.last;
    return detail::flow_change<Dim>(grid(), params().boundaries.periodic_axes(), velocity(),
                                    last > 0 ? &stepper_.velocity_before() : nullptr, last,
                                    detail::in_plane<Dim>(x));
}

template <int Dim, FlowOptions Options>
void GridFluid<Dim, Options>::open_energy_account() {
    flow_.energy.emplace(stepper_.energy_view(flow_), stepper_.velocity_that_carried(flow_));
}

template <int Dim, FlowOptions Options>
void GridFluid<Dim, Options>::step(Real dt) {
    require_positive(dt, "GridFluid.step: dt", "s");
    refuse_beyond_stable(dt);
    flow_.boundaries.keep(flow_.velocity);
    try {
        stepper_.step(flow_, dt);
    } catch (const std::exception& wrong) {  // more than a cell would leave it, a given function fails
        stepper_.take_back(flow_);
        throw FluidError(detail::place_in_time(flow_.steps, flow_.time, dt) + wrong.what());
    } catch (...) {
        stepper_.take_back(flow_);
        throw;
    }
    check(dt);
    if (flow_.energy) flow_.energy->took(stepper_.energy_view(flow_), dt);
    find_eddies();
    flow_.time += dt, flow_.history.took(dt), ++flow_.steps;
    stepper_.took(flow_);
    if (!flow_.params.steady_boundaries) flow_.enters = flow_.boundaries.rate_of_inflow(flow_.velocity);
    flow_.fastest = std::max(flow_.report.courant / dt, flow_.enters);
}

template <int Dim, FlowOptions Options>
void GridFluid<Dim, Options>::advance(Real to_time,
                                      std::span<FlowBody> bodies) requires Options::Solids::present {
    require_finite(to_time, "GridFluid.advance: to_time", "s");
    if (!(flow_.time < to_time)) return;
    detail::refuse_lost(grid(), flow_.params.boundaries, bodies, has_surface);
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
        if (flow_.steps == 0) stand(to_time - flow_.time), stepper_.stand_solids(flow_, now);
    while (flow_.time < to_time) {
        const Real left = to_time - flow_.time;
        const Real own = std::min(stable_step().seconds, step_of_body(fastest));
        const Real steps = std::max(std::ceil(left / own - 1e-9), 1.0), dt = left / steps;
        stand(left - dt);
        flow_.arriving = now;
        step(dt);
        for (std::size_t b = 0; b < now.size(); ++b) {
            const FlowBody& found = flow_.solids.bodies()[b];
            now[b].velocity = found.velocity, now[b].angular_velocity = found.angular_velocity;
        }
        if (steps <= 1) flow_.time = to_time;
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        bodies[b].velocity = now[b].velocity, bodies[b].angular_velocity = now[b].angular_velocity;
        bodies[b].load = flow_.solids.bodies()[b].load;
    }
}

template <int Dim, FlowOptions Options>
void GridFluid<Dim, Options>::refuse_beyond_stable(Real dt) const {
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
    throw FluidError(detail::place_in_time(flow_.steps, flow_.time, dt) + cause);
}

template <int Dim, FlowOptions Options>
void GridFluid<Dim, Options>::check(Real dt) {
    Real size = 0;
    for (int a = 0; a < Dim; ++a) size = std::max(size, grid().largest(a));
    // Without a surface and an outflow the pressure is known but for a constant, and takes no volume.
    const bool found = flow_.is_projected();
    const bool brimful = !found && (flow_.enters > 0 || has_surface || Flow::has_sources) &&
                         flow_.projection.solver().floating();
    // The bound is cheap, the speed itself is not.
    if (found && (flow_.report.courant / dt * size <= flow_.params.velocity_limit ||
                  detail::FastFace<Dim>(grid(), velocity()).speed <= flow_.params.velocity_limit))
        return;
    const std::string cause =
        brimful
            ? "inflows, sources or solids ask for another volume of water, and no surface is left to rise or "
              "fall; make a side that the water reaches an outflow, or leave air above it"
            : detail::wrong_flow(grid(), velocity(), flow_.report.after, flow_.most_left(), flow_.enters > 0);
    stepper_.restore(flow_);
    throw FluidError(detail::place_in_time(flow_.steps, flow_.time, dt) + cause);
}

/// The usual ones, which abrade::compiled has compiled.
#define ABRADE_USUAL_WATER(one)                                                                   \
    one(2, FullBox) one(3, FullBox) one(2, FreeSurface) one(3, FreeSurface) one(2, HeightSurface) \
        one(3, HeightSurface)
#ifdef ABRADE_COMPILED
#define ABRADE_IS_COMPILED(...) extern template class GridFluid<__VA_ARGS__>;
ABRADE_USUAL_WATER(ABRADE_IS_COMPILED)
#undef ABRADE_IS_COMPILED
#endif

static_assert(AdvancingFluid<GridFluid<2>> && AdvancingFluid<GridFluid<3>>);
static_assert(AccountsForEnergy<GridFluid<2>> && AccountsForEnergy<GridFluid<3, FullBox>>);
static_assert(AdvancingFluid<GridFluid<2, HeightSurface>> && AdvancingFluid<GridFluid<3, HeightSurface>>);

}  // namespace abrade
