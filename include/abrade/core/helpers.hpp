#pragma once
// Threads that help the one that asks.

#include <abrade/core/function_ref.hpp>
#include <abrade/core/types.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace abrade::detail {

/// Tells the core that a thread waits.
inline void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

/// What a loop may use.
inline std::atomic<int>& threads_of_loops() noexcept {
    static std::atomic<int> count = [] {
        const char* const told = std::getenv("OMP_NUM_THREADS");
        const int wanted = told ? std::atoi(told) : 0;
        return wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    }();
    return count;
}

/// A few threads that sleep until there is a loop to help with. Who asks works, too, and waits at its end for
/// those alone who have begun: a thread that the machine has no core for costs nothing. A helper looks for
/// the next loop for some ten to a hundred microseconds before it sleeps, so loops that follow each other
/// need not wake it.
class Helpers {
public:
    /// Never destroyed: threads that sleep end with the program.
    static Helpers& one() {
        static Helpers& helpers = *new Helpers;
        return helpers;
    }

    /// Calls task(k) for 0 <= k < tasks by this thread and up to `threads` - 1 others. Each begins with its
    /// own part of them and then takes of the others'. From within a loop, or while another thread asks, by
    /// this thread alone. `task` must not throw: that ends the program where the loop is shared.
    void run(Index tasks, int threads, FunctionRef<Index> task) {
        threads = static_cast<int>(std::min<Index>(threads, tasks));
        std::unique_lock<std::mutex> asks(asking_, std::defer_lock);
        if (threads > 1 && !within_loop() && asks.try_lock()) return share(tasks, threads, task);
        for (Index k = 0; k < tasks; ++k) task(k);
    }

    Helpers(const Helpers&) = delete;
    Helpers& operator=(const Helpers&) = delete;

private:
    /// The next of a part's tasks, on a cache line of its own.
    struct alignas(64) Front {
        std::atomic<Index> next{0};
        Index end = 0;
    };
    static constexpr int closed = 1 << 30, most = 256;
    static constexpr int looks = 2000;  ///< before a thread sleeps: some ten to a hundred microseconds

    Helpers() : fronts_(index(most)) {}

    static std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }
    static bool& within_loop() noexcept {
        thread_local bool within = false;
        return within;
    }

    void share(Index tasks, int threads, FunctionRef<Index> task) noexcept {
        hire(threads - 1);
        task_ = task;
        parts_ = std::min(threads, static_cast<int>(threads_.size()) + 1);
        for (int p = 0; p < parts_; ++p) {
            const auto begin = [&](std::int64_t part) { return static_cast<Index>(tasks * part / parts_); };
            fronts_[index(p)].next.store(begin(p), std::memory_order_relaxed);
            fronts_[index(p)].end = begin(p + 1);
        }
        gate_.store(0, std::memory_order_release);
        loop_.fetch_add(1, std::memory_order_release);
        loop_.notify_all();
        within_loop() = true;
        work(0);
        within_loop() = false;
        // Nobody comes in any more; those within end what they have begun.
        int within = gate_.fetch_or(closed, std::memory_order_acq_rel) | closed;
        for (int look = 0; within != closed; within = gate_.load(std::memory_order_acquire))
            ++look < looks ? relax() : gate_.wait(within, std::memory_order_acquire);
    }

    void hire(int count) {
        count = std::min(count, most - 1);
        try {
            while (static_cast<int>(threads_.size()) < count)
                threads_.emplace_back([this, own = static_cast<int>(threads_.size()) + 1] { help(own); });
        } catch (const std::system_error&) {  // as many as the machine grants
        }
    }

    void help(int own) {
        within_loop() = true;  // a loop within a task is its own
        for (int known = 0;;) {
            for (int look = 0; look < looks && loop_.load(std::memory_order_acquire) == known; ++look)
                relax();
            loop_.wait(known, std::memory_order_acquire);
            known = loop_.load(std::memory_order_acquire);
            int within = gate_.load(std::memory_order_relaxed);
            while ((within & closed) == 0 &&
                   !gate_.compare_exchange_weak(within, within + 1, std::memory_order_acq_rel))
                continue;
            if ((within & closed) != 0) continue;
            if (own < parts_) work(own);
            if (gate_.fetch_sub(1, std::memory_order_acq_rel) == closed + 1) gate_.notify_one();
        }
    }

    void work(int own) {
        for (int p = 0; p < parts_; ++p) {
            Front& front = fronts_[index((own + p) % parts_)];
            for (;;) {
                if (front.next.load(std::memory_order_relaxed) >= front.end) break;
                const Index k = front.next.fetch_add(1, std::memory_order_relaxed);
                if (k >= front.end) break;
                task_(k);
            }
        }
    }

    std::mutex asking_;
    std::vector<std::thread> threads_;
    std::vector<Front> fronts_;  ///< [part]
    FunctionRef<Index> task_;
    int parts_ = 1;
    std::atomic<int> loop_{0};       ///< counts loops
    std::atomic<int> gate_{closed};  ///< helpers within the loop, and whether it is closed
};

}  // namespace abrade::detail
