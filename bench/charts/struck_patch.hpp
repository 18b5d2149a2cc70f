#pragma once
// A patch of concrete that stones strike and slide over: the scene that is run again and again to see what
// the answer depends on.

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <limits>
#include <string>

namespace abrade::charts {

/// A square of concrete on a slope of 30 degrees, steeper than friction, so that stones leave. They are fed a
/// little above the upper half, at random places, turned at random.
struct Patch {
    static constexpr Real square = 0.04;  ///< side of the squares that depth is looked at in [m]

    std::uint32_t seed = 1;
    Real side = 0.24;  ///< [m]
    int stones = 160;
    Real interval = 0.006;     ///< between them [s]
    Real tail = 0;             ///< after the last, for it to leave; 0: the last are still on the way [s]
    Real stone_size = 0.05;    ///< [m]
    Real along = 1, down = 2;  ///< velocity they are fed with [m/s]
    bool bonded = true;        ///< else the concrete is rigid
    LatticeSize lattice{};
    FractureVolume fracture_volume = FractureVolume::cell;
    LinearSpring::Params contact{.stiffness = 2e6, .restitution = 0.6, .friction = 0.5};
    MohrCoulomb::Params bond{.tensile = 2.7e6, .stiffness = 2e6};
    bool dashpot = true;  ///< else contacts lose by a dent (LinearHysteretic), with the same parameters
    ConcreteLevel level = ConcreteLevel::dynamic;
    Index cluster = 0;
    WornOut worn_out = WornOut::grain;
    Overflow overflow = DropOverflow{};
    SubParticleAbrasion::Params wear{.acceleration = 500};
    Real safety = 0.8;

    Scene scene() const {
        constexpr Real slope = pi / 6;
        const Real half = 0.5 * side, never = std::numeric_limits<Real>::infinity();
        const Real volume = pi / 6 * cube(stone_size);
        Scene s;
        s.gravity = standard_gravity * Vec3(std::sin(slope), 0, -std::cos(slope));
        s.concrete = ConcreteBlock{.lattice = flat_lattice(side, side, lattice),
                                   .fracture_volume = fracture_volume,
                                   .level = level,
                                   .cluster = cluster,
                                   .worn_out = worn_out,
                                   .overflow = overflow};
        s.feed = FeedParams{.volume_rate = volume / interval,
                            .classes = {{.size = stone_size, .fraction = 1, .shape = StoneShape::angular}},
                            .region = {{-half, -0.85 * half, 0}, {0.5 * half, 0.85 * half, 0.2}},
                            .velocity = {along, 0, -down},
                            .end = tail > 0 ? (stones + 0.5) * interval : never,
                            .seed = seed};
        s.outlet = half + stone_size;
        return s;
    }
    Real end_time() const { return stones * interval + tail; }
};

/// What came of it. Volumes and energies are those of a mean stone: now and then one finds no room in time.
struct PatchAnswers {
    static constexpr std::size_t places = 24;  ///< across

    Real worn = 0, overflow = 0, detached = 0;  ///< volumes [m3]
    Real mean_depth = 0, max_depth = 0;         ///< of a square [m]
    Real bonds_broken = 0, grains = 0;
    Real lost_normal = 0, lost_sliding = 0;  ///< in contacts with concrete [J]
    Real lost_bond = 0;                      ///< [J]
    Real share = 0;                          ///< largest_collision_share
    Real fed = 0;                            ///< stones
    Real steps = 0, processor = 0;           ///< [-], time of one core [s]
    Real residual = 0;                       ///< of the ledger, relative
    Real removed = 0;                        ///< worn and detached [m3]
    Real impact_share = 0;                   ///< of what was lost [-]
    std::array<Real, places> profile{};      ///< mean depth along the slope, for each place across [m]
    Real loosened = 0;                       ///< spheres that came loose before they were worn out
    Real untied = 0;  ///< likewise, and those that no sound bond ties to the ground, but a seat holds

