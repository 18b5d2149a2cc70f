#pragma once
// Depth-averaged water: a fluid that changes in time, in one or two dimensions.

#include <abrade/core/fields.hpp>
#include <abrade/fluid/shallow_water/solver.hpp>

namespace abrade {

/// Water averaged over its depth.
///   dh/dt + d(hu)/dx + d(hv)/dy = 0
///   d(hu)/dt + d(hu^2 + g h^2/2)/dx + d(huv)/dy = -g h dz_b/dx + g_x h - g_n n^2 |u| u / h^(1/3), likewise v
/// h depth, z_b height of the bed [m], u, v speeds [m/s]
/// g gravity that presses on the bed, g_x along it, g_n all of it [m/s2], n Manning's [s/m^(1/3)]
/// Validity: waves that are longer than water is deep: pressure is hydrostatic.
/// Throws InputError for parameters out of their range, FluidError where a step goes wrong.
/// Source: A. J. C. Barre de Saint-Venant, C. R. Acad. Sci. 73 (1871) 147; hydrostatic reconstruction: E.
/// Audusse et al., SIAM J. Sci. Comput. 25 (2004) 2050, doi:10.1137/S1064827503431090.
///
/// Finite volumes: limited linear profiles of surface and speed (van Leer 1977), hydrostatic reconstruction,
/// HLLC fluxes (Toro 2001), half a step of prediction (van Leer 1984), implicit friction. Of second order
/// where water is smooth; lakes stay at rest over any bed, depths stay positive, volume is kept to round-off,
/// uniform flow down a slope is exact. Works only where water is and may come in the next step. A step that
/// would make a depth negative is repeated at half its length.
template <int Dim>
class ShallowWater {
public:
    static constexpr std::string_view name = "ShallowWater";
    using Params = ShallowWaterParams<Dim>;

    explicit ShallowWater(Params params)
        : params_(std::move(params)), solver_((params_.validate(), params_)) {
        roughness_length_ = std::pow(26 * params_.manning, 6) / 30;
        time_ = params_.start_time;
    }
    const Params& params() const noexcept { return params_; }

    // --- going on ------------------------------------------------------------------------------

    Real time() const noexcept { return time_; }  ///< [s]

    /// From `courant`, with the cell that sets it, counted row by row; infinite where nothing flows.
    FluidStep stable_step() const noexcept { return solver_.stable_step(params_.courant); }

    /// Goes on to exactly that time. Throws FluidError, which leaves the state before the step that went
    /// wrong; InputError where the time is not finite.
    void advance(Real to_time) {
        require_finite(to_time, "ShallowWater.advance: to_time", "s");
        while (time_ < to_time) {
            const Real left = to_time - time_;
            Real dt = stable_step().seconds;
            const bool last = dt >= left * (1 - 1e-9);
            if (last)
                dt = left;
            else if (2 * dt > left)  // no sliver of a step is left: the last two share
                dt = 0.5 * left;
            const Real taken = solver_.step(dt, time_);
            time_ = last && taken == dt ? to_time : time_ + taken;
        }
    }

    // --- what solids do to it ------------------------------------------------------------------

    /// How high solids would stand over the plan of each cell [m], from here on: water stands on top of them.
    void set_solids(const CellColumn& raised) { solver_.set_solids(raised); }
    /// Gives a wet cell momentum over density and area, along the plane [m2/s].
    void push(Index i, Index j, const Vec3& momentum) noexcept { solver_.push(i, j, momentum); }

    // --- what stones feel ----------------------------------------------------------------------

    /// Water at a point, between the centres of cells. At a height z above the bed it moves at
    ///   u(z) = U h ln(1 + z/z_0) / ((h + z_0) ln(1 + h/z_0) - h),  z_0 = (26 n)^6 / 30,
    /// as UniformFlow has it, or at U all over. Beyond the grid: as at its edge.
    FluidSample sample(const Vec3& x, Real /*t*/) const noexcept {
        const Column column = column_at(x);
        FluidSample at{Vec3::Zero(), column.surface - x.z(), params_.density, params_.viscosity};
        if (!(column.depth > 0)) return at;
        const Real share = profile_share(std::clamp(x.z() - column.bed, 0.0, column.depth), column.depth);
        for (int a = 0; a < Dim; ++a) at.velocity[a] = share * column.speed[static_cast<std::size_t>(a)];
        return at;
    }

    // --- what it is like -----------------------------------------------------------------------

