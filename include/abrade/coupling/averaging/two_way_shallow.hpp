#pragma once
// Depth-averaged water that feels the bodies in it.

#include <abrade/coupling/drag/dense_drag.hpp>
#include <abrade/fluid/shallow_water/shallow_water.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace abrade {

/// Shallow water and bodies in it (ResolvedFluid): what it does to them is taken from it, and what they
/// displace raises it. Upon a body acts what acts in one-way water (fluid_load), and the slope of the
/// surface:
///   F = B + beta (u - v) - rho g V grad(surface),
/// B buoyancy, drag implicit in the body's velocity v. The column loses B and drag, as far as they point
/// along the plane, over a triangle along each axis that has the variance of a ball of three diameters, or of
/// three cells where these are wider (half width sqrt(6/5) radii of that ball), to each cell by the water in
/// it; a body where no water is has none of it. There the volume below the surface stands under the water,
/// whose surface lies on top of both: it flows as over a bed that is so much higher, and so the slope's part
/// is taken from it, too. Bodies are not turned, and have no added mass.
template <DragLaw Drag = CliftGauvin>
class TwoWayShallow {
public:
    static constexpr std::string_view name = "TwoWayShallow";
    using Params = ShallowWaterParams<2>;

    explicit TwoWayShallow(Params params, Drag drag = {})
        : water_(std::move(params)), drag_(std::move(drag)) {}
    const Params& params() const noexcept { return water_.params(); }
    const ShallowWater<2>& water() const noexcept { return water_; }
    auto columns() const { return water_.columns(); }

    Real time() const noexcept { return water_.time(); }  ///< [s]
    FluidStep stable_step() const noexcept { return water_.stable_step(); }
    FluidSample sample(const Vec3& x, Real t) const noexcept { return water_.sample(x, t); }

    /// Throws as ShallowWater does.
    void advance(Real to_time) { water_.advance(to_time); }
    /// The same among bodies that stand at `to_time` as they are given, and came there straight.
    void advance(Real to_time, std::span<FlowBody> bodies) {
        require_finite(to_time, "TwoWayShallow.advance: to_time", "s");
        if (!(time() < to_time)) return;
        const Real from = time(), own = water_.stable_step().seconds;
        const int steps = std::max(static_cast<int>(std::ceil((to_time - from) / own - 1e-9)), 1);
        std::vector<FlowLoad> acted;
        for (const FlowBody& body : bodies) acted.push_back(body.load);
        for (int n = 1; n <= steps; ++n) {
            const Real dt = (to_time - from) / steps;
            raised_.assign(water_.grid().size(), 0.0);
            for (std::size_t b = 0; b < bodies.size(); ++b)
                exchange(bodies[b], acted[b], dt, (steps - n) * dt);
            water_.set_solids(raised_);
            water_.advance(n == steps ? to_time : from + n * dt);
        }
    }

    static void fields(auto&& field) { field("water", &TwoWayShallow::water_); }

private:
    struct Part {
        Index i = 0, j = 0;
        Real share = 0;
    };

    /// `acted`: the load that it has had so far; `later`: how long before the end of its way it is looked at.
    void exchange(FlowBody& body, const FlowLoad& acted, Real dt, Real later) {
        const Vec3 x = body.position - later * body.velocity;
        spread(x, body.diameter());
        const FluidSample here = parts_.empty() ? FluidSample{} : water_.sample(x, time());
        const Real below = submerged_share(here.depth, 0.5 * body.diameter()) * body.volume;
        const FluidLoad load = fluid_load(drag_, here, {x, body.velocity, body.volume}, params().gravity);
        const Real slip = (here.velocity - body.velocity).norm();
        const Real beta = slip > 0 ? load.drag.norm() / slip : 0, stiff = dt * beta * body.inverse_mass;
        const Vec3 pressed = params().density * params().gravity.z() * below * slope();
        const Vec3 others = load.buoyancy + pressed - acted.force;
        if (body.inverse_mass > 0)
            body.velocity =
                (body.velocity + dt * body.inverse_mass * others + stiff * here.velocity) / (1 + stiff);
        const Vec3 taken = load.buoyancy + beta * (here.velocity - body.velocity);
        body.load = {taken + pressed, Vec3::Zero()};
        const Real cell = water_.grid().spacing(0) * water_.grid().spacing(1);
        for (const Part& part : parts_) {
            raised_[water_.grid().at(part.i, part.j)] += part.share * below / cell;
            water_.push(part.i, part.j, -dt * part.share / (params().density * cell) * taken);
        }
    }

    /// Over the wet cells about a place, to each by its water: a thin one would be flung away by what it was
    /// given.
    void spread(const Vec3& x, Real diameter) {
        const ShallowGrid<2>& grid = water_.grid();
        std::array<std::vector<std::pair<Index, Real>>, 2> layers;
        for (int a = 0; a < 2; ++a) {
            const Real h = grid.spacing(a), half = triangle_half(spread_radius(diameter, h));
            const auto number = [&](Real at) {
                return static_cast<Index>(std::floor((at - grid.low(a)) / h));
            };
            for (Index i = number(x[a] - half); i <= number(x[a] + half); ++i)
                if (const Real share =
                        1 - std::abs(grid.low(a) + (static_cast<Real>(i) + 0.5) * h - x[a]) / half;
                    share > 0 && has(a, wrapped(a, i)))
                    layers[static_cast<std::size_t>(a)].push_back({wrapped(a, i), share});
        }
        parts_.clear();
        Real sum = 0;
        for (const auto& [j, along_y] : layers[1])
            for (const auto& [i, along_x] : layers[0])
                if (is_wet(i, j)) {
                    const Real weight = along_x * along_y * water_.depth(i, j);
                    parts_.push_back({i, j, weight}), sum += weight;
                }
        for (Part& part : parts_) part.share /= sum;
    }
    bool has(int a, Index i) const noexcept { return i >= 0 && i < water_.grid().count(a); }
    /// Across a periodic side.
    Index wrapped(int a, Index i) const noexcept {
        const Index n = water_.grid().count(a);
        const auto& ends = params().boundaries[static_cast<std::size_t>(a)];
        return ends[0].kind == ShallowBoundary::Kind::periodic ? (i % n + n) % n : i;
    }
    bool is_wet(Index i, Index j) const noexcept { return water_.depth(i, j) > params().dry_depth; }

    /// Of the surface, mean over the parts [-].
    Vec3 slope() const noexcept {
        Vec3 sum = Vec3::Zero();
        for (const Part& part : parts_)
            for (int a = 0; a < 2; ++a) {
                const std::array<Index, 2> step{a == 0, a == 1}, at{part.i, part.j};
                const auto to = [&](Index by) {  // or the cell itself, where there is none
                    const Index i = wrapped(0, at[0] + by * step[0]), j = wrapped(1, at[1] + by * step[1]);
                    const bool there = has(a, a == 0 ? i : j) && is_wet(i, j);
                    return there ? water_.surface(i, j) : water_.surface(part.i, part.j);
                };
                sum[a] += part.share * (to(1) - to(-1)) / (2 * water_.grid().spacing(a));
            }
        return sum;
    }

    ShallowWater<2> water_;
    Drag drag_;
    CellColumn raised_;        ///< by solids [m]
    std::vector<Part> parts_;  ///< of the body at work
};

static_assert(ResolvedFluid<TwoWayShallow<>>);

}  // namespace abrade