    /// Calls f(name, answer) for each; answer(a) is the one of a.
    static void visit(auto&& f) {
        const auto member = [&](const char* name, Real PatchAnswers::*of) {
            f(
                name, [of](auto&& a) -> auto& { return a.*of; });
        };
        member("worn_m3", &PatchAnswers::worn);
        member("overflow_m3", &PatchAnswers::overflow);
        member("detached_m3", &PatchAnswers::detached);
        member("mean_depth_m", &PatchAnswers::mean_depth);
        member("max_depth_m", &PatchAnswers::max_depth);
        member("bonds_broken", &PatchAnswers::bonds_broken);
        member("grains", &PatchAnswers::grains);
        member("lost_normal_J", &PatchAnswers::lost_normal);
        member("lost_sliding_J", &PatchAnswers::lost_sliding);
        member("lost_bond_J", &PatchAnswers::lost_bond);
        member("largest_share", &PatchAnswers::share);
        member("fed", &PatchAnswers::fed);
        member("steps", &PatchAnswers::steps);
        member("processor_s", &PatchAnswers::processor);
        member("residual", &PatchAnswers::residual);
        member("removed_m3", &PatchAnswers::removed);
        member("impact_share", &PatchAnswers::impact_share);
        for (std::size_t n = 0; n < places; ++n)
            f(
                "depth_" + std::to_string(n + 1) + "_m", [n](auto&& a) -> auto& { return a.profile[n]; });
        member("loosened", &PatchAnswers::loosened);
        member("untied", &PatchAnswers::untied);
    }
    Real lost() const { return lost_normal + lost_sliding; }
};

namespace detail {

template <class Sim>
PatchAnswers answers_of(Sim sim, const Patch& patch) {
    const std::clock_t start = std::clock();
    sim.run({.end_time = patch.end_time(), .safety = patch.safety});
    Concrete concrete = sim.concrete();
    concrete.settle(std::numeric_limits<Real>::infinity());  // what an epoch still collects
    const Lattice& lattice = concrete.lattice();
    const Ledger& e = sim.ledger();
    const auto fed = static_cast<Real>(sim.feed()->supplied_stones());
    PatchAnswers a{.worn = concrete.worn_volume() / fed,
                   .overflow = concrete.overflow_volume() / fed,
                   .detached = concrete.detached_volume() / fed,
                   .bonds_broken = static_cast<Real>(sim.bonds_broken()),
                   .lost_normal = e.concrete_lost_normal / fed,
                   .lost_sliding = e.concrete_lost_sliding / fed,
                   .lost_bond = e.lost_bond / fed,
                   .share = concrete.largest_collision_share(),
                   .fed = fed,
                   .steps = static_cast<Real>(sim.steps()),
                   .processor = static_cast<Real>(std::clock() - start) / CLOCKS_PER_SEC,
                   .residual = e.residual_relative()};
    a.removed = a.worn + a.detached, a.impact_share = a.lost_normal / a.lost();
    const auto& state = sim.world().state();
    for (Index s = 0; s < concrete.sites(); ++s) {
        a.grains += concrete.gone(s);
        if (!(concrete.fracture(s) < 1)) continue;
        a.loosened += concrete.gone(s);
        a.untied += state.standing ? state.standing->graph().loose(s) : concrete.gone(s);
    }
    // Over squares of one size, so that spheres of any size can be compared.
    const auto across = static_cast<std::size_t>(patch.side / Patch::square + 0.5);
    std::vector<Real> lost(across * across, 0);
    const std::vector<Real> depth = concrete.depth();
    for (const LatticeSite& site : lattice.sites) {
        if (site.layer > 0) continue;
        const auto cell = [&](Real x) {
            return static_cast<std::size_t>((x + 0.5 * patch.side) / Patch::square);
        };
        const auto column = static_cast<std::size_t>(site.column);
        lost[cell(site.centre.x()) * across + cell(site.centre.y())] +=
            depth[column] * lattice.column_area[column];
    }
    for (const Real volume : lost) {
        a.mean_depth += volume / abrade::square(patch.side);
        a.max_depth = std::max(a.max_depth, volume / abrade::square(Patch::square));
    }
    // A place may be wider or narrower than a row of spheres.
    const auto rows = static_cast<std::size_t>(lattice.count_across);
    for (std::size_t c = 0; c < depth.size(); ++c)
        for (std::size_t part = c % rows * a.places; part < (c % rows + 1) * a.places; ++part)
            a.profile[part / rows] += depth[c] / static_cast<Real>(depth.size());
    return a;
}

}  // namespace detail

inline PatchAnswers run(const Patch& patch) {
    const auto with = [&](auto sim) {
        const SubParticleAbrasion wear{patch.wear};
        if (!patch.bonded) return detail::answers_of(std::move(sim).wear(wear), patch);
        return detail::answers_of(std::move(sim).bond(MohrCoulomb{patch.bond}).wear(wear), patch);
    };
    const LinearSpring::Params& k = patch.contact;
    if (patch.dashpot) return with(simulate(patch.scene()).contact(LinearSpring{k}));
    return with(simulate(patch.scene())
                    .contact(LinearHysteretic{{.stiffness = k.stiffness,
                                               .restitution = k.restitution,
                                               .friction = k.friction,
                                               .tangential_ratio = k.tangential_ratio}}));
}

}  // namespace abrade::charts
