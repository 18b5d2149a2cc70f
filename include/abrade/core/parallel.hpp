#pragma once
// The one seam to threads. Results are the same bits for every number of threads: work is cut into
// blocks of fixed size and sums are added up in block order. How much there is to do decides whether a loop
// asks for other threads at all.

#include <abrade/core/types.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <vector>

#if defined(_OPENMP)
#include <omp.h>
#endif

namespace abrade {

/// Threads that a loop may use: 1 without OpenMP, else OMP_NUM_THREADS or the machine's cores.
inline int thread_count() noexcept {
#if defined(_OPENMP)
    return omp_get_max_threads();
#else
    return 1;
#endif
}

inline void set_thread_count([[maybe_unused]] int count) noexcept {
#if defined(_OPENMP)
    omp_set_num_threads(std::max(1, count));
#endif
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
    /// One call, over `items`: `together` says whether by all threads.
    class Call {
    public:
        Call(LoopWork& work, Index items) : work_(work), items_(items) {
            const int threads = thread_count();
            if (threads == 1) return;
            if (share_every_loop.load(std::memory_order_relaxed)) {
                together = true;
                return;
            }
            const std::uint32_t call = 1 + work.calls_.fetch_add(1, std::memory_order_relaxed);
            timed_ = (call & (call - 1)) == 0 || call % 4096 == 0;
            if (timed_) start_ = Clock::now();
            // Less than this for each of them, and waking them costs more than they save [s].
            constexpr double least = 10e-6;
            together = !timed_ && work.per_item_.load(std::memory_order_relaxed) * items > least * threads;
        }
        ~Call() {
            if (timed_) work_.took(std::chrono::duration<double>(Clock::now() - start_).count() / items_);
        }
        Call(const Call&) = delete;
        Call& operator=(const Call&) = delete;

        bool together = false;

    private:
        LoopWork& work_;
        Index items_;
        bool timed_ = false;
        Clock::time_point start_{};
    };

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
    if (items <= 0) return;
    const Index blocks = block_count(items, size);
    static constinit detail::LoopWork work;
    const detail::LoopWork::Call call(work, items);
#if defined(_OPENMP)
#pragma omp parallel for schedule(dynamic) if (call.together && blocks > 1)
#endif
    for (Index block = 0; block < blocks; ++block) {
        const Index first = block * size;
        body(block, first, std::min(items, first + size));
    }
}

/// Calls `body(task)` for each of a few large tasks, in parallel; the same thread gets the same tasks each
/// time, so that what they work on stays in its cache. `body` must not throw.
template <class Body>
void parallel_tasks(Index tasks, Body&& body) {
    if (tasks <= 0) return;
    static constinit detail::LoopWork work;
    const detail::LoopWork::Call call(work, tasks);
#if defined(_OPENMP)
#pragma omp parallel for schedule(static) if (call.together && tasks > 1)
#endif
    for (Index task = 0; task < tasks; ++task) body(task);
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
