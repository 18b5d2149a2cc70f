#pragma once
// Velocities of the air beside water: the water's, carried on outward.

#include <abrade/fluid/wet_rows.hpp>

#include <cstdint>
#include <vector>

namespace abrade {

/// Gives faces between dry cells the mean of the known velocities around them, layer by layer outward from
/// the water, as far as the stencils of the next step reach. Known are faces of wet cells; beyond the first
/// layer also those that hold liquid of their own, which fly on as they do.
template <int Dim>
class VelocityExtension {
public:
    static constexpr int layers = 3;

    explicit VelocityExtension(const Layout<Dim>& layout)
        : layout_(layout), known_(layout.total, 0), before_(layout) {}

    /// `wet`: cells whose pressure is known, ghosts included; `rows`: rows to be looked at; `held`: share of
    /// a cell that liquid fills; `open_area` may be none.
    template <class State>
    void extend(FaceField<Dim, State>& u, const Field<std::uint8_t>& wet, const WetRows<Dim>& rows,
                const Field<State>& held, const FaceField<Dim>* open_area) {
        // Where water has left nothing is known any more.
        before_.for_each_row([&](int plane, int row, const RowRange& r) {
            std::fill_n(known_.data() + layout_.row_start(plane, row) + r.begin, r.length(), std::uint8_t{0});
        });
        before_ = rows;
        for (int a = 0; a < Dim; ++a) {
            const Offset back = layout_.stride[a];
            faces_.clear();
            for (int plane = 0; plane < layout_.planes(); ++plane)
                for (int row = 0; row < layout_.rows_per_plane(); ++row) {
                    const RowRange r = rows.row(plane, row);
                    const Offset start = layout_.row_start(plane, row);
                    for (int i = r.begin; i < r.end; ++i) {
                        const Offset c = start + i;
                        if (open_area && (*open_area)[a][c] == 0) {
                            known_[c] = 0;
                            u[a][c] = 0;
                        } else if ((wet[c] | wet[c - back]) != 0) {
                            known_[c] = 1;
                        } else {
                            known_[c] = 0;
                            if (!at_low_side(a, plane, row, i)) faces_.push_back(c);
                        }
                    }
                }
            for (std::uint8_t layer = 2; layer < 2 + layers; ++layer) {
                next_.clear();
                for (const Offset c : faces_) {
                    State sum = 0;
                    int count = 0;
                    for (const Offset s : layout_.stride)
                        for (const Offset n : {c - s, c + s})
                            if (known_[n] != 0 && known_[n] < layer) sum += u[a][n], ++count;
                    if (count > 0) {
                        u[a][c] = sum / static_cast<State>(count);
                        known_[c] = layer;
                    } else {
                        next_.push_back(c);
                    }
                }
                if (layer == 2)  // drops and sheets thinner than a cell
                    for (const Offset c : next_)
                        if (held[c] + held[c - back] > State(1e-6)) known_[c] = 2;
                faces_.clear();
                for (const Offset c : next_)
                    if (known_[c] == 0) faces_.push_back(c);
            }
            for (const Offset c : faces_) u[a][c] = 0;
        }
    }

private:
    bool at_low_side(int axis, int plane, int row, int i) const noexcept {
        return (axis == 0 ? plane : axis == 1 ? i : row) == 0;
    }
    Layout<Dim> layout_;
    Field<std::uint8_t> known_;
    WetRows<Dim> before_;  ///< looked at the last time
    std::vector<Offset> faces_, next_;
};

}  // namespace abrade
