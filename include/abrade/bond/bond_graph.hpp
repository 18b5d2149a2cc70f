#pragma once
// Who holds whom: the graph of sound bonds, and what is no longer tied to the ground once some are cut.

#include <abrade/core/fields.hpp>
#include <abrade/core/types.hpp>

#include <algorithm>
#include <compare>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// Two that are held together.
struct BondedPair {
    Index first = 0, second = 0;
    auto operator<=>(const BondedPair&) const = default;
};

/// Members are numbered once, as built, whatever becomes of their bodies. Cuts are looked into locally: the
/// search for the ground begins at the ends of what was cut and stops where it is found.
class BondGraph {
public:
    struct End {
        Index tie = 0, other = 0;
    };
    /// Members that hold together, in ascending order.
    using Component = std::vector<Index>;

    /// `held` [member] tells who is part of the ground. Pairs are ties in the order given.
    void build(std::span<const BondedPair> pairs, std::vector<char> held) {
        held_ = std::move(held);
        cut_.assign(pairs.size(), 0), mark_.assign(held_.size(), 0);
        loose_.assign(held_.size(), 0);
        round_ = 0;
        start_.assign(held_.size() + 1, 0);
        for (const BondedPair& pair : pairs) ++start_[at(pair.first) + 1], ++start_[at(pair.second) + 1];
        for (std::size_t m = 1; m < start_.size(); ++m) start_[m] += start_[m - 1];
        ends_.resize(at(start_.back()));
        std::vector<Index> next(start_.begin(), start_.end() - 1);
        for (Index t = 0; t < static_cast<Index>(pairs.size()); ++t) {
            const BondedPair& pair = pairs[at(t)];
            ends_[at(next[at(pair.first)]++)] = {t, pair.second};
            ends_[at(next[at(pair.second)]++)] = {t, pair.first};
        }
        doubtful_.resize(held_.size());  // some may be tied to nothing from the start
        for (std::size_t m = 0; m < doubtful_.size(); ++m) doubtful_[m] = static_cast<Index>(m);
    }

    Index members() const noexcept { return static_cast<Index>(held_.size()); }
    bool held(Index member) const noexcept { return held_[at(member)] != 0; }
    bool loose(Index member) const noexcept { return loose_[at(member)] != 0; }
    /// All ties of a member, cut ones too.
    std::span<const End> of(Index member) const noexcept {
        return std::span(ends_).subspan(at(start_[at(member)]),
                                        at(start_[at(member) + 1] - start_[at(member)]));
    }

    void cut(Index tie, const BondedPair& members) {
        cut_[at(tie)] = 1;
        doubtful_.push_back(members.first), doubtful_.push_back(members.second);
    }

    /// What cuts since the last call have untied from the ground, each piece once.
    std::vector<Component> take_loose() {
        std::vector<Component> components;
        const std::uint32_t tied = ++round_;  // marked in this call: known to be tied
        for (const Index from : std::exchange(doubtful_, {})) {
            if (held(from) || loose(from) || mark_[at(from)] == tied) continue;
            Component component{from};
            bool grounded = false;
            const std::uint32_t mine = ++round_;
            mark_[at(from)] = mine;
            for (std::size_t n = 0; n < component.size() && !grounded; ++n)
                for (const End& end : of(component[n])) {
                    if (cut_[at(end.tie)] || mark_[at(end.other)] == mine) continue;
                    grounded = grounded || held(end.other) || mark_[at(end.other)] == tied;
                    mark_[at(end.other)] = mine;
                    component.push_back(end.other);
                }
            if (grounded) {
                for (const Index member : component) mark_[at(member)] = tied;
                continue;
            }
            for (const Index member : component) loose_[at(member)] = 1;
            std::sort(component.begin(), component.end());
            components.push_back(std::move(component));
        }
        return components;
    }

    /// What of a piece still holds together, for it may have broken on.
    std::vector<Component> parts(const Component& component) const {
        std::vector<Component> all;
        std::vector<char> met(component.size(), 0);
        const auto place = [&](Index member) {
            return static_cast<std::size_t>(std::lower_bound(component.begin(), component.end(), member) -
                                            component.begin());
        };
        for (std::size_t from = 0; from < component.size(); ++from) {
            if (std::exchange(met[from], 1)) continue;
            Component part{component[from]};
            for (std::size_t n = 0; n < part.size(); ++n)
                for (const End& end : of(part[n]))
                    if (!cut_[at(end.tie)] && !std::exchange(met[place(end.other)], 1))
                        part.push_back(end.other);
            std::sort(part.begin(), part.end());
            all.push_back(std::move(part));
        }
        return all;
    }

    static void fields(auto&& field) {
        field("cut", &BondGraph::cut_), field("loose", &BondGraph::loose_), field("mark", &BondGraph::mark_),
            field("round", &BondGraph::round_), field("doubtful", &BondGraph::doubtful_);
    }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

    std::vector<Index> start_{0};      ///< [member + 1]
    std::vector<End> ends_;            ///< member by member
    std::vector<char> cut_;            ///< [tie]
    std::vector<char> held_, loose_;   ///< [member]
    std::vector<std::uint32_t> mark_;  ///< [member] the round of the search that met it last
    std::uint32_t round_ = 0;
    std::vector<Index> doubtful_;  ///< members that may have come loose
};

}  // namespace abrade
