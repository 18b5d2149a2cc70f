#pragma once
// Concrete that stands: what its bonds hold, checked by equilibrium, and what comes loose.

#include <abrade/bond/bond_graph.hpp>
#include <abrade/bond/equilibrium.hpp>

#include <limits>
#include <optional>

namespace abrade {

/// A load on the sphere of a site: force, and torque over its radius [N].
struct SiteLoad {
    Index site = 0;
    Screw load{};
};

/// Spheres of one radius that stand where they were built. A sphere under load is checked by equilibrium:
/// it, and all within `cluster` bonds of it, give way on their bonds to what stands around them, and bonds
/// break where the law says so, the most overloaded first. What bonds no longer tie to the ground is a piece
/// in a seat: it stays as long as the contacts that its broken bonds are can hold it, all of it as one rigid
/// body, under the load on it and its weight; then it comes loose. Spheres are numbered by site.
template <BondLaw Law>
class StandingBonds {
public:
    struct Setup {
        std::span<const Vec3> centre;  ///< [site] [m]
        Real radius = 0;               ///< [m]
        std::vector<char> held{};      ///< [site] part of the ground
        Vec3 weight = Vec3::Zero();    ///< of a sphere [N]
        Index cluster = 0;             ///< [bonds]
    };

    StandingBonds(const Law& law, Setup setup, std::vector<BondedPair> pairs)
        : law_(law), centre_(setup.centre.begin(), setup.centre.end()), radius_(setup.radius),
          weight_(setup.weight), cluster_(setup.cluster), pairs_(std::move(pairs)),
          balance_(setup.radius, friction_of(law)) {
        graph_.build(pairs_, std::move(setup.held));
        cut_.assign(pairs_.size(), 0);
        safe2_.assign(centre_.size(), 0), known_.assign(centre_.size(), 0), lost_.assign(centre_.size(), 0);
        seat_of_.assign(centre_.size(), -1);
    }

    /// Square of the load, force and torque over radius together [N2], that the sphere of a site bears for
    /// certain, whatever its direction; 0 where nobody has asked yet.
    Real safe_squared(Index site) const noexcept { return safe2_[at(site)]; }
    /// Strength may fall by this before `weakened` must be told [-].
    static constexpr Real strength_step = 1.0 / 64;

    /// The strength of a site has fallen by a step.
    void weakened(Index site) {
        forget(site);
        for (const BondGraph::End& end : graph_.of(site)) forget(end.other);
    }

    /// Takes in the loads, and which sites are empty from now on. `left(site)` is what is left of a
    /// sphere's strength. Returns the sites that are no longer held, in ascending order.
    template <class Left>
    std::vector<Index> settle(std::span<const SiteLoad> site_loads, std::span<const Index> emptied,
                              Left&& left) {
        std::vector<Index> loose;
        for (const Index site : emptied)
            if (!lost_[at(site)]) lose(site);
        for (const SiteLoad& site_load : site_loads)
            if (!lost_[at(site_load.site)] && !graph_.held(site_load.site)) check(site_load, left, loose);
        seat_pieces(nullptr, loose);
        std::sort(loose.begin(), loose.end());
        return loose;
    }

    Index broken_tension() const noexcept { return broken_tension_; }
    Index broken_shear() const noexcept { return broken_shear_; }
    const BondGraph& graph() const noexcept { return graph_; }

    static void fields(auto&& field) {
        field("graph", &StandingBonds::graph_), field("cut", &StandingBonds::cut_),
            field("safe2", "N2", &StandingBonds::safe2_), field("known", &StandingBonds::known_),
            field("lost", &StandingBonds::lost_), field("seat_of", &StandingBonds::seat_of_),
            field("seats", &StandingBonds::seats_), field("doubtful", &StandingBonds::doubtful_),
            field("fresh", &StandingBonds::fresh_), field("broken_tension", &StandingBonds::broken_tension_),
            field("broken_shear", &StandingBonds::broken_shear_);
    }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }
    /// A member that comes farther than this share of its radius is not held.
    static constexpr Real held_share = 0.1;

    using Memory = typename Law::Memory;

