#pragma once
// Which bodies the sites of the concrete are, and where those stand that are none.

#include <abrade/dem/store/neighbours.hpp>
#include <abrade/dem/store/particles.hpp>
#include <abrade/geometry/lattice.hpp>
#include <abrade/geometry/point_grid.hpp>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace abrade {

/// The concrete's spheres as bodies. Where concrete stands (ConcreteLevel), those that no moving body is near
/// are none.
struct SiteBodies {
    bool stand = false;           ///< none of them moves while it is concrete
    Clump sphere{};               ///< what each site is made of
    std::vector<Index> body_of;   ///< [site] -1: no body, or gone
    std::vector<char> held;       ///< [site] part of the ground, which never moves
    std::vector<char> marks;      ///< [site] all 0 between uses
    PointGrid grid;               ///< of the sites as built
    std::vector<Vec3> place;      ///< [site] of standing spheres [m]; far away where one has left
    std::vector<Index> worn_out;  ///< fully fractured, and there until nothing touches them
    std::vector<Index> emptied;   ///< sites that bonds have not been told of yet

    // Of WornOut::recedes only:
    std::vector<Vec3> way;   ///< [site] to the next sphere below, which it reaches at gamma_f = 1 [m]
    std::vector<char> worn;  ///< [site] whether it has worn since it last sank
    Real longest_way = 0;    ///< [m]

    static void fields(auto&& field) {
        field("body_of", &SiteBodies::body_of), field("place", "m", &SiteBodies::place),
            field("worn_out", &SiteBodies::worn_out), field("emptied", &SiteBodies::emptied),
            field("worn", &SiteBodies::worn);
    }

    bool recede() const noexcept { return !way.empty(); }
    void note_worn(Index site) noexcept {
        if (recede()) worn[static_cast<std::size_t>(site)] = 1;
    }
};

/// A sphere of a moving body near a standing one, whose image at `shift` is meant.
struct SitePair {
    Index sphere = 0, site = 0;
    ImageShift shift{};
    bool touches = false;  ///< as the standing sphere is, or as it will be once it has sunk
};

namespace detail {

/// Marks on sites, taken off again when done: no look at all of them.
class SiteMarks {
public:
    explicit SiteMarks(std::vector<char>& marks) : marks_(marks) {}
    ~SiteMarks() {
        for (const Index site : all_) marks_[static_cast<std::size_t>(site)] = 0;
    }
    SiteMarks(const SiteMarks&) = delete;
    SiteMarks& operator=(const SiteMarks&) = delete;

    bool near(Index site) const noexcept { return marks_[static_cast<std::size_t>(site)] & near_; }
    bool touched(Index site) const noexcept { return marks_[static_cast<std::size_t>(site)] & touched_; }
    void add_near(Index site) { add(site, near_); }
    void add_touched(Index site) { add(site, touched_); }
    const std::vector<Index>& all() const noexcept { return all_; }  ///< marked either way

private:
    static constexpr char near_ = 1, touched_ = 2;

    void add(Index site, char mark) {
        char& own = marks_[static_cast<std::size_t>(site)];
        if (!own) all_.push_back(site);
        own = static_cast<char>(own | mark);
    }

    std::vector<char>& marks_;
    std::vector<Index> all_;
};

/// From each site to the next below it in its column; from the last of a column as from the one above it, or
/// a diameter down where it is alone [m].
inline std::vector<Vec3> ways_down(const Lattice& lattice) {
    std::vector<std::size_t> order(lattice.sites.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t n) {
        const LatticeSite& site = lattice.sites[n];
        return std::tuple(site.column, site.layer, -site.centre.z(), n);
    };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    std::vector<Vec3> way(order.size(), Vec3(0, 0, -2 * lattice.radius));
    for (std::size_t n = 1; n < order.size(); ++n) {
        const LatticeSite &upper = lattice.sites[order[n - 1]], &lower = lattice.sites[order[n]];
        if (upper.column == lower.column) way[order[n - 1]] = way[order[n]] = lower.centre - upper.centre;
    }
    return way;
}

}  // namespace detail

}  // namespace abrade
