#pragma once
// Numbers that go with the cells of a row.

#include <abrade/fluid/grid.hpp>

#include <vector>

namespace abrade::detail {

/// A number that is the same for a whole row in 3-D; in 2-D rows are vertical and it may change with the
/// level.
template <int Dim, class State>
class RowValue {
public:
    template <class Of>
    RowValue(std::vector<State>& room, int first, int last, Of&& of) {
        if constexpr (Dim == 3) {
            value_ = static_cast<State>(of(0));
        } else {
            room.clear();
            for (int i = first; i < last; ++i) room.push_back(static_cast<State>(of(i)));
            values_ = room.data() - first;
        }
    }
    State operator[](int i) const noexcept {
        if constexpr (Dim == 3)
            return value_;
        else
            return values_[i];
    }

private:
    State value_ = 0;
    const State* values_ = nullptr;
};

}  // namespace abrade::detail
