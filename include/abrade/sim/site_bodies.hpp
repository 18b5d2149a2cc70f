#pragma once
// Which bodies the sites of the concrete are, and where those stand that are none.

#include <abrade/dem/particles.hpp>
#include <abrade/geometry/lattice.hpp>
#include <abrade/geometry/point_grid.hpp>

#include <utility>

namespace abrade {

/// The concrete's spheres as bodies. Where concrete stands (ConcreteLevel), those that no moving body is near
/// are none.
struct SiteBodies {
    bool stand = false;          ///< none of them moves while it is concrete
    Clump sphere{};              ///< what each site is made of
    std::vector<Index> body_of;  ///< [site] -1: no body, or gone
    std::vector<char> held;      ///< [site] part of the ground, which never moves
    std::vector<char> marks;     ///< [site] all 0 between uses
    PointGrid grid;              ///< of the sites as built
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

    bool has(Index site) const noexcept { return marks_[static_cast<std::size_t>(site)] != 0; }
    void add(Index site) {
        if (!std::exchange(marks_[static_cast<std::size_t>(site)], 1)) all_.push_back(site);
    }
    std::vector<Index>& all() noexcept { return all_; }

private:
    std::vector<char>& marks_;
    std::vector<Index> all_;
};

}  // namespace detail

}  // namespace abrade
