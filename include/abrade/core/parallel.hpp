#pragma once
// The one seam to threads. Results are the same bits for every number of threads: work is cut into
// blocks of fixed size and sums are added up in block order. How much there is to do decides whether a loop
// asks for other threads at all.

#include <abrade/core/function_ref.hpp>
#include <abrade/core/helpers.hpp>
#include <abrade/core/types.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <vector>

namespace abrade {

/// Threads that a loop may use: what OMP_NUM_THREADS says, else as many as the machine has for the program.
inline int thread_count() noexcept { return detail::threads_of_loops().load(std::memory_order_relaxed); }

inline void set_thread_count(int count) noexcept {
    detail::threads_of_loops().store(std::max(1, count), std::memory_order_relaxed);
}

/// Items per block. Small enough to share out, large enough that a block repays its bookkeeping.
inline constexpr Index block_size = 256;
/// The same where an item is a body of many spheres, or as much work.
inline constexpr Index block_of_bodies = 16;
/// The same where an item is a plane of a grid.
inline constexpr Index block_of_planes = 32;

constexpr Index block_count(Index items, Index size = block_size) noexcept {
    return (items + size - 1) / size;
}

namespace detail {

/// Whether loops ask for all threads, however little there is to do: for tests.
inline std::atomic<bool> share_every_loop{false};

/// What an item of one loop of a program takes alone, measured at its calls 1, 2, 4, 8, ..., later each
/// 4096th: so a small loop costs no look at the clock, and a large one no thread that waits. A call that
/// something else on the machine has held up is not believed: the shorter of the last two counts.
class LoopWork {
    using Clock = std::chrono::steady_clock;

public:
    /// Calls task(k) for 0 <= k < tasks, of `items` altogether, by as many threads as are worth waking.
    void run(Index tasks, Index items, FunctionRef<Index> task) {
        const auto by = [&](int threads) { Helpers::one().run(tasks, threads, task); };
        const int threads = thread_count();
        if (threads <= 1 || tasks <= 1 || share_every_loop.load(std::memory_order_relaxed))
            return by(threads);
        const std::uint32_t call = 1 + calls_.fetch_add(1, std::memory_order_relaxed);
        if ((call & (call - 1)) == 0 || call % 4096 == 0) {
            const auto start = Clock::now();
            by(1);
            took(std::chrono::duration<double>(Clock::now() - start).count() / items);
            return;
        }
        // Less than this for each of them, and waking them costs more than they save [s].
        constexpr double least = 20e-6;
        const double share = per_item_.load(std::memory_order_relaxed) * items / least;
        by(share < threads ? static_cast<int>(share) : threads);
    }

private:
    void took(double per_item) noexcept {
        const double last = last_.exchange(per_item, std::memory_order_relaxed);
        per_item_.store(std::min(per_item, last), std::memory_order_relaxed);
    }

    std::atomic<std::uint32_t> calls_{0};
    std::atomic<double> last_{1}, per_item_{0};  ///< [s]
};

}  // namespace detail

/// Calls `body(block, first, last)` for each block of [0, items); blocks run in any order, in parallel.
/// `body` must not throw.
template <class Body>
void parallel_blocks(Index items, Body&& body, Index size = block_size) {
    static constinit detail::LoopWork work;
    work.run(block_count(items, size), items, [&](Index block) {
        const Index first = block * size;
        body(block, first, std::min(items, first + size));
    });
}

/// Calls `body(task)` for each of a few large tasks, in parallel; the same thread begins with the same tasks
/// each time, so that what they work on stays in its cache. `body` must not throw.
template <class Body>
void parallel_tasks(Index tasks, Body&& body) {
    static constinit detail::LoopWork work;
    work.run(tasks, tasks, body);
}

/// The same of tasks that are known to be worth other threads: of runs of a large grid's planes.
inline void parallel_runs(Index runs, detail::FunctionRef<Index> body) {
    detail::Helpers::one().run(runs, thread_count(), body);
}

/// Calls `body(i)` for each i in [0, items), in parallel. `body` must not throw.
template <class Body>
void parallel_for(Index items, Body&& body, Index size = block_size) {
    parallel_blocks(
        items,
        [&](Index, Index first, Index last) {
            for (Index i = first; i < last; ++i) body(i);
        },
        size);
}

/// Sum of `term(i)` over [0, items), the same bits for every number of threads.
/// `Sum` is default-constructed as zero and has `+=`.
template <class Sum, class Term>
Sum parallel_sum(Index items, Term&& term, Index size = block_size) {
    std::vector<Sum> partial(static_cast<std::size_t>(block_count(items, size)), Sum{});
    parallel_blocks(
        items,
        [&](Index block, Index first, Index last) {
            Sum sum{};
            for (Index i = first; i < last; ++i) sum += term(i);
            partial[static_cast<std::size_t>(block)] = sum;
        },
        size);
    Sum total{};
    for (const Sum& sum : partial) total += sum;
    return total;
}

/// Largest `term(i)` over [0, items), 0 or more; not a number where a term is none.
template <class Term>
Real parallel_max(Index items, Term&& term, Index size = block_size) {
    std::vector<Real> partial(static_cast<std::size_t>(block_count(items, size)), 0);
    const auto raise = [](Real& most, Real value) {
        if (!(value <= most)) most = value;
    };
    parallel_blocks(
        items,
        [&](Index block, Index first, Index last) {
            for (Index i = first; i < last; ++i) raise(partial[static_cast<std::size_t>(block)], term(i));
        },
        size);
    Real largest = 0;
    for (const Real most : partial) raise(largest, most);
    return largest;
}

}  // namespace abrade
