#pragma once
// The discrete Poisson operator of the pressure on one grid, and what works on it row by row.

#include <abrade/fluid/wet_rows.hpp>

#include <algorithm>

namespace abrade {

/// The operator of a finite volume on one grid,
///   (A e)_c = sum over faces g (e_c - e_neighbour) + d_c e_c,
/// with g the conductance of a face, area / distance / density ratio, and d that of the faces at which e = 0.
/// A face has one number, so A is symmetric; rows sum up to d exactly. Cells with no conductance at all take
/// no part. In single precision: it is a preconditioner, and what it leaves is computed anew in double.
template <int Dim>
struct Poisson {
    static constexpr int outer = Layout<Dim>::outer, inner = Layout<Dim>::inner;

    Layout<Dim> layout;
    PerAxis<bool, Dim> periodic{};
    PerAxis<Field<float>, Dim> face;  ///< g of a cell's lower face
    Field<float> dirichlet;           ///< d
    Field<float> inverse_diagonal;    ///< 1 / (sum g + d), 0 where that is 0
    std::vector<RowRange> rows;       ///< [plane * rows_per_plane + row] cells that take part

    Poisson() = default;
    Poisson(const Layout<Dim>& l, const PerAxis<bool, Dim>& repeats)
        : layout(l), periodic(repeats), face(face_field<Dim, float>(l)), dirichlet(l.total),
          inverse_diagonal(l.total), rows(static_cast<std::size_t>(l.planes() * l.rows_per_plane())) {}

    RowRange& range(int plane, int row) noexcept {
        return rows[static_cast<std::size_t>(plane * layout.rows_per_plane() + row)];
    }
    RowRange range(int plane, int row) const noexcept {
        return rows[static_cast<std::size_t>(plane * layout.rows_per_plane() + row)];
    }

    /// From a cell to its neighbours across a periodic side or not.
    struct Neighbours {
        PerAxis<Offset, Dim> low, high;
    };
    Neighbours neighbours(int plane, int row) const noexcept {
        Neighbours n;
        for (int a = 0; a < Dim; ++a) n.low[a] = -layout.stride[a], n.high[a] = layout.stride[a];
        const auto wrap = [&](int axis, int i) {
            const Offset around = (layout.cells[axis] - 1) * layout.stride[axis];
            if (periodic[axis] && i == 0) n.low[axis] = around;
            if (periodic[axis] && i == layout.cells[axis] - 1) n.high[axis] = -around;
        };
        wrap(outer, plane);
        if constexpr (Dim == 3) wrap(2, row);
        return n;
    }
    /// Along a row a cell finds its neighbour across the periodic side in a ghost.
    void join_row(Field<float>& x, Offset row) const noexcept {
        if (!periodic[inner]) return;
        const int n = layout.row_length();
        x[row - 1] = x[row + n - 1];
        x[row + n] = x[row];
    }

    /// One half of a Gauss-Seidel sweep in red-black order on a row: cells of one colour get the value that
    /// meets their equation. Vectors compute both colours and store one.
    void smooth(Field<float>& x, const Field<float>& b, int plane, int row, int colour) const noexcept {
        const RowRange r = range(plane, row);
        if (r.empty()) return;
        const Offset start = layout.row_start(plane, row);
        join_row(x, start);
        const Terms t(*this, x, plane, row, start);
        float* const out = x.data() + start;
        const float* const __restrict right = b.data() + start;
        const float* const __restrict inverse = inverse_diagonal.data() + start;
        const int parity = (plane + row + colour) & 1;
        // Lanes read neighbours of the other colour only, which no lane changes.
#pragma omp simd
        for (int i = r.begin; i < r.end; ++i) {
            const float value = (right[i] + t.sum(i)) * inverse[i];
            if (((i ^ parity) & 1) == 0) out[i] = value;
        }
    }

    /// The first half sweep from x = 0.
    void smooth_zero(Field<float>& x, const Field<float>& b, int plane, int row, int colour) const noexcept {
        const RowRange r = range(plane, row);
        const Offset start = layout.row_start(plane, row);
        float* const __restrict out = x.data() + start;
        const float* const __restrict right = b.data() + start;
        const float* const __restrict inverse = inverse_diagonal.data() + start;
        const int parity = (plane + row + colour) & 1;
#pragma omp simd
        for (int i = r.begin; i < r.end; ++i) out[i] = ((i ^ parity) & 1) == 0 ? right[i] * inverse[i] : 0.0f;
    }

    /// out[i] = (b - A x) of a row, i from the row's cell 0.
    void residual(Field<float>& x, const Field<float>& b, int plane, int row,
                  float* __restrict out) const noexcept {
        const RowRange r = range(plane, row);
        const Offset start = layout.row_start(plane, row);
        join_row(x, start);
        const Terms t(*this, x, plane, row, start);
        const float* const __restrict right = b.data() + start;
#pragma omp simd
        for (int i = r.begin; i < r.end; ++i) out[i] = right[i] - t.product(i);
    }

    /// out = A x on a row; returns x . A x there.
    double apply(Field<float>& x, Field<float>& out, int plane, int row) const noexcept {
        const RowRange r = range(plane, row);
        const Offset start = layout.row_start(plane, row);
        join_row(x, start);
        const Terms t(*this, x, plane, row, start);
        float* const __restrict to = out.data() + start;
        const float* const __restrict from = x.data() + start;
        float sum = 0;
#pragma omp simd reduction(+ : sum)
        for (int i = r.begin; i < r.end; ++i) {
            to[i] = t.product(i);
            sum += to[i] * from[i];
        }
        return sum;
    }

    /// From faces and `dirichlet` all the rest: the inverse diagonal, periodic copies, the range of each row.
    void complete(int plane) noexcept {
        for (int row = 0; row < layout.rows_per_plane(); ++row) {
            const Offset start = layout.row_start(plane, row);
            const int n = layout.row_length();
            RowRange r{n, 0};
            for (int i = 0; i < n; ++i) {
                const Offset c = start + i;
                float sum = dirichlet[c];
                for (int a = 0; a < Dim; ++a) sum += face[a][c] + face[a][c + layout.stride[a]];
                inverse_diagonal[c] = sum > 0 ? 1 / sum : 0;
                if (sum > 0) r.begin = std::min(r.begin, i), r.end = i + 1;
            }
            range(plane, row) = r.empty() ? RowRange{} : r;
        }
    }

private:
    /// Pointers of one row, so that loops over it are loops over plain arrays.
    struct Terms {
        PerAxis<const float*, Dim> low_face, high_face, low, high;
        const float *x, *dirichlet;

        Terms(const Poisson& m, const Field<float>& values, int plane, int row, Offset start) noexcept
            : x(values.data() + start), dirichlet(m.dirichlet.data() + start) {
            const Neighbours n = m.neighbours(plane, row);
            for (int a = 0; a < Dim; ++a) {
                low_face[a] = m.face[a].data() + start;
                high_face[a] = low_face[a] + m.layout.stride[a];
                low[a] = x + n.low[a];
                high[a] = x + n.high[a];
            }
        }
        float sum(int i) const noexcept {
            float s = low_face[0][i] * low[0][i] + high_face[0][i] * high[0][i];
            for (int a = 1; a < Dim; ++a) s += low_face[a][i] * low[a][i] + high_face[a][i] * high[a][i];
            return s;
        }
        float product(int i) const noexcept {
            float s = dirichlet[i] * x[i];
            for (int a = 0; a < Dim; ++a)
                s += low_face[a][i] * (x[i] - low[a][i]) + high_face[a][i] * (x[i] - high[a][i]);
            return s;
        }
    };
};

}  // namespace abrade
