#pragma once
// Depth-averaged water, what happens at the ends of its grid: walls, inflow, outflow, periodic space.

#include <abrade/fluid/shallow_water/grid.hpp>

namespace abrade {

/// What stands at one end of an axis.
struct ShallowBoundary {
    enum class Kind { wall, inflow, outflow, periodic };
    Kind kind = Kind::wall;
    Real discharge = 0;  ///< of an inflow [m3/s]; in one dimension, per width [m2/s]
    /// Of an inflow, above the lowest bed of that side [m]: for supercritical flow. 0: critical. Where water
    /// before it stands higher and pushes harder than what comes in, it comes in that high.
    Real depth = 0;

    static ShallowBoundary wall() { return {}; }
    static ShallowBoundary inflow(Real discharge, Real depth = 0) { return {Kind::inflow, discharge, depth}; }
    /// Lets waves out and nothing in.
    static ShallowBoundary outflow() { return {Kind::outflow}; }
    static ShallowBoundary periodic() { return {Kind::periodic}; }
};

/// Both ends of each axis: {{x low, x high}, {y low, y high}}.
template <int Dim>
using ShallowBoundaries = std::array<std::array<ShallowBoundary, 2>, Dim>;

/// One end of one axis, of a grid: ghost cells beyond it, water that comes in, and what has passed.
template <int Dim>
class ShallowBoundaryCells {
public:
    ShallowBoundaryCells() = default;
    ShallowBoundaryCells(const ShallowBoundary& side, const ShallowGrid<Dim>& grid, int axis, bool high)
        : side_(side), axis_(axis), high_(high), count_(grid.count(1 - axis)),
          length_(Dim == 2 ? grid.spacing(1 - axis) : 1), flux(static_cast<std::size_t>(count_), 0.0) {
        if (!is_inflow()) return;
        depth.assign(flux.size(), 0.0), speed = bed = depth;
    }

    static void fields(auto&& field) {
        field("depth", "m", &ShallowBoundaryCells::depth),
            field("speed", "m/s", &ShallowBoundaryCells::speed);
    }

    bool is_inflow() const noexcept { return side_.kind == ShallowBoundary::Kind::inflow; }
    bool is_outflow() const noexcept { return side_.kind == ShallowBoundary::Kind::outflow; }
    bool is_wall() const noexcept { return side_.kind == ShallowBoundary::Kind::wall; }
    bool is_periodic() const noexcept { return side_.kind == ShallowBoundary::Kind::periodic; }
    bool is_open() const noexcept { return is_inflow() || is_outflow(); }
    Index count() const noexcept { return count_; }
    int axis() const noexcept { return axis_; }
    bool high() const noexcept { return high_; }

    /// Cell number `deep` inside (0 is the outermost; -1 and -2 are ghosts), `k` along the side.
    std::size_t cell(const ShallowGrid<Dim>& grid, Index deep, Index k) const noexcept {
        const Index n = high_ ? grid.count(axis_) - 1 - deep : deep;
        return axis_ == 0 ? grid.at(n, k) : grid.at(k, n);
    }
    std::size_t face(const ShallowGrid<Dim>& grid, Index k) const noexcept {
        const Index n = high_ ? grid.count(axis_) : 0;
        return axis_ == 0 ? grid.at(n, k) : grid.at(k, n);
    }
    /// The first cells behind it.
    CellBox first_cells(const ShallowGrid<Dim>& grid) const noexcept {
        CellBox box = grid.all();
        const auto a = static_cast<std::size_t>(axis_);
        (high_ ? box.first : box.last)[a] =
            high_ ? box.last[a] - ShallowGrid<Dim>::ghosts : ShallowGrid<Dim>::ghosts;
        return box.within(grid.all());
    }

    /// Bed of the ghost cells: mirrored in a wall, repeated in periodic space, else carried on in a straight
    /// line where it falls outward, level where it rises.
    void extend_bed(const ShallowGrid<Dim>& grid, CellColumn& column) const {
        for (Index k = -corner(); k < count_ + corner(); ++k)
            for (Index g = 1; g <= ShallowGrid<Dim>::ghosts; ++g) {
                const Real edge = column[cell(grid, 0, k)];
                const Real inner = column[cell(grid, std::min<Index>(1, grid.count(axis_) - 1), k)];
                column[cell(grid, -g, k)] =
                    is_open() ? edge + g * std::min(0.0, edge - inner) : column[source(grid, g, k)];
            }
    }

    /// What an inflow with a depth of its own brings, or how high critical flow stands: once the bed is
    /// known.
    void settle(const ShallowGrid<Dim>& grid, const ShallowBed<Dim>& on, Real gravity) {
        if (!is_inflow()) return;
        Real lowest = std::numeric_limits<Real>::infinity();
        for (Index k = 0; k < count_; ++k) {
            bed[at(k)] = on.face[static_cast<std::size_t>(axis_)][face(grid, k)];
            lowest = std::min(lowest, bed[at(k)]);
        }
        Real low = lowest, high = lowest + 0.01;
        while (!is_subcritical(high, gravity)) high = lowest + 2 * (high - lowest);
        for (int n = 0; n < 100; ++n) {
            const Real middle = 0.5 * (low + high);
            (is_subcritical(middle, gravity) ? high : low) = middle;
        }
        critical_level_ = high;
        require(
            lowest + side_.depth <= critical_level_ + 1e-9 * (critical_level_ - lowest),
            {"ShallowWater.boundaries." + std::string(1, "xy"[axis_]) + (high_ ? ".high" : ".low") + ".depth",
             "at most critical (" + to_text(critical_level_ - lowest) + " m)", "m",
             "leave it 0 for subcritical flow: water before it sets it"},
            side_.depth);
        given_level_ = side_.depth > 0 ? lowest + side_.depth : critical_level_;
        set_level(given_level_);
        given_push_ = push(gravity);
    }

