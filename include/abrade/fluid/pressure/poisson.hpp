#pragma once
// The discrete Poisson operator of the pressure on one grid, and what works on it row by row.

#include <abrade/fluid/mesh/wet_rows.hpp>

#include <algorithm>

namespace abrade {

/// The operator of a finite volume on one grid,
///   (A e)_c = sum over faces g (e_c - e_neighbour) + d_c e_c,
/// with g the conductance of a face, area / distance / density ratio, and d that of the faces at which e = 0.
/// A face has one number, so A is symmetric; rows sum up to d exactly. Cells with no conductance at all take
/// no part. In single precision: it is a preconditioner, and what it leaves is computed anew in double.
template <int Dim>
struct Poisson {
    static constexpr int outer = Layout<Dim>::outer, inner = Layout<Dim>::inner, lanes = Layout<Dim>::lanes;

    Layout<Dim> layout;
    PerAxis<bool, Dim> periodic{};
    PerAxis<Field<float>, Dim> face;  ///< g of a cell's lower face
    Field<float> dirichlet;           ///< d
    Field<float> inverse_diagonal;    ///< 1 / (sum g + d), 0 where that is 0
    PerAxis<float, Dim> interior{};   ///< g between cells that lie amid others
    std::vector<RowRange> rows;       ///< [plane * rows_per_plane + row] cells that take part
    std::vector<RowRange> even_rows;  ///< and those of them whose faces all conduct `interior`

    Poisson() = default;
    Poisson(const Layout<Dim>& l, const PerAxis<bool, Dim>& repeats)
        : layout(l), periodic(repeats), face(face_field<Dim, float>(l)), dirichlet(l.total),
          inverse_diagonal(l.total),
          rows(static_cast<std::size_t>(l.planes() * l.rows_per_plane()), {0, l.row_length()}),
          even_rows(rows) {}

    RowRange range(int plane, int row) const noexcept { return rows[index(plane, row)]; }

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
    /// meets their equation. Packs compute both colours and keep one.
    void smooth(Field<float>& x, const Field<float>& b, int plane, int row, int colour) const noexcept {
        const Offset start = layout.row_start(plane, row);
        const float* const right = b.data() + start;
        float* const out = x.data() + start;
        const int parity = (plane + row + colour) & 1;
        for_packs(x, plane, row, [&](const auto& terms, int first) {
            // Cells that take no part have no diagonal and stay 0.
            alignas(64) float value[lanes];
#pragma omp simd
            for (int k = 0; k < lanes; ++k) value[k] = terms.solved(right[first + k], first + k);
#pragma omp simd
            for (int k = 0; k < lanes; ++k)
                out[first + k] = ((k ^ parity) & 1) == 0 ? value[k] : out[first + k];
        });
    }

    /// The first half sweep from x = 0.
    void smooth_zero(Field<float>& x, const Field<float>& b, int plane, int row, int colour) const noexcept {
        const Offset start = layout.row_start(plane, row);
        const float* const __restrict right = b.data() + start;
        float* const __restrict out = x.data() + start;
        const int parity = (plane + row + colour) & 1;
        for_packs(x, plane, row, [&](const auto& terms, int first) {
#pragma omp simd
            for (int k = 0; k < lanes; ++k)
                out[first + k] =
                    right[first + k] * (((k ^ parity) & 1) == 0 ? terms.inverse(first + k) : 0.0f);
        });
    }

    /// out[i] = (b - A x) of a row, i from the row's cell 0; 0 in what its last packs hold beyond its range.
    void residual(Field<float>& x, const Field<float>& b, int plane, int row,
                  float* __restrict out) const noexcept {
        const float* const __restrict right = b.data() + layout.row_start(plane, row);
        for_packs(x, plane, row, [&](const auto& terms, int first) {
#pragma omp simd
            for (int k = 0; k < lanes; ++k) out[first + k] = right[first + k] - terms.product(first + k);
        });
    }

