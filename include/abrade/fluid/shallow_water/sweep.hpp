#pragma once
// Depth-averaged water, one step of one tile: slopes, prediction, fluxes and new states, row by row while
// they are in cache.

#include <abrade/fluid/shallow_water/boundary_conditions.hpp>

namespace abrade {

/// What drives water and holds it back.
struct ShallowForces {
    Real pressing = standard_gravity;  ///< gravity into the bed [m/s2]
    std::array<Real, 2> along{0, 0};   ///< along x, y: a slope that the frame is tilted by [m/s2]
    Real gravity_manning2 = 0;         ///< g n^2 [m^(1/3)]
    Real dry_depth = 1e-5;             ///< below it water stands still [m]
    Real velocity_limit = 100;         ///< beyond it a run is wrong [m/s]
};

/// A step of second order by one flux for each face (MUSCL-Hancock: B. van Leer, SIAM J. Sci. Stat. Comput. 5
/// (1984) 1, doi:10.1137/0905001): limited linear profiles of surface and speed, moved on by half a step by
/// what they do within their cell, meet at the faces. Two Runge-Kutta stages would need twice the fluxes for
/// the same order.
///
/// Numbers are packs; what stands in lanes behind a row's end means nothing.
template <int Dim>
class ShallowSweep {
public:
    ShallowSweep(const ShallowGrid<Dim>& grid, const ShallowBed<Dim>& bed, const ShallowForces& forces,
                 std::array<std::array<ShallowBoundaryCells<Dim>, 2>, Dim>& boundaries) noexcept
        : grid_(grid), bed_(bed), forces_(forces), boundaries_(boundaries) {}

    /// Takes the tile's cells from one state to the next. Also finds which are wet, how fast their waves are,
    /// and whether all is sound.
    [[gnu::flatten]] void run(const ShallowState<Dim>& from, ShallowState<Dim>& to, Real dt,
                              ShallowTile& tile) noexcept {
        from_ = &from, to_ = &to, dt_ = dt;
        const CellBox box = tile.due();
        first_ = box.first[0], last_ = box.last[0];
        tile.wet = {}, tile.largest_rate = 0, tile.unsound = false;
        if constexpr (Dim == 2) {
            level(box.first[1] - 2), level(box.first[1] - 1);
            predict_row(box.first[1] - 1), predict_row(box.first[1]);
            flux_across(box.first[1] - 1);
        }
        for (Index j = box.first[1]; j < box.last[1]; ++j) {
            if constexpr (Dim == 2)
                predict_row(j + 1), flux_across(j);
            else
                predict_row(j);
            flux_along(j);
            if (forces_.gravity_manning2 > 0)
                update<true>(j, tile);
            else
                update<false>(j, tile);
        }
    }

private:
    static constexpr Index room = ShallowTiles<Dim>::width + 2 * ShallowGrid<Dim>::margin;
    static constexpr int lanes = pack_lanes;
    static constexpr std::size_t rows = Dim;  ///< that are needed at a time
    struct alignas(64) Row {
        std::array<Real, static_cast<std::size_t>(room)> number{};
        Real& operator[](std::size_t i) noexcept { return number[i]; }
        const Real& operator[](std::size_t i) const noexcept { return number[i]; }
    };
    /// A row of cells half a step on, with half the changes across each cell.
    struct Predicted {
        Row surface{};                                         ///< [m]
        Row most{};                                            ///< depth that may be shown to a face [m]
        std::array<Row, Dim> speed{};                          ///< [m/s]
        std::array<Row, Dim> surface_change{};                 ///< [axis] [m]
        std::array<std::array<Row, Dim>, Dim> speed_change{};  ///< [axis][of which speed] [m/s]
    };
    struct Fluxes {
        Row mass{}, low{}, high{}, along{};
    };

    static Pack load(const Real* from) noexcept { return Pack::load_from_anywhere(from); }
    static void put(Real* to, Pack value) noexcept { std::memcpy(to, &value.lanes, sizeof(Pack::Native)); }
    /// Where cell i of the tile stands in a row of ours.
    std::size_t here(Index i) const noexcept {
        return static_cast<std::size_t>(i - first_ + ShallowGrid<Dim>::margin);
    }
    std::size_t cell(Index i, Index j) const noexcept { return grid_.at(i, j); }
    Row& surface(Index j) noexcept { return surface_[static_cast<std::size_t>(j + 8) % 4]; }
    Predicted& predicted(Index j) noexcept { return predicted_[static_cast<std::size_t>(j + 8) % rows]; }
    Fluxes& across(Index j) noexcept { return across_[static_cast<std::size_t>(j + 8) % rows]; }