    /// Ghost cells of a state, before its fluxes are taken.
    void fill(const ShallowGrid<Dim>& grid, const ShallowBed<Dim>& on, Real gravity,
              ShallowState<Dim>& state) {
        if (is_inflow()) meet(grid, on, gravity, state);
        const auto a = static_cast<std::size_t>(axis_);
        const Real inwards = high_ ? -1 : 1;
        for (Index k = -corner(); k < count_ + corner(); ++k)
            for (Index g = 1; g <= ShallowGrid<Dim>::ghosts; ++g) {
                const std::size_t ghost = cell(grid, -g, k);
                if (is_inflow()) {
                    const std::size_t s = at(std::clamp<Index>(k, 0, count_ - 1));
                    state.depth[ghost] = depth[s];
                    for (auto& column : state.speed) column[ghost] = 0;
                    state.speed[a][ghost] = inwards * speed[s];
                    continue;
                }
                const std::size_t from = source(grid, g, k);
                state.depth[ghost] = state.depth[from];
                for (auto& column : state.speed) column[ghost] = column[from];
                if (is_wall()) state.speed[a][ghost] = -state.speed[a][from];
            }
    }

    /// Of water that comes in: sum over axes of (u + sqrt(g h)) / spacing, the largest [1/s].
    Real largest_rate(Real spacing, Real other_spacing, Real gravity) const noexcept {
        Real most = 0;
        for (std::size_t k = 0; k < depth.size(); ++k) {
            const Real c = std::sqrt(gravity * depth[k]);
            most = std::max(most, (speed[k] + c) / spacing + (Dim == 2 ? c / other_spacing : 0));
        }
        return most;
    }

    /// What comes in at place k of an inflow, where the cell inside shows some depth [m2/s], [m3/s2].
    struct Incoming {
        Real mass, momentum;
    };
    Incoming incoming(std::size_t k, Real shown, Real gravity) const noexcept {
        const Real q = depth[k] * speed[k];
        Real h = depth[k];
        // Below the speed of waves the water inside says how high it stands, down to critical.
        if (square(speed[k]) < gravity * h) h = std::max(shown, std::cbrt(square(q) / gravity));
        return {q, (h > 0 ? square(q) / h : 0) + 0.5 * gravity * (h - shown) * (h + shown)};
    }

    /// Volume that comes in through it over a time of 1 s, as `flux` has it [m3/s].
    Real rate() const noexcept {
        Real sum = 0;
        for (const Real one : flux) sum += one;
        return (high_ ? -length_ : length_) * sum;
    }

private:
    static std::size_t at(Index k) noexcept { return static_cast<std::size_t>(k); }

    /// Cells of the corners beyond both ends that this side fills: the sides along y do, after those along x.
    Index corner() const noexcept { return axis_ == 1 ? ShallowGrid<Dim>::ghosts : 0; }

    /// The cell whose state ghost `g` takes on.
    std::size_t source(const ShallowGrid<Dim>& grid, Index g, Index k) const noexcept {
        const Index last = grid.count(axis_) - 1;
        if (is_periodic()) return cell(grid, std::max<Index>(last + 1 - g, 0), k);
        return cell(grid, is_wall() ? std::min(g - 1, last) : 0, k);
    }

    bool is_subcritical(Real level, Real gravity) const noexcept {
        Real area = 0, width = 0;
        for (const Real z : bed)
            if (level > z) area += length_ * (level - z), width += length_;
        return square(side_.discharge) * width <= gravity * cube(area);
    }

    /// Shares the discharge out by what each strip can carry, h^(5/3).
    void set_level(Real level) {
        Real carried = 0;
        for (std::size_t k = 0; k < bed.size(); ++k) {
            depth[k] = std::max(0.0, level - bed[k]);
            speed[k] = std::cbrt(square(depth[k]));
            carried += depth[k] * speed[k] * length_;
        }
        for (Real& one : speed) one *= side_.discharge / carried;
    }

    /// Momentum that comes in and pressure, over density [m4/s2].
    Real push(Real gravity) const noexcept {
        Real sum = 0;
        for (std::size_t k = 0; k < depth.size(); ++k)
            sum += length_ * depth[k] * (square(speed[k]) + 0.5 * gravity * depth[k]);
        return sum;
    }

    /// Comes in as it is given, or as high as the water that stands before it, where that is subcritical and
    /// pushes harder: a jump drowns what shoots in.
    void meet(const ShallowGrid<Dim>& grid, const ShallowBed<Dim>& on, Real gravity,
              const ShallowState<Dim>& state) {
        Real weight = 0, level = 0;
        for (Index k = 0; k < count_; ++k) {
            const std::size_t first = cell(grid, 0, k);
            const Real h = state.depth[first], share = h * std::cbrt(square(h));
            weight += share, level += share * (h + on.cell[first]);
        }
        const bool met = weight > 0 && level > weight * critical_level_;
        if (met) set_level(level / weight);
        if (!met || push(gravity) <= given_push_) set_level(given_level_);
    }

    ShallowBoundary side_;
    int axis_ = 0;
    bool high_ = false;
    Index count_ = 0;
    Real length_ = 1;                            ///< of a face [m]
    Real critical_level_ = 0, given_level_ = 0;  ///< [m]
    Real given_push_ = 0;
    std::vector<Real> bed;  ///< [m]

public:
    std::vector<Real> flux;          ///< along the axis, of volume, in the last step [m2/s]
    std::vector<Real> depth, speed;  ///< of an inflow: [m], inwards [m/s]
};

}  // namespace abrade