    const ShallowGrid<Dim>& grid() const noexcept { return solver_.grid(); }
    Real depth(Index i, Index j = 0) const noexcept {
        return solver_.state().depth[grid().at(i, j)];
    }                                                                                            ///< [m]
    Real bed(Index i, Index j = 0) const noexcept { return solver_.ground()[grid().at(i, j)]; }  ///< [m]
    /// Of water and of the solids in it [m].
    Real surface(Index i, Index j = 0) const noexcept { return depth(i, j) + solver_.bed()[grid().at(i, j)]; }
    Real speed(int axis, Index i, Index j = 0) const noexcept {  ///< [m/s]
        return solver_.state().speed[static_cast<std::size_t>(axis)][grid().at(i, j)];
    }
    /// Through column i of cells, along x [m3/s]; in one dimension, per width [m2/s].
    Real discharge(Index i) const noexcept {
        Real sum = 0;
        for (Index j = 0; j < grid().count(1); ++j) sum += depth(i, j) * speed(0, i, j);
        return Dim == 2 ? sum * grid().spacing(1) : sum;
    }
    Index steps() const noexcept { return solver_.steps(); }
    Index steps_repeated() const noexcept { return solver_.steps_repeated(); }    ///< at half their length
    Index cells_worked_on() const noexcept { return solver_.cells_worked_on(); }  ///< in the last step

    Real volume() const noexcept { return solver_.volume(); }  ///< [m3]; in one dimension, per width [m2]
    /// What has come in through one end of an axis since the start, less what has left [m3].
    Real volume_in(int axis, bool high) const noexcept { return solver_.volume_in(axis, high); }
    /// Volume against what it was and what came in, over all that was and passed [-].
    Real volume_residual() const noexcept {
        Real in = 0, moved = solver_.volume_at_start();
        for (int a = 0; a < Dim; ++a)
            for (const bool high : {false, true})
                in += volume_in(a, high), moved += std::abs(volume_in(a, high));
        return moved > 0 ? std::abs(volume() - solver_.volume_at_start() - in) / moved : 0;
    }

    /// Columns for a file, cell by cell along x, row by row.
    struct Columns {
        std::vector<Real> depth, surface, speed_x, speed_y;
        /// They last as long as the columns do.
        std::vector<FieldView> fields() const {
            std::vector<FieldView> all{
                {"depth", "m", 1, depth}, {"surface", "m", 1, surface}, {"speed_x", "m/s", 1, speed_x}};
            if constexpr (Dim == 2) all.push_back({"speed_y", "m/s", 1, speed_y});
            return all;
        }
    };
    Columns columns() const {
        Columns all;
        solver_.each_cell([&](Index i, Index j) {
            all.depth.push_back(depth(i, j)), all.surface.push_back(surface(i, j));
            all.speed_x.push_back(speed(0, i, j));
            if constexpr (Dim == 2) all.speed_y.push_back(speed(1, i, j));
        });
        return all;
    }

    static void fields(auto&& field) {
        field("solver", &ShallowWater::solver_), field("time", "s", &ShallowWater::time_);
    }

private:
    /// Water over one place of the plane.
    struct Column {
        Real depth = 0, surface = 0, bed = 0;
        std::array<Real, Dim> speed{};
    };

    /// Between the centres around it: the bed linearly, water by the same weights among cells that are wet.
    Column column_at(const Vec3& x) const noexcept {
        std::array<std::array<Index, 2>, 2> cell{};
        std::array<std::array<Real, 2>, 2> weight{{{1, 0}, {1, 0}}};
        for (int a = 0; a < Dim; ++a) {
            const auto s = static_cast<std::size_t>(a);
            const Real last = static_cast<Real>(grid().count(a) - 1);
            const Real place =
                std::min(last, std::max(0.0, (x[a] - grid().low(a)) / grid().spacing(a) - 0.5));
            const auto before = static_cast<Index>(place);
            cell[s] = {before, std::min(before + 1, grid().count(a) - 1)};
            weight[s][1] = place - before, weight[s][0] = 1 - weight[s][1];
        }
        Column at;
        Real wet = 0;
        const ShallowState<Dim>& state = solver_.state();
        for (std::size_t q = 0; q < Dim; ++q)
            for (std::size_t p = 0; p < 2; ++p) {
                const std::size_t k = grid().at(cell[0][p], cell[1][q]);
                const Real share = weight[0][p] * weight[1][q], h = state.depth[k], z = solver_.bed()[k];
                at.bed += share * solver_.ground()[k];
                if (!(h > params_.dry_depth)) continue;
                wet += share, at.surface += share * (h + z);
                for (std::size_t a = 0; a < Dim; ++a) at.speed[a] += share * state.speed[a][k];
            }
        if (wet > 0) {
            at.surface /= wet;
            for (Real& u : at.speed) u /= wet;
            at.depth = std::max(0.0, at.surface - at.bed);
        } else {
            at.surface = FluidSample{}.depth;  // not the bed's: a body that reaches below that is as dry
        }
        return at;
    }

    /// Speed at a height over the mean speed.
    Real profile_share(Real height, Real depth) const noexcept {
        const Real z0 = roughness_length_;
        if (params_.profile == VelocityProfile::uniform || z0 == 0) return 1;
        const Real mean = (depth + z0) * std::log1p(depth / z0) - depth;
        return mean > 0 ? depth * std::log1p(height / z0) / mean : 1;
    }

    Params params_;
    ShallowSolver<Dim> solver_;
    Real roughness_length_ = 0;  ///< z_0 [m]
    Real time_ = 0;
};

static_assert(AdvancingFluid<ShallowWater<1>>);
static_assert(AdvancingFluid<ShallowWater<2>>);

}  // namespace abrade
