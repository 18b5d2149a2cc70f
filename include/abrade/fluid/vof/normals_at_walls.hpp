#pragma once
// The surface in cells that walls cut: it goes on as it came.

#include <abrade/core/parallel.hpp>
#include <abrade/fluid/mesh/cell_sizes.hpp>
#include <abrade/fluid/vof/liquid_in_cut_cells.hpp>
#include <abrade/fluid/vof/plane_fit.hpp>

#include <cmath>

namespace abrade {

/// A liquid fraction in a cell that a wall cuts says nothing of a plane in the whole cell. There the surface
/// is that of the neighbours which no wall cuts, the mean of their planes, carried on from cell to cell where
/// a wall leaves at a shallow angle, and moved by what that leaves out of the cell's own liquid. So a planar
/// surface stays exact up to the wall, and water in a curved invert rests. The plane that holds the cell's
/// volume (`distance`) gets the same normal. Whole cells of which the surface cuts a corner only, or whose
/// whole neighbours do not tell its tilt, are treated alike. Cells that no neighbour tells of keep what they
/// have, but for traces of water or air in whole ones: these follow the fractions of all that is around.
///
/// Where a cut cell holds about as much as would lie below that plane, it is `reconstructed` on which side of
/// the surface its centre is: a cell half full of its open part may have its centre above the water, inside
/// the wall. Where it does not, a film or a front on the wall, its fraction says more.
template <int Dim>
class SurfaceAtWalls {
public:
    SurfaceAtWalls() = default;
    /// `smallest_void`: air of less than this share of a cell [-] is no surface.
    SurfaceAtWalls(const Layout<Dim>& layout, const CellSizes<Dim>& sizes, Real smallest_void)
        : stencil_(layout), sizes_(sizes), fit_(layout, sizes), stride_(layout.stride),
          full_(1 - smallest_void) {}

    /// Shares that walls leave open [-]; they must outlive this.
    void set_walls(const FaceField<Dim>* apertures, const Field<Real>* open_fractions) noexcept {
        apertures_ = apertures;
        open_fractions_ = open_fractions;
    }

    /// A cell that a wall cuts, whose centre may lie below the surface all the same: it wants a plane.
    bool is_dry_beside_water(Index c, const Real* fraction, const std::uint8_t* marks) const noexcept {
        if (fraction[c] > 0 || (marks[c] & cell_mark::whole) != 0) return false;
        for (const Offset s : stride_)
            if (fraction[c - s] > 0 || fraction[c + s] > 0) return true;
        return false;
    }

    void find(SurfacePlanes<Dim>& planes, const Real* fraction, const std::uint8_t* marks,
              const Index* plane_of) {
        known_.resize(static_cast<std::size_t>(planes.count()));
        open_.clear();
        parallel_for(planes.count(), [&](Index i) {
            const auto k = static_cast<std::size_t>(i);
            const std::uint8_t mark = marks[planes.cell[k]];
            const bool whole = (mark & cell_mark::whole) != 0;
            if (whole && fraction[planes.cell[k]] > full_)
                known_[k] = of_trace;
            else
                known_[k] = whole && fraction[planes.cell[k]] > 1 - full_ && is_wide(planes, k, fraction) &&
                            ((mark & cell_mark::ringed) != 0 || is_held(planes, k, fraction, marks));
            planes.reconstructed[k] = 0;
            if (fraction[planes.cell[k]] == 0) planes.distance[k] = -1;  // nothing of it may be rounded
        });
        for (Index i = 0; i < planes.count(); ++i)
            if (known_[static_cast<std::size_t>(i)] == 0) open_.push_back(i);
        constexpr int farthest = 6;  // cells from the last whole one
        for (int pass = 0; pass < farthest && !open_.empty(); ++pass) {
            found_.assign(open_.size(), 0);
            parallel_for(static_cast<Index>(open_.size()), [&](Index n) {
                const auto k = static_cast<std::size_t>(n);
                found_[k] = carry_on(planes, open_[k], {fraction, marks, plane_of});
            });
            std::size_t left = 0;
            for (std::size_t n = 0; n < open_.size(); ++n) {
                if (found_[n])
                    known_[static_cast<std::size_t>(open_[n])] = 1;
                else
                    open_[left++] = open_[n];
            }
            if (left == open_.size()) break;
            open_.resize(left);
        }
        // Traces of water or air in whole cells that nobody tells of.
        std::erase_if(open_, [&](Index i) {
            const Index c = planes.cell[static_cast<std::size_t>(i)];
            return (marks[c] & cell_mark::whole) == 0 || (fraction[c] > trace && fraction[c] < 1 - trace);
        });
        for (Index first = 0; first < static_cast<Index>(open_.size()); first += pack_lanes)
            follow_fractions(planes, first, fraction, marks);
    }

