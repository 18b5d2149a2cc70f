#pragma once
// Columns of grains that collapse on a rough bed when their container is taken away (dem12). Shared by the
// tests and by bench/charts/column_collapse.cpp; docs/verification/column_collapse.md tells what is compared.
//
// Lengths are in grain diameters d, times in sqrt(d/g), until they meet the library.

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/sim/simulation.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace column_collapse {

using namespace abrade;

constexpr Real diameter = 0.01, density = 2650, g = standard_gravity;  // [m], [kg/m3], [m/s2]
constexpr Real packing = 0.6;  ///< solid fraction by which solid volume per area is shown as a height [-]

enum class Shape {
    round,  ///< a cylinder, opened all round: polygon of 24 planes
    flat    ///< a slice of a wide column, against a wall at x = 0, opened at one side; periodic across
};

struct Column {
    Shape shape = Shape::round;
    Real radius = 8;      ///< or length, along which the flat one is opened [d]
    Real aspect = 1;      ///< height / radius [-]
    Real width = 5;       ///< of the slice [d]
    Real friction = 0.5;  ///< of all contacts [-]
    /// Of the springs [rho g d2]. Softer ones would give way, not under the weight of a high column (1 % of
    /// d) but as it lands while it settles.
    Real stiffness = 1e4;
    std::uint32_t seed = 1;  ///< of the grains' sizes

    Real height() const { return aspect * radius; }  ///< [d]
    /// Area of the column's foot [d2].
    Real foot() const {
        return shape == Shape::round ? 24 * std::tan(pi / 24) * square(radius) : radius * width;
    }
};

inline LinearSpring grain_law(const Column& column) {
    return LinearSpring{{.stiffness = column.stiffness * density * g * square(diameter),
                         .restitution = 0.5,
                         .friction = column.friction}};
}

/// A grain: its centre and radius [d]. The bed's surface, the tops of its spheres, lies near z = 0.
struct Grain {
    Vec3 centre = Vec3::Zero();
    Real radius = 0.5;
};
using Grains = std::vector<Grain>;

inline Real solid(const Grain& grain) { return 4 * pi / 3 * cube(grain.radius); }
inline Real solid(const Grains& grains) {
    Real sum = 0;
    for (const Grain& grain : grains) sum += solid(grain);
    return sum;
}

/// An open scene: a bed of fixed spheres of d, out to `reach` from the axis, and what bounds the slice.
inline Scene bed(const Column& column, Real reach) {
    const bool flat = column.shape == Shape::flat;
    Scene scene;
    const Clump sphere = make_clump("bed", {{Vec3::Zero(), 0.5 * diameter}});
    const auto rows = static_cast<Index>(std::ceil(reach));
    const auto across = static_cast<Index>(std::lround(column.width));
    // Shifted at random off a square lattice, and up and down: a lattice would lead grains along its rows. A
    // shift follows from the place alone, so that grains settled on a small bed fit a large one.
    for (Index i = flat ? -1 : -rows; i < rows; ++i)
        for (Index j = flat ? 0 : -rows; j < (flat ? across : rows); ++j) {
            std::seed_seq place{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)};
            std::mt19937 random(place);
            const auto shift = [&] { return 0.4 * (std::generate_canonical<Real, 53>(random) - 0.5); };
            Vec3 centre{i + 0.5, j + 0.5, -0.5};
            for (int axis = 0; axis < 3; ++axis) centre[axis] += shift();
            if (flat || centre.head<2>().norm() < reach) scene.add_fixed(sphere, diameter * centre);
        }
    scene.add_wall({0, 0, -diameter}, {0, 0, 1});  // for grains that find a hole, or roll off the bed
    if (flat) {
        scene.add_wall({0, 0, 0}, {1, 0, 0});
        scene.bounds.low.y() = 0, scene.bounds.high.y() = diameter * column.width;
        scene.periodic_along = {false, true, false};
    }
    return scene;
}

