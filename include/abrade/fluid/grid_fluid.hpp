#pragma once
// Water on a staggered Cartesian grid.

#include <abrade/fluid/fluid_model.hpp>
#include <abrade/fluid/momentum.hpp>
#include <abrade/fluid/projection.hpp>
#include <abrade/fluid/velocity_extension.hpp>
#include <abrade/fluid/velocity_sides.hpp>
#include <abrade/fluid/volume_of_fluid.hpp>
#include <abrade/fluid/wall_friction.hpp>
#include <abrade/fluid/walls.hpp>

#include <optional>

namespace abrade {

/// What fills the box.
struct FullBox {};      ///< water, everywhere and for ever
struct FreeSurface {};  ///< water below a surface; above it a void at pressure 0

/// Incompressible flow,  du/dt + div(u u) = g - grad p / rho + nu laplace(u),  div u = 0, on a MAC grid (F.
/// Harlow and J. Welch, doi 10.1063/1.1761178): pressures in cells, velocities on their faces. Heun's method
/// in time, one projection a step; the pressure of the step before goes into both stages, so velocity and
/// pressure are of second order.
///
/// With a free surface a step is: the liquid moves with the velocity (VolumeOfFluid); momentum goes with the
/// same fluxes; the pressure is found below the new surface, where it is 0 (F. Gibou et al.,
/// doi 10.1006/jcph.2001.6977); velocities are carried on outward. Liquid and velocity leap over each other,
/// so waves do not decay by the time step.
template <int Dim = 3, class Surface = FreeSurface, AdvectionScheme Scheme = Limited, class State = Real>
class GridFluid {
    static constexpr bool has_surface = std::same_as<Surface, FreeSurface>;
    static_assert(!has_surface || std::same_as<State, Real>, "a free surface is kept in double precision");

public:
    struct Params {
        typename Grid<Dim>::Params grid{};
        Sides<Dim> sides{};
        SideVelocity<Dim> side_velocity{};        ///< none: walls at rest
        bool steady_sides = true;                 ///< side_velocity does not depend on time
        WallLaw wall_law{};                       ///< of walls inside, and of sides that are walls
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
          pressure_(grid_.layout().total) {
        if constexpr (has_surface) water_.emplace(grid_, params_.sides, params_.wall_law);
    }

    /// Puts walls into the box, or new ones in the place of the old: a shape by its distance [m] (WallShape).
    /// Liquid that was set before stays, as a share of what is open.
    template <WallShape<Dim> Shape>
    void set_walls(const Shape& shape, typename Walls<Dim>::Params how = {}) requires has_surface {
        Water& w = *water_;
        w.walls.emplace(grid_, shape, how);
        w.liquid.set_walls(&w.walls->open_area(), &w.walls->open_volume());
        w.friction = WallFriction<Dim>(grid_, params_.sides, params_.wall_law, &*w.walls);
        w.liquid.prepare();
        find_water();
    }
    const Walls<Dim>* walls() const noexcept requires has_surface {
        return water_->walls ? &*water_->walls : nullptr;
    }

    const Params& params() const noexcept { return params_; }
    const Grid<Dim>& grid() const noexcept { return grid_; }
    const FaceField<Dim, State>& velocity() const noexcept { return velocity_; }
    const Field<State>& pressure() const noexcept { return pressure_; }  ///< over density [m2/s2]
    const VolumeOfFluid<Dim>& liquid() const noexcept requires has_surface { return water_->liquid; }
    Real time() const noexcept { return time_; }
    const VolumeStep& moved() const noexcept { return water_->moved; }
    const auto& last_projection() const noexcept { return report_; }
    const Projection<Dim, State>& projection() const noexcept { return projection_; }

    /// Sets the velocity from a function of place, made free of divergence.
    void set_velocity(auto&& of) {
        grid_.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            for (int a = 0; a < Dim; ++a)
                velocity_[a][c] = static_cast<State>(of(grid_.face_centre(a, cell))[a]);
        });
        sides_.fill(velocity_);
        Field<State> ignored(grid_.layout().total);
        report_ = projection_.project(velocity_, ignored, 1, 1e-12);
        sides_.fill(velocity_);
    }

    /// Sets the liquid: share of each cell's open volume, from 0 to 1. The pressure begins as that of water
    /// at rest below each cell's own surface as far as one projection finds it.
    void set_liquid(auto&& share) requires has_surface {
        Field<Real>& f = water_->liquid.fraction();
        grid_.for_each([&](const CellNumber<Dim>& cell, Offset c) { f[c] = share(cell); });
        water_->liquid.prepare();
        water_->hold();
        find_water();
    }

    void step(Real dt) {
        if constexpr (has_surface)
            step_below_surface(dt);
        else
            step_full(dt);
        time_ += dt;
        fastest_ = report_.courant / dt;
    }