    BondKinematics kinematics(const BondedPair& pair, const StandingLink& link) const noexcept {
        BondKinematics bond;
        bond.normal = link.normal, bond.radius = radius_;
        bond.length = (centre_[at(pair.first)] - centre_[at(pair.second)]).norm();
        bond.effective_mass = bond.effective_inertia = bond.time_step = 1;
        bond.compression = link.compression(), bond.displacement = link.displacement,
        bond.rotation = link.rotation;
        return bond;
    }
    /// mu, from what the law answers for a broken bond that is dragged far.
    static Real friction_of(const Law& law) noexcept {
        Memory broken{};
        broken.broken = 1;
        BondKinematics bond;
        bond.radius = bond.length = bond.effective_mass = bond.effective_inertia = bond.time_step = 1;
        bond.compression = 1, bond.displacement = {1e9, 0, 0};
        const Vec3 force = law.respond(bond, 1, broken).load.force;
        return force.z() > 0 ? force.template head<2>().norm() / force.z() : 0;
    }

    void forget(Index site) noexcept { known_[at(site)] = 0, safe2_[at(site)] = 0; }

    StandingLink link_of(Index tie, Index member, Index a, Index b, const Vec3& from_a,
                         const Vec3& from_b) const noexcept {
        const BondedPair& pair = pairs_[at(tie)];
        const Index other = pair.first == member ? pair.second : pair.first;
        const Vec3 apart = centre_[at(member)] - centre_[at(other)];
        const Vec3 contact = 0.5 * (centre_[at(member)] + centre_[at(other)]);
        StandingLink link;
        link.a = a, link.b = b, link.number = tie, link.sound = !cut_[at(tie)];
        link.normal = apart.normalized();
        link.arm_a = contact - from_a, link.arm_b = contact - from_b;
        link.k = law_.rigidity(radius_, apart.norm());
        return link;
    }

    /// The spheres that give way with one: itself first.
    std::vector<Index> cluster_about(Index site) const {
        std::vector<Index> members{site};
        std::size_t from = 0;
        for (Index n = 0; n < cluster_; ++n)
            for (const std::size_t to = members.size(); from < to; ++from)
                for (const BondGraph::End& end : graph_.of(members[from]))
                    if (!lost_[at(end.other)] && !graph_.held(end.other) && !cut_[at(end.tie)] &&
                        std::find(members.begin(), members.end(), end.other) == members.end())
                        members.push_back(end.other);
        return members;
    }
    void set_up(std::span<const Index> members) {
        balance_.begin(static_cast<Index>(members.size()));
        for (std::size_t a = 0; a < members.size(); ++a) {
            balance_.load[a].along = weight_;
            for (const BondGraph::End& end : graph_.of(members[a])) {
                if (lost_[at(end.other)]) continue;
                const auto b = std::find(members.begin(), members.end(), end.other) - members.begin();
                const bool inside = b < static_cast<std::ptrdiff_t>(members.size());
                if (inside && b < static_cast<std::ptrdiff_t>(a)) continue;
                balance_.links.push_back(link_of(end.tie, members[a], static_cast<Index>(a),
                                                 inside ? static_cast<Index>(b) : -1, centre_[at(members[a])],
                                                 centre_[at(end.other)]));
            }
        }
    }

    Real strength(Index tie, auto&& left, Real less = 0) const noexcept {
        const auto of = [&](Index site) { return std::max(left(site) - less, 0.0); };
        return law_.strength(of(pairs_[at(tie)].first), of(pairs_[at(tie)].second));
    }
    FailureMode failure(const StandingLink& link, Real share, Real strength) const noexcept {
        StandingLink scaled = link;
        scaled.displacement *= share, scaled.rotation *= share;
        return law_.respond(kinematics(pairs_[at(link.number)], scaled), strength, Memory{}).failure;
    }
    /// The largest factor on what a link bears at which it holds, up to `most`.
    Real bears(const StandingLink& link, Real strength, Real most) const noexcept {
        if (failure(link, most, strength) == FailureMode::intact) return most;
        Real low = 0, high = most;
        for (int n = 0; n < 40; ++n) {
            const Real middle = 0.5 * (low + high);
            (failure(link, middle, strength) == FailureMode::intact ? low : high) = middle;
        }
        return low;
    }

