#pragma once
// Several passes over a grid in one: planes go through all stages while they are in cache.

#include <abrade/core/parallel.hpp>

namespace abrade::detail {

/// Calls stage(s, plane) for stages 0 <= s < stages and planes 0 <= plane < planes, such that a stage finds
/// planes plane - 1, plane and plane + 1 after stage s - 1 and before stage s + 1. A plane follows its stage
/// as a wave: it is loaded once for all of them.
///
/// Threads get a run of planes each. Near the ends of a run stages wait for the neighbour's planes; those
/// that are left over, a wedge of planes at each end, follow when all runs are done. The order in which a
/// plane is worked on, and so every bit, is the same for any number of threads. `joined`: the last plane and
/// the first are neighbours.
template <class Stage>
void wavefront(int planes, int stages, bool joined, int runs, Stage&& stage) {
    if (joined && planes < 2 * stages) {  // a wedge would meet itself
        for (int s = 0; s < stages; ++s)
            for (int plane = 0; plane < planes; ++plane) stage(s, plane);
        return;
    }
    runs = std::clamp(planes / (2 * stages + 2), 1, std::max(1, runs));
    const auto start = [&](Index run) { return static_cast<int>(std::int64_t{planes} * run / runs / 2 * 2); };
    const auto end = [&](Index run) { return run + 1 == runs ? planes : start(run + 1); };
    parallel_tasks(runs, [&](Index run) {
        const int first = start(run), last = end(run);
        const int open_below = run > 0 || joined, open_above = run + 1 < runs || joined;
        for (int front = first; front < last + stages - 1; ++front)
            for (int s = 0; s < stages; ++s) {
                const int plane = front - s;
                if (plane >= first + open_below * s && plane < last - open_above * s) stage(s, plane);
            }
    });
    if (stages == 1 || (runs == 1 && !joined)) return;
    parallel_tasks(joined ? runs : runs - 1, [&](Index wedge) {
        const int seam = end(joined ? (wedge + runs - 1) % runs : wedge);
        for (int s = 1; s < stages; ++s)
            for (int plane = seam - s; plane < seam + s; ++plane) stage(s, plane % planes);
    });
}

}  // namespace abrade::detail
