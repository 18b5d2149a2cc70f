#pragma once
// Water on a staggered Cartesian grid.

#include <abrade/fluid/embedded_boundary/wall_friction.hpp>
#include <abrade/fluid/energy/energy_account.hpp>
#include <abrade/fluid/fluid_model.hpp>
#include <abrade/fluid/height/thin_water.hpp>
#include <abrade/fluid/mesh/fastest_face.hpp>
#include <abrade/fluid/momentum/eddy_viscosity.hpp>
#include <abrade/fluid/momentum/momentum.hpp>
#include <abrade/fluid/navier_stokes/changed_boundary.hpp>
#include <abrade/fluid/navier_stokes/outflows.hpp>
#include <abrade/fluid/navier_stokes/state_backup.hpp>
#include <abrade/fluid/navier_stokes/step_limits.hpp>
#include <abrade/fluid/navier_stokes/surface_heights.hpp>
#include <abrade/fluid/pressure/solids_in_flow.hpp>

#include <optional>

namespace abrade {

/// What fills the box.
struct FullBox {};      ///< water, everywhere and for ever
struct FreeSurface {};  ///< water below a surface; above it a void at pressure 0
/// The same, of a surface that is a height: z = h(x, y, t) (HeightOfFluid). For channels, rivers and tanks;
/// it knows no film, no void and no spray, and stops where the water wants to overturn.
struct HeightSurface {};

/// Incompressible flow,  du/dt + div(u u) = g - grad p / rho + nu laplace(u),  div u = 0, on a MAC grid (F.
/// Harlow and J. Welch, doi 10.1063/1.1761178): pressures in cells, velocities on their faces. Heun's method
/// in time, one projection a step; the pressure of the step before goes into both stages, so velocity and
/// pressure are of second order.
///
/// With a free surface a step is: the liquid moves with the velocity (VolumeOfFluid, or HeightOfFluid where
/// the surface is a height); momentum goes with the same fluxes; the pressure is found below the new surface,
/// where it is 0 (F. Gibou et al., doi 10.1006/jcph.2001.6977); velocities are carried on outward. Liquid and
/// velocity leap over each other, so waves do not decay by the time step. Walls of any shape may
/// stand in a box with a free surface.
///
/// With a TurbulenceModel the viscosity grows by that of eddies, found at the end of each step from the
/// velocity as the pressure left it.
template <int Dim = 3, class Surface = FreeSurface, AdvectionScheme Scheme = Koren, class State = Real,
          TurbulenceModel Turbulence = NoTurbulence, SolidsInFlow Solids = NoSolids>
class GridFluid {
    static constexpr bool is_height = std::same_as<Surface, HeightSurface>;
    static constexpr bool has_surface = is_height || std::same_as<Surface, FreeSurface>;
    static_assert(!has_surface || std::same_as<State, Real>, "a surface is kept in double precision");
    static_assert(!Solids::present || (Dim == 3 && std::same_as<State, Real>),
                  "solids that move: in 3-D, in double precision");

public:
    static constexpr std::string_view name = "GridFluid";
    using Params = GridFluidParams<Dim>;
    using Liquid = std::conditional_t<is_height, HeightOfFluid<Dim>, VolumeOfFluid<Dim>>;

