#pragma once
// Ctrl-C (or a terminal that goes away) asks a run to end well; a second Ctrl-C ends it at once.

#include <signal.h>

#include <array>
#include <atomic>
#include <cstddef>

namespace abrade::examples {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP only sets a flag, to be read between two steps; the
/// next one kills the program as usual. The destructor puts back what was there before. Only one at a time.
class Interrupt {
public:
    Interrupt() {
        flag() = 0;
        struct sigaction action {};
        action.sa_handler = &Interrupt::handle;
        action.sa_flags = SA_RESTART;
        sigemptyset(&action.sa_mask);
        for (std::size_t i = 0; i < signals_.size(); ++i) sigaction(signals_[i], &action, &before_[i]);
    }
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;
    ~Interrupt() {
        for (std::size_t i = 0; i < signals_.size(); ++i) sigaction(signals_[i], &before_[i], nullptr);
    }

    /// Whether a signal came.
    bool requested() const noexcept { return flag() != 0; }

    /// Which one, or 0.
    int signal_number() const noexcept { return flag(); }

private:
    static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

    static std::atomic<int>& flag() noexcept {
        static constinit std::atomic<int> value{0};
        return value;
    }

    static void handle(int number) noexcept {
        if (flag().exchange(number) == 0) return;
        ::signal(number, SIG_DFL);
        ::raise(number);
    }

    static constexpr std::array<int, 3> signals_{SIGINT, SIGTERM, SIGHUP};
    std::array<struct sigaction, 3> before_{};
};

}  // namespace abrade::examples