    template <class Left>
    void check(const SiteLoad& site_load, Left&& left, std::vector<Index>& loose) {
        const Real load2 = site_load.load.along.squaredNorm() + site_load.load.about.squaredNorm();
        if (!known_[at(site_load.site)]) find_safe(site_load.site, left);
        if (load2 <= safe2_[at(site_load.site)]) return;
        const std::vector<Index> members = cluster_about(site_load.site);
        for (bool breaks = true; breaks;) {
            set_up(members);
            balance_.load[0].along += site_load.load.along, balance_.load[0].about += site_load.load.about;
            balance_.solve(held_share * radius_);
            breaks = break_worst(left);
        }
        const Index seat = seat_of_[at(site_load.site)];
        seat_pieces(&site_load, loose);
        if (seat >= 0 && !lost_[at(site_load.site)] && seat_of_[at(site_load.site)] == seat)
            try_seat(seat, &site_load, loose);
    }
    /// Breaks the link that is overloaded most, if any is.
    template <class Left>
    bool break_worst(Left&& left) {
        Real least = 1;
        const StandingLink* worst = nullptr;
        for (const StandingLink& link : balance_.links) {
            if (!link.sound) continue;
            const Real left_over = strength(link.number, left);
            if (failure(link, 1, left_over) == FailureMode::intact) continue;
            if (const Real share = bears(link, left_over, 1); !worst || share < least)
                least = share, worst = &link;
        }
        if (!worst) return false;
        (failure(*worst, 1, strength(worst->number, left)) == FailureMode::tension ? broken_tension_
                                                                                   : broken_shear_) += 1;
        cut(worst->number);
        return true;
    }
    void cut(Index tie) {
        if (cut_[at(tie)]) return;
        cut_[at(tie)] = 1;
        graph_.cut(tie, pairs_[at(tie)]);
        forget(pairs_[at(tie)].first), forget(pairs_[at(tie)].second);
        for (const Index site : {pairs_[at(tie)].first, pairs_[at(tie)].second})
            if (seat_of_[at(site)] >= 0) doubtful_.push_back(seat_of_[at(site)]);
    }