    static void fields(auto&& field) { field("known", &SurfaceAtWalls::known_); }

private:
    static constexpr int vertical = Grid<Dim>::vertical;
    static constexpr Real trace = 1e-3;          ///< [-], as SurfaceNormals ends a column
    static constexpr std::uint8_t of_trace = 2;  ///< no surface: asks nobody, and nobody asks it
    static std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

    /// Of all cells.
    struct Cells {
        const Real* fraction;
        const std::uint8_t* marks;
        const Index* plane_of;
    };

    /// Whether the whole cells about a whole one tell its tilt. Beside a wall they may all be full or dry.
    bool is_held(const SurfacePlanes<Dim>& planes, std::size_t k, const Real* fraction,
                 const std::uint8_t* marks) const noexcept {
        Point<Dim> normal;
        for (int a = 0; a < Dim; ++a) normal[a] = planes.normal[at(a)][k];
        int nearest = 0;  // axis
        if (!(normal.cwiseAbs().maxCoeff(&nearest) > 0)) return false;
        // Seldom in doubt: the surface passes through the middle of some of them, in all directions.
        int aa = 0, ab = 0, bb = 0;
        for (int n = 0; n < detail::Stencil<Dim>::size; ++n) {
            const Offset c = planes.cell[k] + stencil_.step[at(n)];
            if ((marks[c] & cell_mark::whole) == 0 || std::abs(fraction[c] - 0.5) > 0.3) continue;
            const int a = detail::Stencil<Dim>::along(nearest == 0 ? 1 : 0, n);
            const int b = Dim == 3 ? detail::Stencil<Dim>::along(nearest == 2 ? 1 : 2, n) : 0;
            aa += a * a, ab += a * b, bb += b * b;
        }
        return (Dim == 2 ? aa > 0 : aa * bb > ab * ab) ||
               fit_.hold(normal, fraction, marks, planes.cell[k], planes.level[k]) > 0.01;
    }

    /// Whether the surface cuts more than a corner off a cell. The smaller its area there, the more a little
    /// liquid moves it: pressure and surface would answer each other faster than steps allow. A little liquid
    /// is a surface where there is more below it, a little air where there is more above.
    bool is_wide(const SurfacePlanes<Dim>& planes, std::size_t k, const Real* fraction) const noexcept {
        constexpr Real corner = 0.13, narrow = 0.5;
        const Index c = planes.cell[k];
        const Real f = fraction[c];
        if (f > corner && f < 1 - corner) return true;
        const CellPlane<Dim> plane = planes.plane(static_cast<Index>(k));
        int nearest = 0;
        for (int a = 1; a < Dim; ++a)
            if (std::abs(plane.normal[at(a)]) > std::abs(plane.normal[at(nearest)])) nearest = a;
        const Real along = plane.normal[at(nearest)], way = 1e-6 * std::abs(along);
        const bool up = along > 0, little = f <= corner;
        const Real beyond = fraction[c + (up == little ? -1 : 1) * stride_[nearest]];
        return (little ? beyond > 1 - corner : beyond < corner) &&
               fraction_below<Dim>(plane.normal, plane.distance + way) -
                       fraction_below<Dim>(plane.normal, plane.distance - way) >
                   2e-6 * narrow;
    }

