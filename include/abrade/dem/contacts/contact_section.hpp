#pragma once
// The contacts of a step: Verlet pairs slab by slab, the inner pairs among them in packs, and what these
// remember.

#include <abrade/dem/contacts/contact_kernel.hpp>

#include <algorithm>
#include <compare>
#include <span>
#include <utility>

namespace abrade {

/// Sums over the contacts of one evaluation. `watched_*` count a loss once for each of the two spheres
/// that is watched.
struct ContactSums {
    Real lost_normal = 0, lost_tangential = 0, stored = 0;      ///< [J]
    Real lost_rolling = 0, lost_film = 0;                       ///< [J]
    Real watched_lost_normal = 0, watched_lost_tangential = 0;  ///< [J]
    Real deepest = 0;                                           ///< as in PackSums [-]
    Real wall_power = 0;                                        ///< of walls that move, on spheres [W]

    ContactSums& operator+=(const ContactSums& other) noexcept {
        lost_normal += other.lost_normal, lost_tangential += other.lost_tangential;
        stored += other.stored, lost_rolling += other.lost_rolling, lost_film += other.lost_film;
        watched_lost_normal += other.watched_lost_normal;
        watched_lost_tangential += other.watched_lost_tangential;
        deepest = std::max(deepest, other.deepest), wall_power += other.wall_power;
        return *this;
    }
};

/// What sets packs apart: each kind has packs of its own, so that none has to ask.
struct ContactKind {
    Index plane = -1;          ///< -1: spheres with each other
    MaterialPair materials{};  ///< one pair of them: one law
    bool watched = false;      ///< spheres that an observer watches are among them
    auto operator<=>(const ContactKind&) const = default;
};

/// Verlet pairs (`near`), inner pairs, and of these those that touch; contacts at rest.
struct ContactCensus {
    std::size_t near = 0, inner_pairs = 0, touching = 0, at_rest = 0;
    ContactCensus& operator+=(const ContactCensus& o) noexcept {
        return near += o.near, inner_pairs += o.inner_pairs, touching += o.touching, at_rest += o.at_rest,
               *this;
    }
};

/// What one pair of spheres remembers while lists are renewed. Spheres by their lasting index, planes as in
/// SlotPair.
template <class Law>
struct KeptContact {
    Index first = 0, second = 0;
    typename Law::template Memory<Real> memory{};
    SeenMotion<Law, Real> before{};
};

/// A contact that touched when last evaluated.
template <class Law>
struct TouchingContact {
    SlotPair pair{};
    MaterialPair materials{};
    HeldSides held = HeldSides::none;
    typename Law::template Memory<Real> memory{};
    SeenMotion<Law, Real> before{};
};

/// The contacts that one slab is in charge of. Verlet pairs (`near`) are those within the skin of the list;
/// of them `refine` picks the inner list, those that may touch before it is called again, and only inner
/// pairs are evaluated.
template <ContactLaw Law>
class ContactSection {
public:
    using Memory = typename Law::template Memory<Real>;
    using Seen = SeenMotion<Law, Real>;

    struct Near {
        SlotPair pair;
        MaterialPair materials{};
        std::uint8_t watched_sides = 0;
        HeldSides held = HeldSides::none;
        Index kept = -1;  ///< into what contacts of the last list remember, -1: nothing
    };

    /// Takes a new list of pairs, which stand in the order of their kinds, and what they remember.
    void set_near(std::span<const Near> near, std::span<const ContactKind> kinds,
                  std::span<const KeptContact<Law>> kept, Index phantom) {
        near_.assign(near.begin(), near.end());
        kinds_.assign(kinds.begin(), kinds.end());
        phantom_ = phantom;
        begin_packs();
        for (std::size_t n = 0; n < near_.size(); ++n) {
            if (near_[n].kept < 0) continue;
            const KeptContact<Law>& k = kept[static_cast<std::size_t>(near_[n].kept)];
            add_lane(n, k.memory, k.before, true);
        }
    }

    /// Picks the pairs whose surfaces are nearer than `skin` [m], and those that touch. Of pairs of which
    /// both rest (`rests` [slot], empty: none; planes do), those that touch are kept with what they remember,
    /// and not evaluated.
    void refine(const HotArrays& lines, std::span<const Plane> planes, Real skin,
                std::span<const char> rests) {
        where_.assign(near_.size(), -1);
        for (std::size_t l = 0; l < lane_.size(); ++l)
            if (lane_[l] >= 0 && packs_[l / lanes].touched[static_cast<int>(l % lanes)])
                where_[static_cast<std::size_t>(lane_[l])] = static_cast<Index>(l);
        std::swap(packs_, old_packs_);
        begin_packs();
        std::size_t first = 0;
        for (const ContactKind& kind : kinds_) {
            std::size_t last = first;
            while (last < near_.size() && is_of(near_[last], kind)) ++last;
            // Those that touch come first: packs without one are passed over.
            for (std::size_t n = first; n < last; ++n)
                if (where_[n] >= 0 && !both_rest(n, rests)) keep_lane(n, static_cast<std::size_t>(where_[n]));
            for (std::size_t n = first; n < last; ++n)
                if (where_[n] < 0 && !both_rest(n, rests) && are_within(skin, lines, planes, n))
                    add_lane(n, Memory{}, Seen{}, false);
            if (!rests.empty())
                for (std::size_t n = first; n < last; ++n)
                    if (where_[n] >= 0 && both_rest(n, rests))
                        keep_at_rest(n, static_cast<std::size_t>(where_[n]));
            first = last;
        }
    }

