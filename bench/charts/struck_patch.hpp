#pragma once
// A patch of concrete that stones strike and slide over: the scene that is run again and again to see what
// the answer depends on.

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/dem/linear_hysteretic.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <algorithm>
#include <cstdint>
#include <ctime>

namespace abrade::charts {

/// 0.24 m x 0.24 m of concrete on a slope of 30 degrees, steeper than friction, so that stones leave. They
/// are fed a little above the upper half, at random places, turned at random.
struct Patch {
    static constexpr Real side = 0.24;    ///< [m]
    static constexpr Real square = 0.04;  ///< side of the squares that depth is looked at in [m]

    std::uint32_t seed = 1;
    int stones = 160;
    Real interval = 0.006;     ///< between them [s]
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
        constexpr Real half = 0.5 * side, slope = pi / 6;
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
                            .seed = seed};
        s.outlet = half + stone_size;
        return s;
    }
    Real end_time() const { return stones * interval; }
};

/// What came of it. Volumes and energies are those of a mean stone: now and then one finds no room in time.
struct PatchAnswers {
    Real worn = 0, overflow = 0, detached = 0;  ///< volumes [m3]
    Real mean_depth = 0, max_depth = 0;         ///< of a square [m]
    Real bonds_broken = 0, grains = 0;
    Real lost_normal = 0, lost_sliding = 0;  ///< in contacts with concrete [J]
    Real lost_bond = 0;                      ///< [J]
    Real share = 0;                          ///< largest_collision_share
    Real fed = 0;                            ///< stones
    Real steps = 0, processor = 0;           ///< [-], time of one core [s]
    Real residual = 0;                       ///< of the ledger, relative
    Real loosened = 0;                       ///< spheres that came loose before they were worn out
    Real untied = 0;  ///< likewise, and those that no sound bond ties to the ground, but a seat holds

    /// Calls f(name, member) for each.
    static void visit(auto&& f) {
        f("worn_m3", &PatchAnswers::worn), f("overflow_m3", &PatchAnswers::overflow);
        f("detached_m3", &PatchAnswers::detached), f("mean_depth_m", &PatchAnswers::mean_depth);
        f("max_depth_m", &PatchAnswers::max_depth), f("bonds_broken", &PatchAnswers::bonds_broken);
        f("grains", &PatchAnswers::grains), f("lost_normal_J", &PatchAnswers::lost_normal);
        f("lost_sliding_J", &PatchAnswers::lost_sliding), f("lost_bond_J", &PatchAnswers::lost_bond);
        f("largest_share", &PatchAnswers::share), f("fed", &PatchAnswers::fed);
        f("steps", &PatchAnswers::steps);
        f("processor_s", &PatchAnswers::processor), f("residual", &PatchAnswers::residual);
        f("loosened", &PatchAnswers::loosened), f("untied", &PatchAnswers::untied);
    }
    Real lost() const { return lost_normal + lost_sliding; }
};

namespace detail {

template <class Sim>
PatchAnswers answers_of(Sim sim, const Patch& patch) {
    const std::clock_t start = std::clock();
    sim.run({.end_time = patch.end_time(), .safety = patch.safety});
    const Concrete& concrete = sim.concrete();
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
    const auto& state = sim.world().state();
    for (Index s = 0; s < concrete.sites(); ++s) {
        a.grains += concrete.gone(s);
        if (!(concrete.fracture(s) < 1)) continue;
        a.loosened += concrete.gone(s);
        a.untied += state.standing ? state.standing->ties().loose(s) : concrete.gone(s);
    }
    // Over squares of one size, so that spheres of any size can be compared.
    constexpr auto across = static_cast<std::size_t>(Patch::side / Patch::square + 0.5);
    std::vector<Real> lost(across * across, 0);
    const std::vector<Real> depth = concrete.depth();
    for (const LatticeSite& site : lattice.sites) {
        if (site.layer > 0) continue;
        const auto cell = [&](Real x) {
            return static_cast<std::size_t>((x + 0.5 * Patch::side) / Patch::square);
        };
        const auto column = static_cast<std::size_t>(site.column);
        lost[cell(site.centre.x()) * across + cell(site.centre.y())] +=
            depth[column] * lattice.column_area[column];
    }
    for (const Real volume : lost) {
        a.mean_depth += volume / abrade::square(Patch::side);
        a.max_depth = std::max(a.max_depth, volume / abrade::square(Patch::square));
    }
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
