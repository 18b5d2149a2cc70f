#pragma once
// Concrete that stands: which of its spheres are bodies, what wears out, and what is let go.

#include <abrade/sim/advance.hpp>

namespace abrade {

namespace detail {

/// Calls `visit(site)` for standing sites nearer than `skin` [m] to a sphere of a body, some of them more
/// than once; `particles` must be as of now.
template <class P>
void each_site_near(const State<P>& state, Index body, Real skin, auto&& visit) {
    const Particles& p = state.particles;
    const Lattice& lattice = state.concrete.lattice();
    const Vec3 period = state.scene.periodic().period;
    const auto first = static_cast<std::size_t>(p.first_sphere[static_cast<std::size_t>(body)]);
    const auto count = static_cast<std::size_t>(p.sphere_count[static_cast<std::size_t>(body)]);
    for (std::size_t s = first; s < first + count; ++s) {
        const Real reach = p.radius[s] + lattice.radius + skin;
        const auto look = [&](const Vec3& x) {
            state.sites.grid.each_about(x, reach, [&](Index site) {
                if (state.concrete.gone(site)) return;
                if ((lattice.sites[static_cast<std::size_t>(site)].centre - x).squaredNorm() < square(reach))
                    visit(site);
            });
        };
        look(p.centre[s]);
        each_shift(
            period, [](int, int) { return true; },
            [&](const ImageShift& shift) { look(p.centre[s] + shift.times(period)); });
    }
}

}  // namespace detail

/// The lowest z at which a sphere of radius `reach` [m] over x touches no concrete that stands.
template <class P>
Real height_above_standing(const State<P>& state, const Vec3& x, Real reach) {
    Real lowest = -std::numeric_limits<Real>::infinity();
    if (!state.sites.stand) return lowest;
    const Real both = state.concrete.lattice().radius + reach;
    const Vec3 column(both, both, std::numeric_limits<Real>::infinity());
    state.sites.grid.each_about(x, column, [&](Index site) {
        if (state.concrete.gone(site)) return;
        const Vec3& centre = state.place_of(site);
        const Real room2 = square(both) - (centre - x).template head<2>().squaredNorm();
        if (room2 > 0) lowest = std::max(lowest, centre.z() + std::sqrt(room2));
    });
    return lowest;
}

/// Marks the standing sites that are nearer than `skin` [m] to what moves among the bodies from `first` on;
/// `particles` must be as of now.
template <class P>
void mark_near(const State<P>& state, Index first, Real skin, detail::SiteMarks& near) {
    for (Index b = first; b < state.particles.bodies(); ++b)
        if (state.particles.inverse_mass[static_cast<std::size_t>(b)] > 0)
            detail::each_site_near(state, b, skin, [&](Index site) { near.add(site); });
}

/// Makes bodies of the marked spheres that are none.
template <class P>
void stand_by(State<P>& state, detail::SiteMarks& near) {
    std::sort(near.all().begin(), near.all().end());
    for (const Index site : near.all()) state.body_at(site);
}

/// Marks in `gone` [body] the standing spheres that are not marked as near.
template <class P>
void retire(const State<P>& state, const detail::SiteMarks& near, std::vector<char>& gone) {
    for (std::size_t b = 0; b < gone.size(); ++b)
        if (state.particles.kind[b] == Kind::concrete && !near.has(state.particles.site[b])) gone[b] = 1;
}

/// Places the wear that waits, takes out what is worn out, and lets go what bonds no longer hold. Loads must
/// be those of now, and nothing may have been evaluated since.
template <class P>
void settle_concrete(State<P>& state, Real time) {
    if (!state.scene.concrete) return;
    Concrete& concrete = state.concrete;
    const WornOut worn_out = state.scene.concrete->worn_out;
    std::vector<Index> emptied, loose;
    if (concrete.unsettled()) {
        const std::vector<Index> full = concrete.settle(time);
        if (worn_out == WornOut::fines)
            for (const Index site : full) state.wear_away(site), emptied.push_back(site);
        if (worn_out == WornOut::grain && state.sites.stand)
            for (const Index site : full) emptied.push_back(site), loose.push_back(site);
        if constexpr (P::has_bonds)
            if (state.standing)
                for (const Index site : concrete.taken_from()) state.standing->weakened(site);
    }
    if constexpr (P::has_bonds)
        if (state.standing) {
            for (const Index site : std::exchange(state.weakened, {})) state.standing->weakened(site);
            std::vector<Press>& presses = state.presses;
            std::sort(presses.begin(), presses.end(),
                      [](const Press& a, const Press& b) { return a.site < b.site; });
            if (!presses.empty() || !emptied.empty()) {
                const std::vector<Index> unheld =
                    state.standing->settle(presses, emptied, state.strength_of_site());
                loose.insert(loose.end(), unheld.begin(), unheld.end());
            }
            presses.clear();
        }
    std::sort(loose.begin(), loose.end());
    for (const Index site : loose) state.let_go(site);
}

}  // namespace abrade
