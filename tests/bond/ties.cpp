// Who is still tied to the ground, against a search through everything.
#include <abrade/bond/bond_graph.hpp>

#include <doctest/doctest.h>

#include <random>
#include <set>

using namespace abrade;

namespace {

/// Members that no way along sound ties leads to a held one, found by spreading from all held ones.
std::set<Index> loose_by_search(Index members, const std::vector<BondedPair>& pairs,
                                const std::vector<char>& held, const std::vector<char>& cut) {
    std::vector<char> tied = held;
    for (bool spread = true; spread;) {
        spread = false;
        for (std::size_t t = 0; t < pairs.size(); ++t) {
            char &a = tied[static_cast<std::size_t>(pairs[t].first)],
                 &b = tied[static_cast<std::size_t>(pairs[t].second)];
            if (!cut[t] && a != b) a = b = 1, spread = true;
        }
    }
    std::set<Index> loose;
    for (Index m = 0; m < members; ++m)
        if (!tied[static_cast<std::size_t>(m)]) loose.insert(m);
    return loose;
}

}  // namespace

TEST_CASE(
    "what comes loose, cut by cut, is what a whole search finds; each piece is told once and hangs "
    "together") {
    std::mt19937 random(1);
    constexpr Index side = 8, members = side * side;
    for (int turn = 0; turn < 20; ++turn) {
        std::vector<BondedPair> pairs;
        std::vector<char> held(members, 0);
        for (Index i = 0; i < side; ++i)
            for (Index j = 0; j < side; ++j) {
                const Index here = i * side + j;
                held[static_cast<std::size_t>(here)] = j == 0;
                if (i + 1 < side) pairs.push_back({here, here + side});
                if (j + 1 < side) pairs.push_back({here, here + 1});
            }
        BondGraph ties;
        ties.build(pairs, held);
        CHECK(ties.take_loose().empty());
        std::vector<char> cut(pairs.size(), 0);
        std::set<Index> loose;
        std::vector<Index> order;
        for (Index t = 0; t < static_cast<Index>(pairs.size()); ++t) order.push_back(t);
        std::shuffle(order.begin(), order.end(), random);
        for (std::size_t n = 0; n < order.size(); ++n) {
            const auto t = static_cast<std::size_t>(order[n]);
            ties.cut(order[n], pairs[t]);
            cut[t] = 1;
            if (n % 3 != 0 && n + 1 < order.size()) continue;  // several cuts at once
            for (const BondGraph::Component& piece : ties.take_loose()) {
                CHECK(std::is_sorted(piece.begin(), piece.end()));
                CHECK(ties.parts(piece) == std::vector<BondGraph::Component>{piece});
                for (const Index member : piece) CHECK(loose.insert(member).second);
            }
            REQUIRE(loose == loose_by_search(members, pairs, held, cut));
            for (const Index member : loose) CHECK(ties.loose(member));
        }
        CHECK(loose.size() == members - side);
    }
}

TEST_CASE("what nothing ties is loose from the start, and a piece that breaks on has parts") {
    const std::vector<BondedPair> pairs{{0, 1}, {2, 3}, {3, 4}};
    BondGraph ties;
    ties.build(pairs, {1, 0, 0, 0, 0, 0});
    CHECK(ties.take_loose() == std::vector<BondGraph::Component>{{2, 3, 4}, {5}});
    ties.cut(1, pairs[1]);
    CHECK(ties.take_loose().empty());
    CHECK(ties.parts({2, 3, 4}) == std::vector<BondGraph::Component>{{2}, {3, 4}});
}
