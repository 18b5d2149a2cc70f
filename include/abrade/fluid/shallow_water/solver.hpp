#pragma once
// Depth-averaged water, the state and one step of it.

#include <abrade/core/parallel.hpp>
#include <abrade/fluid/fluid_model.hpp>
#include <abrade/fluid/shallow_water/parameters.hpp>
#include <abrade/fluid/shallow_water/sweep.hpp>

namespace abrade {

/// Cells, bed, state; steps that are taken whole or not at all.
template <int Dim>
class ShallowSolver {
public:
    explicit ShallowSolver(const ShallowWaterParams<Dim>& p)
        : grid_(p.low, p.high, p.cells), forces_{.pressing = -p.gravity.z(),
                                                 .along = {p.gravity.x(), p.gravity.y()},
                                                 .gravity_manning2 = p.gravity.norm() * square(p.manning),
                                                 .dry_depth = p.dry_depth,
                                                 .velocity_limit = p.velocity_limit},
          tiles_(grid_) {
        for (std::size_t a = 0; a < Dim; ++a)
            for (std::size_t end = 0; end < 2; ++end)
                boundaries_[a][end] =
                    ShallowBoundaryCells<Dim>(p.boundaries[a][end], grid_, static_cast<int>(a), end == 1);
        lay_bed(p);
        pour(p);
    }

    const ShallowGrid<Dim>& grid() const noexcept { return grid_; }
    const CellColumn& ground() const noexcept { return ground_; }  ///< [m]
    const CellColumn& bed() const noexcept { return bed_.cell; }   ///< and what solids add to it [m]
    /// `raised`: by solids, cell by cell as the bed is [m]. What flows in flows in over the ground.
    void set_solids(const CellColumn& raised) {
        if (std::ranges::equal(raised, raised_)) return;
        raised_ = raised;
        raise_bed();
    }
    /// Of momentum over density and area [m2/s].
    void push(Index i, Index j, const Vec3& momentum) noexcept {
        const std::size_t k = grid_.at(i, j);
        ShallowState<Dim>& now = states_[current_];
        if (!(now.depth[k] > forces_.dry_depth)) return;
        for (std::size_t a = 0; a < Dim; ++a) now.speed[a][k] += momentum[static_cast<int>(a)] / now.depth[k];
    }
    const ShallowState<Dim>& state() const noexcept { return states_[current_]; }
    Index steps() const noexcept { return steps_; }
    Index steps_repeated() const noexcept { return repeated_; }
    Real volume_at_start() const noexcept { return volume_at_start_; }
    Real volume_in(int axis, bool high) const noexcept {
        return volume_in_[static_cast<std::size_t>(axis)][high];
    }
    template <class Visit>
    void each_cell(Visit&& visit) const {
        for (Index j = 0; j < grid_.count(1); ++j)
            for (Index i = 0; i < grid_.count(0); ++i) visit(i, j);
    }
    Real volume() const noexcept {
        Real sum = 0;
        for (Index j = 0; j < grid_.count(1); ++j) {
            Real row = 0;
            for (Index i = 0; i < grid_.count(0); ++i) row += state().depth[grid_.at(i, j)];
            sum += row;
        }
        return sum * grid_.cell_size();
    }
    Index cells_worked_on() const noexcept {
        Index cells = 0;
        for (const Index t : tiles_.due) cells += tiles_.list[static_cast<std::size_t>(t)].due().cells();
        return cells;
    }

    /// What `courant` allows, with the cell that sets it, counted row by row.
    FluidStep stable_step(Real courant) const noexcept {
        FluidStep step;
        if (largest_rate_ > 0) step.lower(courant / largest_rate_, "CFL", largest_rate_cell());
        if (const Real inflow = largest_inflow_rate(); inflow > 0)
            step.lower(courant / inflow, "CFL of the inflow");
        return step;
    }

    /// One step of at most `dt`; gives back the time that it took: half, a quarter ... of dt where a depth
    /// would have become negative.
    Real step(Real dt, Real time) {
        tiles_.find_reached(periodic_);
        each_side([&](ShallowBoundaryCells<Dim>& side) {
            if (side.is_inflow()) tiles_.add_reached(side.first_cells(grid_));
        });
        ShallowState<Dim>&present = states_[current_], &next = states_[1 - current_];
        each_side(
            [&](ShallowBoundaryCells<Dim>& side) { side.fill(grid_, bed_, forces_.pressing, present); });
        for (int halvings = 0;; ++halvings, dt *= 0.5) {
            if (!try_step(present, next, dt)) {
                if (halvings == most_halvings || !has_negative_depth(next)) fail_step(next, dt, time);
                ++repeated_;
                continue;
            }
            current_ = 1 - current_;
            ++steps_;
            largest_rate_ = 0;
            for (const Index t : tiles_.due)
                largest_rate_ =
                    std::max(largest_rate_, tiles_.list[static_cast<std::size_t>(t)].largest_rate);
            each_side([&](ShallowBoundaryCells<Dim>& side) {
                volume_in_[static_cast<std::size_t>(side.axis())][side.high()] += dt * side.rate();
            });
            return dt;
        }
    }

