#pragma once
// Depth-averaged water, one stage of a step over one tile: slopes, fluxes and new states, row by row while
// they are in cache.

#include <abrade/fluid/shallow_water_sides.hpp>

namespace abrade {

/// What drives water and holds it back.
struct ShallowForces {
    Real pressing = standard_gravity;  ///< gravity into the bed [m/s2]
    std::array<Real, 2> along{0, 0};   ///< along x, y: a slope that the frame is tilted by [m/s2]
    Real gravity_manning2 = 0;         ///< g n^2 [m^(1/3)]
    Real dry_depth = 1e-5;             ///< below it water stands still [m]
    Real fastest = 100;                ///< beyond it a run is wrong [m/s]
};

/// One stage of a step of second order (S. Gottlieb, C.-W. Shu, Math. Comput. 67 (1998) 73,
/// doi:10.1090/S0025-5718-98-00913-2): U' = U + dt L(U), then (U + U' + dt L(U'))/2.
template <int Dim>
struct ShallowStage {
    const ShallowState<Dim>* begin = nullptr;  ///< U
    const ShallowState<Dim>* from = nullptr;   ///< U in the first stage, U' in the second
    ShallowState<Dim>* to = nullptr;
    Real* friction = nullptr;  ///< rate at the begin [1/s]: written in the first stage, read in the second
    Real dt = 0;               ///< [s]
};

/// Works on a tile. Numbers are packs; what stands in ghost lanes behind a row's end means nothing.
template <int Dim>
class ShallowSweep {
public:
    ShallowSweep(const ShallowGrid<Dim>& grid, const ShallowBed<Dim>& bed, const ShallowForces& forces,
                 std::array<std::array<ShallowSide<Dim>, 2>, Dim>& sides) noexcept
        : grid_(grid), bed_(bed), forces_(forces), sides_(sides) {}

    /// The second stage also finds which cells are wet and how swift they are.
    template <bool second>
    void run(const ShallowStage<Dim>& stage, ShallowTile& tile) noexcept {
        stage_ = &stage;
        const CellBox box = tile.due();
        first_ = box.first[0], last_ = box.last[0];
        if constexpr (second) tile.wet = {}, tile.swiftest = 0;
        unsound_ = false;
        if constexpr (Dim == 2) {
            for (Index j = box.first[1] - 2; j <= box.first[1] + 1; ++j) prepare(j);
            slope_across(box.first[1] - 1), slope_across(box.first[1]);
            flux_across(box.first[1] - 1);
        }
        for (Index j = box.first[1]; j < box.last[1]; ++j) {
            if constexpr (Dim == 2)
                prepare(j + 2), slope_across(j + 1), flux_across(j);
            else
                prepare(j);
            slope_along(j), flux_along(j);
            if (forces_.gravity_manning2 > 0)
                update<second, true>(j, tile);
            else
                update<second, false>(j, tile);
        }
        tile.unsound |= unsound_;
    }

private:
    static constexpr Index room = ShallowTiles<Dim>::width + 2 * ShallowGrid<Dim>::margin;
    static constexpr std::size_t slopes = Dim + 1;  ///< of surface, speed along x, along y
    static constexpr int lanes = pack_lanes;
    using Row = std::array<Real, static_cast<std::size_t>(room)>;
    struct Fluxes {
        Row mass, low, high, along;
    };

    static Pack load(const Real* from) noexcept { return detail::load<Pack>(from); }
    /// Where cell i of the tile stands in a row of ours.
    std::size_t here(Index i) const noexcept {
        return static_cast<std::size_t>(i - first_ + ShallowGrid<Dim>::margin);
    }
    static std::size_t ring(Index j) noexcept { return static_cast<std::size_t>(j + 8) % 4; }
    static std::size_t pair(Index j) noexcept { return static_cast<std::size_t>(j + 8) % 2; }

