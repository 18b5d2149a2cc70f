#pragma once
// All faces of a grid that bodies cover some of, and what is left of them to the water.

#include <abrade/core/parallel.hpp>
#include <abrade/coupling/spread_cloud.hpp>

#include <algorithm>
#include <numeric>
#include <span>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

namespace abrade {

/// A face and one of the bodies that cover it.
struct CoveredFace : SolidFace {
    std::size_t body = 0;
    Real open = 0;          ///< share of the face that walls leave open; 0: no water passes [-]
    Real water = 0;         ///< share that bodies leave to the water, too [-]
    Real covered = 0;       ///< by the one body, of what is open; with all of them just what is no water [-]
    Real part = 0;          ///< of the one body in what all cover [-]
    Real all_friction = 0;  ///< of all bodies here [1/m2]
    Real lighter = 1;       ///< the water's density over the face's, where `weigh` asks for it [-]
    Real heavier = 0;       ///< what the body adds to the face's density, over this [-]
    Real per_gap = 0;       ///< 1 over the distance of the pressures to both sides [1/m]
    Real weight = 1;        ///< share of the face's inertia that is below the surface [-]
    bool high_wet = true, low_wet = true;  ///< cells to both sides: dry ones have no pressure
    bool conducts = false;                 ///< whether a pressure's gradient pushes what is in it
    Real mobility = 0;                     ///< what a gradient moves a cloud by, over water [-]
    Real last_gradient = 0;                ///< of the pressure that it has felt already [m/s2]
    bool leaves = false;  ///< at a side where water leaves: only what is added to a pressure pushes there
    Real mass = 0;        ///< of its control volume, as far as walls leave it open and it is wet [kg]
    Real velocity = 0;    ///< of the water, before a pressure acts [m/s]
    Real solid = 0;       ///< velocity of what covers it [m/s]
    Real held = 0;        ///< share of the way to `target` [m/s] that friction takes the water [-]
    Real target = 0;
    Real taken = 0;    ///< by friction in the first stage [m/s]
    Real given = 0;    ///< to the water beside friction [m/s]
    Real rate = 0;     ///< of friction [1/s]
    Real unmixed = 0;  ///< velocity before `mix` [m/s]

    bool at_surface() const noexcept { return high_wet != low_wet; }
    /// From `open`, `water` and `part`: a closed face passes no water, not even what rounding leaves of it.
    void cover() noexcept { covered = open > 0 ? part * (1 - water / open) : 0; }
    /// Share of a gradient that moves what covers the face, where faces between two wet cells conduct it.
    Real yields() const noexcept { return at_surface() || leaves ? 0 : mobility; }
    /// Of a pressure over density [m/s2].
    template <class Number>
    Real gradient(const Field<Number>& of) const noexcept {
        const auto above = high_wet ? static_cast<Real>(of[face]) : 0;
        const auto below = low_wet ? static_cast<Real>(of[low]) : 0;
        return (above - below) * per_gap;
    }
};

/// Of all bodies, body by body along the channel, and in the order of their planes; what walls and the
/// surface leave of them.
class CoveredFaces {
public:
    static constexpr Index planes_at_once = 4;  ///< stones lie in heaps