    /// The longest step that is stable from here.
    FluidStep stable_step() const {
        FluidStep step;
        if (params_.largest_step > 0) step.lower(params_.largest_step, "largest_step");
        Real per_h2 = 0, smallest = std::numeric_limits<Real>::infinity();
        for (int a = 0; a < Dim; ++a) {
            for (int i = 0; i < grid_.cells(a); ++i) smallest = std::min(smallest, grid_.size(a, i));
            per_h2 += 1 / square(smallest);
        }
        // Heun's method is stable for real eigenvalues down to -2/dt; those of friction reach 4 nu sum 1/h^2.
        if (nu() > 0) step.lower(0.5 / (nu() * per_h2), "viscosity");
        // At the end of a step from here gravity may have made the water faster by g dt.
        Real fall = 0;
        for (int a = 0; a < Dim; ++a) fall += std::abs(params_.gravity[a]) / smallest;
        if (fastest_ > 0 || fall > 0)
            step.lower(
                2 * params_.courant / (fastest_ + std::sqrt(square(fastest_) + 4 * fall * params_.courant)),
                "CFL");
        if constexpr (has_surface) {
            step.lower(water_->liquid.stable_step(velocity_), "volume of fluid");
            // A wave of two cells' length, the shortest that the grid knows, must not cross a cell.
            const Real g = params_.gravity.norm();
            if (g > 0) step.lower(params_.courant * std::sqrt(pi * smallest / g), "gravity wave");
        }
        return step;
    }

    /// Goes on to exactly `to_time` in steps of its own.
    void advance(Real to_time) {
        while (time_ < to_time) {
            const Real left = to_time - time_, longest = stable_step().seconds;
            const Real steps = std::ceil(left / longest - 1e-9);
            if (steps <= 1) {
                step(left);
                time_ = to_time;
            } else {
                step(left / steps);
            }
        }
    }

    Real kinetic_energy() const {
        Real sum = 0;
        grid_.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            Real u2 = 0;
            for (int a = 0; a < Dim; ++a)
                u2 += 0.5 * (square(velocity_[a][c]) + square(velocity_[a][c + grid_.layout().stride[a]]));
            if constexpr (has_surface) u2 *= water_->liquid.fraction()[c];
            sum += 0.5 * u2 * grid_.volume(cell);
        });
        return params_.density * sum;
    }