    /// Takes the mean of known planes around a cell. Planes that are not known are not touched by others.
    bool carry_on(SurfacePlanes<Dim>& planes, Index i, const Cells& cells) const {
        const auto& [fraction, marks, plane_of] = cells;
        const auto own = static_cast<std::size_t>(i);
        const Index level = planes.level[own];
        Point<Dim> normal = Point<Dim>::Zero();
        Real distance = 0;
        int count = 0;
        for (int k = 0; k < detail::Stencil<Dim>::size; ++k) {
            const Index other = plane_of[planes.cell[own] + stencil_.step[static_cast<std::size_t>(k)]];
            if (other < 0 || known_[static_cast<std::size_t>(other)] != 1) continue;
            const auto j = static_cast<std::size_t>(other);
            Point<Dim> n, to_own;
            for (int a = 0; a < Dim; ++a) {
                n[a] = planes.normal[static_cast<std::size_t>(a)][j] / sizes_.edge(a, planes.level[j]);
                const int along = detail::Stencil<Dim>::along(a, k);
                const Real gap =
                    a == vertical ? sizes_.gap(std::max(level, planes.level[j])) : sizes_.edge(a, level);
                to_own[a] = -along * gap;
            }
            const Real length = n.norm();
            if (!(length > 0)) continue;
            normal += n / length;
            distance += (planes.position[j] - n.dot(to_own)) / length;
            ++count;
        }
        const Real length = normal.norm();
        if (count == 0 || !(length > 1e-3 * count)) return false;
        for (int a = 0; a < Dim; ++a)
            planes.normal[static_cast<std::size_t>(a)][own] = normal[a] / length * sizes_.edge(a, level);
        planes.position[own] = distance / count;
        const Real held = fraction[planes.cell[own]];
        if ((marks[planes.cell[own]] & cell_mark::whole) != 0) {
            planes.distance[own] = plane_distance<Dim>(planes.plane(i).normal, held);
            if (held > 1 - full_ && is_wide(planes, own, fraction))
                planes.position[own] = planes.distance[own];
            return true;
        }
        CellPlane<Dim> plane = planes.plane(i);
        plane.distance = planes.position[own];
        planes.reconstructed[own] = (plane.distance >= 0) == (held >= 0.5) ||
                                    std::abs(open_below(planes.cell[own], plane) - held) < 0.25;
        if (planes.reconstructed[own] && held > 0 && held < full_) answer(planes, own, plane, held);
        if (held > 0)
            planes.distance[own] = plane_distance<Dim>(plane.normal, held);
        else
            for (const Real component : plane.normal) planes.distance[own] -= std::abs(component);
        return true;
    }

    /// Tilts from all that is around a pack of cells: among whole cells alone, of which the fit knows, a
    /// trace may seem a drop in a corner.
    void follow_fractions(SurfacePlanes<Dim>& planes, Index first, const Real* fraction,
                          const std::uint8_t* marks) const noexcept {
        const Index lanes = std::min<Index>(pack_lanes, static_cast<Index>(open_.size()) - first);
        detail::PackCells cells, levels;
        const auto plane = [&](int lane) {
            return static_cast<std::size_t>(
                open_[static_cast<std::size_t>(first + std::min<Index>(lane, lanes - 1))]);
        };
        for (int lane = 0; lane < pack_lanes; ++lane)
            cells[at(lane)] = planes.cell[plane(lane)], levels[at(lane)] = planes.level[plane(lane)];
        const auto normal = fit_.find(0, fraction, marks, cell_mark::open, cells, levels).normal;
        const Pack distance = plane_distance<Dim>(normal, detail::values_at(fraction, cells));
        for (int lane = 0; lane < lanes; ++lane) {
            const std::size_t k = plane(lane);
            for (std::size_t a = 0; a < Dim; ++a) planes.normal[a][k] = normal[a][lane];
            planes.distance[k] = planes.position[k] = distance[lane];
        }
    }

    /// Where a carried-on plane leaves out some of what the cell holds, or takes too much, it rises or sinks
    /// by that over its area: the pressure of each cell answers the cell's own liquid. Were it to answer that
    /// of others, water at rest could run away from it.
    void answer(SurfacePlanes<Dim>& planes, std::size_t own, CellPlane<Dim> plane, Real held) const {
        constexpr Real narrow = 0.1;  // area of the plane in the open over the cell's [-]: see `is_wide`
        const Index c = planes.cell[own];
        Real size = 0;
        for (const Real component : plane.normal) size = std::max(size, std::abs(component));
        const Real missing = held - open_below(c, plane), way = 1e-4 * size;
        plane.distance += way;
        const Real more = open_below(c, plane);
        plane.distance -= 2 * way;
        const Real per_way = (more - open_below(c, plane)) / (2 * way);
        if (per_way * size * (*open_fractions_)[c] > narrow) planes.position[own] += missing / per_way;
    }

    /// Share of what is open of a cell that lies below a plane [-].
    Real open_below(Offset c, const CellPlane<Dim>& plane) const {
        const auto depth = [&](const Point<Dim>& unit) {
            Real below = plane.distance;
            for (int a = 0; a < Dim; ++a) below -= plane.normal[at(a)] * (unit[a] - 0.5);
            return below;
        };
        return detail::WaterAmongWalls<Dim>::share(*apertures_, stride_, c, (*open_fractions_)[c], depth);
    }

    detail::Stencil<Dim> stencil_{};
    CellSizes<Dim> sizes_{};
    VolumeFit<Dim> fit_{};
    PerAxis<Offset, Dim> stride_{};
    const FaceField<Dim>* apertures_ = nullptr;
    const Field<Real>* open_fractions_ = nullptr;
    Real full_ = 1;
    std::vector<std::uint8_t> known_;  ///< [surface plane] 0: yet to be found; 1: stands; of_trace
    std::vector<std::uint8_t> found_;
    std::vector<Index> open_;
};

}  // namespace abrade