    /// Throws InputError where parameters make no flow, and what given functions throw.
    explicit GridFluid(Params params, Turbulence turbulence = {}, Solids solids = {})
        : params_((params.validate(), std::move(params))), turbulence_(std::move(turbulence)),
          solids_(std::move(solids)), grid_(std::make_shared<const Grid<Dim>>(params_.grid)),
          boundaries_(*grid_, with_free_slip(params_.boundaries, params_.wall_law), params_.boundary_velocity,
                      params_.start_time),
          projection_(*grid_, params_.boundaries), velocity_(face_field<Dim, State>(layout())),
          stage_(velocity_), pressure_(layout().total),
          side_friction_(*grid_, params_.boundaries, side_law(params_.wall_law), nullptr),
          time_(params_.start_time) {
        if constexpr (has_surface) {
            water_.emplace(*grid_, params_);
            detail::check_inflows(params_, water_->liquid(), water_->walls());
            water_->find(projection_, pressure_);
            outflows_ = detail::Outflows<Dim>(*grid_, params_);
        }
        if constexpr (!has_surface) detail::refuse_in_full_box(params_);
        look_at_walls();
        detail::give_velocity(*grid_, params_, velocity_);
        boundaries_.fill(velocity_);
        if constexpr (has_surface) give_discharge();
        if (params_.velocity)
            free_of_divergence(1e-12);
        else
            finish(velocity_);
        if constexpr (has_surface) {
            find_pressure_of_weight(1e-12);
            first_step_ = std::sqrt(2 * water_->liquid().stable_step(stage_));
        }
        enters_ = boundaries_.rate_of_inflow(velocity_);
        fastest_ = std::max(fastest_, enters_);
        find_eddies();
        if constexpr (has_surface) {
            backup_ = {*grid_, velocity_, stage_, *water_};
            history_.expect(stable_step().seconds);
            heights_.find(*grid_, water_->rows(), water_->liquid_fraction());
        } else {
            saved_velocity_ = velocity_;
        }
        if constexpr (Solids::present) mixture_ = stage_;
        if constexpr (Solids::present && !has_surface)
            find_pressure_of_weight(1e-12);  // bodies feel it first
    }

    const Params& params() const noexcept { return params_; }
    const Grid<Dim>& grid() const noexcept { return *grid_; }
    /// Component a of a cell on its lower face along a [m/s].
    const FaceField<Dim, State>& velocity() const noexcept { return velocity_; }
    const Field<State>& pressure() const noexcept { return pressure_; }  ///< over density [m2/s2]
    const Liquid& liquid() const noexcept requires has_surface { return water_->liquid(); }
    const EmbeddedBoundary<Dim>* walls() const noexcept requires has_surface { return water_->walls(); }
    /// nu_t of cells, as the velocity makes it now [m2/s].
    const Field<State>& eddy_viscosity() const noexcept requires Turbulence::has_eddies {
        return eddies_->field();
    }
    const Solids& solids() const noexcept { return solids_; }
    Index wet_cells() const noexcept { return projection_.wet_cells(); }
    Real time() const noexcept { return time_; }  ///< [s]
    const auto& last_projection() const noexcept { return report_; }
    Index steps() const noexcept { return steps_; }

    /// The longest step that is stable from here.
    FluidStep stable_step() const {
        detail::StepCauses<Dim> causes{.viscosity = nu(), .fastest = fastest_};
        if constexpr (Turbulence::has_eddies)
            causes.viscosity += eddies_->largest(), causes.together = eddies_->rate();
        if constexpr (has_surface) {
            const Point<Dim> gravity = params_.acceleration(time_);
            causes.gravity = &gravity;
            FluidStep step = detail::limit_of_step<Dim>(*grid_, params_, causes);
            step.lower(water_->liquid().stable_step(velocity_), step_cause);
            if (steps_ == 0) step.lower(first_step_, step_cause);
            return smooth(step);
        } else {
            return smooth(detail::limit_of_step<Dim>(*grid_, params_, causes));
        }
    }

    /// In which a body crosses as much of a cell as it may in a step [s].
    Real step_of_body(Real speed) const { return params_.courant * grid_->smallest() / speed; }
    /// Goes on to exactly `to_time` [s] in own steps. Throws FluidError; InputError for no finite time.
    void advance(Real to_time) {
        require_finite(to_time, "GridFluid.advance: to_time", "s");
        while (time_ < to_time) {
            const Real left = to_time - time_;
            const Real steps = std::ceil(left / stable_step().seconds - 1e-9);
            step(steps <= 1 ? left : left / steps);
            if (steps <= 1) time_ = to_time;
        }
    }

    /// The same among bodies that stand at `to_time` as they are given, and came there straight
    /// (ResolvedFluid). Throws as that does, and leaves the flow as it was before the step that went wrong.
    void advance(Real to_time, std::span<FlowBody> bodies) requires Solids::present;

    /// One step of dt [s]. Throws FluidError where it is longer than `stable_step` or goes wrong, and leaves
    /// the flow as it was.
    void step(Real dt);

