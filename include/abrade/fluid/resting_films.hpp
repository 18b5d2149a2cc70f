#pragma once
// Films thinner than half a cell, on sides that something presses them on.

#include <abrade/fluid/row_starts.hpp>
#include <abrade/fluid/water_cells.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace abrade::detail {

/// Liquid between dry cells has no pressure: it flies on as it is, and gravity makes it faster. Of a film on
/// a closed side that would be the face between its cell and the next one. It is kept from moving into the
/// side where that next cell is empty: no pressure would ever stop it.
template <int Dim>
class RestingFilms {
public:
    /// `pressed`: axes along which anything presses on sides.
    RestingFilms(const Grid<Dim>& grid, const Sides<Dim>& sides, const PerAxis<bool, Dim>& pressed)
        : stride_(grid.layout().stride) {
        for (int a = 0; a < Dim; ++a)
            for (const bool high : {false, true}) {
                if (!pressed[a] || !is_closed(sides[a][high]) || grid.cells(a) == 1) continue;
                const Offset s = stride_[a];
                grid.for_each_beside(a, high, [&](const CellNumber<Dim>&, Offset c) {
                    faces_.push_back({a, high ? c : c + s, high ? c - s : c + s, high ? 1.0 : -1.0});
                });
            }
        const auto film = [&](const Face& f) { return f.into > 0 ? f.face : f.face - stride_[f.axis]; };
        std::ranges::stable_sort(faces_, {}, film);
        starts_ = {grid.layout(), faces_.size(), [&](std::size_t k) { return film(faces_[k]); }};
    }

    /// `wet`: 1 where there is a pressure; `held`: liquid of a cell, as a share of it [-]; `rows` hold it.
    void hold(FaceField<Dim>& u, const WetRows<Dim>& rows, const Field<std::uint8_t>& wet,
              const Field<Real>& held) const {
        starts_.for_each(&rows, [&](std::size_t k) {
            const Face& f = faces_[k];
            Real& speed = u[f.axis][f.face];
            if (!(speed * f.into > 0) || (wet[f.face] | wet[f.face - stride_[f.axis]]) != 0) return;
            if (held[f.beyond] <= liquid_of_a_face) speed = 0;
        });
    }

private:
    struct Face {
        int axis = 0;
        Offset face = 0, beyond = 0;  ///< beyond: the cell that the film does not lie in
        Real into = 0;                ///< the side: -1 or 1
    };
    PerAxis<Offset, Dim> stride_;
    std::vector<Face> faces_;
    RowStarts<Dim> starts_;
};

}  // namespace abrade::detail