    /// Evaluates the law once for each inner pair, commits its memory and adds its answer to the loads.
    /// `laws` is a Law, or a table of them by materials.
    template <class Laws, ContactObserver Observer>
    ContactSums respond(const Laws& laws, const Observer& observer, std::span<const Plane> planes,
                        HotArrays& lines, const ContactStep& step) noexcept {
        PackSums sums;
        for (const Run& run : runs_) {
            const ContactKind kind = kinds_[run.kind];
            const Law& law = law_between(laws, kind.materials);
            const auto packs = std::span(packs_).subspan(run.first, run.last - run.first);
            const PackRun shared{kind.plane < 0 ? nullptr : &planes[static_cast<std::size_t>(kind.plane)],
                                 watched_sides_.data() + run.first * lanes, held_of(run)};
            if (kind.plane < 0 && kind.watched)
                sums += abrade::respond<KernelKind{false, true}>(law, observer, packs, shared, lines, step);
            else if (kind.plane < 0)
                sums += abrade::respond<KernelKind{false, false}>(law, observer, packs, shared, lines, step);
            else if (kind.watched)
                sums += abrade::respond<KernelKind{true, true}>(law, observer, packs, shared, lines, step);
            else
                sums += abrade::respond<KernelKind{true, false}>(law, observer, packs, shared, lines, step);
        }
        return {sum(sums.lost_normal),
                sum(sums.lost_tangential),
                sum(sums.stored),
                sum(sums.lost_rolling),
                sum(sums.lost_film),
                sum(sums.watched_lost_normal),
                sum(sums.watched_lost_tangential),
                largest(sums.deepest),
                sum(sums.wall_power)};
    }

    /// Calls `visit(TouchingContact)` for each contact that touched when last evaluated and whose pair is
    /// `wanted`.
    template <class Visit, class Wanted>
    void each_touching(Visit&& visit, Wanted&& wanted) const {
        for (std::size_t l = 0; l < lane_.size(); ++l) {
            const ContactPack<Law>& pack = packs_[l / lanes];
            const int lane = static_cast<int>(l % lanes);
            if (lane_[l] < 0 || !pack.touched[lane]) continue;
            const Near& near = near_[static_cast<std::size_t>(lane_[l])];
            if (!wanted(near.pair)) continue;
            visit(TouchingContact<Law>{near.pair, near.materials, near.held,
                                       detail::memory_of_lane<Memory>(pack.memory, lane),
                                       detail::memory_of_lane<Seen>(pack.before, lane)});
        }
    }
    /// Calls `visit(pair)` for each inner pair.
    template <class Visit>
    void each_inner_pair(Visit&& visit) const {
        for (const Run& run : runs_)
            for (std::size_t l = run.first * lanes; l < run.last * lanes; ++l)
                if (lane_[l] >= 0) visit(near_[static_cast<std::size_t>(lane_[l])].pair);
    }

    /// As of the last call of `refine`.
    ContactCensus census() const noexcept { return {near_.size(), inner_pairs_, touching_, at_rest_}; }

    static void fields(auto&& field) {
        field.bytes("near", &ContactSection::near_), field.bytes("kinds", &ContactSection::kinds_),
            field.bytes("packs", &ContactSection::packs_), field("lane", &ContactSection::lane_),
            field("watched_sides", &ContactSection::watched_sides_),
            field("held_sides", &ContactSection::held_sides_), field.bytes("runs", &ContactSection::runs_),
            field("filled", &ContactSection::filled_), field("inner_pairs", &ContactSection::inner_pairs_),
            field("touching", &ContactSection::touching_), field("at_rest", &ContactSection::at_rest_),
            field("resting", &ContactSection::resting_), field("phantom", &ContactSection::phantom_);
    }

private:
    static constexpr auto lanes = static_cast<std::size_t>(pack_lanes);
    /// Packs of one kind that are evaluated, next to each other; behind them stand those at rest.
    struct Run {
        std::size_t kind, first, last;
    };

