#pragma once
// Edges, faces and volumes of a grid's cells, by their level: the number along the vertical axis, the only
// one along which sizes may change.

#include <abrade/fluid/mesh/grid.hpp>

#include <array>
#include <vector>

namespace abrade {

/// In 2-D per metre of width.
template <int Dim>
class CellSizes {
public:
    static constexpr int vertical = Grid<Dim>::vertical;

    CellSizes() = default;
    explicit CellSizes(const Grid<Dim>& grid) : uniform_(grid.uniform()) {
        for (int k = -ghosts; k < grid.cells(vertical) + ghosts; ++k) {
            One& one = levels_.emplace_back();
            one.volume = 1;
            for (int a = 0; a < Dim; ++a) {
                one.edge[index(a)] = grid.size(a, a == vertical ? k : 0);
                one.volume *= one.edge[index(a)];
            }
            for (int a = 0; a < Dim; ++a) one.face[index(a)] = one.volume / one.edge[index(a)];
            one.gap = grid.gap(vertical, k);
        }
    }

    bool uniform() const noexcept { return uniform_; }
    Real edge(int axis, Index level) const noexcept { return at(level).edge[index(axis)]; }  ///< [m]
    Real face(int axis, Index level) const noexcept { return at(level).face[index(axis)]; }  ///< [m2]
    Real volume(Index level) const noexcept { return at(level).volume; }                     ///< [m3]
    /// From the centre of the level below [m].
    Real gap(Index level) const noexcept { return at(level).gap; }

private:
    static constexpr int ghosts = Layout<Dim>::ghosts;
    struct One {
        std::array<Real, Dim> edge{}, face{};
        Real volume = 0, gap = 0;
    };
    static std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }
    const One& at(Index level) const noexcept { return levels_[index(level + ghosts)]; }

    bool uniform_ = true;
    std::vector<One> levels_;
};

}  // namespace abrade
