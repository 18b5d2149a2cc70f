#pragma once
// Water on a staggered Cartesian grid.

#include <abrade/fluid/momentum.hpp>
#include <abrade/fluid/projection.hpp>
#include <abrade/fluid/velocity_sides.hpp>

#include <optional>

namespace abrade {

/// Incompressible flow,  du/dt + div(u u) = g - grad p / rho + nu laplace(u),  div u = 0, on a MAC grid (F.
/// Harlow and J. Welch, doi 10.1063/1.1761178): pressures in cells, velocities on their faces. Heun's method
/// in time, one projection a step; the pressure of the step before goes into both stages, so velocity and
/// pressure are of second order.
template <int Dim = 3, AdvectionScheme Scheme = Limited, class State = Real>
class GridFluid {
public:
    struct Params {
        typename Grid<Dim>::Params grid{};
        Sides<Dim> sides{};
        SideVelocity<Dim> side_velocity{};        ///< none: walls at rest
        bool steady_sides = true;                 ///< side_velocity does not depend on time
        Real density = 1000;                      ///< [kg/m3]
        Real viscosity = 1.31e-3;                 ///< dynamic [Pa s]
        Point<Dim> gravity = Point<Dim>::Zero();  ///< [m/s2]
        Real courant = 0.5;                       ///< limit of dt sum |u_a| / h_a [-]
        Real largest_step = 0;                    ///< [s]; 0: none
        Real tolerance = 1e-6;                    ///< share of a cell's volume gained or lost in a step [-]
    };

    explicit GridFluid(Params params)
        : params_(std::move(params)), grid_(params_.grid),
          sides_(grid_, params_.sides, params_.side_velocity), projection_(grid_, params_.sides),
          velocity_(face_field<Dim, State>(grid_.layout())), stage_(velocity_),
          pressure_(grid_.layout().total) {}

    const Params& params() const noexcept { return params_; }
    const Grid<Dim>& grid() const noexcept { return grid_; }
    const FaceField<Dim, State>& velocity() const noexcept { return velocity_; }
    const Field<State>& pressure() const noexcept { return pressure_; }  ///< over density [m2/s2]
    Real time() const noexcept { return time_; }
    const auto& last_projection() const noexcept { return report_; }

    /// Sets the velocity from a function of place, made free of divergence.
    void set_velocity(auto&& of) {
        grid_.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            for (int a = 0; a < Dim; ++a)
                velocity_[a][c] = static_cast<State>(of(grid_.face_centre(a, cell))[a]);
        });
        sides_.fill(velocity_);
        Field<State> ignored(grid_.layout().total);
        report_ = projection_.project(velocity_, ignored, 1, 1e-12);
    }

    void step(Real dt) {
        sides_.fill(velocity_);
        sides_.fill_cells(pressure_);
        advance_momentum<Scheme>(grid_, projection_.faces(),
                                 MomentumStage<Dim, State>{velocity_, velocity_, velocity_, stage_, pressure_,
                                                           dt, 0, -dt, nu(), params_.gravity});
        leave(stage_);
        if (!params_.steady_sides) sides_.set_time(time_ + dt);
        sides_.fill(stage_);
        advance_momentum<Scheme>(grid_, projection_.faces(),
                                 MomentumStage<Dim, State>{stage_, stage_, velocity_, velocity_, pressure_,
                                                           dt, 0.5, -0.5 * dt, nu(), params_.gravity});
        leave(velocity_);
        time_ += dt;
        sides_.fill(velocity_);
        report_ = projection_.project(velocity_, pressure_, dt, params_.tolerance);
    }

    Real kinetic_energy() const {
        Real sum = 0;
        grid_.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            Real u2 = 0;
            for (int a = 0; a < Dim; ++a)
                u2 += 0.5 * (square(velocity_[a][c]) + square(velocity_[a][c + grid_.layout().stride[a]]));
            sum += 0.5 * u2 * grid_.volume(cell);
        });
        return params_.density * sum;
    }

private:
    Real nu() const noexcept { return params_.viscosity / params_.density; }
    /// Faces through which water leaves go on as the ones before them.
    void leave(FaceField<Dim, State>&) const {}

    Params params_;
    Grid<Dim> grid_;
    VelocitySides<Dim> sides_;
    Projection<Dim, State> projection_;
    FaceField<Dim, State> velocity_, stage_;
    Field<State> pressure_;
    Real time_ = 0;
    typename Projection<Dim, State>::Report report_;
};

}  // namespace abrade
