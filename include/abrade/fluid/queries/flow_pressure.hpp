#pragma once
// The pressure of water on a grid between the centres of its cells.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/mesh/interpolation.hpp>
#include <abrade/fluid/setup/grid_fluid_params.hpp>

#include <array>
#include <optional>
#include <string>
#include <type_traits>

namespace abrade {

/// Of a flow on a grid: 2 or 3.
template <class Flow>
inline constexpr int dimensions =
    std::remove_cvref_t<decltype(std::declval<const Flow&>().grid())>::vertical + 1;

/// Water on a grid that can be asked: GridFluid, and every flow with the same accessors. One with a surface
/// says which cells are liquid; one without `liquid()` is full.
// clang-format off
template <class Flow>
concept GridFlow = requires(const Flow& flow) { flow.grid(), flow.params(), flow.time(); } && requires(const Flow& flow) {
    { flow.params().acceleration(flow.time()) } -> std::convertible_to<Point<dimensions<Flow>>>;
    { flow.params().density } -> std::convertible_to<Real>;
    { flow.pressure()[Offset{}] } -> std::convertible_to<Real>;
    { flow.velocity()[0][Offset{}] } -> std::convertible_to<Real>;
} && (!requires(const Flow& flow, const Point<dimensions<Flow>>& x) { flow.surface_at(x); } ||
      requires(const Flow& flow) { flow.liquid().is_liquid(Offset{}); flow.liquid().fraction(); flow.walls(); });
// clang-format on

namespace detail {

/// Throws InputError for a point that is not finite, or outside the box on an axis that is not periodic;
/// returns where it stands inside.
template <int Dim>
Point<Dim> inside_box(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries, Point<Dim> x,
                      std::string_view called) {
    for (int a = 0; a < Dim; ++a) {
        const std::string name = std::string(called) + '.' + Grid<Dim>::axis_name(a);
        require_finite(x[a], name, "m");
        if (boundaries.periodic(a)) {
            x[a] = wrapped(grid, a, x[a]);
            continue;
        }
        const Real round_off = 1e-9 * (grid.high(a) - grid.low(a));
        require(
            x[a] >= grid.low(a) - round_off && x[a] <= grid.high(a) + round_off,
            {name, "inside the box (" + short_text(grid.low(a)) + " to " + short_text(grid.high(a)) + " m)",
             "m", "nothing is known outside; was another corner taken as origin?"},
            x[a]);
        x[a] = std::clamp(x[a], grid.low(a), grid.high(a));
    }
    return x;
}

/// What the pressure is beside its weight, p / rho - g . x, linear about a place [m2/s2]. Of water at rest it
/// is the same everywhere, so weights and gradients of whatever kind meet that exactly.
template <int Dim>
struct LinearHead {
    Point<Dim> about = Point<Dim>::Zero();  ///< [m]
    Real value = 0;                         ///< there [m2/s2]
    Point<Dim> slope = Point<Dim>::Zero();  ///< [m/s2]

    Real at(const Point<Dim>& x) const noexcept { return value + slope.dot(x - about); }
};

/// The cells of a flow, whatever its surface.
template <GridFlow Flow>
class FlowCells {
public:
    static constexpr int Dim = dimensions<Flow>;
    static constexpr bool has_surface = requires(const Flow& flow) { flow.liquid(); };
    /// Cells that lack no more than this of their liquid count as full: below a surface so close to their top
    /// the pressure is off by no more than this share of a cell's weight.
    static constexpr Real nearly = 1e-3;
    using Cell = CellNumber<Dim>;

    explicit FlowCells(const Flow& flow)
        : flow_(flow), grid_(flow.grid()), boundaries_(flow.params().boundaries),
          acceleration_(flow.params().acceleration(flow.time())) {
        if constexpr (has_surface) walls_ = flow.walls();
    }

    const Grid<Dim>& grid() const noexcept { return grid_; }
    const BoundaryConditions<Dim>& boundaries() const noexcept { return boundaries_; }
    const EmbeddedBoundary<Dim>* walls() const noexcept { return walls_; }
    const Point<Dim>& acceleration() const noexcept {
        return acceleration_;
    }  ///< gravity and body force [m/s2]
    Real density() const noexcept { return flow_.params().density; }

