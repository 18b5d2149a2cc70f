#pragma once
// Bodies that are small against cells, spread over the faces of a staggered grid.

#include <abrade/core/parallel.hpp>
#include <abrade/coupling/drag/dense_drag.hpp>
#include <abrade/coupling/mapping/solid_cover.hpp>
#include <abrade/fluid/mesh/wet_rows.hpp>

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// What a spread body has of a face of its cloud.
struct SpreadPart {
    std::uint32_t face = 0;  ///< number in the cloud
    Real share = 0;          ///< sigma, of the face's control volume [-]
};

/// Bodies spread over what walls and other solids leave: each about its centroid, whatever its shape, by a
/// triangle along each axis that has the variance of a ball of three diameters, or of three cells where these
/// are wider. Its parts hold the body's volume along each axis: a pressure that is linear in space pushes
/// with rho g V. All bodies together cover its faces.
class SpreadCloud {
public:
    /// `which`: numbers of those among `bodies` that are spread; `open(axis, face)`: share that is left of a
    /// face.
    template <class Open>
    void place(const Grid<3>& grid, const BoundaryConditions<3>& boundaries, std::span<const FlowBody> bodies,
               std::vector<std::size_t> which, Open&& open) {
        which_ = std::move(which);
        spread_.resize(which_.size());
        parallel_for(
            static_cast<Index>(which_.size()),
            [&](Index n) {
                spread({grid, boundaries}, bodies[which_[index(n)]], open, spread_[index(n)]);
            },
            block_of_bodies);
        gather(grid.layout());
    }

    std::span<const std::size_t> which() const noexcept { return which_; }
    std::size_t count() const noexcept { return which_.size(); }
    Real reach(std::size_t n) const noexcept { return spread_[n].reach; }
    /// Of the n-th of them, along an axis.
    std::span<const SpreadPart> parts(std::size_t n, int axis) const noexcept {
        return spread_[n].parts[axis];
    }

    std::size_t faces() const noexcept { return start_.empty() ? 0 : start_.back(); }
    /// Number of the first face on a plane.
    std::size_t first_on(int plane) const noexcept { return start_[index(3 * plane)]; }

    /// After `place`: gives parts the numbers of their faces, which go on in memory as the grid's do. Calls
    /// visit(number, face, of which all bodies cover the share), in parallel.
    void number(const detail::GridNumbers& in, auto&& visit) {
        if (which_.empty()) return;
        for_planes(in.grid.layout(), [&](int plane, int axis) {
            std::size_t n = start_[index(3 * plane + axis)];
            SolidFace f{.axis = axis, .plane = plane};
            for_each_covered(plane, axis, [&](int row, int i, Offset face) {
                const CellNumber<3> cell{plane, i, row};
                f.gap = in.centre(axis, cell[axis]) - in.centre(axis, cell[axis] - 1);
                f.area = 1;
                for (int a = 0; a < 3; ++a)
                    if (a != axis) f.area *= in.size(a, cell[a]);
                CellNumber<3> below = cell;
                below[axis] = in.wrapped(axis, cell[axis] - 1);
                f.face = face, f.low = in.grid.layout().at(below);
                f.share = std::exchange(covered_[axis][face], 0);
                number_[axis][index(face)] = static_cast<std::uint32_t>(n);
                visit(n++, std::as_const(f));
            });
        });
        parallel_for(
            static_cast<Index>(spread_.size()),
            [&](Index n) {
                Spread& one = spread_[index(n)];
                for (int axis = 0; axis < 3; ++axis)
                    for (std::size_t i = 0; i < one.at[axis].size(); ++i)
                        one.parts[axis][i].face = number_[axis][index(one.at[axis][i])];
            },
            block_of_bodies);
    }

private:
    static std::size_t index(std::integral auto i) noexcept { return static_cast<std::size_t>(i); }
    struct Spread {
        Real reach = 0;  ///< [m]
        PerAxis<std::vector<SpreadPart>, 3> parts;
        PerAxis<std::vector<Offset>, 3> at;    ///< their faces
        PerAxis<PerAxis<RowRange, 3>, 3> box;  ///< numbers of these along each axis
    };
    struct Layer {
        int number = 0;
        Real weight = 0, size = 0;  ///< [-]; of its control volumes [m]
    };