    static void fields(auto&& field) {
        field("tiles", &ShallowSolver::tiles_), field("boundaries", &ShallowSolver::boundaries_),
            field("states", &ShallowSolver::states_), field("current", &ShallowSolver::current_),
            field("largest_rate", "1/s", &ShallowSolver::largest_rate_),
            field("volume_at_start", "m3", &ShallowSolver::volume_at_start_),
            field("volume_in", "m3", &ShallowSolver::volume_in_), field("steps", &ShallowSolver::steps_),
            field("repeated", &ShallowSolver::repeated_), field("raised", "m", &ShallowSolver::raised_);
    }
    void restored() {
        for (const ShallowState<Dim>& state : states_)
            require(state.depth.size() == grid_.size(),
                    {"ShallowWater.cells with their margins",
                     "as many as the checkpoint has, " + std::to_string(state.depth.size()), "",
                     "build the water as it was when it was saved"},
                    static_cast<Real>(grid_.size()));
        if (!raised_.empty()) raise_bed();
    }

private:
    static constexpr int most_halvings = 10;

    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }
    Real at_y(Index j) const noexcept { return Dim == 2 ? grid_.centre(1, j) : 0; }
    void each_side(auto&& visit) {
        for (auto& ends : boundaries_)
            for (auto& side : ends) visit(side);
    }

    void lay_bed(const ShallowWaterParams<Dim>& p) {
        bed_.cell.assign(grid_.size(), 0.0);
        if (p.bed)
            each_cell([&](Index i, Index j) {
                const Real z = p.bed(grid_.centre(0, i), at_y(j));
                if (!std::isfinite(z)) require_finite(z, "ShallowWater.bed in " + grid_.name_of(i, j), "m");
                bed_.cell[grid_.at(i, j)] = z;
            });
        each_side([&](ShallowBoundaryCells<Dim>& side) { side.extend_bed(grid_, bed_.cell); });
        ground_ = bed_.cell;
        bed_.find_faces(grid_);
        each_side([&](ShallowBoundaryCells<Dim>& side) {
            side.settle(grid_, bed_, forces_.pressing);
            if (side.is_periodic()) periodic_[static_cast<std::size_t>(side.axis())] = true;
        });
    }

    void raise_bed() {
        bed_.cell = ground_;
        for (std::size_t k = 0; k < raised_.size(); ++k) bed_.cell[k] += raised_[k];
        each_side([&](ShallowBoundaryCells<Dim>& side) { side.extend_bed(grid_, bed_.cell); });
        bed_.find_faces(grid_);
    }

    void pour(const ShallowWaterParams<Dim>& p) {
        ShallowState<Dim> start(grid_.size());
        if (p.surface)
            each_cell([&](Index i, Index j) {
                const std::size_t k = grid_.at(i, j);
                const Real x = grid_.centre(0, i), y = at_y(j), level = p.surface(x, y);
                if (!std::isfinite(level))
                    require_finite(level, "ShallowWater.surface in " + grid_.name_of(i, j), "m");
                start.depth[k] = std::max(0.0, level - bed_.cell[k]);
                if (start.depth[k] <= p.dry_depth) return;
                for (std::size_t a = 0; a < Dim; ++a) {
                    if (!p.speed[a]) continue;
                    const Real u = p.speed[a](x, y);
                    if (!(std::abs(u) <= p.velocity_limit)) {  // a name of its own for each cell takes long
                        const std::string field = "ShallowWater.speed in " + grid_.name_of(i, j);
                        require_finite(u, field, "m/s");
                        require(false,
                                {field,
                                 "within ShallowWater.velocity_limit (" + to_text(p.velocity_limit) + " m/s)",
                                 "m/s", "raise velocity_limit if it is meant"},
                                u);
                    }
                    start.speed[a][k] = u;
                }
            });
        states_.fill(start);
        volume_at_start_ = volume();
        for (ShallowTile& tile : tiles_.list) {
            tile.largest_rate = 0;
            for (Index j = tile.cells.first[1]; j < tile.cells.last[1]; ++j)
                for (Index i = tile.cells.first[0]; i < tile.cells.last[0]; ++i) {
                    const Real rate = rate_of(i, j);
                    if (rate == 0) continue;
                    tile.wet = tile.wet.with({{i, j}, {i + 1, j + 1}});
                    tile.largest_rate = std::max(tile.largest_rate, rate);
                }
            largest_rate_ = std::max(largest_rate_, tile.largest_rate);
        }
    }