    Real open_fraction(Offset c) const noexcept { return walls_ ? walls_->open_fraction()[c] : 1; }
    Real aperture(int axis, Offset face) const noexcept {
        return walls_ ? walls_->aperture()[axis][face] : 1;
    }
    /// Of what walls leave open of a cell [-].
    Real liquid(Offset c) const noexcept {
        if constexpr (has_surface) return flow_.liquid().fraction()[c];
        return 1;
    }
    /// Whether it has a pressure.
    bool is_wet(Offset c) const noexcept {
        if constexpr (has_surface) return flow_.liquid().is_liquid(c) && open_fraction(c) > 0;
        return true;
    }
    bool has_water(Offset c) const noexcept { return open_fraction(c) > 0 && (liquid(c) > 0 || is_wet(c)); }
    bool is_full(Offset c) const noexcept { return liquid(c) >= 1 - nearly; }
    Real velocity(int axis, Offset face) const noexcept {
        return static_cast<Real>(flow_.velocity()[axis][face]);
    }

    /// Of a cell inside the box, or beyond a periodic side.
    std::optional<Offset> offset(Cell cell) const noexcept {
        for (int a = 0; a < Dim; ++a) {
            const int n = grid_.cells(a);
            if (cell[a] >= 0 && cell[a] < n) continue;
            if (!boundaries_.periodic(a)) return std::nullopt;
            cell[a] = (cell[a] % n + n) % n;
        }
        return grid_.layout().at(cell);
    }
    /// The cell that holds a point of the box.
    Cell holding(const Point<Dim>& x) const noexcept {
        Cell cell;
        for (int a = 0; a < Dim; ++a) {
            const GridPlace place = place_among_faces(grid_, a, x[a], false);
            cell[a] = std::min(place.low + (place.weight == 1), grid_.cells(a) - 1);
        }
        return cell;
    }

    /// p / rho - g . x at a cell's centre, which may stand beyond a periodic side [m2/s2].
    Real head(const Cell& cell, Offset c) const noexcept {
        return static_cast<Real>(flow_.pressure()[c]) - acceleration_.dot(grid_.centre(cell));
    }
    /// [Pa]
    Real pressure(const LinearHead<Dim>& head, const Point<Dim>& x) const noexcept {
        return density() * (head.at(x) + acceleration_.dot(x));
    }
    Point<Dim> gradient(const LinearHead<Dim>& head) const noexcept {  ///< of the pressure [Pa/m]
        return density() * (head.slope + acceleration_);
    }

    /// About a cell: its own value where it is wet, with the gradient of least squares over the wet cells
    /// around that open faces join to it; else the mean of what its nearest wet neighbours go on with. None
    /// where none of them is wet.
    std::optional<LinearHead<Dim>> head_about(const Cell& cell) const {
        const Block around = reached(cell);
        if (around[middle].wet) return fit(cell, around);
        LinearHead<Dim> mean{.about = grid_.centre(cell)};
        for (int steps = 1; steps <= Dim; ++steps) {
            int found = 0;
            for (std::size_t n = 0; n < around.size(); ++n) {
                if (!around[n].wet || !around[n].reached || steps_to(n) != steps) continue;
                const Cell neighbour = neighbour_of(cell, n);
                const LinearHead<Dim> one = fit(neighbour, reached(neighbour));
                mean.value += one.at(mean.about), mean.slope += one.slope, ++found;
            }
            if (found == 0) continue;
            mean.value /= found, mean.slope /= found;
            return mean;
        }
        return std::nullopt;
    }

