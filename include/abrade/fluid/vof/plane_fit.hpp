#pragma once
// The plane that fits the volumes of a cell's neighbours best.

#include <abrade/fluid/mesh/cell_sizes.hpp>
#include <abrade/fluid/vof/planes.hpp>

namespace abrade {

/// Least squares fit of a plane to the liquid fractions of the 3^Dim cells around a cell, whose own fraction
/// it holds exactly: minimises
///   E(normal) = sum over neighbours of [fraction below the plane - f]^2
/// by Gauss and Newton's steps, as in LVIRA (Pilliod & Puckett 2004, doi:10.1016/j.jcp.2003.12.023). Only
/// cells that carry the mark asked for take part, so sides and walls do not bend the surface: a plane is
/// found exactly wherever its traces in those cells determine it.
template <int Dim>
class VolumeFit {
public:
    VolumeFit() = default;
    VolumeFit(const Layout<Dim>& layout, const CellSizes<Dim>& sizes) : stencil_(layout), sizes_(sizes) {}

    struct Found {
        std::array<Pack, Dim> normal;            ///< of any length
        PackMask unsettled = Pack(0) < Pack(0);  ///< further attempts may do better
    };
    /// Normals for a pack of cells, from a given one on or, where there is none, from the gradient of the
    /// fractions, which without any attempts is the answer, of first order.
    Found find(int attempts, const Real* fraction, const std::uint8_t* marks, std::uint8_t asked,
               const detail::PackCells& cells, const detail::PackCells& levels,
               const std::array<Pack, Dim>* from = nullptr) const noexcept {
        const Problem problem = problem_of(fraction, marks, asked, cells, levels);
        const Normal start = from ? *from : against_gradient(problem);
        return attempts == 0 ? Found{start} : improve(problem, start, attempts);
    }

    /// How firmly the cells around hold a normal that has been found: the least eigenvalue of the squares'
    /// second derivatives. 0: it may turn, and none of them would have another fraction.
    Real hold(const Point<Dim>& found, const Real* fraction, const std::uint8_t* marks, Index cell,
              Index level) const noexcept {
        detail::PackCells cells, levels;
        cells.fill(cell), levels.fill(level);
        const Problem problem = problem_of(fraction, marks, cell_mark::whole, cells, levels);
        int held = 0;
        const Real largest = found.cwiseAbs().maxCoeff(&held);
        Normal normal;
        for (int a = 0; a < Dim; ++a) normal[static_cast<std::size_t>(a)] = Pack(found[a] / largest);
        const Misfit now = misfit(problem, normal);
        std::array<Misfit, unknowns> changed;
        for (int a = 0, u = 0; a < Dim; ++a) {
            if (a == held) continue;
            Normal turned = normal;
            turned[static_cast<std::size_t>(a)] += Pack(difference);
            changed[static_cast<std::size_t>(u++)] = misfit(problem, turned);
        }
        Real aa = 0, ab = 0, bb = 0;
        for (std::size_t k = 0; k < size; ++k) {
            const Real ja = (changed[0].each[k][0] - now.each[k][0]) / difference;
            const Real jb = Dim == 3 ? (changed[unknowns - 1].each[k][0] - now.each[k][0]) / difference : 0;
            aa += ja * ja, ab += ja * jb, bb += jb * jb;
        }
        return Dim == 2 ? aa : 0.5 * (aa + bb - std::sqrt(square(aa - bb) + 4 * ab * ab));
    }

private:
    static constexpr Real difference = 1e-6;
    static constexpr int size = detail::Stencil<Dim>::size, own = detail::Stencil<Dim>::own;
    static constexpr int vertical = Grid<Dim>::vertical;
    static constexpr int unknowns = Dim - 1;
    using Normal = std::array<Pack, Dim>;

    struct Problem {
        std::array<Pack, size> fraction, weight;
        std::array<bool, size> used;  ///< by any of the pack
        bool stretched;
        std::array<Pack, 3> ratio, shift;  ///< of the levels below, at and above: edge, centre; in own edges
    };
    struct Misfit {
        std::array<Pack, size> each;
        Pack squares;
    };