    /// Bodies as they stand; those below `resolved_from` cells to a diameter make a cloud, which is one more
    /// body behind the others. `open_area`: shares that walls leave open; none: all is. `retracted`: the
    /// surface of the others' cores [cell].
    void place(const Grid<3>& grid, const Sides<3>& sides, std::span<const FlowBody> bodies,
               Real resolved_from, const FaceField<3>* open_area, Real retracted) {
        SolidCover cloud;  // the last one, large: as a body's it would keep its memory
        if (!covers_.empty()) cloud = std::move(covers_.back()), covers_.pop_back();
        covers_.resize(bodies.size());
        covers_.push_back(std::move(cloud));
        // Along the channel: what stands side by side in it does so in memory.
        std::vector<std::size_t> order(bodies.size()), small;
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t b) { return bodies[b].position[outer]; });
        for (const std::size_t b : order) {
            const Real width = detail::GridNumbers{grid, sides}.cell_width(bodies[b].position);
            covers_[b].averaged = bodies[b].diameter() < resolved_from * width;
            if (covers_[b].averaged) small.push_back(b);
        }
        const auto closed = [open_area](int axis, Offset face) {
            return open_area && (*open_area)[axis][face] == 0;
        };
        parallel_blocks(
            static_cast<Index>(bodies.size()),
            [&](Index, Index first, Index last) {
                detail::SolidCoverFinder finder(detail::GridNumbers{grid, sides}, closed, retracted);
                for (Index b = first; b < last; ++b)
                    if (!covers_[at(b)].averaged) finder.find(bodies[at(b)], covers_[at(b)]);
            },
            block_of_bodies);
        spread(grid, sides, bodies, std::move(small), open_area);
        order.push_back(bodies.size());
        first_.resize(order.size());
        std::size_t all = 0;
        for (const std::size_t b : order) first_[b] = std::exchange(all, all + covers_[b].faces.size());
        faces_.resize(all);
        parallel_blocks(
            static_cast<Index>(covers_.size()),
            [&](Index, Index first, Index last) {
                for (std::size_t b = at(first); b < at(last); ++b) {
                    std::size_t i = first_[b];
                    for (const SolidFace& f : covers_[b].faces) (faces_[i++] = {f}).body = b;
                }
            },
            block_of_bodies);
        sort_by_plane(grid.layout().planes());
        share_out(grid.layout(), open_area);
    }

    std::span<CoveredFace> all() noexcept { return faces_; }
    std::span<const CoveredFace> all() const noexcept { return faces_; }
    std::span<CoveredFace> of(std::size_t body) noexcept {
        return std::span(faces_).subspan(first_[body], covers_[body].faces.size());
    }
    const SpreadCloud& cloud() const noexcept { return cloud_; }
    std::span<const CoveredFace> of_cloud() const noexcept {
        return std::span(faces_).subspan(first_.back());
    }
    std::span<CoveredFace> of_cloud() noexcept { return of(covers_.size() - 1); }
    const SolidCover& cover(std::size_t body) const noexcept { return covers_[body]; }
    std::span<const SolidCover> covers() const noexcept { return covers_; }
    /// Volume in cells, of all bodies or without their cloud.
    std::vector<SolidPart> parts(bool with_cloud) const {
        std::vector<SolidPart> parts;
        for (const SolidCover& cover : covers_)
            if (with_cloud || &cover != &covers_.back())
                parts.insert(parts.end(), cover.parts.begin(), cover.parts.end());
        return parts;
    }
    /// In parallel.
    void for_each(auto&& visit) {
        parallel_for(static_cast<Index>(faces_.size()), [&](Index i) { visit(faces_[at(i)]); });
    }
    /// Those of which bodies cover some, in an order that does not depend on threads: bodies may share a
    /// face.
    void on_plane(int plane, auto&& visit) const {
        if (!by_plane_.empty()) visit_range(*this, at(2 * plane), at(2 * plane + 1), visit);
    }
    /// Plane by plane in parallel, each of the visits to all faces of a plane before the next.
    void by_planes(auto&&... visits) { visit_planes(*this, 2, visits...); }
    void by_planes(auto&&... visits) const { visit_planes(*this, 2, visits...); }
    /// Without those of which bodies cover nothing.
    void covered_by_planes(auto&&... visits) { visit_planes(*this, 1, visits...); }
    void covered_by_planes(auto&&... visits) const { visit_planes(*this, 1, visits...); }

    /// [plane] How many faces are covered in those before it.
    std::vector<std::size_t> covered_before() const {
        std::vector<std::size_t> before{0};
        for (std::size_t p = 0; p + 1 < plane_start_.size(); p += 2)
            before.push_back(before.back() + plane_start_[p + 1] - plane_start_[p]);
        return before;
    }
    /// Calls visit(face, number) for covered ones in the order of their planes, in parallel; `before`: see
    /// `covered_before`.
    void number_covered(const std::vector<std::size_t>& before, auto&& visit) {
        parallel_blocks(
            static_cast<Index>(before.size()) - 1,
            [&](Index, Index first, Index last) {
                for (std::size_t plane = at(first); plane < at(last); ++plane)
                    for (std::size_t i = before[plane]; i < before[plane + 1]; ++i)
                        visit(faces_[by_plane_[plane_start_[2 * plane] + i - before[plane]]], i);
            },
            planes_at_once);
    }

    /// Takes from what faces conduct what bodies cover. `surface`: faces at which the pressure is 0.
    void close(Poisson<3>& m, std::span<const OpenFace> surface) {
        const auto share = [&](const SolidFace& f) {
            return static_cast<Real>(m.face[f.axis][f.face]) * f.gap / f.area;
        };
        by_planes([&](CoveredFace& f) { f.open = share(f), f.per_gap = 1 / f.gap; },
                  [&](const CoveredFace& f) {
                      if (f.share == 0) return;
                      const Real left = share(f) - f.share;
                      m.face[f.axis][f.face] =
                          left > least ? static_cast<float>(left * f.area / f.gap) : 0.0f;
                  },
                  [&](CoveredFace& f) { f.water = share(f), f.cover(); },
                  [&](const CoveredFace& f) {
                      if (f.open > 0)
                          m.face[f.axis][f.face] += static_cast<float>(f.share * f.mobility * f.area / f.gap);
                  },
                  [&](CoveredFace& f) { f.conducts = m.face[f.axis][f.face] > 0; });
        close_surface(surface);
    }
    /// After `close`: opens faces again, and lets them conduct as little as what is in them is heavy.
    /// `ratio(body)`: its density over the water's.
    void weigh(Poisson<3>& m, auto&& ratio) {
        const auto density = [&](const CoveredFace& f) -> float& { return m.face[f.axis][f.face]; };
        const auto add = [&](const CoveredFace& f, auto& to) {
            to += static_cast<std::remove_reference_t<decltype(to)>>(f.covered * (ratio(f.body) - 1));
        };
        const auto find = [&](CoveredFace& f, Real all) {
            f.lighter = 1 / all, f.heavier = f.covered * (ratio(f.body) - 1) / all;
        };
        const auto wet = [](auto visit) {
            return [visit](auto& f) {
                if (f.open > 0 && !f.at_surface()) visit(f);
            };
        };
        by_planes(wet([&](const CoveredFace& f) { density(f) = 1; }),
                  wet([&](const CoveredFace& f) { add(f, density(f)); }),
                  wet([&](CoveredFace& f) { find(f, density(f)); }), wet([&](const CoveredFace& f) {
                      density(f) = static_cast<float>(f.open * f.lighter * f.area / f.gap);
                  }));
        for (auto& [face, share] : surface_) share = 1;
        for (const CoveredFace& f : faces_)
            if (f.open > 0 && f.at_surface()) add(f, surface_[key(f.axis, f.face)]);
        for (CoveredFace& f : faces_)
            if (f.open > 0 && f.at_surface()) find(f, surface_[key(f.axis, f.face)]);
        for (auto& [face, share] : surface_) share = 1 / share;
    }
    /// What a face at the surface conducts, over what it would without bodies [-].
    Real water_share(const OpenFace& open) const noexcept {
        const auto found = surface_.find(key(open.axis, open.face));
        return found == surface_.end() ? 1 : found->second;
    }
    /// Only cells that take part have a pressure.
    void keep_wet(const Poisson<3>& m) {
        for (SolidCover& cover : covers_)
            std::erase_if(cover.cells, [&](const SolidCell& c) { return !(m.inverse_diagonal[c.cell] > 0); });
    }