    /// The surface of a row.
    void level(Index j) noexcept {
        Row& to = surface(j);
        // Packs stand where those of the state do; slopes of the cells beside the row want two beyond it.
        for (Index i = first_ - 2 * lanes; i < last_ + lanes + 2; i += lanes) {
            const std::size_t k = cell(i, j);
            put(&to[here(i)], load(&from_->depth[k]) + load(&bed_.cell[k]));
        }
    }

    void predict_row(Index j) noexcept {
        level(Dim == 2 ? j + 1 : j);
        if (forces_.gravity_manning2 > 0)
            predict<true>(j);
        else
            predict<false>(j);
    }

    /// Half a step on, with what happens within a cell:
    ///   h_t = -(h u_x + u h_x) - (h v_y + v h_y),  u_t = -u u_x - v u_y - g eta_x + g_x - k u,  likewise v.
    template <bool rough>
    void predict(Index j) noexcept {
        const Row& middle = surface(j);
        Predicted& to = predicted(j);
        const std::size_t stride = static_cast<std::size_t>(grid_.stride());
        const Pack dry(forces_.dry_depth), half_step(0.5 * dt_), press(forces_.pressing);
        const std::array<Pack, 2> per{Pack(dt_ / grid_.spacing(0)), Pack(dt_ / grid_.spacing(Dim - 1))};
        for (Index i = first_ - lanes; i <= last_; i += lanes) {
            const std::size_t b = here(i), k = cell(i, j);
            const Pack depth = load(&from_->depth[k]), level = load(&middle[b]);
            std::array<Pack, Dim> speed;
            for (std::size_t c = 0; c < Dim; ++c) speed[c] = load(&from_->speed[c][k]);
            Pack rise(0);
            std::array<Pack, Dim> gain;
            for (std::size_t c = 0; c < Dim; ++c) gain[c] = half_step * Pack(forces_.along[c]);
            for (std::size_t a = 0; a < Dim; ++a) {
                const std::size_t step = a == 0 ? 1 : stride;
                const Real* before = a == 0 ? &middle[b - 1] : &surface(j - 1)[b];
                const Real* after = a == 0 ? &middle[b + 1] : &surface(j + 1)[b];
                const Pack bed_change = load(&bed_.half_change[a][k]);
                const Pack change = change_above_bed(
                    limited_half_change(level - load(before), load(after) - level), bed_change, depth);
                put(&to.surface_change[a][b], change);
                std::array<Pack, Dim> speed_change;
                for (std::size_t c = 0; c < Dim; ++c) {
                    const Real* of = &from_->speed[c][k];
                    speed_change[c] =
                        limited_half_change(speed[c] - load(of - step), load(of + step) - speed[c]);
                    put(&to.speed_change[a][c][b], speed_change[c]);
                    gain[c] -= per[a] * speed[a] * speed_change[c];
                }
                gain[a] -= per[a] * press * change;
                rise -= per[a] * (depth * speed_change[a] + speed[a] * (change - bed_change));
            }
            const PackMask flows = depth > dry;
            Pack held(1);
            if constexpr (rough) held = reciprocal(Pack(1) + half_step * friction(max(depth, dry), speed));
            for (std::size_t c = 0; c < Dim; ++c)
                put(&to.speed[c][b], select(flows, (speed[c] + gain[c]) * held, Pack(0)));
            // A thin sheet may not run dry within half a step.
            put(&to.surface[b], level + select(flows, max(rise, Pack(-0.5) * depth), Pack(0)));
            put(&to.most[b], select(flows, depth + depth, Pack(0)));
        }
    }

    Pack friction(Pack depth, const std::array<Pack, Dim>& speed) const noexcept {
        Pack swift2 = speed[0] * speed[0];
        if constexpr (Dim == 2) swift2 += speed[1] * speed[1];
        return friction_rate(depth, swift2 * rsqrt(max(swift2, Pack(1e-200))), forces_.gravity_manning2);
    }