/// Grains that crossed a periodic bound since lists were looked through come in again.
inline void add(Scene& scene, const Grains& grains) {
    for (const Grain& grain : grains) {
        Vec3 centre = diameter * grain.centre;
        const Real period = scene.periodic().period.y();
        if (period > 0) centre.y() -= period * std::floor(centre.y() / period);
        scene.add_sphere(diameter * grain.radius, {.position = centre}, density);
    }
}

/// Runs until the grains on the bed have next to no kinetic energy: in the mean, what lifts them by `still`
/// d. What rolled off it, beyond `reach`, rolls on. `observer(simulation)` sees it every sqrt(d/g). Throws
/// where grains have not come to rest in `longest` sqrt(d/g).
struct Rest {
    Real still = 0, reach = 0, longest = 0;
};
template <class Sim, class Observer>
void run_to_rest(Sim& sim, const Rest& rest, Observer&& observer) {
    const Real unit = std::sqrt(diameter / g);
    for (Real until = 1;; ++until) {
        // The stable step counts twelve contacts at once; 0.6 of it leaves 1 % of the energy as residue.
        sim.run({.end_time = until * unit, .safety = 0.6});
        observer(sim);
        Real kinetic = 0, weight = 0;
        const Particles& p = sim.particles();
        for (Index b = 0; b < p.bodies(); ++b) {
            const auto i = static_cast<std::size_t>(b);
            if (p.kind[i] != Kind::stone || p.position[i].head<2>().norm() > diameter * rest.reach) continue;
            kinetic += p.kinetic_energy(b), weight += g * p.mass[i];
        }
        if (until > 5 && kinetic < rest.still * diameter * weight) return;
        if (until > rest.longest) throw std::runtime_error("the grains do not come to rest");
    }
}

/// The grains of a simulation, as published last.
template <class Sim>
Grains grains_of(const Sim& sim) {
    Grains grains;
    const Particles& p = sim.particles();
    for (std::size_t b = 0; b < p.position.size(); ++b)
        if (p.kind[b] == Kind::stone)
            grains.push_back(
                {p.position[b] / diameter, p.radius[static_cast<std::size_t>(p.first_sphere[b])] / diameter});
    return grains;
}

/// Grains of 0.85 to 1.15 d, settled in the closed container from a loose lattice. `column.height()` is what
/// they fill at least; `cut` brings them to a height.
inline Grains settled(const Column& column) {
    const Real reach = 1.1 * column.radius + 2;
    Scene scene = bed(column, reach);
    const bool flat = column.shape == Shape::flat;
    if (flat)
        scene.add_wall({diameter * column.radius, 0, 0}, {-1, 0, 0});
    else
        for (int side = 0; side < 24; ++side) {
            const Vec3 outward{std::cos(2 * pi * side / 24), std::sin(2 * pi * side / 24), 0};
            scene.add_wall(diameter * column.radius * outward, -outward);
        }
    std::mt19937_64 random(column.seed);
    const auto uniform = [&] { return std::generate_canonical<Real, 53>(random); };
    Grains grains;
    const Real spacing = 1.18, needed = 0.6 * column.foot() * (column.height() + 1);
    const auto along = static_cast<Index>(column.radius / spacing),
               across = flat ? static_cast<Index>(column.width / spacing) : 2 * along;
    Real filled = 0;
    for (Real z = 0.8; filled < needed; z += spacing)
        for (Index i = flat ? 0 : -along; i < along; ++i)
            for (Index j = 0; j < across; ++j) {
                const Grain grain{{spacing * (i + 0.5), spacing * ((flat ? 0.5 : 0.5 - along) + j), z},
                                  0.425 + 0.15 * uniform()};
                if (!flat && grain.centre.head<2>().norm() > column.radius - 0.6) continue;
                grains.push_back(grain), filled += solid(grain);
            }
    add(scene, grains);
    auto sim = simulate(std::move(scene)).contact(grain_law(column));
    run_to_rest(sim, {1e-3, reach, 40 * std::sqrt(column.height())}, [](const auto&) {});
    return grains_of(sim);
}

