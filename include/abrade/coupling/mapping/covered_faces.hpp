#pragma once
// All faces of a grid that bodies cover some of, and what is left of them to the water.

#include <abrade/core/parallel.hpp>
#include <abrade/coupling/mapping/face_columns.hpp>
#include <abrade/coupling/mapping/solid_shares.hpp>
#include <abrade/coupling/mapping/spread_cloud.hpp>

#include <algorithm>
#include <numeric>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace abrade {

/// Rows of FaceColumns: those of the cloud, then body by body along the channel, and all of them in the
/// order of their planes; what walls and the surface leave of their faces. Visitors are given a row's
/// number.
class CoveredFaces {
public:
    static constexpr Index planes_at_once = 4;  ///< stones lie in heaps

    /// Bodies as they stand; those below `resolved_from` cells to a diameter make a cloud, which is one more
    /// body behind the others. `aperture`: shares that walls leave open; none: all is. `retracted`: the
    /// surface of the others' cores [cell].
    void place(const Grid<3>& grid, const BoundaryConditions<3>& boundaries, std::span<const FlowBody> bodies,
               Real resolved_from, const FaceField<3>* aperture, Real retracted) {
        const detail::GridNumbers numbers{grid, boundaries};
        covers_.resize(bodies.size());
        // Along the channel: what stands side by side in it does so in memory.
        std::vector<std::size_t> order(bodies.size()), small;
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t b) { return bodies[b].position[outer]; });
        for (const std::size_t b : order) {
            covers_[b].averaged =
                bodies[b].diameter() < resolved_from * numbers.cell_width(bodies[b].position);
            if (covers_[b].averaged) small.push_back(b);
        }
        const auto closed = [aperture](int axis, Offset face) {
            return aperture && (*aperture)[axis][face] == 0;
        };
        parallel_blocks(
            static_cast<Index>(bodies.size()),
            [&](Index, Index first, Index last) {
                detail::SolidCoverFinder finder(numbers, closed, retracted);
                for (Index b = first; b < last; ++b)
                    if (!covers_[at(b)].averaged) finder.find(bodies[at(b)], covers_[at(b)]);
            },
            block_of_bodies);
        spread(grid, boundaries, bodies, std::move(small), aperture);
        first_.resize(bodies.size());
        std::size_t rows = cloud_.faces();
        for (const std::size_t b : order) first_[b] = std::exchange(rows, rows + covers_[b].faces.size());
        columns_.resize(rows, cloud_.faces());
        cloud_.number(numbers,
                      [&](std::size_t i, const SolidFace& f) { columns_.place(i, f, bodies.size()); });
        parallel_for(
            static_cast<Index>(covers_.size()),
            [&](Index b) {
                std::size_t i = first_[at(b)];
                for (const SolidFace& f : covers_[at(b)].faces) columns_.place(i++, f, at(b));
            },
            block_of_bodies);
        list_parts();
        sort_by_plane(grid.layout().planes());
        aperture_ = aperture;
        share_out(grid.layout());
    }

    FaceColumns& columns() noexcept { return columns_; }
    const FaceColumns& columns() const noexcept { return columns_; }
    /// Rows of a body.
    FaceRows of(std::size_t body) const noexcept {
        return {first_[body], first_[body] + covers_[body].faces.size()};
    }
    const SpreadCloud& cloud() const noexcept { return cloud_; }
    const SolidCover& cover(std::size_t body) const noexcept { return covers_[body]; }
    std::span<const SolidCover> covers() const noexcept { return covers_; }
    /// Volume in cells: of bodies, of their cloud, of both.
    std::span<const SolidPart> parts_of_bodies() const noexcept { return parts().first(of_bodies_); }
    std::span<const SolidPart> parts_of_cloud() const noexcept { return parts().subspan(of_bodies_); }
    std::span<const SolidPart> parts() const noexcept { return parts_; }
    /// All, in parallel.
    void for_each(auto&& visit) const {
        parallel_for(static_cast<Index>(columns_.count()), [&](Index i) { visit(at(i)); });
    }
    /// Those of which bodies cover some, in an order that does not depend on threads: bodies may share a
    /// face.
    void on_plane(int plane, auto&& visit) const {
        if (columns_.count() > 0) visit_plane(plane, covered, visit);
    }
    /// Plane by plane in parallel, each of the visits to all faces of a plane before the next.
    void by_planes(auto&&... visits) const { visit_planes(every, visits...); }
    /// Without those of which bodies cover nothing.
    void covered_by_planes(auto&&... visits) const { visit_planes(covered, visits...); }
    /// Without the cloud's.
    void of_bodies_by_planes(auto&&... visits) const { visit_planes(of_bodies, visits...); }

    /// [plane] How many faces are covered in those before it.
    std::vector<std::size_t> covered_before() const {
        std::vector<std::size_t> before{0};
        for (int p = 0; p < planes_; ++p)
            before.push_back(before.back() + cloud_.first_on(p + 1) - cloud_.first_on(p) +
                             plane_start_[at(2 * p + 1)] - plane_start_[at(2 * p)]);
        return before;
    }
    /// Calls visit(row, number) for covered ones in the order of their planes, in parallel; `before`: see
    /// `covered_before`.
    void number_covered(const std::vector<std::size_t>& before, auto&& visit) const {
        parallel_for(
            planes_,
            [&](Index plane) {
                std::size_t number = before[at(plane)];
                visit_plane(plane, covered, [&](std::size_t i) { visit(i, number++); });
            },
            planes_at_once);
    }

    /// Takes from what faces conduct what bodies cover. `surface`: faces at which the pressure is 0.
    void close(Poisson<3>& m, std::span<const OpenFace> surface) {
        FaceColumns& f = columns_;
        const auto conducts = [&](std::size_t i) -> float& { return f.at(m.face, i); };
        const auto share = [&](std::size_t i) { return static_cast<Real>(conducts(i)) / f.conductance(i); };
        by_planes([&](std::size_t i) { f.open[i] = share(i), f.set_interior(i); },
                  [&](std::size_t i) {
                      if (f.share[i] == 0) return;
                      const Real left = share(i) - f.share[i];
                      conducts(i) = left > least ? static_cast<float>(left * f.conductance(i)) : 0.0f;
                  },
                  [&](std::size_t i) { f.water[i] = share(i), f.cover(i); },
                  [&](std::size_t i) {
                      if (i < f.cloud && f.open[i] > 0)
                          conducts(i) += static_cast<float>(f.share[i] * f.mobility[i] * f.conductance(i));
                  },
                  [&](std::size_t i) { f.conducts[i] = conducts(i) > 0; });
        close_surface(surface);
    }
    /// After `close`: opens faces again, and lets them conduct as little as what is in them is heavy.
    /// `ratio(body)`: its density over the water's.
    void weigh(Poisson<3>& m, auto&& ratio) {
        FaceColumns& f = columns_;
        const auto density = [&](std::size_t i) -> float& { return f.at(m.face, i); };
        const auto beyond = [&](std::size_t i) { return f.covered[i] * (ratio(f.body[i]) - 1); };
        const auto wet = [&](auto visit) {
            return [&f, visit](std::size_t i) {
                if (f.open[i] > 0 && !f.at_surface(i)) visit(i);
            };
        };
        const auto at_surface = [&](auto visit) {
            return [&f, visit](std::size_t i) {
                if (f.open[i] > 0 && f.at_surface(i)) visit(i, f.surface[i]);
            };
        };
        const auto find = [&](std::size_t i, Real all) {
            f.lighter[i] = 1 / all, f.heavier[i] = beyond(i) / all;
        };
        std::ranges::fill(surface_, 1);
        by_planes([&](std::size_t i) { f.heavier[i] = 0; }, wet([&](std::size_t i) { density(i) = 1; }),
                  wet([&](std::size_t i) { density(i) += static_cast<float>(beyond(i)); }),
                  wet([&](std::size_t i) { find(i, density(i)); }), wet([&](std::size_t i) {
                      density(i) = static_cast<float>(f.open[i] * f.lighter[i] * f.conductance(i));
                  }),
                  at_surface([&](std::size_t i, std::size_t n) { surface_[n] += beyond(i); }),
                  at_surface([&](std::size_t i, std::size_t n) { find(i, surface_[n]); }));
        for (Real& share : surface_) share = 1 / share;
    }
    /// What the n-th of the faces at the surface conducts, over what it would without bodies [-].
    Real water_share(std::size_t n) const noexcept { return surface_[n]; }
    /// Once the operator is built: takes cells without a pressure of their own, which bodies and walls close,
    /// to those inside a body, and pushes the others by what passes through their faces. A cell that is
    /// closed without being covered is a pocket, as between a body and a floor that it touches. What a body
    /// pushes into it goes on to cells beside it that have a pressure, if it closes a face to one, or the
    /// same pressure all around would press on the body.
    void find_closed_cells(const Poisson<3>& m) {
        const auto wet = [&](Offset cell) { return m.inverse_diagonal[cell] > 0; };
        parallel_for(
            static_cast<Index>(covers_.size()),
            [&](Index b) {
                SolidCover& c = covers_[at(b)];
                const auto closed = std::stable_partition(
                    c.cells.begin(), c.cells.end(), [&](const SolidCell& cell) { return wet(cell.cell); });
                c.inside.insert(c.inside.end(), closed, c.cells.end());
                c.cells.erase(closed, c.cells.end());
                push_what_passes(at(b), wet);
            },
            block_of_bodies);
        for (std::size_t b = 0; b < covers_.size(); ++b)
            if (std::ranges::any_of(covers_[b].inside, is_pushed)) lead_out(b, m);
    }

