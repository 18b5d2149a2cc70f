#pragma once
// A hydraulic jump that stands between a fast stream and the level that a tailwater holds: J. B. Belanger,
// Notes sur l'hydraulique (1841), h_2 / h_1 = y = (sqrt(1 + 8 F^2) - 1) / 2, energy lost per weight (y - 1)^3
// / (4 y) h_1.

#include "reference_table.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/setup/inflow.hpp>

#include <doctest/doctest.h>

namespace hydraulic_jump {

using namespace abrade;

constexpr Real gravity = 9.81;  ///< [m/s2]

/// Sums over a section that water goes through, and over time: of height times powers of the speed u along
/// the channel and of the head H = z + p / (rho g) + u^2 / (2 g).
struct Section {
    Real depth = 0;                        ///< [m]
    Real flow = 0, square = 0;             ///< u, u^2
    Real head = 0, energy = 0, count = 0;  ///< H, u H
    Real thrust = 0;                       ///< u^2 + p / rho, times the step [m3/s]

    /// Energy over weight that go through it as one sees who moves at `speed` [m].
    Real head_at(Real speed) const {
        const Real w = speed, g = gravity;
        return (energy - w * head - w * square / g + 1.5 * w * w * flow / g - 0.5 * w * w * w * depth / g) /
               (flow - w * depth);
    }
};

struct Jump {
    Real froude = 2, depth = 0.1;  ///< F, h_1 [m]
    Real toe = 15, length = 50;    ///< where it begins; the channel's length [h_1]

    Real sequent() const { return 0.5 * (std::sqrt(1 + 8 * square(froude)) - 1); }  ///< y
    Real wave() const { return std::sqrt(gravity * depth); }
    Real stream() const { return froude * wave(); }  ///< [m/s]
    Real lost() const {                              ///< [h_1]
        return std::pow(sequent() - 1, 3) / (4 * sequent());
    }

    /// `n` cells to the stream's depth.
    GridFluid<2> channel(int n) const {
        const Real h = depth / n, y = sequent();
        GridFluidParams<2> p;
        p.grid = {.cells = {static_cast<int>(length * n), static_cast<int>(std::ceil(2 * y * n))},
                  .spacing = {h, h}};
        p.boundaries = BoundaryConditions<2>::all(Boundary::free_slip);
        p.boundaries[0][1] = Boundary::outflow;
        Inflow<2>({.discharge = stream() * depth, .depth = depth}).give_to(p);
        p.outflow_water = [*this, y](const Point<2>& x) { return y * depth - x[1]; };
        const auto deep = [*this, y](Real x) { return x < toe * depth ? depth : y * depth; };
        p.water = [deep](const Point<2>& x) { return deep(x[0]) - x[1]; };
        p.velocity = [*this, deep](const Point<2>& x) { return Point<2>(stream() * depth / deep(x[0]), 0); };
        p.gravity = {0, -gravity};
        return GridFluid<2>(p);
    }
    /// Where the surface first comes half way up [m].
    Real front(const GridFluid<2>& flow) const {
        const Grid<2>& grid = flow.grid();
        for (int i = 0; i < grid.cells(0); ++i)
            if (flow.surface_at({grid.centre(0, i), 0}) > 0.5 * (1 + sequent()) * depth)
                return grid.centre(0, i);
        return grid.high(0);
    }
    /// At x [h_1].
    void add(Section& s, const GridFluid<2>& flow, Real x, Real step) const {
        const Grid<2>& grid = flow.grid();
        const int i = static_cast<int>(x * depth / grid.size(0, 0));
        for (int k = 0; k < grid.cells(1); ++k) {
            const Offset c = grid.layout().at({i, k}), up = c + grid.layout().stride[1];
            const Real u = 0.5 * (flow.velocity()[0][c] + flow.velocity()[0][c + grid.layout().stride[0]]);
            const Real w = 0.5 * (flow.velocity()[1][c] + flow.velocity()[1][up]);
            const Real high = flow.liquid().fraction()[c] * grid.size(1, k);
            const Real head = grid.centre(1, k) + (flow.pressure()[c] + 0.5 * (u * u + w * w)) / gravity;
            s.depth += high, s.flow += high * u, s.square += high * u * u;
            s.head += high * head, s.energy += high * u * head;
            s.thrust += step * (high * u * u + flow.pressure()[c] * grid.size(1, k));
        }
        s.count += 1;
    }
    /// Momentum along the channel between two places [h_1], over density and width [m3/s].
    Real momentum(const GridFluid<2>& flow, Real from, Real to) const {
        const Grid<2>& grid = flow.grid();
        const auto column = [&](Real x) { return static_cast<int>(x * depth / grid.size(0, 0)); };
        Real sum = 0;
        for (int i = column(from); i < column(to); ++i)
            for (int k = 0; k < grid.cells(1); ++k) {
                const Offset c = grid.layout().at({i, k});
                const Real u =
                    0.5 * (flow.velocity()[0][c] + flow.velocity()[0][c + grid.layout().stride[0]]);
                sum += flow.liquid().fraction()[c] * grid.volume({i, k}) * u;
            }
        return sum;
    }

    struct Found {
        Real speed = 0;  ///< of the jump, downstream, over the stream's [-]
        Real depth =
            0;  ///< behind over before it, over Belanger's at the Froude number that the jump sees [-]
        Real lost = 0;  ///< energy lost over Belanger's [-]
        /// Momentum that comes in, less what goes out and what is stored, over what comes in: no wall holds
        /// the water along the channel [-].
        Real momentum_lost = 0;
    };
    /// On `n` cells; means from one time to another [h_1 / sqrt(g h_1)].
    Found run(int n, Real from, Real to) const {
        auto flow = channel(n);
        const Real unit = depth / wave();
        flow.advance(from * unit);
        Section before, behind;
        constexpr Real first = 3;
        const Real last = length - 5, held = momentum(flow, first, last);
        Real front_sum = 0, time_sum = 0, product = 0, squares = 0, count = 0;
        while (flow.time() < to * unit) {
            const Real step = flow.stable_step().seconds;
            flow.step(step);
            const Real x = front(flow), t = flow.time();
            front_sum += x, time_sum += t, product += x * t, squares += t * t, count += 1;
            add(before, flow, first, step), add(behind, flow, last, step);
        }
        const Real shallow = before.depth / count, deep = behind.depth / count;
        Found found;
        const Real speed = (product - front_sum * time_sum / count) / (squares - square(time_sum) / count);
        found.speed = speed / stream();
        Jump seen = *this;  // what comes towards a jump that moves
        seen.depth = shallow;
        seen.froude = (before.flow / before.depth - speed) / seen.wave();
        found.depth = deep / shallow / seen.sequent();
        found.lost = (before.head_at(speed) - behind.head_at(speed)) / (seen.lost() * shallow);
        found.momentum_lost = 1 - (behind.thrust + momentum(flow, first, last) - held) / before.thrust;
        MESSAGE("F = " << froude << ", " << n << " cells: it runs at " << 100 * found.speed
                       << " % of the stream's speed; depth behind over Belanger's " << found.depth
                       << "; energy lost " << found.lost << " of Belanger's; momentum lost "
                       << 100 * found.momentum_lost << " %; discharge behind "
                       << behind.flow / count / (stream() * depth) << "; depth there over the tailwater's "
                       << deep / depth / sequent());
        return found;
    }
};

}  // namespace hydraulic_jump