/// The grains below a height [d].
inline Grains cut(Grains grains, Real height) {
    std::erase_if(grains, [&](const Grain& grain) { return grain.centre.z() + grain.radius > height; });
    return grains;
}

/// Height of a deposit against the distance from the axis: solid volume per area over `packing`, in rings
/// (strips) of 1 d.
struct Profile {
    std::vector<Real> height;  ///< [d], of the ring from n to n + 1 [d]

    /// Where the deposit is half a grain thick, seen from outside [d].
    Real front() const {
        for (std::size_t n = height.size(); n-- > 0;)
            if (height[n] >= 0.5) {
                const Real beyond = n + 1 < height.size() ? height[n + 1] : 0;
                return static_cast<Real>(n) + 0.5 + (height[n] - 0.5) / (height[n] - beyond);
            }
        return 0;
    }
};

inline Real distance(const Column& column, const Vec3& x) {
    return column.shape == Shape::round ? x.head<2>().norm() : x.x();
}

inline Profile profile_of(const Column& column, const Grains& grains) {
    Profile profile;
    for (const Grain& grain : grains) {
        const auto ring = static_cast<std::size_t>(std::max(0.0, distance(column, grain.centre)));
        if (profile.height.size() <= ring) profile.height.resize(ring + 1);
        const Real n = static_cast<Real>(ring),
                   area = column.shape == Shape::round ? pi * (square(n + 1) - square(n)) : column.width;
        profile.height[ring] += solid(grain) / (packing * area);
    }
    return profile;
}

/// How far the grains reach that touch the pile, in the mean over 36 sectors (strips as wide as a grain) [d].
/// The pile: grains within half the column's radius, and whatever touches it through a chain of grains. What
/// lies scattered beyond does not count, however densely: the front as seen in an experiment, where a deposit
/// is hundreds of grains long.
inline Real contiguous_front(const Column& column, Grains grains) {
    // Its grains first, in the order they were reached; then those that are not.
    auto end = std::partition(grains.begin(), grains.end(), [&](const Grain& grain) {
        return distance(column, grain.centre) < 0.5 * column.radius;
    });
    const auto apart = [&](const Grain& a, const Grain& b) {
        Vec3 between = a.centre - b.centre;
        if (column.shape == Shape::flat) between.y() -= column.width * std::round(between.y() / column.width);
        return between.norm() - a.radius - b.radius;
    };
    for (auto grain = grains.begin(); grain != end; ++grain)
        end = std::partition(end, grains.end(),
                             [&, from = *grain](const Grain& other) { return apart(from, other) < 0.01; });
    std::vector<Real> reach(column.shape == Shape::round ? 36 : static_cast<std::size_t>(column.width), 0.0);
    for (auto grain = grains.begin(); grain != end; ++grain) {
        const Vec3& x = grain->centre;
        const Real turn =
            column.shape == Shape::round ? 0.5 + std::atan2(x.y(), x.x()) / (2 * pi) : x.y() / column.width;
        const auto sector =
            static_cast<std::size_t>((turn - std::floor(turn)) * static_cast<Real>(reach.size()));
        Real& farthest = reach[std::min(sector, reach.size() - 1)];
        farthest = std::max(farthest, distance(column, x) + grain->radius);
    }
    return std::accumulate(reach.begin(), reach.end(), 0.0) / static_cast<Real>(reach.size());
}

/// What became of a column.
struct Deposit {
    Column column;
    Grains before, after;
    Profile profile;
    Real runout = 0;                  ///< (front - radius) / radius
    Real contiguous = 0;              ///< likewise, of the contiguous front
    Real height = 0;                  ///< of the highest ring of the profile / radius
    Real time = 0;                    ///< to rest [sqrt(d/g)]
    std::vector<Real> times, fronts;  ///< every sqrt(d/g) [sqrt(d/g)], [d]
    Ledger ledger;
};