    /// Sum over axes of (|u| + c)/dx [1/s], 0 in a dry cell.
    Real rate_of(Index i, Index j) const noexcept {
        const std::size_t k = grid_.at(i, j);
        const Real h = state().depth[k];
        if (!(h > forces_.dry_depth)) return 0;
        Real sum = 0;
        for (int a = 0; a < Dim; ++a)
            sum +=
                (std::abs(state().speed[static_cast<std::size_t>(a)][k]) + std::sqrt(forces_.pressing * h)) /
                grid_.spacing(a);
        return sum;
    }
    Index largest_rate_cell() const noexcept {
        const ShallowTile* fastest = &tiles_.list.front();
        for (const ShallowTile& tile : tiles_.list)
            if (tile.largest_rate > fastest->largest_rate) fastest = &tile;
        Index found = -1;
        Real most = 0;
        for (Index j = fastest->cells.first[1]; j < fastest->cells.last[1]; ++j)
            for (Index i = fastest->cells.first[0]; i < fastest->cells.last[0]; ++i)
                if (const Real rate = rate_of(i, j); rate > most) most = rate, found = j * grid_.count(0) + i;
        return found;
    }
    Real largest_inflow_rate() const noexcept {
        Real most = 0;
        for (int a = 0; a < Dim; ++a)
            for (const auto& side : boundaries_[static_cast<std::size_t>(a)])
                most = std::max(
                    most, side.largest_rate(grid_.spacing(a), grid_.spacing(Dim - 1 - a), forces_.pressing));
        return most;
    }

    /// False where a depth or a speed is unsound. Leaves the present state alone.
    bool try_step(const ShallowState<Dim>& present, ShallowState<Dim>& next, Real dt) {
        each_side(
            [](ShallowBoundaryCells<Dim>& side) { std::fill(side.flux.begin(), side.flux.end(), 0.0); });
        // A worker's rows are made once for several tiles. Which tiles go together changes no bit.
        const auto due = static_cast<Index>(tiles_.due.size()), workers = std::min<Index>(due, 16);
        parallel_tasks(workers, [&](Index worker) {
            ShallowSweep<Dim> sweep(grid_, bed_, forces_, boundaries_);
            for (Index n = worker * due / workers; n < (worker + 1) * due / workers; ++n)
                sweep.run(present, next, dt, tiles_.list[at(tiles_.due[at(n)])]);
        });
        return std::none_of(tiles_.due.begin(), tiles_.due.end(),
                            [&](Index t) { return tiles_.list[at(t)].unsound; });
    }

    bool has_negative_depth(const ShallowState<Dim>& state) const noexcept {
        bool negative = false;
        each_cell([&](Index i, Index j) { negative |= state.depth[grid_.at(i, j)] < 0; });
        return negative;
    }

    [[noreturn]] void fail_step(const ShallowState<Dim>& wrong, Real dt, Real time) const {
        std::string what = "nothing is known of the cause";
        each_cell([&](Index i, Index j) {
            const std::size_t k = grid_.at(i, j);
            const Real h = wrong.depth[k], was = state().depth[k];
            Real speed2 = 0, was2 = 0;
            for (std::size_t a = 0; a < Dim; ++a)
                speed2 += square(wrong.speed[a][k]), was2 += square(state().speed[a][k]);
            const Real speed = std::sqrt(speed2);
            std::string cause;
            if (!std::isfinite(h) || !std::isfinite(speed))
                cause = "is not finite: look for forces or an inflow beyond all measure";
            else if (speed > forces_.velocity_limit)
                cause = "is faster than ShallowWater.velocity_limit, " + short_text(forces_.velocity_limit) +
                        " m/s: look for a bed that falls off a cliff, or raise it";
            else if (h < 0)
                cause =
                    "has run below its bed, even with a 1024th of the step: take a smaller "
                    "ShallowWater.courant";
            else
                return;
            what = grid_.name_of(i, j) + " " + cause + "; depth " + short_text(h) + " m, speed " +
                   short_text(speed) + " m/s, before " + short_text(was) + " m, " +
                   short_text(std::sqrt(was2)) + " m/s";
        });
        throw FluidError(what + "; water is as it was at t = " + short_text(time) + " s, its step " +
                         std::to_string(steps_) + " of " + short_text(dt) + " s is not taken");
    }

    ShallowGrid<Dim> grid_;
    ShallowBed<Dim> bed_;
    CellColumn ground_, raised_;  ///< of the bed: without solids, by solids [m]
    ShallowForces forces_;
    ShallowTiles<Dim> tiles_;
    std::array<std::array<ShallowBoundaryCells<Dim>, 2>, Dim> boundaries_;
    std::array<bool, 2> periodic_{};
    std::array<ShallowState<Dim>, 2> states_;  ///< the present one, and the next
    std::size_t current_ = 0;
    Real largest_rate_ = 0;  ///< of all cells [1/s]
    Real volume_at_start_ = 0;
    std::array<std::array<Real, 2>, Dim> volume_in_{};
    Index steps_ = 0, repeated_ = 0;
};

}  // namespace abrade