    /// At a point of the box [Pa]; none where no cell about it is wet. Between centres of wet cells that open
    /// faces join it is linear along each axis, elsewhere that about the cell which holds the point.
    std::optional<Real> pressure_at(const Point<Dim>& x) const {
        const Cell cell = holding(x);
        Cell low = cell;
        Point<Dim> weight;
        for (int a = 0; a < Dim; ++a) {
            if (x[a] < grid_.centre(a, low[a])) --low[a];
            weight[a] = (x[a] - grid_.centre(a, low[a])) / grid_.gap(a, low[a] + 1);
        }
        const Block around = reached(cell);
        Real sum = 0;
        for (int corner = 0; corner < 1 << Dim; ++corner) {
            Real share = 1;
            Cell at = low;
            std::size_t n = 0, place = 1;
            for (int a = 0; a < Dim; ++a, place *= 3) {
                const bool up = corner >> a & 1;
                share *= up ? weight[a] : 1 - weight[a];
                at[a] += up;
                n += place * static_cast<std::size_t>(at[a] - cell[a] + 1);
            }
            if (!around[n].wet || !around[n].reached) {
                const auto head = head_about(cell);
                if (!head) return std::nullopt;
                return pressure(*head, x);
            }
            sum += share * head(at, around[n].cell);
        }
        return density() * (sum + acceleration_.dot(x));
    }

private:
    struct Neighbour {
        Offset cell = 0;
        bool inside = false, wet = false, reached = false;
    };
    static constexpr std::size_t count = Dim == 3 ? 27 : 9, middle = count / 2;
    /// A cell and those around it, by thirds of the index.
    using Block = std::array<Neighbour, count>;

    static int step(std::size_t n, int axis) noexcept {
        for (int a = 0; a < axis; ++a) n /= 3;
        return static_cast<int>(n % 3) - 1;
    }
    static int steps_to(std::size_t n) noexcept {
        int sum = 0;
        for (int a = 0; a < Dim; ++a) sum += step(n, a) != 0;
        return sum;
    }
    static Cell neighbour_of(Cell cell, std::size_t n) noexcept {
        for (int a = 0; a < Dim; ++a) cell[a] += step(n, a);
        return cell;
    }

    /// Which cells around one open faces lead to, within the block; of a closed one all.
    Block reached(const Cell& cell) const noexcept {
        Block block;
        for (std::size_t n = 0; n < count; ++n)
            if (const auto c = offset(neighbour_of(cell, n))) block[n] = {*c, true, is_wet(*c), false};
        const bool closed = open_fraction(block[middle].cell) == 0;
        for (auto& n : block) n.reached = !walls_ || closed;
        block[middle].reached = true;
        if (!walls_ || closed) return block;
        for (int pass = 0; pass < Dim; ++pass)
            for (std::size_t n = 0; n < count; ++n) {
                std::size_t place = 1;
                for (int a = 0; a < Dim; ++a, place *= 3) {
                    if (step(n, a) == 1) continue;
                    Neighbour &low = block[n], &high = block[n + place];
                    // Beyond a periodic side a face is that of the cell inside, where it stands.
                    if (!low.inside || !high.inside || aperture(a, high.cell) == 0) continue;
                    low.reached = high.reached = low.reached || high.reached;
                }
            }
        return block;
    }

    LinearHead<Dim> fit(const Cell& cell, const Block& around) const {
        using Matrix = Eigen::Matrix<Real, Dim, Dim>;
        const Point<Dim> centre = grid_.centre(cell);
        const Real own = head(cell, around[middle].cell);
        constexpr Real ridge = 1e-10;  // no neighbours along an axis: no slope
        Matrix matrix = ridge * Matrix::Identity();
        Point<Dim> right = Point<Dim>::Zero(), size;
        for (int a = 0; a < Dim; ++a) size[a] = grid_.size(a, cell[a]);
        for (std::size_t n = 0; n < count; ++n) {
            if (n == middle || !around[n].wet || !around[n].reached) continue;
            const Cell at = neighbour_of(cell, n);
            const Point<Dim> apart = (grid_.centre(at) - centre).cwiseQuotient(size);
            const Real weight = 1 / apart.squaredNorm();
            matrix += weight * apart * apart.transpose();
            right += weight * (head(at, around[n].cell) - own) * apart;
        }
        const Point<Dim> slope = matrix.inverse() * right;
        return {centre, own, slope.cwiseQuotient(size)};
    }

    const Flow& flow_;
    const Grid<Dim>& grid_;
    const BoundaryConditions<Dim>& boundaries_;
    const EmbeddedBoundary<Dim>* walls_ = nullptr;
    Point<Dim> acceleration_;
};

}  // namespace detail
}  // namespace abrade