    /// Square of the load that a sphere bears for certain. Each link bears stretch, shear, bend and twist of
    /// which the shares of what it bears of each alone add up to 1, for what laws bear is convex.
    template <class Left>
    void find_safe(Index site, Left&& left) {
        known_[at(site)] = 1, safe2_[at(site)] = 0;
        if (seat_of_[at(site)] >= 0) return;
        const std::vector<Index> members = cluster_about(site);
        set_up(members);
        // Broken bonds are left out: what sound ones hold alone, all of them together hold.
        bool any_sound = false;
        for (StandingLink& link : balance_.links) {
            any_sound |= link.sound;
            if (!link.sound) link.grip = StandingLink::Grip::open;
        }
        if (!any_sound) return;
        balance_.find_compliance();
        Real weakest = std::numeric_limits<Real>::infinity();
        for (std::size_t l = 0; l < balance_.links.size(); ++l) {
            const StandingLink& link = balance_.links[l];
            if (!link.sound) continue;
            const Vec3 across = link.normal.unitOrthogonal();
            const std::array<Screw, 4> kinds{{{link.normal, Vec3::Zero()},
                                              {across, Vec3::Zero()},
                                              {Vec3::Zero(), across},
                                              {Vec3::Zero(), link.normal}}};
            const Real left_over = strength(link.number, left, strength_step);
            Real share = 0;  // of what the link bears, for a unit load
            for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
                if (!(balance_.compliance(l)[kind] > 0)) continue;
                StandingLink one = link;
                one.displacement = kinds[kind].along, one.rotation = kinds[kind].about;
                // Over a metre or a radian nothing holds.
                share += balance_.compliance(l)[kind] / std::max(bears(one, left_over, 1), 1e-300);
            }
            weakest = std::min(weakest, share > 0 ? 1 / share : weakest);
        }
        const Real safe = weakest - static_cast<Real>(members.size()) * weight_.norm();
        safe2_[at(site)] = safe > 0 ? square(std::min(safe, 1e100)) : 0;
    }

    /// The sphere of a site is there no more.
    void lose(Index site) {
        lost_[at(site)] = 1;
        for (const BondGraph::End& end : graph_.of(site)) {
            cut(end.tie);
            forget(end.other);
            if (seat_of_[at(end.other)] >= 0) doubtful_.push_back(seat_of_[at(end.other)]);
        }
        seat_of_[at(site)] = -1;
    }

    /// Finds what has come off the ground, and sees whether it, and what else may have lost support, stays.
    void seat_pieces(const SiteLoad* site_load, std::vector<Index>& loose) {
        for (bool more = true; more;) {
            for (const BondGraph::Component& component : graph_.take_loose()) add_seats(component);
            std::sort(doubtful_.begin(), doubtful_.end());
            doubtful_.erase(std::unique(doubtful_.begin(), doubtful_.end()), doubtful_.end());
            const std::vector<Index> now = std::exchange(doubtful_, {});
            for (const Index seat : now) split(seat);
            for (const Index seat : std::exchange(fresh_, {})) try_seat(seat, site_load, loose);
            more = !doubtful_.empty() || !fresh_.empty();
        }
    }
    void add_seats(const BondGraph::Component& component) {
        for (const BondGraph::Component& part : graph_.parts(component)) {
            BondGraph::Component there;
            for (const Index site : part)
                if (!lost_[at(site)]) there.push_back(site);
            if (there.empty()) continue;
            for (const Index site : there)
                seat_of_[at(site)] = static_cast<Index>(seats_.size()), forget(site);
            fresh_.push_back(static_cast<Index>(seats_.size()));
            seats_.push_back(std::move(there));
        }
    }
    /// A piece in a seat may have broken on, or lost what held it.
    void split(Index seat) {
        BondGraph::Component component = std::exchange(seats_[at(seat)], {});
        std::erase_if(component, [&](Index site) { return lost_[at(site)] || seat_of_[at(site)] != seat; });
        if (!component.empty()) add_seats(component);
    }
    void try_seat(Index seat, const SiteLoad* site_load, std::vector<Index>& loose) {
        const BondGraph::Component component = seats_[at(seat)];
        if (component.empty()) return;
        Vec3 centre = Vec3::Zero();
        for (const Index site : component) centre += centre_[at(site)] / static_cast<Real>(component.size());
        balance_.begin(1);
        balance_.load[0].along = static_cast<Real>(component.size()) * weight_;
        for (const Index site : component) {
            for (const BondGraph::End& end : graph_.of(site))
                if (!lost_[at(end.other)] && seat_of_[at(end.other)] != seat)
                    balance_.links.push_back(link_of(end.tie, site, 0, -1, centre, centre_[at(end.other)]));
            if (!site_load || site_load->site != site) continue;
            balance_.load[0].along += site_load->load.along;
            balance_.load[0].about +=
                site_load->load.about + (centre_[at(site)] - centre).cross(site_load->load.along) / radius_;
        }
        if (balance_.solve(held_share * radius_)) return;
        for (const Index site : component) loose.push_back(site);
        seats_[at(seat)].clear();
        for (const Index site : component) lose(site);
    }

    Law law_;
    std::vector<Vec3> centre_;
    Real radius_ = 0;
    Vec3 weight_ = Vec3::Zero();
    Index cluster_ = 0;
    std::vector<BondedPair> pairs_;
    BondGraph graph_;
    Equilibrium balance_;
    std::vector<char> cut_;                    ///< [tie]
    std::vector<Real> safe2_;                  ///< [site] [N2]
    std::vector<char> known_;                  ///< [site] whether that has been found
    std::vector<char> lost_;                   ///< [site] its sphere has left
    std::vector<Index> seat_of_;               ///< [site] -1: none
    std::vector<BondGraph::Component> seats_;  ///< pieces that no bond ties to the ground
    std::vector<Index> doubtful_, fresh_;  ///< seats that may have lost support, that nobody has looked at
    Index broken_tension_ = 0, broken_shear_ = 0;
};

}  // namespace abrade