    /// Puts another wall in the box, between steps: one that has worn, for instance. No water is lost, and
    /// columns settle at once (ChangedBoundary): so let a cell change by little at a time. Takes as long as
    /// building does. Throws as that does, and InputError where water has no room; the flow is as it was.
    void set_wall(PlaceFunction<Dim> wall) requires has_surface {
        GridFluid next(*this);
        next.params_.wall = std::move(wall);
        GridFluidParams<Dim> dry = next.params_;
        dry.water = {};
        auto& water = next.water_.emplace(*grid_, dry);
        if (water.has_walls_of(*water_)) {
            params_.wall = std::move(next.params_.wall);
            return;
        }
        water.find(next.projection_, next.stage_[0]);  // nowhere, so that nothing stays of the old
        detail::ChangedBoundary<Dim, Liquid> change(water_->liquid(), water_->walls(), water.walls(),
                                                    params_.gravity);
        const auto [fraction, volume_defect] = change.run();
        water.restore(fraction, volume_defect, WetRows<Dim>::whole(layout()), water_->liquid().steps());
        water.make_room();
        detail::check_inflows(next.params_, water.liquid(), water.walls());
        water.find(next.projection_, next.pressure_);
        next.find_pressure_of_weight(1e-3);  // the old one knows nothing of where the surface is now
        if (params_.steady_boundaries) next.give_discharge();
        next.enters_ = next.boundaries_.rate_of_inflow(next.velocity_);
        next.look_at_walls();
        next.heights_.find(*grid_, water.rows(), water.liquid_fraction());
        next.finish(next.velocity_);
        next.free_of_divergence();  // or the liquid would flow into the new walls
        next.find_eddies();
        if (next.energy_) next.energy_->reshaped(next.energy_view());
        *this = std::move(next);
    }

    /// Water at a point; in two dimensions at its x and z. Beyond the box as at its edge or, where sides are
    /// periodic, where it comes in again. t is not asked: what is known is the present.
    FluidSample sample(const Vec3& x, Real /*t*/) const noexcept {
        const Point<Dim> at = detail::in_plane<Dim>(x);
        const PerAxis<bool, Dim> periodic = params_.boundaries.periodic_axes();
        FluidSample sample{Vec3::Zero(), std::numeric_limits<Real>::infinity(), params_.density,
                           params_.viscosity};
        for (int a = 0; a < Dim; ++a)
            sample.velocity[a == Dim - 1 ? 2 : a] = face_value(*grid_, periodic, velocity_[a], a, at);
        if constexpr (has_surface) sample.depth = surface_at(at) - x[2];
        return sample;
    }

    /// Differences over a cell, and over the last step.
    FlowChange change(const Vec3& x, Real /*t*/) const noexcept {
        const FaceField<Dim, State>* before = history_.last > 0 ? &saved_velocity_ : nullptr;
        if constexpr (has_surface)
            if (before) before = &backup_.velocity();
        return detail::flow_change<Dim>(*grid_, params_.boundaries.periodic_axes(), velocity_, before,
                                        history_.last, detail::in_plane<Dim>(x));
    }

    /// Height of the water's surface at a place in the plane: floor and what stands on it [m].
    Real surface_at(const Point<Dim>& x) const noexcept requires has_surface {
        return heights_.at(*grid_, x);
    }

    Real kinetic_energy() const {  ///< [J]; in two dimensions per width
        return params_.density * detail::kinetic_energy(*grid_, velocity_, liquid_fraction());
    }

    /// Opens the energy account (WaterEnergy), or opens it anew: terms count from here. Without it steps do
    /// nothing for it.
    void open_energy_account();
    bool has_energy_account() const noexcept { return energy_.has_value(); }
    /// Throws std::logic_error where no account was opened.
    const WaterEnergy& energy() const {
        if (!energy_) throw std::logic_error("GridFluid.energy: call open_energy_account() first");
        return energy_->energy();
    }

    /// All that solids were given so far, by the ledger of who moves them [J].
    void solids_took(Real work) requires Solids::present;