    /// out = A x on a row; returns x . A x there.
    double apply(Field<float>& x, Field<float>& out, int plane, int row) const noexcept {
        const Offset start = layout.row_start(plane, row);
        float* const __restrict to = out.data() + start;
        const float* const __restrict from = x.data() + start;
        const int n = layout.row_length();
        alignas(64) float sums[lanes] = {};
        for_packs(x, plane, row, [&](const auto& terms, int first) {
#pragma omp simd
            for (int k = 0; k < lanes; ++k) {
                const float product = terms.product(first + k);
                to[first + k] = product;
                sums[k] += product * (first + k < n ? from[first + k] : 0.0f);  // no ghosts
            }
        });
        float sum = 0;
        for (const float s : sums) sum += s;
        return static_cast<double>(sum);
    }

    /// Over the cells of a plane that take part.
    double dot(const Field<float>& x, const Field<float>& y, int plane) const noexcept {
        double total = 0;
        for_rows(plane, [&](Offset start, RowRange r) {
            const float *const p = x.data() + start, *const q = y.data() + start;
            float sum = 0;
#pragma omp simd reduction(+ : sum)
            for (int i = r.begin; i < r.end; ++i) sum += p[i] * q[i];
            total += static_cast<double>(sum);
        });
        return total;
    }
    /// Calls body(start, range) for the rows of a plane that are not empty.
    void for_rows(int plane, auto&& body) const noexcept {
        for (int row = 0; row < layout.rows_per_plane(); ++row)
            if (const RowRange r = range(plane, row); !r.empty()) body(layout.row_start(plane, row), r);
    }

    /// Before `complete`: which cells of a row may take part, those of the last time included.
    void look_at(int plane, int row, RowRange cells) noexcept { rows[index(plane, row)] = cells; }

    /// From faces, `dirichlet` and `interior` all the rest on a plane: the inverse diagonal, the ranges of
    /// rows.
    void complete(int plane) noexcept {
        for (int row = 0; row < layout.rows_per_plane(); ++row) {
            const RowRange within = range(plane, row);
            if (within.empty()) continue;
            const Offset start = layout.row_start(plane, row);
            RowRange r{within.end, within.begin};
            for (int i = within.begin; i < within.end; ++i) {
                const Offset c = start + i;
                float sum = dirichlet[c];
                for (int a = 0; a < Dim; ++a) sum += face[a][c] + face[a][c + layout.stride[a]];
                inverse_diagonal[c] = sum > 0 ? 1 / sum : 0;
                if (sum > 0) r.begin = std::min(r.begin, i), r.end = i + 1;
            }
            rows[index(plane, row)] = r.empty() ? RowRange{} : r;
            even_rows[index(plane, row)] = even_part(start, r);
        }
    }

private:
    std::size_t index(int plane, int row) const noexcept {
        return static_cast<std::size_t>(plane * layout.rows_per_plane() + row);
    }

    /// The longest run of packs of cells that lie amid others; none: empty, at the end.
    RowRange even_part(Offset start, RowRange r) const noexcept {
        RowRange longest{Layout<Dim>::pack(r.end + lanes - 1), 0}, run;
        longest.end = longest.begin;
        for (int i = Layout<Dim>::pack(r.begin); i < r.end; i += lanes) {
            bool even = i >= r.begin && i + lanes <= r.end;
            for (int k = i; even && k < i + lanes; ++k) {
                even = dirichlet[start + k] == 0;
                for (int a = 0; a < Dim; ++a)
                    even = even && face[a][start + k] == interior[a] &&
                           face[a][start + k + layout.stride[a]] == interior[a];
            }
            if (!even) continue;
            run = run.end == i && !run.empty() ? RowRange{run.begin, i + lanes} : RowRange{i, i + lanes};
            if (run.length() > longest.length()) longest = run;
        }
        return longest;
    }