    /// Flux along an axis through a face, between cell `low` of one row and cell `high` of another, or of the
    /// same.
    WaterFlux<Pack> flux(const Predicted& low_row, std::size_t low, const Predicted& high_row,
                         std::size_t high, std::size_t axis, Pack bed) const noexcept {
        const auto at_high_end = [&](const Row& middle, const Row& change) {
            return load(&middle[low]) + load(&change[low]);
        };
        const auto at_low_end = [&](const Row& middle, const Row& change) {
            return load(&middle[high]) - load(&change[high]);
        };
        const Pack surface_low = at_high_end(low_row.surface, low_row.surface_change[axis]);
        const Pack surface_high = at_low_end(high_row.surface, high_row.surface_change[axis]);
        bed =
            bed_at_face(bed, surface_low, load(&low_row.most[low]), surface_high, load(&high_row.most[high]));
        const auto side = [&](Pack surface, const Predicted& row, const auto& at_end) {
            WaterBeside<Pack> water{max(surface - bed, Pack(0)),
                                    at_end(row.speed[axis], row.speed_change[axis][axis]), Pack(0)};
            if constexpr (Dim == 2)
                water.along = at_end(row.speed[1 - axis], row.speed_change[axis][1 - axis]);
            return water;
        };
        return water_flux(side(surface_low, low_row, at_high_end), side(surface_high, high_row, at_low_end),
                          forces_.pressing);
    }

    /// Fluxes through the faces between each cell of row j and the one before it.
    void flux_along(Index j) noexcept {
        const Predicted& row = predicted(j);
        for (Index i = first_; i <= last_; i += lanes) {
            const std::size_t b = here(i);
            const Pack bed = load(&bed_.face[0][cell(i, j)]);
            put(along_, b, flux(row, b - 1, row, b, 0, bed));
        }
        if (first_ == 0) pass_side(boundaries_[0][0], j, row, here(0), along_, here(0), cell(0, j));
        if (last_ == grid_.count(0))
            pass_side(boundaries_[0][1], j, row, here(last_ - 1), along_, here(last_), cell(last_, j));
    }

    /// Fluxes through the faces between rows j and j + 1.
    void flux_across(Index j) noexcept {
        if constexpr (Dim == 2) {
            const Predicted &low = predicted(j), &high = predicted(j + 1);
            Fluxes& fluxes = across(j);
            for (Index i = first_; i < last_; i += lanes) {
                const std::size_t b = here(i);
                const Pack bed = load(&bed_.face[1][cell(i, j + 1)]);
                put(fluxes, b, flux(low, b, high, b, 1, bed));
            }
            const auto at_end = [&](ShallowBoundaryCells<Dim>& side, const Predicted& row) {
                for (Index i = first_; i < std::min(last_, grid_.count(0)); ++i)
                    pass_side(side, i, row, here(i), fluxes, here(i), cell(i, j + 1));
            };
            if (j == -1) at_end(boundaries_[1][0], high);
            if (j == grid_.count(1) - 1) at_end(boundaries_[1][1], low);
        }
    }

    /// At an end of the grid: walls let nothing through, an inflow brings what it must, what passes is
    /// written down. `inner` is the cell inside, of `row`.
    void pass_side(ShallowBoundaryCells<Dim>& side, Index k, const Predicted& row, std::size_t inner,
                   Fluxes& fluxes, std::size_t b, std::size_t face) noexcept {
        const auto s = static_cast<std::size_t>(k), axis = static_cast<std::size_t>(side.axis());
        const Real inwards = side.high() ? -1 : 1;
        if (side.is_inflow()) {
            const Real surface = row.surface[inner] - inwards * row.surface_change[axis][inner];
            const Real shown = std::max(0.0, std::min(surface - bed_.face[axis][face], row.most[inner]));
            const auto incoming = side.incoming(s, shown, forces_.pressing);
            fluxes.mass[b] = inwards * incoming.mass;
            (side.high() ? fluxes.low : fluxes.high)[b] = incoming.momentum;
            fluxes.along[b] = 0;
        } else if (side.is_wall() || (side.is_outflow() && inwards * fluxes.mass[b] > 0)) {
            fluxes.mass[b] = fluxes.along[b] = 0;  // not to round-off only
        }
        side.flux[s] = fluxes.mass[b];
    }

    static void put(Fluxes& fluxes, std::size_t b, const WaterFlux<Pack>& flux) noexcept {
        put(&fluxes.mass[b], flux.mass), put(&fluxes.low[b], flux.low);
        put(&fluxes.high[b], flux.high);
        if constexpr (Dim == 2) put(&fluxes.along[b], flux.along);
    }