    /// Whether the surfaces of Verlet pair n are nearer than `skin` [m], or half of it where one never moves.
    bool are_within(Real skin, const HotArrays& lines, std::span<const Plane> planes,
                    std::size_t n) const noexcept {
        const auto [first, second] = near_[n].pair;
        const SpherePlace& a = lines.place[static_cast<std::size_t>(first)];
        if (second < 0)
            return planes[static_cast<std::size_t>(-1 - second)].distance(a.centre) < a.radius + 0.5 * skin;
        const SpherePlace& b = lines.place[static_cast<std::size_t>(second)];
        if (lines.motion[static_cast<std::size_t>(first)].inverse_mass == 0 ||
            lines.motion[static_cast<std::size_t>(second)].inverse_mass == 0)
            skin *= 0.5;
        return (a.centre - b.centre).squaredNorm() < square(a.radius + b.radius + skin);
    }

    bool both_rest(std::size_t n, std::span<const char> rests) const noexcept {
        if (rests.empty()) return false;
        const auto [first, second] = near_[n].pair;
        return rests[static_cast<std::size_t>(first)] &&
               (second < 0 || rests[static_cast<std::size_t>(second)]);
    }

    void begin_packs() {
        packs_.clear(), lane_.clear(), runs_.clear(), watched_sides_.clear(), held_sides_.clear();
        filled_ = lanes, inner_pairs_ = touching_ = at_rest_ = 0;
    }

    /// Puts Verlet pair n, which had `old` among the lanes before, into the next one.
    void keep_lane(std::size_t n, std::size_t old) {
        const ContactPack<Law>& from = old_packs_[old / lanes];
        const int lane = static_cast<int>(old % lanes);
        add_lane(n, detail::memory_of_lane<Memory>(from.memory, lane),
                 detail::memory_of_lane<Seen>(from.before, lane), true);
    }

    /// The same behind the packs that are evaluated. Nothing moves there, so there is no motion to remember.
    void keep_at_rest(std::size_t n, std::size_t old) {
        add_lane(
            n, detail::memory_of_lane<Memory>(old_packs_[old / lanes].memory, static_cast<int>(old % lanes)),
            Seen{}, true, true);
    }

    /// Puts Verlet pair n into the next lane; pairs come in the order of their kinds.
    void add_lane(std::size_t n, const Memory& memory, const Seen& before, bool touched, bool rests = false) {
        std::size_t kind = runs_.empty() ? 0 : runs_.back().kind;
        while (!is_of(near_[n], kinds_[kind])) ++kind;
        if (runs_.empty() || runs_.back().kind != kind) {
            runs_.push_back({kind, packs_.size(), packs_.size()});
            filled_ = lanes, resting_ = false;
        }
        if (rests != std::exchange(resting_, rests)) filled_ = lanes;
        if (filled_ == lanes) {
            ContactPack<Law>& fresh = packs_.emplace_back();
            fresh.first.fill(line_offset(kinds_[kind].plane < 0 ? phantom_ : phantom_ + 2));
            fresh.second.fill(line_offset(phantom_ + 1));
            lane_.resize(lane_.size() + lanes, -1), watched_sides_.resize(lane_.size(), 0);
            if (!rests) ++runs_.back().last;
            filled_ = 0;
        }
        ContactPack<Law>& pack = packs_.back();
        const int lane = static_cast<int>(filled_);
        pack.first[filled_] = line_offset(near_[n].pair.first);
        if (near_[n].pair.second >= 0) pack.second[filled_] = line_offset(near_[n].pair.second);
        const std::size_t place = (packs_.size() - 1) * lanes + filled_;
        lane_[place] = static_cast<Index>(n), watched_sides_[place] = near_[n].watched_sides;
        if constexpr (MayDampFreeMass<Law>) {
            held_sides_.resize(lane_.size(), HeldSides::none);
            held_sides_[place] = near_[n].held;
        }
        ++filled_;
        if (rests)
            ++at_rest_;
        else
            ++inner_pairs_, touching_ += touched;
        if (!touched) return;
        detail::set_memory_of_lane(pack.memory, lane, memory);
        detail::set_memory_of_lane(pack.before, lane, before);
        pack.touched.set(lane);
    }

    const HeldSides* held_of(const Run& run) const noexcept {
        return MayDampFreeMass<Law> ? held_sides_.data() + run.first * lanes : nullptr;
    }

    static bool is_of(const Near& near, const ContactKind& kind) noexcept {
        return kind == ContactKind{near.pair.second < 0 ? -1 - near.pair.second : -1, near.materials,
                                   near.watched_sides > 0};
    }

    std::vector<Near> near_;
    std::vector<ContactKind> kinds_;  ///< of the Verlet pairs, in their order
    std::vector<ContactPack<Law>> packs_, old_packs_;
    std::vector<Index> lane_;                  ///< [pack x lane] into near_, -1: left over
    std::vector<std::uint8_t> watched_sides_;  ///< [pack x lane]
    std::vector<HeldSides> held_sides_;        ///< [pack x lane], of laws that may damp free mass
    std::vector<Run> runs_;
    std::vector<Index> where_;  ///< [near] its lane before, while lists are refined
    std::size_t filled_ = lanes, inner_pairs_ = 0, touching_ = 0, at_rest_ = 0;
    bool resting_ = false;  ///< whether the last pack is at rest
    Index phantom_ = 0;
};

}  // namespace abrade