    /// Surface, and the most depth that a cell may show.
    void prepare(Index j) noexcept {
        Row &surface = surface_[ring(j)], &most = most_[ring(j)];
        const std::size_t row = grid_.at(0, j);
        for (Index i = first_ - ShallowGrid<Dim>::block; i < last_ + ShallowGrid<Dim>::block; i += lanes) {
            const std::size_t k = row + static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i));
            const Pack h = load(&stage_->from->depth[k]);
            detail::put(&surface[here(i)], h + load(&bed_.cell[k]));
            detail::put(&most[here(i)], select(h > Pack(forces_.dry_depth), h + h, Pack(0)));
        }
    }

    void slope_along(Index j) noexcept {
        const std::size_t row = grid_.at(0, j);
        const Row& surface = surface_[ring(j)];
        for (Index i = first_ - 1; i <= last_; i += lanes) {
            const std::size_t b = here(i), k = row + static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i));
            const auto slope = [&](const Real* at) {
                const Pack middle = load(at);
                return limited_slope(middle - load(at - 1), load(at + 1) - middle);
            };
            detail::put(&slope_x_[0][b], slope(&surface[b]));
            for (std::size_t c = 0; c < Dim; ++c)
                detail::put(&slope_x_[c + 1][b], slope(&stage_->from->speed[c][k]));
        }
    }

    void slope_across(Index j) noexcept {
        const std::size_t row = grid_.at(0, j), step = static_cast<std::size_t>(grid_.stride());
        auto& slopes_of = slope_y_[pair(j)];
        const Row &below = surface_[ring(j - 1)], &middle = surface_[ring(j)], &above = surface_[ring(j + 1)];
        for (Index i = first_; i < last_; i += lanes) {
            const std::size_t b = here(i), k = row + static_cast<std::size_t>(i);
            const Pack h = load(&middle[b]);
            detail::put(&slopes_of[0][b], limited_slope(h - load(&below[b]), load(&above[b]) - h));
            for (std::size_t c = 0; c < Dim; ++c) {
                const Real* speed = &stage_->from->speed[c][k];
                const Pack u = load(speed);
                detail::put(&slopes_of[c + 1][b],
                            limited_slope(u - load(speed - step), load(speed + step) - u));
            }
        }
    }

    /// Fluxes through the faces between each cell of row j and the one before it.
    void flux_along(Index j) noexcept {
        const std::size_t row = grid_.at(0, j);
        const Row &surface = surface_[ring(j)], &most = most_[ring(j)];
        const auto& from = *stage_->from;
        for (Index i = first_; i <= last_; i += lanes) {
            const std::size_t b = here(i), k = row + static_cast<std::size_t>(i);
            const Pack bed = load(&bed_.face[0][k]), half(0.5);
            WaterBeside<Pack> low, high;
            low.depth = depth_at_face(load(&surface[b - 1]) + half * load(&slope_x_[0][b - 1]), bed,
                                      load(&most[b - 1]));
            high.depth = depth_at_face(load(&surface[b]) - half * load(&slope_x_[0][b]), bed, load(&most[b]));
            low.through = load(&from.speed[0][k - 1]) + half * load(&slope_x_[1][b - 1]);
            high.through = load(&from.speed[0][k]) - half * load(&slope_x_[1][b]);
            if constexpr (Dim == 2) {
                low.along = load(&from.speed[1][k - 1]) + half * load(&slope_x_[2][b - 1]);
                high.along = load(&from.speed[1][k]) - half * load(&slope_x_[2][b]);
            } else {
                low.along = high.along = Pack(0);
            }
            put(flux_x_, b, water_flux(low, high, forces_.pressing));
        }
        const auto at_end = [&](ShallowSide<Dim>& side, Index i) {
            const std::size_t b = here(i), inner = side.high() ? b - 1 : b;
            const Real turn = side.high() ? 0.5 : -0.5;
            const Real shown = depth_at_face(surface[inner] + turn * slope_x_[0][inner],
                                             bed_.face[0][row + static_cast<std::size_t>(i)], most[inner]);
            pass_side(side, j, shown, flux_x_, b);
        };
        if (first_ == 0) at_end(sides_[0][0], 0);
        if (last_ == grid_.count(0)) at_end(sides_[0][1], last_);
    }

    /// Fluxes through the faces between rows j and j + 1.
    void flux_across(Index j) noexcept {
        if constexpr (Dim == 2) {
            const std::size_t row = grid_.at(0, j), step = static_cast<std::size_t>(grid_.stride());
            const Row &low_surface = surface_[ring(j)], &low_most = most_[ring(j)];
            const Row &high_surface = surface_[ring(j + 1)], &high_most = most_[ring(j + 1)];
            const auto &low_slope = slope_y_[pair(j)], &high_slope = slope_y_[pair(j + 1)];
            Fluxes& fluxes = flux_y_[pair(j)];
            const auto& from = *stage_->from;
            for (Index i = first_; i < last_; i += lanes) {
                const std::size_t b = here(i), k = row + static_cast<std::size_t>(i);
                const Pack bed = load(&bed_.face[1][k + step]), half(0.5);
                WaterBeside<Pack> low, high;
                low.depth = depth_at_face(load(&low_surface[b]) + half * load(&low_slope[0][b]), bed,
                                          load(&low_most[b]));
                high.depth = depth_at_face(load(&high_surface[b]) - half * load(&high_slope[0][b]), bed,
                                           load(&high_most[b]));
                low.through = load(&from.speed[1][k]) + half * load(&low_slope[2][b]);
                high.through = load(&from.speed[1][k + step]) - half * load(&high_slope[2][b]);
                low.along = load(&from.speed[0][k]) + half * load(&low_slope[1][b]);
                high.along = load(&from.speed[0][k + step]) - half * load(&high_slope[1][b]);
                put(fluxes, b, water_flux(low, high, forces_.pressing));
            }
            const auto at_end = [&](ShallowSide<Dim>& side) {
                const Row& surface = side.high() ? low_surface : high_surface;
                const Row& most = side.high() ? low_most : high_most;
                const auto& slope = side.high() ? low_slope[0] : high_slope[0];
                const Real turn = side.high() ? 0.5 : -0.5;
                for (Index i = first_; i < std::min(last_, grid_.count(0)); ++i) {
                    const std::size_t b = here(i);
                    const Real shown =
                        depth_at_face(surface[b] + turn * slope[b],
                                      bed_.face[1][row + step + static_cast<std::size_t>(i)], most[b]);
                    pass_side(side, i, shown, fluxes, b);
                }
            };
            if (j == -1) at_end(sides_[1][0]);
            if (j == grid_.count(1) - 1) at_end(sides_[1][1]);
        }
    }

    /// At an end of the grid: an inflow brings what it must, and what passes is written down. The cell inside
    /// shows the depth `shown`.
    void pass_side(ShallowSide<Dim>& side, Index k, Real shown, Fluxes& fluxes, std::size_t b) noexcept {
        const auto s = static_cast<std::size_t>(k);
        if (side.is_inflow()) {
            const Real h = side.depth[s], u = side.speed[s], turn = side.high() ? -1 : 1;
            fluxes.mass[b] = turn * h * u;
            const Real pushed = h * u * u + 0.5 * forces_.pressing * (h - shown) * (h + shown);
            (side.high() ? fluxes.low : fluxes.high)[b] = pushed;
            fluxes.along[b] = 0;
        }
        side.flux[s] += 0.5 * fluxes.mass[b];  // each stage is half of a step
    }

    static void put(Fluxes& fluxes, std::size_t b, const WaterFlux<Pack>& flux) noexcept {
        detail::put(&fluxes.mass[b], flux.mass), detail::put(&fluxes.low[b], flux.low);
        detail::put(&fluxes.high[b], flux.high);
        if constexpr (Dim == 2) detail::put(&fluxes.along[b], flux.along);
    }

    template <bool second, bool rough>
    void update(Index j, ShallowTile& tile) noexcept {
        const std::size_t row = grid_.at(0, j);
        const Pack dry(forces_.dry_depth), dt(stage_->dt), half(0.5);
        const Pack per_x(stage_->dt / grid_.spacing(0)), per_y(Dim == 2 ? stage_->dt / grid_.spacing(1) : 0);
        const Pack press(forces_.pressing);
        const auto &from = *stage_->from, &begin = *stage_->begin;
        auto& to = *stage_->to;
        const Fluxes &y_low = flux_y_[pair(j - 1)], &y_high = flux_y_[pair(j)];
        const auto& slope_y = slope_y_[pair(j)];
        Pack swiftest(0);
        Index wet_first = last_, wet_last = first_;
        for (Index i = first_; i < last_; i += lanes) {
            const std::size_t b = here(i), k = row + static_cast<std::size_t>(i);
            const Pack h = load(&from.depth[k]);
            Pack grown = per_x * (load(&flux_x_.mass[b]) - load(&flux_x_.mass[b + 1]));
            std::array<Pack, Dim> speed, momentum;  // momentum gained in the step
            speed[0] = load(&from.speed[0][k]);
            const Pack pushed = press * h;
            momentum[0] =
                per_x * (load(&flux_x_.high[b]) - load(&flux_x_.low[b + 1]) - pushed * load(&slope_x_[0][b]));
            if constexpr (Dim == 2) {
                speed[1] = load(&from.speed[1][k]);
                grown += per_y * (load(&y_low.mass[b]) - load(&y_high.mass[b]));
                momentum[0] += per_y * (load(&y_low.along[b]) - load(&y_high.along[b]));
                momentum[1] =
                    per_y * (load(&y_low.high[b]) - load(&y_high.low[b]) - pushed * load(&slope_y[0][b])) +
                    per_x * (load(&flux_x_.along[b]) - load(&flux_x_.along[b + 1]));
            }
            for (std::size_t c = 0; c < Dim; ++c) momentum[c] += dt * Pack(forces_.along[c]) * h;

            // Friction is implicit. What it does is of second order in dt, and nothing at the speed at which
            // it holds the drive: q = (q_0 + dt L (1 + r/2)) / (1 + r + r^2/2), r = dt (k + k')/2 and L = (L
            // + L')/2.
            Pack rate(0);
            if constexpr (rough) {
                Pack swift2 = speed[0] * speed[0];
                if constexpr (Dim == 2) swift2 += speed[1] * speed[1];
                rate = friction_rate(max(h, dry), root(swift2), forces_.gravity_manning2);
                rate = select(h > dry, rate, Pack(0));
            }
            Pack depth;
            std::array<Pack, Dim> flow;  // depth times speed
            if constexpr (!second) {
                depth = h + grown;
                const Pack held = rough ? reciprocal(Pack(1) + dt * rate) : Pack(1);
                for (std::size_t c = 0; c < Dim; ++c) flow[c] = (h * speed[c] + momentum[c]) * held;
                if constexpr (rough) detail::put(&stage_->friction[k], rate);
            } else {
                const Pack h0 = load(&begin.depth[k]);
                depth = half * (h0 + (h + grown));
                if constexpr (rough) {
                    const Pack rate0 = load(&stage_->friction[k]), r = half * dt * (rate0 + rate);
                    const Pack more = Pack(1) + half * r, held = reciprocal(Pack(1) + r * more);
                    for (std::size_t c = 0; c < Dim; ++c) {
                        const Pack q0 = h0 * load(&begin.speed[c][k]);
                        const Pack first = h * speed[c] * (Pack(1) + dt * rate0) - q0;  // of the first stage
                        flow[c] = (q0 + half * (first + momentum[c]) * more) * held;
                    }
                } else {
                    for (std::size_t c = 0; c < Dim; ++c)
                        flow[c] = half * (h0 * load(&begin.speed[c][k]) + (h * speed[c] + momentum[c]));
                }
            }
            const PackMask flows = depth > dry;
            const Pack thin = reciprocal(max(depth, dry));
            for (std::size_t c = 0; c < Dim; ++c) {
                speed[c] = select(flows, flow[c] * thin, Pack(0));
                detail::put(&to.speed[c][k], speed[c]);
            }
            detail::put(&to.depth[k], depth);

            PackMask inside = Pack(0) <= Pack(0);
            if (i + lanes > grid_.count(0)) inside = inside_row(i);
            PackMask sound = depth >= Pack(0);
            for (std::size_t c = 0; c < Dim; ++c)
                sound = sound & (max(speed[c], -speed[c]) <= Pack(forces_.fastest));
            unsound_ |= any(inside & !sound);
            if constexpr (second) {
                const Pack wave = root(press * depth);
                Pack swift = (max(speed[0], -speed[0]) + wave) * Pack(1 / grid_.spacing(0));
                if constexpr (Dim == 2)
                    swift += (max(speed[1], -speed[1]) + wave) * Pack(1 / grid_.spacing(1));
                const PackMask counts = inside & flows;
                swiftest = max(swiftest, select(counts, swift, Pack(0)));
                if (any(counts)) wet_first = std::min(wet_first, i), wet_last = i + lanes;
            }
        }
        if constexpr (second) {
            tile.swiftest = std::max(tile.swiftest, largest(swiftest));
            if (wet_first < wet_last)
                tile.wet = tile.wet.with({{wet_first, j}, {std::min(wet_last, grid_.count(0)), j + 1}});
        }
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
    std::array<std::array<ShallowSide<Dim>, 2>, Dim>& sides_;
    const ShallowStage<Dim>* stage_ = nullptr;
    Index first_ = 0, last_ = 0;  ///< cells of each row that are worked on
    bool unsound_ = false;
    std::array<Row, 4> surface_{}, most_{};                            ///< [row % 4] [m]
    std::array<Row, slopes> slope_x_{};                                ///< changes across a cell
    std::array<std::array<Row, slopes>, Dim == 2 ? 2 : 1> slope_y_{};  ///< [row % 2]
    Fluxes flux_x_{};
    std::array<Fluxes, Dim == 2 ? 2 : 1> flux_y_{};  ///< [row % 2], through the face above it
};

}  // namespace abrade
