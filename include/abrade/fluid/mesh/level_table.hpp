#pragma once
// Numbers that depend on the level of a cell alone: sizes, areas, and what is made of them.

#include <abrade/fluid/mesh/grid.hpp>

#include <vector>

namespace abrade::detail {

/// One number per level, those of ghosts but the lowest included, and 0 beyond as far as packs look.
template <int Dim, class State>
class LevelTable {
public:
    LevelTable() = default;
    /// `of(level)`.
    LevelTable(const Grid<Dim>& grid, auto&& of) {
        constexpr int g = Layout<Dim>::ghosts;
        values_.assign(lanes + 1, State(0));
        for (int level = 1 - g; level < grid.cells(Grid<Dim>::vertical) + g; ++level)
            values_.push_back(static_cast<State>(of(level)));
        values_.resize(values_.size() + lanes, State(0));
    }

    /// Of the cells of a row: in 3-D it is the same for all of them, in 2-D rows are vertical.
    class Row {
    public:
        explicit Row(const State* first) noexcept : first_(first), value_(*first) {}
        State operator[](int i) const noexcept {
            if constexpr (Dim == 3)
                return value_;
            else
                return first_[i];
        }

    private:
        const State* first_;
        State value_;
    };
    /// `row` as in Layout: in 3-D its level.
    Row row(int row) const noexcept {
        return Row(values_.data() + lanes + Layout<Dim>::ghosts + (Dim == 3 ? row : 0));
    }

private:
    static constexpr int lanes = Layout<Dim>::lanes;
    std::vector<State> values_;
};

}  // namespace abrade::detail
