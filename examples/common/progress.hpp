#pragma once
// One line on a terminal that says how far a run is and how long it will take.

#include <abrade/core/types.hpp>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

namespace abrade::examples {

/// "95 s" as "1:35", "4000 s" as "1:06:40".
inline std::string clock_text(Real seconds) {
    const long s = static_cast<long>(std::clamp(seconds, 0.0, 3.5e9) + 0.5);
    char text[32];
    if (s >= 3600)
        std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", s / 3600, s / 60 % 60, s % 60);
    else
        std::snprintf(text, sizeof text, "%ld:%02ld", s / 60, s % 60);
    return text;
}

/// Draws on stderr where that is a terminal, a few times per second; is silent elsewhere. Clears its line at
/// the end.
class Progress {
public:
    /// `end` is the value of `update` at which the run is done; `unit` is written behind it.
    Progress(std::string label, Real end, std::string unit = "s", Real start = 0)
        : label_{std::move(label)}, unit_{std::move(unit)}, start_{start}, end_{end},
          shown_{isatty(STDERR_FILENO) != 0} {}
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    ~Progress() { clear(); }

    /// Cheap enough for every step. `note` is put at the end of the line: "312 stones".
    void update(Real now, std::string_view note = {}) {
        if (!shown_) return;
        const auto time = Clock::now();
        if (drawn_ && time - last_ < std::chrono::milliseconds{250}) return;
        last_ = time;
        drawn_ = true;
        std::fprintf(stderr, "\r\033[K%s",
                     line(now, std::chrono::duration<Real>(time - begin_).count(), note).c_str());
        std::fflush(stderr);
    }

    /// The text of the line after `elapsed` seconds: "invert channel  42 %  2.1 of 5 s, 0:30 left, 312
    /// stones".
    std::string line(Real now, Real elapsed, std::string_view note = {}) const {
        const Real done = end_ > start_ ? std::clamp((now - start_) / (end_ - start_), 0.0, 1.0) : 1.0;
        char numbers[64];
        std::snprintf(numbers, sizeof numbers, "  %3.0f %%  %.3g of %.3g ", 100 * done, now, end_);
        std::string text = label_ + numbers + unit_;
        if (done > 0 && elapsed > 1) text += ", " + clock_text(elapsed * (1 - done) / done) + " left";
        if (!note.empty()) text.append(", ").append(note);
        return text;
    }

    /// Removes the line, so that something else can be printed; the next `update` draws it again.
    void clear() {
        if (drawn_) std::fputs("\r\033[K", stderr);
        drawn_ = false;
    }

private:
    using Clock = std::chrono::steady_clock;
    std::string label_;
    std::string unit_;
    Real start_;
    Real end_;
    bool shown_;
    bool drawn_ = false;
    Clock::time_point begin_ = Clock::now();
    Clock::time_point last_{};
};

}  // namespace abrade::examples
