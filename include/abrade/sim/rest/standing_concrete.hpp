#pragma once
// Concrete that stands: which of its spheres are bodies, what wears out, and what is let go.

#include <abrade/sim/motion/advance.hpp>

namespace abrade {

namespace detail {

/// Calls `visit(sphere, site, shift, square of the distance of the centres)` for the spheres of a body and
/// the standing ones whose surfaces are nearer than `skin` [m], as they stand or as they will once they have
/// sunk.
template <class P>
void each_site_near(const State<P>& state, Index body, Real skin, auto&& visit) {
    const Particles& p = state.particles;
    const SiteBodies& sites = state.sites;
    const Real own = state.concrete.lattice().radius;
    const Vec3 period = state.scene.periodic().period;
    const auto first = p.first_sphere[static_cast<std::size_t>(body)],
               last = first + p.sphere_count[static_cast<std::size_t>(body)];
    Real extent = 0;
    for (Index s = first; s < last; ++s) {
        const auto n = static_cast<std::size_t>(s);
        extent = std::max(extent, p.offset[n].norm() + p.radius[n]);
    }
    const Real reach = extent + own + skin;
    const auto look = [&](const ImageShift& shift) {
        const Vec3 away = shift.times(period), x = p.position[static_cast<std::size_t>(body)] + away;
        sites.grid.each_about(x, reach + sites.longest_way, [&](Index site) {
            const auto at_site = static_cast<std::size_t>(site);
            const Vec3& now = sites.place[at_site];
            const bool sinks = sites.recede() && sites.worn[at_site] && !state.concrete.gone(site);
            const Vec3 then = sinks ? state.place_once_sunk(site) : now;
            const auto distance2 = [&](const Vec3& from) {
                const Real of_now = (now - from).squaredNorm();
                return sinks ? std::min(of_now, (then - from).squaredNorm()) : of_now;
            };
            if (distance2(x) >= square(reach)) return;
            for (Index s = first; s < last; ++s) {
                const auto n = static_cast<std::size_t>(s);
                if (const Real d2 = distance2(p.centre[n] + away); d2 < square(p.radius[n] + own + skin))
                    visit(s, site, -shift, d2);
            }
        });
    };
    look({});
    each_shift(
        period, [](int, int) { return true; }, look);
}

}  // namespace detail

/// The lowest z at which a sphere of radius `reach` [m] over x touches no concrete that stands.
template <class P>
Real height_above_standing(const State<P>& state, const Vec3& x, Real reach) {
    Real lowest = -std::numeric_limits<Real>::infinity();
    if (!state.sites.stand) return lowest;
    const Real both = state.concrete.lattice().radius + reach;
    const Real wide = both + state.sites.longest_way;
    const Vec3 column(wide, wide, std::numeric_limits<Real>::infinity());
    state.sites.grid.each_about(x, column, [&](Index site) {
        if (state.concrete.gone(site)) return;
        // One that waits to sink is in the way until then.
        for (const Vec3& centre : {state.place_of(site), state.sites.place[static_cast<std::size_t>(site)]}) {
            const Real room2 = square(both) - (centre - x).template head<2>().squaredNorm();
            if (room2 > 0) lowest = std::max(lowest, centre.z() + std::sqrt(room2));
        }
    });
    return lowest;
}

/// Adds the standing spheres that are nearer than `skin` [m] to what moves among the bodies from `first` on;
/// `particles` must be as of now.
template <class P>
void find_near_sites(const State<P>& state, Index first, Real skin, std::vector<SitePair>& pairs) {
    const Particles& p = state.particles;
    const Index bodies = p.bodies() - first;
    std::vector<std::vector<SitePair>> found(static_cast<std::size_t>(block_count(bodies, block_of_bodies)));
    const Real own = state.concrete.lattice().radius;
    parallel_blocks(
        bodies,
        [&](Index block, Index from, Index to) {
            for (Index b = first + from; b < first + to; ++b)
                if (p.inverse_mass[static_cast<std::size_t>(b)] > 0)
                    detail::each_site_near(
                        state, b, skin,
                        [&](Index sphere, Index site, const ImageShift& shift, Real distance2) {
                            const Real both = p.radius[static_cast<std::size_t>(sphere)] + own;
                            found[static_cast<std::size_t>(block)].push_back(
                                {sphere, site, shift, distance2 < square(both)});
                        });
        },
        block_of_bodies);
    for (const auto& some : found) pairs.insert(pairs.end(), some.begin(), some.end());
}

/// The concrete's surface changes between collisions, never within one: what is worn out vanishes once
/// nothing touches it, and where worn spheres recede, those that nothing touches sink. Grains that are worn
/// out are no surface and vanish at once. `near` has the spheres that are near and touched.
template <class P>
void reshape(State<P>& state, const detail::SiteMarks& near) {
    SiteBodies& sites = state.sites;
    std::erase_if(sites.worn_out, [&](Index site) {
        const bool is_grain = state.concrete.gone(site);
        if (near.touched(site) && !is_grain) return false;
        state.wear_away(site);
        if (sites.stand && !is_grain) sites.emptied.push_back(site);
        return true;
    });
    if (!sites.recede()) return;
    for (const Index site : near.all())
        if (sites.worn[static_cast<std::size_t>(site)] && !near.touched(site) && !state.concrete.gone(site))
            state.sink(site);
}

/// Makes bodies of the marked spheres that are none.
template <class P>
void stand_by(State<P>& state, const detail::SiteMarks& near) {
    std::vector<Index> all;
    for (const Index site : near.all())
        if (near.near(site) && !state.concrete.gone(site)) all.push_back(site);
    std::sort(all.begin(), all.end());
    for (const Index site : all) state.body_at(site);
}

/// Marks in `gone` [body] the standing spheres that are not marked as near.
template <class P>
void retire(const State<P>& state, const detail::SiteMarks& near, std::vector<char>& gone) {
    for (std::size_t b = 0; b < gone.size(); ++b)
        if (state.particles.kind[b] == Kind::concrete && !near.near(state.particles.site[b])) gone[b] = 1;
}

/// Places the wear that waits, takes out what is worn out, and lets go what bonds no longer hold. Loads must
/// be those of now, and nothing may have been evaluated since.
template <class P>
void settle_concrete(State<P>& state, Real time) {
    if (!state.scene.concrete) return;
    Concrete& concrete = state.concrete;
    const WornOut worn_out = state.scene.concrete->worn_out;
    const bool as_fines = worn_out == WornOut::fines || worn_out == WornOut::recedes;
    std::vector<Index> emptied = std::exchange(state.sites.emptied, {}), loose;
    if (concrete.unsettled()) {
        const std::vector<Index> full = concrete.settle(time);
        if (as_fines) state.sites.worn_out.insert(state.sites.worn_out.end(), full.begin(), full.end());
        for (const Index site : concrete.taken_from()) state.sites.note_worn(site);
        if (worn_out == WornOut::grain && state.sites.stand)
            for (const Index site : full) emptied.push_back(site), loose.push_back(site);
        if constexpr (P::has_bonds)
            if (state.standing)
                for (const Index site : concrete.taken_from()) state.standing->weakened(site);
    }
    if constexpr (P::has_bonds)
        if (state.standing) {
            for (const Index site : std::exchange(state.events.weakened, {})) state.standing->weakened(site);
            std::vector<SiteLoad>& site_loads = state.events.site_loads;
            std::sort(site_loads.begin(), site_loads.end(),
                      [](const SiteLoad& a, const SiteLoad& b) { return a.site < b.site; });
            if (!site_loads.empty() || !emptied.empty()) {
                const std::vector<Index> unheld =
                    state.standing->settle(site_loads, emptied, state.strength_of_site());
                loose.insert(loose.end(), unheld.begin(), unheld.end());
            }
            site_loads.clear();
        }
    std::sort(loose.begin(), loose.end());
    if (!loose.empty()) land(state);  // what comes loose begins now, and not as those that fly took off
    // What is fully worn goes as fines, once nothing touches it, and not as a grain before.
    for (const Index site : loose)
        if (!as_fines || concrete.fracture(site) < 1) state.let_go(site);
}

}  // namespace abrade