    template <bool rough>
    void update(Index j, ShallowTile& tile) noexcept {
        const Predicted& row = predicted(j);
        const Pack dry(forces_.dry_depth), dt(dt_), press(forces_.pressing);
        const Pack per_x(dt_ / grid_.spacing(0)), per_y(dt_ / grid_.spacing(Dim - 1));
        const Pack each_x(1 / grid_.spacing(0)), each_y(1 / grid_.spacing(Dim - 1));
        const Fluxes &y_low = across(j - 1), &y_high = across(j);
        Pack largest_rate(0);
        Index wet_first = last_, wet_last = first_;
        for (Index i = first_; i < last_; i += lanes) {
            const std::size_t b = here(i), k = cell(i, j);
            const Pack h = load(&from_->depth[k]);
            const Pack h_half = max(load(&row.surface[b]) - load(&bed_.cell[k]), Pack(0));
            const Pack pushed = (press + press) * h_half;  // by twice half the change of the surface
            Pack grown = per_x * (load(&along_.mass[b]) - load(&along_.mass[b + 1]));
            std::array<Pack, Dim> gain;  // of momentum
            gain[0] = per_x * (load(&along_.high[b]) - load(&along_.low[b + 1]) -
                               pushed * load(&row.surface_change[0][b]));
            if constexpr (Dim == 2) {
                grown += per_y * (load(&y_low.mass[b]) - load(&y_high.mass[b]));
                gain[0] += per_y * (load(&y_low.along[b]) - load(&y_high.along[b]));
                gain[1] = per_y * (load(&y_low.high[b]) - load(&y_high.low[b]) -
                                   pushed * load(&row.surface_change[1][b])) +
                          per_x * (load(&along_.along[b]) - load(&along_.along[b + 1]));
            }
            const Pack depth = h + grown;
            // Friction is implicit: q' = (q + dt L (1 + r/2)) / (1 + r + r^2/2), r = dt k of half a step on.
            // Of second order in dt, and exact where it holds the drive: dt L = r q.
            Pack more(1), held(1);
            if constexpr (rough) {
                std::array<Pack, Dim> speed_half;
                for (std::size_t c = 0; c < Dim; ++c) speed_half[c] = load(&row.speed[c][b]);
                const Pack r = dt * friction(max(h_half, dry), speed_half);
                more = Pack(1) + Pack(0.5) * r;
                held = reciprocal(Pack(1) + r * more);
            }
            const PackMask flows = depth > dry;
            const Pack thin = reciprocal(max(depth, dry)) * held,
                       wave = wave_speed(max(depth, dry), forces_.pressing);
            Pack rate = wave * (Dim == 2 ? each_x + each_y : each_x);
            PackMask sound = depth >= Pack(0);
            for (std::size_t c = 0; c < Dim; ++c) {
                const Pack flow =
                    h * load(&from_->speed[c][k]) + more * (gain[c] + dt * Pack(forces_.along[c]) * h_half);
                const Pack speed = select(flows, flow * thin, Pack(0)), size = max(speed, -speed);
                put(&to_->speed[c][k], speed);
                sound = sound & (size <= Pack(forces_.velocity_limit));
                rate += size * (c == 0 ? each_x : each_y);
            }
            put(&to_->depth[k], depth);
            PackMask counts = flows, unsound = !sound;
            if (i + lanes > grid_.count(0))
                counts = counts & inside_row(i), unsound = unsound & inside_row(i);
            tile.unsound |= any(unsound);
            largest_rate = max(largest_rate, select(counts, rate, Pack(0)));
            if (any(counts)) wet_first = std::min(wet_first, i), wet_last = i + lanes;
        }
        tile.largest_rate = std::max(tile.largest_rate, largest(largest_rate));
        if (wet_first < wet_last)
            tile.wet = tile.wet.with({{wet_first, j}, {std::min(wet_last, grid_.count(0)), j + 1}});
    }

    /// Lanes from cell i on that belong to the row.
    PackMask inside_row(Index i) const noexcept {
        Pack number(0);
        for (int lane = 0; lane < lanes; ++lane) number.set(lane, i + lane);
        return number < Pack(grid_.count(0));
    }

    const ShallowGrid<Dim>& grid_;
    const ShallowBed<Dim>& bed_;
    const ShallowForces& forces_;
    std::array<std::array<ShallowBoundaryCells<Dim>, 2>, Dim>& boundaries_;
    const ShallowState<Dim>* from_ = nullptr;
    ShallowState<Dim>* to_ = nullptr;
    Real dt_ = 0;                              ///< [s]
    Index first_ = 0, last_ = 0;               ///< cells of each row that are worked on
    std::array<Row, 4> surface_{};             ///< [row % 4] [m]
    std::array<Predicted, rows> predicted_{};  ///< [row % 2]
    Fluxes along_{};
    std::array<Fluxes, rows> across_{};  ///< [row % 2], through the face above it
};

}  // namespace abrade
