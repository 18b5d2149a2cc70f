#pragma once
// Planes of a grid shared out to threads.

#include <abrade/core/parallel.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace abrade::detail {

/// Where runs of neighbouring planes begin, one run a thread, and behind them the number of planes.
using PlaneRuns = std::vector<int>;

/// Runs of about the same weight, each of at least `least` planes (even), where there are so many. They begin
/// at even planes: a pair, which is one plane of a coarser grid, has one thread.
template <class Weight>
PlaneRuns plane_runs(int planes, int least, Weight&& weight) {
    const int count = std::clamp(planes / least, 1, thread_count());
    PlaneRuns runs{0};
    if (count > 1) {
        std::vector<std::int64_t> before{0};  // weight below each plane
        for (int plane = 0; plane < planes; ++plane) before.push_back(before.back() + weight(plane));
        for (int run = 1; run < count; ++run) {
            const std::int64_t share = before.back() * run / count;
            const int at = static_cast<int>(std::ranges::lower_bound(before, share) - before.begin());
            runs.push_back(std::clamp(at, runs.back() + least, planes - (count - run) * least) / 2 * 2);
        }
    }
    runs.push_back(planes);
    return runs;
}

/// Calls body(plane) for all planes, a run to each thread.
template <class Body>
void parallel_planes(const PlaneRuns& runs, Body&& body) {
    parallel_tasks(static_cast<Index>(runs.size()) - 1, [&](Index run) {
        const auto r = static_cast<std::size_t>(run);
        for (int plane = runs[r]; plane < runs[r + 1]; ++plane) body(plane);
    });
}

}  // namespace abrade::detail