    Problem problem_of(const Real* fraction, const std::uint8_t* marks, std::uint8_t asked,
                       const detail::PackCells& cells, const detail::PackCells& levels) const noexcept {
        Problem problem{};
        problem.stretched = !sizes_.uniform();
        for (int k = 0; k < size; ++k) {
            const auto i = static_cast<std::size_t>(k);
            problem.fraction[i] = detail::values_at(fraction, cells, stencil_.step[i]);
            for (int lane = 0; lane < pack_lanes; ++lane) {
                const auto l = static_cast<std::size_t>(lane);
                const bool known = (marks[cells[l] + stencil_.step[i]] & asked) != 0;
                problem.weight[i].set(lane, known ? 1 : 0);
                problem.used[i] = problem.used[i] || (known && k != own);  // its own fraction is held
            }
        }
        for (int v = 0; v < 3; ++v) {
            const auto i = static_cast<std::size_t>(v);
            problem.ratio[i] = problem.shift[i] = Pack(Real(v == 1));
            if (v == 1) problem.shift[i] = Pack(0);
            for (int lane = 0; lane < pack_lanes; ++lane) {
                const Index level = levels[static_cast<std::size_t>(lane)];
                const Real edge = sizes_.edge(vertical, level);
                problem.ratio[i].set(lane, sizes_.edge(vertical, level + v - 1) / edge);
                if (v != 1)
                    problem.shift[i].set(lane,
                                         v == 0 ? -sizes_.gap(level) / edge : sizes_.gap(level + 1) / edge);
            }
        }
        return problem;
    }

    /// Differences between neighbours across the stencil, as Youngs weighs them; pairs of which one is not
    /// known are left out.
    static Normal gradient(const Problem& problem) noexcept {
        Normal g;
        for (int a = 0; a < Dim; ++a) {
            Pack sum = Pack(0), all = Pack(0);
            constexpr std::array<int, 3> power{1, 3, 9};
            for (int k = 0; k < size; ++k) {
                if (detail::Stencil<Dim>::along(a, k) > 0) continue;
                int from_line = 0;
                for (int b = 0; b < Dim; ++b)
                    if (b != a) from_line += detail::Stencil<Dim>::along(b, k) != 0;
                const auto i = static_cast<std::size_t>(k);
                const auto j = static_cast<std::size_t>(k + power[static_cast<std::size_t>(a)]);
                const Pack w = Pack(Real(4 >> from_line)) * problem.weight[i] * problem.weight[j];
                sum += w * (problem.fraction[j] - problem.fraction[i]);
                all += w;
            }
            g[static_cast<std::size_t>(a)] = sum / max(all, Pack(1));
        }
        return g;
    }

    static Misfit misfit(const Problem& problem, const Normal& normal) noexcept {
        Misfit result;
        result.squares = Pack(0);
        const Pack distance = plane_distance<Dim>(normal, problem.fraction[own]);
        detail::SortedNormal<Pack> m{};
        for (int v = 0; v < 3; ++v) {
            const auto i = static_cast<std::size_t>(v);
            Normal scaled = normal;
            scaled[vertical] = scaled[vertical] * problem.ratio[i];
            if (v == 0 || problem.stretched) m = detail::sorted<Dim>(scaled);
            for (int k = 0; k < size; ++k) {
                if (detail::Stencil<Dim>::along(vertical, k) != v - 1) continue;
                const auto n = static_cast<std::size_t>(k);
                if (!problem.used[n]) {
                    result.each[n] = Pack(0);
                    continue;
                }
                Pack d = distance - normal[vertical] * problem.shift[i];
                for (int a = 0; a < Dim; ++a)
                    if (a != vertical)
                        d -= normal[static_cast<std::size_t>(a)] *
                             Pack(Real(detail::Stencil<Dim>::along(a, k)));
                const Pack low = Pack(0.5) + d * m.scale, high = Pack(0.5) - d * m.scale;
                const Pack less = detail::lower_fraction<Dim>(m, detail::positive(min(low, high)));
                const Pack below = select(low < high, less, Pack(1) - less);
                result.each[n] = problem.weight[n] * (below - problem.fraction[n]);
                result.squares += result.each[n] * result.each[n];
            }
        }
        return result;
    }

    static Pack largest(const Normal& n) noexcept {
        Pack most = detail::magnitude(n[0]);
        for (std::size_t a = 1; a < Dim; ++a) most = max(most, detail::magnitude(n[a]));
        return most;
    }
    static Normal against_gradient(const Problem& problem) noexcept {
        Normal normal = gradient(problem);
        const Pack steepest = largest(normal);
        const PackMask none = !(steepest > Pack(0));  // a drop, all alone: level
        for (std::size_t a = 0; a < Dim; ++a)
            normal[a] = select(none, Pack(Real(a == vertical)), -normal[a] / max(steepest, Pack(1e-30)));
        return normal;
    }

