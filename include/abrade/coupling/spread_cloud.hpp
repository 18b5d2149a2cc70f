#pragma once
// Bodies that are small against cells, spread over the faces of a staggered grid.

#include <abrade/core/parallel.hpp>
#include <abrade/coupling/dense_drag.hpp>
#include <abrade/coupling/solid_cover.hpp>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// What a spread body has of a face of its cloud.
struct SpreadPart {
    std::uint32_t face = 0;  ///< number in the cloud
    Real share = 0;          ///< sigma, of the face's control volume [-]
};

/// Bodies spread over what walls and other solids leave: each of their spheres by a triangle along each axis
/// that has the variance of a ball of three diameters, or of three cells where these are wider. Its parts
/// hold the body's volume along each axis: a pressure that is linear in space pushes with rho g V. All bodies
/// together cover its faces.
class SpreadCloud {
public:
    /// `which`: numbers of those among `bodies` that are spread; `open(axis, face)`: share that is left of a
    /// face.
    template <class Open>
    void place(const Grid<3>& grid, const Sides<3>& sides, std::span<const FlowBody> bodies,
               std::vector<std::size_t> which, Open&& open) {
        which_ = std::move(which);
        spread_.resize(which_.size());
        parallel_blocks(
            static_cast<Index>(which_.size()),
            [&](Index, Index first, Index last) {
                for (auto n = static_cast<std::size_t>(first); n < static_cast<std::size_t>(last); ++n)
                    spread({grid, sides}, bodies[which_[n]], open, spread_[n]);
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

    std::size_t faces() const noexcept { return start_[3]; }
    /// The i-th of them, and the share that all bodies cover.
    SolidFace face(const detail::GridNumbers& in, std::size_t i) const noexcept {
        int axis = 0;
        while (i >= start_[axis + 1]) ++axis;
        const Covered& covered = faces_[axis][i - start_[axis]];
        SolidFace f = face_of(in, axis, covered.face);
        f.share = covered.share;
        return f;
    }

private:
    struct Covered {
        Offset face = 0;
        Real share = 0;
    };
    struct Spread {
        Real reach = 0;  ///< [m]
        PerAxis<std::vector<SpreadPart>, 3> parts;
        PerAxis<std::vector<Offset>, 3> at;  ///< their faces
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
            const bool inside = in.sides.periodic(a) || (i >= (faces ? 1 : 0) && i < in.grid.cells(a));
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
            parts.clear(), at.clear();
            Real sum = 0;
            for (const Sphere& s : body.spheres) {
                Real largest = body.spheres.size() > 1 ? cube(s.radius) : 1;
                const Real volume = largest;
                for (int a = 0; a < 3; ++a) {
                    find_layers(in, a, a == axis, s.centre[a], half, layers[a]);
                    Real top = 0;
                    for (const Layer& layer : layers[a]) top = std::max(top, layer.weight);
                    largest *= top;
                }
                for (const Layer& x : layers[0])
                    for (const Layer& y : layers[1])
                        for (const Layer& z : layers[2]) {
                            const Real weight = volume * x.weight * y.weight * z.weight;
                            if (weight < least * largest) continue;
                            const Offset face = in.grid.layout().at({x.number, y.number, z.number});
                            const Real has = weight * open(axis, face);
                            if (!(has > 0)) continue;
                            parts.push_back({0, has / (x.size * y.size * z.size)});
                            at.push_back(face), sum += has;
                        }
            }
            for (SpreadPart& part : parts) part.share = std::min(part.share * body.volume / sum, most);
        }
    }
    static Real control_volume(const detail::GridNumbers& in, int axis, Offset face) noexcept {
        const CellNumber<3> n = in.grid.layout().number(face);
        Real volume = in.centre(axis, n[axis]) - in.centre(axis, n[axis] - 1);
        for (int a = 0; a < 3; ++a)
            if (a != axis) volume *= in.size(a, n[a]);
        return volume;
    }

    /// Numbers the faces that any of them has a part in; axes share none.
    void gather(const Layout<3>& layout) {
        constexpr std::uint32_t none = ~std::uint32_t{0};
        for (auto& faces : faces_) faces.clear();
        start_.fill(0);
        if (which_.empty()) return;
        if (number_[0].empty())
            for (auto& numbers : number_) numbers.assign(static_cast<std::size_t>(layout.total), none);
        parallel_tasks(3, [&](Index axis) {
            auto& faces = faces_[axis];
            for (Spread& one : spread_)
                for (std::size_t i = 0; i < one.parts[axis].size(); ++i) {
                    const Offset face = one.at[axis][i];
                    std::uint32_t& number = number_[axis][static_cast<std::size_t>(face)];
                    if (number == none) {
                        number = static_cast<std::uint32_t>(faces.size());
                        faces.push_back({face, 0});
                    }
                    one.parts[axis][i].face = number;
                    faces[number].share += one.parts[axis][i].share;
                }
            for (const Covered& f : faces) number_[axis][static_cast<std::size_t>(f.face)] = none;
        });
        for (std::size_t axis = 0; axis < 3; ++axis) start_[axis + 1] = start_[axis] + faces_[axis].size();
        parallel_for(static_cast<Index>(spread_.size()), [&](Index n) {
            for (std::size_t axis = 1; axis < 3; ++axis)
                for (SpreadPart& part : spread_[static_cast<std::size_t>(n)].parts[axis])
                    part.face += static_cast<std::uint32_t>(start_[axis]);
        });
    }
    static SolidFace face_of(const detail::GridNumbers& in, int axis, Offset face) noexcept {
        const Layout<3>& l = in.grid.layout();
        CellNumber<3> below = l.number(face);
        SolidFace f{.face = face, .axis = axis, .plane = std::min(below[Layout<3>::outer], l.planes() - 1)};
        f.gap = in.centre(axis, below[axis]) - in.centre(axis, below[axis] - 1);
        f.area = control_volume(in, axis, face) / f.gap;
        below[axis] = in.wrapped(axis, below[axis] - 1);
        f.low = l.at(below);
        return f;
    }

    std::vector<std::size_t> which_;
    std::vector<Spread> spread_;
    PerAxis<std::vector<Covered>, 3> faces_;
    PerAxis<std::size_t, 4> start_{};                ///< [axis] number of its first face
    PerAxis<std::vector<std::uint32_t>, 3> number_;  ///< of faces, while they are gathered
};

}  // namespace abrade
