#pragma once
// The pressure's operator on cells twice as large.

#include <abrade/fluid/mesh/plane_runs.hpp>
#include <abrade/fluid/pressure/poisson.hpp>

namespace abrade::detail {

/// Calls body(offset) for the cells at the lower end of an axis.
template <int Dim>
void for_face(const Layout<Dim>& l, int axis, auto&& body) {
    CellNumber<Dim> cell{};
    const auto walk = [&](auto&& self, int a) -> void {
        if (a == Dim) return body(l.at(cell));
        for (int i = 0; i < (a == axis ? 1 : l.cells[a]); ++i) {
            cell[a] = i;
            self(self, a + 1);
        }
    };
    walk(walk, 0);
}

template <int Dim>
void close_periodic(Poisson<Dim>& m) {
    // The upper face of the last cell is the lower face of the first.
    const Layout<Dim>& l = m.layout;
    for (int a = 0; a < Dim; ++a) {
        if (!m.periodic[a]) continue;
        if (l.cells[a] == 1) m.face[a].fill(0);  // a cell has no exchange with itself
        const Offset around = l.cells[a] * l.stride[a];
        for_face(l, a, [&](Offset c) { m.face[a][c + around] = m.face[a][c]; });
    }
}

struct RowNumber {
    int plane, row;
};
/// Adds what a fine row conducts to the coarse row that starts at `to`.
template <int Dim>
void gather(const Poisson<Dim>& f, const PerAxis<bool, Dim>& paired, Poisson<Dim>& c, RowNumber at,
            Offset to) {
    const RowRange r = f.range(at.plane, at.row);
    const Offset from = f.layout.row_start(at.plane, at.row);
    const bool pairs = paired[Layout<Dim>::inner];
    const auto parent = [&](int i) { return pairs ? i / 2 : i; };
    const float* const dirichlet = f.dirichlet.data() + from;
    float* const tied = c.dirichlet.data() + to;
    for (int i = r.begin; i < r.end; ++i) tied[parent(i)] += 0.5f * dirichlet[i];
    for (int a = 0; a < Dim; ++a) {
        const float* const face = f.face[a].data() + from;
        float* const sum = c.face[a].data() + to;
        if (a == Layout<Dim>::inner) {
            if (pairs)
                for (int j = (r.begin + 1) / 2; j < (r.end + 1) / 2; ++j) sum[j] += 0.5f * face[2 * j];
            else
                for (int i = r.begin; i < r.end; ++i) sum[i] += face[i];
            continue;
        }
        const int number = a == Layout<Dim>::outer ? at.plane : at.row;
        if (paired[a] && number % 2 != 0) continue;  // inside the coarse cell
        const float share = paired[a] ? 0.5f : 1.0f;
        for (int i = r.begin; i < r.end; ++i) sum[parent(i)] += share * face[i];
    }
}

/// The operator of cells of which each is a pair along the `paired` axes; `runs`: its planes, for threads.
template <int Dim>
void coarsen(const Poisson<Dim>& f, const PerAxis<bool, Dim>& paired, Poisson<Dim>& c,
             const PlaneRuns& runs) {
    const Layout<Dim>&lf = f.layout, &lc = c.layout;
    c.interior = f.interior;
    for (int a = 0; a < Dim; ++a) {
        if (!paired[a]) continue;
        for (int b = 0; b < Dim; ++b) c.interior[b] *= a == b ? 0.5f : 2.0f;
    }
    /// Fine numbers that make up a coarse one.
    const auto children = [&](int a, int i) {
        const int first = paired[a] ? 2 * i : i;
        return RowRange{first, std::min(first + (paired[a] ? 2 : 1), lf.cells[a])};
    };
    parallel_planes(runs, [&](int coarse_plane) {
        const RowRange planes = children(Layout<Dim>::outer, coarse_plane);
        for (int coarse_row = 0; coarse_row < lc.rows_per_plane(); ++coarse_row) {
            const RowRange rows = Dim == 3 ? children(Dim - 1, coarse_row) : RowRange{0, 1};
            RowRange all;
            for (int plane = planes.begin; plane < planes.end; ++plane)
                for (int row = rows.begin; row < rows.end; ++row) all = hull(all, f.range(plane, row));
            if (paired[Layout<Dim>::inner] && !all.empty()) all = {all.begin / 2, (all.end + 1) / 2};
            all = hull(all, c.range(coarse_plane, coarse_row));
            c.look_at(coarse_plane, coarse_row, all);
            if (all.empty()) continue;
            const Offset to = lc.row_start(coarse_plane, coarse_row);
            for (auto& component : c.face)
                std::fill_n(component.data() + to + all.begin, all.length() + 1, 0.0f);
            std::fill_n(c.dirichlet.data() + to + all.begin, all.length(), 0.0f);
            for (int plane = planes.begin; plane < planes.end; ++plane)
                for (int row = rows.begin; row < rows.end; ++row) gather(f, paired, c, {plane, row}, to);
        }
    });
    close_periodic(c);
    parallel_planes(runs, [&](int plane) { c.complete(plane); });
}

}  // namespace abrade::detail