    static void fields(auto&& field) {
        field("boundaries", &GridFluid::boundaries_), field("velocity", "m/s", &GridFluid::velocity_);
        field("stage", "m/s", &GridFluid::stage_), field("pressure", "m2/s2", &GridFluid::pressure_);
        field("energy", &GridFluid::energy_), field.bytes("report", &GridFluid::report_);
        field("time", "s", &GridFluid::time_), field("fastest", "1/s", &GridFluid::fastest_);
        field("enters", "1/s", &GridFluid::enters_), field("first_step", "s", &GridFluid::first_step_);
        field("history", &GridFluid::history_), field("given", "J", &GridFluid::given_),
            field("steps", &GridFluid::steps_);
        if constexpr (Turbulence::has_eddies) field("eddies", &GridFluid::eddies_);
        if constexpr (has_surface) {
            field("backup", &GridFluid::backup_), field("water", &GridFluid::water_);
            field("heights", &GridFluid::heights_), field("outflows", &GridFluid::outflows_);
        } else {
            field("saved_velocity", "m/s", &GridFluid::saved_velocity_);
        }
        if constexpr (Solids::present) field("solids", &GridFluid::solids_);
    }
    void restored() {
        if constexpr (has_surface) water_->show(projection_);
    }

private:
    static constexpr std::string_view step_cause = is_height ? "height of fluid" : "volume of fluid";
    using Stage = MomentumStage<Dim, State>;
    struct Nothing {};
    using Eddies = detail::EddyViscosity<Dim, State>;
    using EnergyAccount = detail::EnergyAccount<Dim, State, Scheme, Liquid>;

    const Layout<Dim>& layout() const noexcept { return grid_->layout(); }
    Real nu() const noexcept { return params_.viscosity / params_.density; }
    /// Liquid of cells [-] and rows that hold it; none: all cells are full.
    const Field<Real>* liquid_fraction() const noexcept {
        if constexpr (has_surface) return &water_->liquid_fraction();
        return nullptr;
    }
    const WetRows<Dim>* rows() const noexcept {
        if constexpr (has_surface) return &water_->rows();
        return nullptr;
    }
    /// What the pressure is to drive out; none: nothing.
    const Field<Real>* volume_defect() const noexcept {
        if constexpr (is_height)
            if (!water_->liquid().has_volume_defect()) return nullptr;
        return &water_->liquid().volume_defect();
    }
    /// In a full box that of logarithmic sides alone; the surface's water has its own.
    static WallLaw side_law(const WallLaw& law) {
        return !has_surface && law.kind == WallLaw::Kind::logarithmic ? law : WallLaw{WallLaw::Kind::slip};
    }

    void refuse_beyond_stable(Real dt) const;

    /// A given force may not know the time beyond the run: it then fails the step that asks for it.
    FluidStep smooth(FluidStep step) const {
        if constexpr (Solids::present)
            step = detail::step_among_solids(step, *grid_, params_, solids_.fastest());
        if (!params_.body_force || !std::isfinite(step.seconds)) return step;
        try {
            step.lower(detail::smooth_step<Dim>(params_.body_force, time_, step.seconds), "body force");
        } catch (...) {
        }
        return step;
    }

    typename EnergyAccount::View energy_view() const;

    /// What walls decide once, beside the water.
    void look_at_walls() {
        [[maybe_unused]] const EmbeddedBoundary<Dim>* walls = nullptr;
        if constexpr (has_surface) {
            walls = water_->walls();
            heights_ = detail::SurfaceHeights<Dim>(*grid_, params_.boundaries.periodic_axes(), walls);
        }
        if constexpr (Turbulence::has_eddies)
            eddies_.emplace(*grid_, params_, turbulence_, walls, Solids::present);
    }

    /// Walls, and cells that are too small to stay open, take some of the faces that water comes
    /// through.
    void give_discharge();

    /// A velocity that was given, or walls that have come.
    void free_of_divergence(Real tolerance = 1e-6);

    void find_pressure_of_weight(Real tolerance);

    void step_full(Real dt);

    void step_below_surface(Real dt);