    static Found improve(const Problem& problem, Normal normal, int attempts) noexcept {
        // The largest component is held at +-1, the others are the unknowns.
        const Pack one = largest(normal);
        std::array<Pack, Dim> size_of;
        for (std::size_t a = 0; a < Dim; ++a) {
            normal[a] /= one;
            size_of[a] = detail::magnitude(normal[a]);
        }
        std::array<PackMask, Dim> held;
        if constexpr (Dim == 2) {
            held[0] = size_of[0] > size_of[1];
            held[1] = !held[0];
        } else {
            held[0] = (size_of[0] > size_of[1]) & (size_of[0] > size_of[2]);
            held[1] = (!held[0]) & (size_of[1] > size_of[2]);
            held[2] = !(held[0] | held[1]);
        }
        const auto moved = [&](const Normal& from, const std::array<Pack, unknowns>& by) {
            Normal to = from;
            if constexpr (Dim == 2) {
                to[0] += select(held[0], Pack(0), by[0]);
                to[1] += select(held[1], Pack(0), by[0]);
            } else {
                to[0] += select(held[0], Pack(0), by[0]);
                to[1] += select(held[1], Pack(0), select(held[0], by[0], by[1]));
                to[2] += select(held[2], Pack(0), by[1]);
            }
            return to;
        };

        Misfit now = misfit(problem, normal);
        Pack trust = Pack(1);
        PackMask active = now.squares > Pack(1e-26);
        for (int attempt = 0; attempt < attempts && any(active); ++attempt) {
            std::array<Misfit, unknowns> changed;
            for (std::size_t u = 0; u < unknowns; ++u) {
                std::array<Pack, unknowns> by;
                by.fill(Pack(0));
                by[u] = Pack(difference);
                changed[u] = misfit(problem, moved(normal, by));
            }
            std::array<Pack, unknowns> right;
            Pack aa = Pack(0), ab = Pack(0), bb = Pack(0);
            right.fill(Pack(0));
            for (std::size_t k = 0; k < size; ++k) {
                const Pack ja = (changed[0].each[k] - now.each[k]) * Pack(1 / difference);
                aa += ja * ja;
                right[0] -= ja * now.each[k];
                if constexpr (Dim == 3) {
                    const Pack jb = (changed[1].each[k] - now.each[k]) * Pack(1 / difference);
                    ab += ja * jb;
                    bb += jb * jb;
                    right[1] -= jb * now.each[k];
                }
            }
            const Pack small = Pack(1e-12) * (aa + bb) + Pack(1e-20);
            aa += small;
            bb += small;
            std::array<Pack, unknowns> by;
            if constexpr (Dim == 2) {
                by[0] = right[0] / aa;
            } else {
                const Pack det = aa * bb - ab * ab;
                by[0] = (bb * right[0] - ab * right[1]) / det;
                by[1] = (aa * right[1] - ab * right[0]) / det;
            }
            // By how much the squares would fall, were the fractions linear in the unknowns.
            Pack promised = by[0] * right[0];
            for (std::size_t u = 1; u < unknowns; ++u) promised += by[u] * right[u];
            Pack longest = Pack(0);
            for (Pack& b : by) {
                b = min(max(b * trust, Pack(-0.5)), Pack(0.5));
                longest = max(longest, detail::magnitude(b));
            }
            const Normal next = moved(normal, by);
            // Round-off of differences: 1e-10 of a slope. A short step that brings little needs no proof,
            // unless one like it was found worse.
            active = active & (promised > Pack(1e-18) * now.squares);
            const PackMask little = promised < max(Pack(1e-2) * now.squares, Pack(1e-12));
            const PackMask last_step = active & little & (longest < Pack(1e-3)) & (trust > Pack(0.99));
            for (std::size_t a = 0; a < Dim; ++a) normal[a] = select(last_step, next[a], normal[a]);
            active = active & !last_step;
            if (!any(active)) break;
            const Misfit then = misfit(problem, next);
            const PackMask better = active & (then.squares < now.squares);
            for (std::size_t a = 0; a < Dim; ++a) normal[a] = select(better, next[a], normal[a]);
            const PackMask settled = better & (now.squares - then.squares < Pack(1e-2) * now.squares);
            for (std::size_t k = 0; k < size; ++k) now.each[k] = select(better, then.each[k], now.each[k]);
            now.squares = select(better, then.squares, now.squares);
            trust = select(better, min(Pack(1), trust * Pack(4)), trust * Pack(0.25));
            active = active & !settled & (now.squares > Pack(1e-26)) & (longest > Pack(1e-9));
        }
        return {normal, active};
    }

    detail::Stencil<Dim> stencil_{};
    CellSizes<Dim> sizes_{};
};

}  // namespace abrade