    /// Calls body(terms, first) for the packs of a row.
    void for_packs(Field<float>& x, int plane, int row, auto&& body) const noexcept {
        const RowRange r = rows[index(plane, row)], even = even_rows[index(plane, row)];
        if (r.empty()) return;
        const Offset start = layout.row_start(plane, row);
        join_row(x, start);
        const Terms terms(*this, x, plane, row, start);
        const EvenTerms even_terms(*this, terms);
        for (int i = Layout<Dim>::pack(r.begin); i < even.begin; i += lanes) body(terms, i);
        for (int i = even.begin; i < even.end; i += lanes) body(even_terms, i);
        for (int i = even.end; i < r.end; i += lanes) body(terms, i);
    }

    /// Pointers of one row, so that loops over it are loops over plain arrays. Neighbours along the row stand
    /// beside a cell; in 2-D there are none along the third axis, and the terms of it are left out.
    struct Terms {
        const float *x, *dirichlet, *diagonal, *along;
        PerAxis<const float*, Dim - 1> low_face, high_face, low, high;

        Terms(const Poisson& m, const Field<float>& values, int plane, int row, Offset start) noexcept
            : x(values.data() + start), dirichlet(m.dirichlet.data() + start),
              diagonal(m.inverse_diagonal.data() + start), along(m.face[inner].data() + start) {
            const Neighbours n = m.neighbours(plane, row);
            for (int k = 0; k < Dim - 1; ++k) {
                const int a = axis(k);
                low_face[k] = m.face[a].data() + start;
                high_face[k] = low_face[k] + m.layout.stride[a];
                low[k] = x + n.low[a];
                high[k] = x + n.high[a];
            }
        }
        float inverse(int i) const noexcept { return diagonal[i]; }
        /// What x must be for a cell's equation to hold.
        float solved(float right, int i) const noexcept {
            float sum = right + (along[i] * x[i - 1] + along[i + 1] * x[i + 1]) + across(0, i);
            if constexpr (Dim == 3) sum += across(1, i);
            return sum * diagonal[i];
        }
        float product(int i) const noexcept {
            float sum = dirichlet[i] * x[i] +
                        (along[i] * (x[i] - x[i - 1]) + along[i + 1] * (x[i] - x[i + 1])) + drop(0, i);
            if constexpr (Dim == 3) sum += drop(1, i);
            return sum;
        }
        static constexpr int axis(int k) noexcept { return k == 0 ? outer : Dim - 1; }

    private:
        float across(int k, int i) const noexcept {
            return low_face[k][i] * low[k][i] + high_face[k][i] * high[k][i];
        }
        float drop(int k, int i) const noexcept {
            return low_face[k][i] * (x[i] - low[k][i]) + high_face[k][i] * (x[i] - high[k][i]);
        }
    };

    /// The same where all faces conduct alike.
    struct EvenTerms {
        const float* x;
        PerAxis<const float*, Dim - 1> low, high;
        float along, diagonal;
        PerAxis<float, Dim - 1> g;

        EvenTerms(const Poisson& m, const Terms& terms) noexcept
            : x(terms.x), low(terms.low), high(terms.high), along(m.interior[inner]), diagonal(along) {
            for (int k = 0; k < Dim - 1; ++k) g[k] = m.interior[Terms::axis(k)], diagonal += g[k];
            diagonal = 1 / (2 * diagonal);
        }
        float inverse(int) const noexcept { return diagonal; }
        float solved(float right, int i) const noexcept {
            float sum = right + along * (x[i - 1] + x[i + 1]) + g[0] * (low[0][i] + high[0][i]);
            if constexpr (Dim == 3) sum += g[1] * (low[1][i] + high[1][i]);
            return sum * diagonal;
        }
        float product(int i) const noexcept {
            float sum = along * ((x[i] - x[i - 1]) + (x[i] - x[i + 1])) +
                        g[0] * ((x[i] - low[0][i]) + (x[i] - high[0][i]));
            if constexpr (Dim == 3) sum += g[1] * ((x[i] - low[1][i]) + (x[i] - high[1][i]));
            return sum;
        }
    };
};

}  // namespace abrade