    void project(typename Projection<Dim, State>::Demand demand);
    /// Share of its volume that a cell may gain or lose in a step, root mean square, or the step fails [-].
    Real most_left() const noexcept { return std::max(10 * params_.tolerance, Real(1e-5)); }

    /// Takes back from open faces the fall of what is not below the surface.
    void carry_weight(FaceField<Dim>& u, const Point<Dim>& fall) const {
        for (const OpenFace& open : projection_.open_faces())
            u[open.axis][open.face] -= (1 - open.weight) * fall[open.axis];
    }

    void advance(const PerAxis<WetRows<Dim>, Dim>& faces, Stage& stage) const {
        if constexpr (Turbulence::has_eddies) stage.eddy_viscosity = &eddies_->field();
        advance_momentum<Scheme, Turbulence::has_eddies>(*grid_, faces, stage);
    }

    void find_eddies() {
        if constexpr (Turbulence::has_eddies && Solids::present)
            eddies_->make_way(*grid_, params_.boundaries, solids_.resolved_parts());
        if constexpr (Turbulence::has_eddies)
            eddies_->find(velocity_, boundaries_, rows(), liquid_fraction());
    }

    /// The advecting velocity of water and solids, from the water's.
    void mix(const FaceField<Dim, State>& u, auto&& with_solids) requires Solids::present {
        boundaries_.copy(u, mixture_, rows());
        with_solids();
        boundaries_.fill(mixture_, rows());
    }

    /// Calls use() while the velocity is what moves the water alone.
    void while_seeping(auto&& use) {
        if constexpr (Solids::present) {
            struct Back {  // a step that goes wrong takes it back, too
                GridFluid& flow;
                ~Back() { flow.solids_.unseep(flow.velocity_), flow.boundaries_.join(flow.velocity_); }
            };
            solids_.seep(velocity_);
            const Back back{*this};
            boundaries_.enter(velocity_), boundaries_.join(velocity_);
            use();
        } else {
            use();
        }
    }

    /// Air beside the water, ghosts.
    void finish(FaceField<Dim, State>& u) {
        if constexpr (has_surface) water_->extend(u);
        boundaries_.fill(u, rows());
    }

    void restore();
    /// After a step that threw: a full box has not changed by then.
    void take_back() { has_surface ? restore() : boundaries_.back(velocity_); }
    void check(Real dt);

    Params params_;
    [[no_unique_address]] Turbulence turbulence_;
    [[no_unique_address]] Solids solids_;
    std::shared_ptr<const Grid<Dim>> grid_;  ///< shared among copies, parts of which point to it
    VelocityBoundaries<Dim> boundaries_;
    Projection<Dim, State> projection_;
    FaceField<Dim, State> velocity_, stage_, saved_velocity_;
    std::conditional_t<Solids::present, FaceField<Dim, State>, Nothing> mixture_{};  ///< at work
    std::span<const FlowBody> arriving_;  ///< bodies of the step to come
    Field<State> pressure_, saved_pressure_;
    std::conditional_t<has_surface, detail::StateBackup<Dim, Liquid>, Nothing> backup_{};
    WallFriction<Dim> side_friction_;  ///< of a full box
    std::conditional_t<has_surface, std::optional<detail::SurfaceWater<Dim, Liquid>>, Nothing> water_{};
    std::conditional_t<has_surface, detail::SurfaceHeights<Dim>, Nothing> heights_{};
    std::conditional_t<has_surface, detail::Outflows<Dim>, Nothing> outflows_{};
    std::conditional_t<Turbulence::has_eddies, std::optional<Eddies>, Nothing> eddies_{};
    std::optional<EnergyAccount> energy_;  ///< none: nobody asks
    typename Projection<Dim, State>::Report report_;
    Real time_ = 0, fastest_ = 0, enters_ = 0;  ///< [s]; largest sum |u_a| / h_a, inside and at inflows [1/s]
    Real first_step_ = 0;                       ///< in which what first moves it does not cross a cell [s]
    Real given_ = 0;                            ///< to solids [J]
    detail::StepHistory history_;               ///< when steps grow is told from them
    Index steps_ = 0;
};

}  // namespace abrade
