#pragma once
// Several passes over a grid in one: planes go through all stages while they are in cache.

#include <abrade/fluid/mesh/plane_runs.hpp>

namespace abrade::detail {

/// Most stages of a wave, and planes that a run then needs, lest the wedges at its ends touch.
inline constexpr int most_stages = 6, shortest_run = 2 * most_stages;

/// Calls stage(s, plane) for stages 0 <= s < stages and all planes of `runs`, such that a stage finds
/// planes plane - 1, plane and plane + 1 after stage s - 1 and before stage s + 1. A plane follows its stage
/// as a wave: it is loaded once for all of them.
///
/// Threads get a run of planes each, of `shortest_run` at least. Near the ends of a run stages wait for the
/// neighbour's planes; those that are left over, a wedge of planes at each end, follow when all runs are
/// done. The order in which a plane is worked on, and so every bit, is the same for any number of threads.
/// `joined`: the last plane and the first are neighbours.
template <class Stage>
void wavefront(const PlaneRuns& runs, int stages, bool joined, Stage&& stage) {
    const int planes = runs.back();
    if (joined && planes < 2 * stages) {  // a wedge would meet itself
        for (int s = 0; s < stages; ++s)
            for (int plane = 0; plane < planes; ++plane) stage(s, plane);
        return;
    }
    const auto count = static_cast<Index>(runs.size()) - 1;
    const auto start = [&](Index run) { return runs[static_cast<std::size_t>(run)]; };
    parallel_runs(count, [&](Index run) {
        const int first = start(run), last = start(run + 1);
        const int open_below = run > 0 || joined, open_above = run + 1 < count || joined;
        for (int front = first; front < last + stages - 1; ++front)
            for (int s = 0; s < stages; ++s) {
                const int plane = front - s;
                if (plane >= first + open_below * s && plane < last - open_above * s) stage(s, plane);
            }
    });
    if (stages == 1 || (count == 1 && !joined)) return;
    parallel_runs(joined ? count : count - 1, [&](Index wedge) {
        const int seam = start(wedge + 1);
        for (int s = 1; s < stages; ++s)
            for (int plane = seam - s; plane < seam + s; ++plane) stage(s, plane % planes);
    });
}

}  // namespace abrade::detail