    /// Part of a triangle that is `half` wide to either side, below a place x from its middle [-].
    static Real below(Real x, Real half) noexcept {
        const Real t = std::clamp(x / half, -1.0, 1.0);
        return t < 0 ? 0.5 * square(1 + t) : 1 - 0.5 * square(1 - t);
    }
    /// Layers of control volumes inside the box, along `a`.
    static void find_layers(const detail::GridNumbers& in, int a, bool faces, Real middle, Real half,
                            std::vector<Layer>& layers) {
        layers.clear();
        const int first = in.cell_at(a, middle - half), last = in.cell_at(a, middle + half) + (faces ? 1 : 0);
        for (int i = first; i <= last; ++i) {
            const bool inside = in.boundaries.periodic(a) || (i >= (faces ? 1 : 0) && i < in.grid.cells(a));
            if (!inside) continue;
            const Real low = faces ? in.centre(a, i - 1) : in.face(a, i);
            const Real high = faces ? in.centre(a, i) : in.face(a, i + 1);
            const Real weight = below(high - middle, half) - below(low - middle, half);
            if (weight > 0) layers.push_back({in.wrapped(a, i), weight, high - low});
        }
    }

    template <class Open>
    static void spread(const detail::GridNumbers& in, const FlowBody& body, const Open& open, Spread& to) {
        constexpr Real least = 0.02, most = 0.9;  // of the largest weight; of a face
        to.reach = spread_radius(body.diameter(), in.cell_width(body.position));
        const Real half = triangle_half(to.reach);
        PerAxis<std::vector<Layer>, 3> layers;
        for (int axis = 0; axis < 3; ++axis) {
            auto& parts = to.parts[axis];
            auto& at = to.at[axis];
            parts.clear(), at.clear(), to.box[axis].fill({});
            Real sum = 0, largest = 1;
            for (int a = 0; a < 3; ++a) {
                find_layers(in, a, a == axis, body.position[a], half, layers[a]);
                Real top = 0;
                for (const Layer& layer : layers[a]) {
                    top = std::max(top, layer.weight);
                    to.box[axis][a] = hull(to.box[axis][a], {layer.number, layer.number + 1});
                }
                largest *= top;
            }
            for (const Layer& x : layers[0])
                for (const Layer& z : layers[2])
                    for (const Layer& y : layers[1]) {
                        const Real weight = x.weight * y.weight * z.weight;
                        if (weight < least * largest) continue;
                        const Offset face = in.grid.layout().at({x.number, y.number, z.number});
                        const Real has = weight * open(axis, face);
                        if (!(has > 0)) continue;
                        parts.push_back({0, has / (x.size * y.size * z.size)});
                        at.push_back(face), sum += has;
                    }
            for (SpreadPart& part : parts) part.share = std::min(part.share * body.volume / sum, most);
        }
    }

    /// What all of them cover of each face, and how many faces that are on each plane.
    void gather(const Layout<3>& layout) {
        start_.assign(index(3 * layout.planes() + 1), 0);
        if (which_.empty()) return;
        if (covered_[0].size() == 0) {
            covered_ = face_field<3>(layout);
            for (auto& numbers : number_) numbers.resize(index(layout.total));
        }
        parallel_tasks(3, [&](Index axis) {  // which share no face
            rows_[axis] = WetRows<3>(layout);
            for (const Spread& one : spread_) {
                for (std::size_t i = 0; i < one.at[axis].size(); ++i)
                    covered_[axis][one.at[axis][i]] += one.parts[axis][i].share;
                const auto& box = one.box[axis];
                for (int plane = box[0].begin; plane < box[0].end; ++plane)
                    for (int row = box[2].begin; row < box[2].end; ++row)
                        rows_[axis].row(plane, row) = hull(rows_[axis].row(plane, row), box[1]);
            }
        });
        for_planes(layout, [&](int plane, int axis) {
            std::size_t& count = start_[index(3 * plane + axis + 1)];
            for_each_covered(plane, axis, [&](int, int, Offset) { ++count; });
        });
        std::partial_sum(start_.begin(), start_.end(), start_.begin());
    }
    static void for_planes(const Layout<3>& layout, auto&& body) {
        parallel_for(
            layout.planes(),
            [&](Index plane) {
                for (int axis = 0; axis < 3; ++axis) body(static_cast<int>(plane), axis);
            },
            block_of_planes);
    }
    void for_each_covered(int plane, int axis, auto&& visit) const {
        const Layout<3>& layout = rows_[axis].layout();
        for (int row = 0; row < layout.rows_per_plane(); ++row) {
            const RowRange range = rows_[axis].row(plane, row);
            const Offset start = layout.row_start(plane, row);
            for (int i = range.begin; i < range.end; ++i)
                if (covered_[axis][start + i] > 0) visit(row, i, start + i);
        }
    }

    std::vector<std::size_t> which_;
    std::vector<Spread> spread_;
    std::vector<std::size_t> start_;                 ///< [3 plane + axis] number of its first face
    FaceField<3> covered_;                           ///< share of a face until it gets its number, or 0
    PerAxis<WetRows<3>, 3> rows_;                    ///< that hold all of them
    PerAxis<std::vector<std::uint32_t>, 3> number_;  ///< of faces
};

}  // namespace abrade
