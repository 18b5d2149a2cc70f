#pragma once
// Planes of a grid shared out to threads.

#include <abrade/core/parallel.hpp>
#include <abrade/fluid/mesh/grid.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace abrade::detail {

/// Where runs of neighbouring planes begin, one run a thread, and behind them the number of planes.
using PlaneRuns = std::vector<int>;

/// Runs with about as many cells in `range(plane, row)`, each of at least `least` planes (even), where there
/// are so many. They begin at even planes: a pair, which is one plane of a coarser grid, has one thread.
template <int Dim, class Range>
PlaneRuns plane_runs(const Layout<Dim>& layout, int least, Range&& range) {
    const int planes = layout.planes(), rows = layout.rows_per_plane();
    const int count = std::clamp(planes / least, 1, thread_count());
    PlaneRuns runs{0};
    if (count > 1) {
        std::vector<std::int64_t> before{0};  // cells below each plane
        for (int plane = 0; plane < planes; ++plane) {
            std::int64_t cells = before.back() + rows;  // a dry row costs a look
            for (int row = 0; row < rows; ++row) cells += range(plane, row).length();
            before.push_back(cells);
        }
        for (int run = 1; run < count; ++run) {
            const std::int64_t share = before.back() * run / count;
            const int at = static_cast<int>(std::ranges::lower_bound(before, share) - before.begin());
            runs.push_back(std::clamp(at, runs.back() + least, planes - (count - run) * least) / 2 * 2);
        }
    }
    runs.push_back(planes);
    return runs;
}

/// Calls body(first, last) for parts [first, last) of all runs: the whole of an only run, else parts of a
/// sixteenth of it, of `least` planes (even) at least, that begin at even planes. A thread has a run of its
/// own, part by part; when it is done it helps with the others': cells do not all cost the same, and cores
/// have other work. So body meets its neighbours at work, in any order, and writes to its own planes only. It
/// must not throw.
inline void parallel_parts(const PlaneRuns& runs, int least, FunctionRef<int, int> body) {
    const std::size_t count = runs.size() - 1;
    if (count == 1) return body(0, runs.back());
    struct alignas(64) Front {
        std::atomic<int> plane;
    };
    std::vector<Front> fronts(count);
    for (std::size_t run = 0; run < count; ++run) fronts[run].plane = runs[run];
    parallel_runs(static_cast<Index>(count), [&](Index task) {
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t run = (static_cast<std::size_t>(task) + k) % count;
            const int end = runs[run + 1], part = std::max(least, (end - runs[run]) / 32 * 2);
            const auto next = [&] { return fronts[run].plane.fetch_add(part, std::memory_order_relaxed); };
            for (int first = next(); first < end; first = next()) body(first, std::min(first + part, end));
        }
    });
}

/// Calls body(plane) for all planes, in parallel, as `parallel_parts` does.
template <class Body>
void parallel_planes(const PlaneRuns& runs, Body&& body) {
    parallel_parts(runs, 2, [&](int first, int last) {
        for (int plane = first; plane < last; ++plane) body(plane);
    });
}

}  // namespace abrade::detail