private:
    using Stage = MomentumStage<Dim, State>;
    /// Sides whose friction is added apart let the water glide.
    static Sides<Dim> without_friction(Sides<Dim> sides, const WallLaw& law) {
        if (law.kind == WallLaw::Kind::no_slip) return sides;
        for (auto& ends : sides.kind)
            for (Side& side : ends)
                if (side == Side::wall) side = Side::slip;
        return sides;
    }
    Real nu() const noexcept { return params_.viscosity / params_.density; }

    void step_full(Real dt) {
        sides_.fill_cells(pressure_);
        advance_momentum<Scheme>(
            grid_, projection_.faces(),
            Stage{velocity_, velocity_, velocity_, stage_, pressure_, dt, 0, -dt, nu(), params_.gravity});
        if (!params_.steady_sides) sides_.set_time(time_ + dt);
        leave(stage_);
        sides_.fill(stage_);
        advance_momentum<Scheme>(grid_, projection_.faces(),
                                 Stage{stage_, stage_, velocity_, velocity_, pressure_, dt, 0.5, -0.5 * dt,
                                       nu(), params_.gravity});
        leave(velocity_);
        sides_.fill(velocity_);
        report_ = projection_.project(velocity_, pressure_, dt, params_.tolerance);
        sides_.fill(velocity_);
    }

    void step_below_surface(Real dt) {
        Water& w = *water_;
        w.before = w.held();
        w.rows_before = w.rows;
        w.moved = w.liquid.advance(velocity_, dt);
        find_rows();
        w.hold();
        FaceField<Dim>& carrier = w.carrier;
        carrier = w.liquid.moved();
        Stage stage{velocity_, carrier, velocity_,       stage_, pressure_, dt,        0,
                    -dt,       nu(),    params_.gravity, dt,     &w.before, &w.held(), w.open_area()};
        advance_momentum<Scheme>(grid_, w.faces, stage);
        push_open_faces(stage_, -dt);
        if (!params_.steady_sides) sides_.set_time(time_ + dt);
        leave(stage_);
        w.extension.extend(stage_, w.wet, w.rows, w.held(), w.open_area());
        sides_.fill(stage_);
        // In the bulk the second stage is carried by its own velocity; at the surface by the liquid's fluxes.
        take_stage_where_full(carrier, dt);
        advance_momentum<Scheme>(grid_, w.faces,
                                 Stage{stage_, carrier, velocity_, velocity_, pressure_, dt, 0.5, 0.5 * dt,
                                       nu(), params_.gravity, dt, &w.before, &w.held(), w.open_area()});
        push_open_faces(velocity_, 0.5 * dt);
        w.friction.apply(velocity_, dt, nu());
        leave(velocity_);
        find_water();
        sides_.fill(velocity_);
        report_ = projection_.project(velocity_, pressure_, dt, params_.tolerance, true, &w.liquid.surplus());
        w.extension.extend(velocity_, w.wet, w.rows, w.held(), w.open_area());
        sides_.fill(velocity_);
    }

    /// At the surface the pressure falls to 0 within `slope`, not over the distance of the centres.
    void push_open_faces(FaceField<Dim, State>& u, Real weight) {
        for (const OpenFace& open : projection_.open_faces())
            if (open.plain != 0)
                u[open.axis][open.face] += weight * (open.slope - open.plain) * pressure_[open.cell];
    }

    void take_stage_where_full(FaceField<Dim>& carrier, Real dt) {
        const Layout<Dim>& l = grid_.layout();
        for (int a = 0; a < Dim; ++a) {
            std::vector<Real> swept(static_cast<std::size_t>(grid_.cells(Grid<Dim>::vertical)));
            for (std::size_t k = 0; k < swept.size(); ++k) {
                CellNumber<Dim> cell{};
                cell[Grid<Dim>::vertical] = static_cast<int>(k);
                swept[k] = dt * grid_.volume(cell) / grid_.size(a, cell[a]);
            }
            water_->rows.for_each_row([&](int plane, int row, const RowRange& r) {
                const Offset start = l.row_start(plane, row);
                Real* const __restrict c = carrier[a].data() + start;
                const Real* const __restrict u = velocity_[a].data() + start;
                const Real* const __restrict v = stage_[a].data() + start;
                const Real* const f = water_->held().data() + start;
                const Real* const g = water_->before.data() + start;
                const Real* const o = water_->walls ? water_->walls->open_area()[a].data() + start : nullptr;
                const Offset back = l.stride[a];
                for (int i = r.begin; i < r.end; ++i) {
                    const Real area = swept[static_cast<std::size_t>(Dim == 3 ? row : i)];
                    const bool full = f[i] == 1 && f[i - back] == 1 && g[i] == 1 && g[i - back] == 1;
                    const Real open = o ? o[i] : 1;
                    c[i] = full ? c[i] + (v[i] - u[i]) * (area * open) : c[i];
                }
            });
        }
    }

    /// Rows that hold water and what is near, and faces that carry momentum.
    void find_rows() {
        Water& w = *water_;
        std::array<bool, Dim> wraps;
        for (int a = 0; a < Dim; ++a) wraps[static_cast<std::size_t>(a)] = params_.sides.periodic(a);
        w.rows = w.liquid.wet().dilated(VelocityExtension<Dim>::layers, wraps);
        const Layout<Dim>& l = grid_.layout();
        for (int a = 0; a < Dim; ++a)
            w.rows.for_each_plane([&](int plane) {
                for (int row = 0; row < l.rows_per_plane(); ++row) {
                    RowRange r = w.liquid.wet().row(plane, row);
                    const int first = params_.sides.periodic(a) ? 0 : 1;
                    if (a == Layout<Dim>::inner) {
                        r = {std::max(first, r.begin), std::min(l.row_length(), r.end + 1)};
                        if (w.liquid.wet().row(plane, row).empty()) r = {};
                    } else {
                        const int number = a == Layout<Dim>::outer ? plane : row;
                        if (number == 0 && first == 1) {
                            r = {};
                        } else {
                            const int below = number > 0 ? number - 1 : l.cells[a] - 1;
                            r = hull(r, a == Layout<Dim>::outer ? w.liquid.wet().row(below, row)
                                                                : w.liquid.wet().row(plane, below));
                        }
                    }
                    w.faces[a].row(plane, row) = r.empty() ? RowRange{} : r;
                }
            });
    }

    /// Which cells are wet below the present surface, and where it crosses the lines between centres.
    void find_water() {
        Water& w = *water_;
        find_rows();
        w.hold();
        const Layout<Dim>& l = grid_.layout();
        WetRows<Dim> rows = w.rows;
        rows.include(w.rows_before);
        const Field<Real>& f = w.liquid.fraction();
        w.open.clear();
        rows.for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = l.row_start(plane, row);
            for (int i = r.begin; i < r.end; ++i) {
                const bool is = f[start + i] >= 0.5 && w.is_open(start + i);
                w.wet[start + i] = is;
                if (!is) pressure_[start + i] = 0;
            }
        });
        copy_wet_around();
        for (int plane = 0; plane < l.planes(); ++plane)
            for (int row = 0; row < l.rows_per_plane(); ++row) {
                const RowRange r = w.rows.row(plane, row);
                const Offset start = l.row_start(plane, row);
                for (int i = r.begin; i < r.end; ++i)
                    if (w.wet[start + i] == 0 && w.is_open(start + i))
                        add_open_faces(start + i, plane, row, i);
            }
        auto leaving = projection_.outflows(w.wet);
        w.open.insert(w.open.end(), leaving.begin(), leaving.end());
        projection_.set({w.wet, rows, w.open, w.walls ? &w.walls->open_volume() : nullptr, w.open_area()});
    }

    void copy_wet_around() {
        for (int a = 0; a < Dim; ++a)
            if (params_.sides.periodic(a)) return sides_.fill_cells(water_->wet);
    }

    /// The faces between a dry cell and its wet neighbours.
    void add_open_faces(Offset c, int plane, int row, int i) {
        Water& w = *water_;
        const Layout<Dim>& l = grid_.layout();
        const int level = Dim == 3 ? row : i;
        for (int a = 0; a < Dim; ++a) {
            const Offset s = l.stride[a];
            const int number = a == Layout<Dim>::outer ? plane : a == Layout<Dim>::inner ? i : row;
            const auto add = [&](Offset liquid, Offset face, int above, int lower_number, int liquid_level) {
                const Real plain = above / grid_.gap(a, lower_number);
                const Real share = w.liquid.surface_share(liquid, liquid_level, a, -above, 0.01);
                w.open.push_back({face, liquid, a, plain / share, plain});
            };
            // `above`: 1 where the wet cell is the upper one.
            const bool vertical = a == Grid<Dim>::vertical;
            if ((number + 1 < l.cells[a]) && w.wet[c + s]) add(c + s, c + s, 1, number + 1, level + vertical);
            if (number > 0 && w.wet[c - s]) add(c - s, c, -1, number, level - vertical);
        }
    }

    /// Faces through which water leaves go on as the ones before them.
    void leave(FaceField<Dim, State>& u) {
        const Layout<Dim>& l = grid_.layout();
        for (int a = 0; a < Dim; ++a)
            for (const bool high : {false, true})
                if (params_.sides[a][static_cast<std::size_t>(high)] == Side::outflow)
                    sides_.along_side(a, high, [&](Offset c, std::size_t) {
                        const Offset s = l.stride[a];
                        if (high)
                            u[a][c + s] = u[a][c];
                        else
                            u[a][c] = u[a][c + s];
                    });
    }

    struct Water {
        Water(const Grid<Dim>& grid, const Sides<Dim>& sides, const WallLaw& law)
            : liquid(grid, sides), friction(grid, sides, law, nullptr), before(grid.layout().total),
              carrier(face_field<Dim>(grid.layout())), wet(grid.layout().total), rows(grid.layout()),
              rows_before(grid.layout()), extension(grid.layout()) {
            for (auto& f : faces) f = WetRows<Dim>(grid.layout());
            // The projection begins with a full box.
            for (int plane = 0; plane < grid.layout().planes(); ++plane)
                for (int row = 0; row < grid.layout().rows_per_plane(); ++row)
                    rows_before.row(plane, row) = {0, grid.layout().row_length()};
        }
        /// Liquid in each cell, as a share of the whole cell [-].
        const Field<Real>& held() const noexcept { return walls ? held_in_open : liquid.fraction(); }
        void hold() {
            if (!walls) return;
            if (held_in_open.size() == 0) held_in_open = Field<Real>(liquid.fraction().size());
            const Field<Real>&f = liquid.fraction(), &v = walls->open_volume();
            for (Offset c = 0; c < f.size(); ++c) held_in_open[c] = f[c] * v[c];
        }
        const FaceField<Dim>* open_area() const noexcept { return walls ? &walls->open_area() : nullptr; }
        bool is_open(Offset c) const noexcept { return !walls || walls->open_volume()[c] > 0; }

        VolumeOfFluid<Dim> liquid;
        std::optional<Walls<Dim>> walls;
        WallFriction<Dim> friction;
        Field<Real> held_in_open;
        Field<Real> before;      ///< liquid share at the beginning of the step
        FaceField<Dim> carrier;  ///< what carries momentum in the stage at work [m3]
        Field<std::uint8_t> wet;
        WetRows<Dim> rows, rows_before;
        std::array<WetRows<Dim>, Dim> faces;
        VelocityExtension<Dim> extension;
        std::vector<OpenFace> open;
        VolumeStep moved;
    };

    Params params_;
    Grid<Dim> grid_;
    VelocitySides<Dim> sides_;
    Projection<Dim, State> projection_;
    FaceField<Dim, State> velocity_, stage_;
    Field<State> pressure_;
    Real time_ = 0, fastest_ = 0;  ///< [s], sum |u_a| / h_a at most [1/s]
    typename Projection<Dim, State>::Report report_;
    std::optional<Water> water_;
};

}  // namespace abrade