private:
    /// Resolved bodies leave no room for others.
    void spread(const Grid<3>& grid, const Sides<3>& sides, std::span<const FlowBody> bodies,
                std::vector<std::size_t> small, const FaceField<3>* open_area) {
        const bool some = !small.empty();
        if (some) make_sums(grid.layout());
        for (const std::size_t b : small) {
            covers_[b].clear();
            for (int a = 0; a < 3; ++a) {
                const Real x = bodies[b].position[a];
                covers_[b].cut |= (!is_closed(sides[a][0]) && x < grid.low(a)) ||
                                  (!is_closed(sides[a][1]) && x > grid.high(a));
            }
        }
        for (std::size_t b = 0; b < bodies.size() && some; ++b)
            for (const SolidFace& f : covers_[b].faces) sums_[f.axis][f.face] += f.share;
        const auto open = [&](int axis, Offset face) {
            return std::max((open_area ? (*open_area)[axis][face] : 1) - sums_[axis][face], Real(0));
        };
        cloud_.place(grid, sides, bodies, std::move(small), open, covers_.back());
        for (std::size_t b = 0; b < bodies.size() && some; ++b)
            for (const SolidFace& f : covers_[b].faces) sums_[f.axis][f.face] = 0;
    }

    static constexpr int outer = Layout<3>::outer;
    static constexpr Real least = 1e-6;  ///< of a face: less conducts nothing

    static std::size_t at(std::integral auto i) noexcept { return static_cast<std::size_t>(i); }
    static Offset key(int axis, Offset face) noexcept { return 4 * face + axis; }

    static void visit_range(auto& self, std::size_t first, std::size_t last, auto& visit) {
        for (std::size_t i = self.plane_start_[first]; i < self.plane_start_[last]; ++i)
            visit(self.faces_[self.by_plane_[i]]);
    }
    /// Of each plane the first, or both its parts.
    static void visit_planes(auto& self, Index parts, auto&... visits) {
        parallel_blocks(
            static_cast<Index>(self.plane_start_.size()) / 2,
            [&](Index, Index first, Index last) {
                for (Index plane = first; plane < last; ++plane)
                    (visit_range(self, at(2 * plane), at(2 * plane + parts), visits), ...);
            },
            planes_at_once);
    }

    void make_sums(const Layout<3>& layout) {
        if (sums_[0].size() == 0) sums_ = face_field<3>(layout);
    }

    /// What walls and all bodies leave of faces, until `close` knows which of these have a pressure; and all
    /// friction, even of one body: it may be near itself, across a periodic side.
    void share_out(const Layout<3>& layout, const FaceField<3>* open_area) {
        if (faces_.empty()) return;
        make_sums(layout);
        const auto sum = [&](const CoveredFace& f) -> Real& { return sums_[f.axis][f.face]; };
        by_planes(
            [&](const CoveredFace& f) { sum(f) += f.share; },
            [&](CoveredFace& f) {
                f.open = open_area ? (*open_area)[f.axis][f.face] : 1;
                f.water = std::max(f.open - sum(f), 0.0);
                f.part = sum(f) > 0 ? f.share / sum(f) : 0, f.cover();
            },
            [&](const CoveredFace& f) { sum(f) = 0; }, [&](const CoveredFace& f) { sum(f) += f.friction; },
            [&](CoveredFace& f) { f.all_friction = sum(f); }, [&](const CoveredFace& f) { sum(f) = 0; });
    }

    /// In each plane those come first of which bodies cover some.
    void sort_by_plane(int planes) {
        const auto part = [](const SolidFace& f) { return at(2 * f.plane + (f.share == 0)); };
        plane_start_.assign(at(2 * planes) + 1, 0);
        for (const SolidFace& f : faces_) ++plane_start_[part(f) + 1];
        for (std::size_t p = 1; p < plane_start_.size(); ++p) plane_start_[p] += plane_start_[p - 1];
        by_plane_.resize(faces_.size());
        std::vector<std::size_t> next = plane_start_;
        for (std::size_t i = 0; i < faces_.size(); ++i) by_plane_[next[part(faces_[i])]++] = i;
    }

    /// What of a face between water and air is solid pushes on no water.
    void close_surface(std::span<const OpenFace> surface) {
        surface_.clear();
        std::unordered_multimap<Offset, std::size_t> dry;
        for (std::size_t i = 0; i < faces_.size(); ++i)
            if (faces_[i].open == 0) dry.insert({key(faces_[i].axis, faces_[i].face), i});
        if (dry.empty()) return;
        for (const OpenFace& open : surface) {
            const auto [first, last] = dry.equal_range(key(open.axis, open.face));
            if (first == last) continue;
            Real left = 1;
            for (auto i = first; i != last; ++i) left -= faces_[i->second].share;
            if (left < least) left = 0;
            for (auto i = first; i != last; ++i) {
                CoveredFace& f = faces_[i->second];
                f.open = 1, f.water = left, f.cover(), f.per_gap = std::abs(open.slope);
                f.high_wet = open.cell == f.face, f.low_wet = open.cell == f.low;
                f.leaves = open.plain == 0, f.weight = open.weight;
            }
            surface_[key(open.axis, open.face)] = left;
        }
    }

    std::vector<SolidCover> covers_;  ///< [body], and of the cloud
    SpreadCloud cloud_;
    std::vector<CoveredFace> faces_;        ///< body by body, the cloud's last
    std::vector<std::size_t> first_;        ///< [body] in `faces_`
    std::vector<std::size_t> by_plane_;     ///< `faces_` in the order of their planes
    std::vector<std::size_t> plane_start_;  ///< [2 plane, + 1 of those near by] in `by_plane_`
    std::unordered_map<Offset, Real> surface_;
    FaceField<3> sums_;  ///< of what bodies have at a face; 0 but while they are needed
};

}  // namespace abrade