/// The law of dem12 for the runout, (front - radius) / radius. Axisymmetric: G. Lube, H. Huppert, S. Sparks,
/// M. Hallworth, J. Fluid Mech. 508 (2004) 175, doi:10.1017/S0022112004009036. The flat one is a secondary
/// quote, its prefactors uncertain.
inline Real runout_law(Shape shape, Real a) {
    return shape == Shape::round ? std::min(1.24 * a, 1.6 * std::sqrt(a))
                                 : std::min(1.2 * a, 1.6 * std::pow(a, 2. / 3));
}

/// As far as the law sends the front, as far again, and room for grains that roll on [d].
inline Real reach_of(const Column& column) {
    return column.radius * (1 + 2 * runout_law(column.shape, column.aspect)) + 8;
}

/// Opens the container: a second scene, without it, from where the grains of the first one lie.
template <class Law, class Fluid = NoFluid>
Deposit collapse(const Column& column, const Grains& grains, const Law& law, Fluid fluid = Fluid{}) {
    const Real reach = reach_of(column);
    Scene scene = bed(column, reach);
    add(scene, grains);
    auto sim = simulate(std::move(scene)).contact(law).fluid(std::move(fluid));
    Deposit deposit;
    deposit.column = column, deposit.before = grains;
    run_to_rest(sim, {1e-4, reach, 60 * std::sqrt(column.height())}, [&](const auto& now) {
        deposit.times.push_back(now.time() / std::sqrt(diameter / g));
        deposit.fronts.push_back(profile_of(column, grains_of(now)).front());
    });
    deposit.after = grains_of(sim);
    deposit.profile = profile_of(column, deposit.after);
    deposit.runout = deposit.profile.front() / column.radius - 1;
    deposit.contiguous = contiguous_front(column, deposit.after) / column.radius - 1;
    deposit.height =
        *std::max_element(deposit.profile.height.begin(), deposit.profile.height.end()) / column.radius;
    deposit.time = deposit.times.back();
    deposit.ledger = sim.ledger();
    return deposit;
}
inline Deposit collapse(const Column& column, const Grains& grains) {
    return collapse(column, grains, grain_law(column));
}

/// Columns of one foot, cut from one that was settled as high as the highest.
struct Series {
    Column column;
    std::vector<Real> aspects;  ///< ascending
};

/// Calls `each(deposit)` as it is done.
template <class Each>
std::vector<Deposit> collapse_all(Series series, Each&& each) {
    series.column.aspect = series.aspects.back();
    const Grains grains = settled(series.column);
    std::vector<Deposit> deposits;
    for (const Real aspect : series.aspects) {
        series.column.aspect = aspect;
        deposits.push_back(collapse(series.column, cut(grains, series.column.height())));
        each(deposits.back());
    }
    return deposits;
}

/// The power of the aspect ratio that the runouts grow with: the slope of the least squares line in
/// logarithms.
inline Real runout_exponent(const std::vector<Deposit>& deposits, Real Deposit::*runout = &Deposit::runout) {
    Real sx = 0, sy = 0, sxx = 0, sxy = 0;
    const auto n = static_cast<Real>(deposits.size());
    for (const Deposit& deposit : deposits) {
        const Real x = std::log(deposit.column.aspect), y = std::log(deposit.*runout);
        sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

inline Column column_of(Shape shape, Real radius, Real stiffness = 1e4) {
    Column column;
    column.shape = shape, column.radius = radius, column.stiffness = stiffness;
    return column;
}
// The series of the page, below and above the bend of the laws. Low columns need more grains across, or the
// length of their runout is only a few grains.
inline const Series low_round{column_of(Shape::round, 16, 4e3), {0.5, 0.75, 1.25}},
    high_round{column_of(Shape::round, 8, 4e3), {3, 4, 5}}, low_flat{column_of(Shape::flat, 32), {0.5, 1, 2}},
    high_flat{column_of(Shape::flat, 16), {3, 5, 7}};

}  // namespace column_collapse