private:
    /// Resolved bodies leave no room for others.
    void spread(const Grid<3>& grid, const BoundaryConditions<3>& boundaries,
                std::span<const FlowBody> bodies, std::vector<std::size_t> small,
                const FaceField<3>* aperture) {
        const bool some = !small.empty();
        if (some) make_sums(grid.layout());
        for (const std::size_t b : small) {
            covers_[b].clear();
            for (int a = 0; a < 3; ++a) {
                const Real x = bodies[b].position[a];
                if (boundaries.periodic(a)) continue;
                covers_[b].cut |= (!is_closed(boundaries[a][0]) && x < grid.low(a)) ||
                                  (!is_closed(boundaries[a][1]) && x > grid.high(a));
            }
        }
        for (std::size_t b = 0; b < bodies.size() && some; ++b)
            for (const SolidFace& f : covers_[b].faces) sums_[f.axis][f.face] += f.share;
        const auto open = [&](int axis, Offset face) {
            return std::max((aperture ? (*aperture)[axis][face] : 1) - sums_[axis][face], Real(0));
        };
        cloud_.place(grid, boundaries, bodies, std::move(small), open);
        for (std::size_t b = 0; b < bodies.size() && some; ++b)
            for (const SolidFace& f : covers_[b].faces) sums_[f.axis][f.face] = 0;
    }

    static SolidCell* find(std::vector<SolidCell>& in, Offset cell) noexcept {
        const auto found = std::ranges::find(in, cell, &SolidCell::cell);
        return found == in.end() ? nullptr : &*found;
    }
    static bool is_pushed(const SolidCell& cell) noexcept { return !cell.area.isZero(0); }

    /// Walls and other bodies may leave less of a face than a body would cover.
    void push_what_passes(std::size_t body, auto&& wet) {
        constexpr Real least_lack = 1e-6;  // conductances are in single precision
        const FaceColumns& f = columns_;
        SolidCover& c = covers_[body];
        for (const std::size_t i : of(body)) {
            const Real lacks = f.open[i] * f.covered[i] - f.share[i];
            if (std::abs(lacks) < least_lack) continue;
            if (f.open[i] == 0 && !wet(f.face[i]) && !wet(f.low[i])) continue;  // in the air
            const detail::Six pushes = lacks * f.volume[i] / f.gap[i] * f.coefficient(i);
            for (const auto& [cell, sign] : {std::pair{f.face[i], -1.0}, std::pair{f.low[i], 1.0}})
                if (SolidCell* const of_cell = find(wet(cell) ? c.cells : c.inside, cell))
                    of_cell->area += sign * pushes.template head<3>(),
                        of_cell->area_moment += sign * pushes.template tail<3>();
        }
    }

    /// From pockets to the cells beside them that have a pressure, behind faces that the body closes.
    void lead_out(std::size_t body, const Poisson<3>& m) {
        struct Exit {
            std::size_t row;
            SolidCell *from, *to;
            Real open;  ///< the more faces of `to` conduct, the less of a jet
        };
        FaceColumns& f = columns_;
        SolidCover& c = covers_[body];
        std::vector<Exit> exits;
        for (const std::size_t i : of(body)) {
            const bool above = m.inverse_diagonal[f.face[i]] > 0, below = m.inverse_diagonal[f.low[i]] > 0;
            if (above == below || f.open[i] * f.covered[i] == 0 || f.at_surface(i)) continue;
            const Offset to = above ? f.face[i] : f.low[i], from = above ? f.low[i] : f.face[i];
            const Exit exit{i, find(c.inside, from), find(c.cells, to),
                            1 / static_cast<Real>(m.inverse_diagonal[to])};
            if (exit.from && exit.to && is_pushed(*exit.from)) exits.push_back(exit);
        }
        for (const Exit& exit : exits) {
            Real open = 0;
            for (const Exit& other : exits) open += other.from == exit.from ? other.open : 0;
            const Real part = exit.open / open, away = exit.to->cell == f.face[exit.row] ? 1 : -1;
            exit.to->area += part * exit.from->area, exit.to->area_moment += part * exit.from->area_moment;
            const Real through =
                f.volume[exit.row] / f.gap[exit.row] * f.open[exit.row] * f.covered[exit.row];
            const detail::Six pushed = (detail::Six() << exit.from->area, exit.from->area_moment).finished();
            f.detours.push_back({exit.row, -away * part / through * pushed});
            f.detour[exit.row] = static_cast<std::uint32_t>(f.detours.size());
        }
    }

    static constexpr int outer = Layout<3>::outer;
    static constexpr Real least = 1e-6;  ///< of a face: less conducts nothing

    static std::size_t at(std::integral auto i) noexcept { return static_cast<std::size_t>(i); }

    struct Which {
        bool cloud, near;  ///< and those that are near by, beside covered ones
    };
    static constexpr Which every{true, true}, covered{true, false}, of_bodies{false, true};
    void visit_plane(Index plane, Which which, auto&& visit) const {
        const auto p = static_cast<int>(plane);
        if (which.cloud)
            for (std::size_t i = cloud_.first_on(p); i < cloud_.first_on(p + 1); ++i) visit(i);
        for (std::size_t n = plane_start_[at(2 * p)]; n < plane_start_[at(2 * p + 1 + which.near)]; ++n)
            visit(std::size_t{by_plane_[n]});
    }
    void visit_planes(Which which, auto&... visits) const {
        parallel_for(
            planes_, [&](Index plane) { (visit_plane(plane, which, visits), ...); }, planes_at_once);
    }

    /// By walls [-].
    Real left_open(std::size_t i) const noexcept { return aperture_ ? columns_.at(*aperture_, i) : 1; }
    void make_sums(const Layout<3>& layout) {
        if (sums_[0].size() == 0) sums_ = face_field<3>(layout);
    }

    /// What walls and all bodies leave of faces, until `close` knows which of these have a pressure; and all
    /// friction, even of one body: it may be near itself, across a periodic side.
    void share_out(const Layout<3>& layout) {
        FaceColumns& f = columns_;
        if (f.count() == 0) return;
        make_sums(layout);
        const auto sum = [&](std::size_t i) -> Real& { return f.at(sums_, i); };
        by_planes([&](std::size_t i) { sum(i) += f.share[i]; },
                  [&](std::size_t i) {
                      f.open[i] = left_open(i);
                      f.water[i] = std::max(f.open[i] - sum(i), 0.0);
                      f.part[i] = sum(i) > 0 ? f.share[i] / sum(i) : 0, f.cover(i);
                  },
                  [&](std::size_t i) { sum(i) = 0; });
        of_bodies_by_planes([&](std::size_t i) { sum(i) += f.friction[i]; },
                            [&](std::size_t i) { f.all_friction[i] = sum(i); },
                            [&](std::size_t i) { sum(i) = 0; });
    }

    void list_parts() {
        const FaceColumns& f = columns_;
        of_bodies_ = 0;
        for (const SolidCover& cover : covers_) of_bodies_ += cover.parts.size();
        parts_.resize(of_bodies_ + 2 * f.cloud);
        auto next = parts_.begin();
        for (const SolidCover& cover : covers_) next = std::ranges::copy(cover.parts, next).out;
        const std::span of_cloud = std::span(parts_).subspan(of_bodies_);
        parallel_for(static_cast<Index>(f.cloud), [&](Index n) {
            const std::size_t i = at(n);
            const Real half = f.share[i] * f.volume[i] / 6;  // of each axis' a third
            of_cloud[2 * i] = {f.face[i], half}, of_cloud[2 * i + 1] = {f.low[i], half};
        });
    }

    /// Bodies' rows; in each plane those come first of which they cover some.
    void sort_by_plane(int planes) {
        const FaceColumns& f = columns_;
        const auto part = [&](std::size_t i) { return at(2 * f.plane[i] + (f.share[i] == 0)); };
        planes_ = planes;
        plane_start_.assign(at(2 * planes) + 1, 0);
        for (std::size_t i = f.cloud; i < f.count(); ++i) ++plane_start_[part(i) + 1];
        std::partial_sum(plane_start_.begin(), plane_start_.end(), plane_start_.begin());
        by_plane_.resize(f.count() - f.cloud);
        std::vector<std::size_t> next = plane_start_;
        for (std::size_t i = f.cloud; i < f.count(); ++i)
            by_plane_[next[part(i)]++] = static_cast<std::uint32_t>(i);
    }

    /// What of a face between water and air is solid pushes on no water.
    void close_surface(std::span<const OpenFace> surface) {
        FaceColumns& f = columns_;
        surface_.assign(surface.size(), 1);
        if (f.count() == 0) return;
        for (std::size_t n = 0; n < surface.size(); ++n)
            sums_[surface[n].axis][surface[n].face] = static_cast<Real>(n + 1);
        const auto dry = [&](auto visit) {
            return [&, visit](std::size_t i) {
                if (f.open[i] > 0 || f.at(sums_, i) == 0) return;
                const auto n = static_cast<std::size_t>(f.at(sums_, i)) - 1;
                visit(i, n, surface[n]);
            };
        };
        by_planes(dry([&](std::size_t i, std::size_t n, const OpenFace&) {
                      surface_[n] -= f.share[i] / left_open(i);
                  }),
                  dry([&](std::size_t, std::size_t n, const OpenFace&) {
                      if (surface_[n] < least) surface_[n] = 0;
                  }),
                  dry([&](std::size_t i, std::size_t n, const OpenFace& open) {
                      f.open[i] = left_open(i), f.water[i] = surface_[n] * f.open[i], f.cover(i);
                      f.per_gap[i] = std::abs(open.slope), f.surface[i] = static_cast<std::uint32_t>(n);
                      f.high_wet[i] = open.cell == f.face[i], f.low_wet[i] = open.cell == f.low[i];
                      f.leaves[i] = open.plain == 0, f.weight[i] = open.weight;
                  }));
        for (const OpenFace& open : surface) sums_[open.axis][open.face] = 0;
    }

    const FaceField<3>* aperture_ = nullptr;  ///< of the step; none: all is open
    std::vector<SolidCover> covers_;          ///< [body]
    SpreadCloud cloud_;
    FaceColumns columns_;
    std::vector<SolidPart> parts_;  ///< of bodies, then of the cloud
    std::size_t of_bodies_ = 0;
    std::vector<std::size_t> first_;  ///< [body] of its rows
    int planes_ = 0;
    std::vector<std::uint32_t> by_plane_;   ///< bodies' rows in the order of their planes
    std::vector<std::size_t> plane_start_;  ///< [2 plane, + 1 of those near by] in `by_plane_`
    std::vector<Real> surface_;             ///< [number of a face at the surface] see `water_share`
    FaceField<3> sums_;                     ///< of what bodies have at a face; 0 but while they are needed
};

}  // namespace abrade
