#pragma once
// What has happened in a simulation and is yet to be dealt with.

#include <abrade/bond/bond_graph.hpp>
#include <abrade/bond/standing_bonds.hpp>
#include <abrade/core/fields.hpp>

#include <vector>

namespace abrade {

/// Who finds something puts it here; it is dealt with before the next forces (`World::make_ready`), in this
/// order, or where lists are renewed.
struct Events {
    // Put by an evaluation, taken by `settle_concrete`.
    std::vector<SiteLoad> site_loads;  ///< on quasi-static concrete, beyond what it bears for certain
    std::vector<Index> weakened;       ///< sites whose strength has fallen by a step
    // Put by an evaluation and by wear, taken by `State::free_loose_concrete`.
    bool bond_broke = false;
    // Put by `settle_concrete`, `State::free_loose_concrete`, `reshape` and changes between runs, taken by a
    // renewal of lists.
    std::vector<Index> worn_away;                  ///< sites whose bodies are to go
    std::vector<Index> removed;                    ///< bodies that a user takes out
    std::vector<BondGraph::Component> components;  ///< that came loose and are to go on as clumps
    bool lists_due = false;                        ///< lists are to be renewed before the next forces

    void put(const std::vector<SiteLoad>& new_loads, const std::vector<Index>& new_weakened) {
        site_loads.insert(site_loads.end(), new_loads.begin(), new_loads.end());
        weakened.insert(weakened.end(), new_weakened.begin(), new_weakened.end());
    }

    static void fields(auto&& field) {
        field.bytes("site_loads", &Events::site_loads), field("weakened", &Events::weakened),
            field("bond_broke", &Events::bond_broke), field("worn_away", &Events::worn_away),
            field("removed", &Events::removed), field("components", &Events::components),
            field("lists_due", &Events::lists_due);
    }
};

}  // namespace abrade
