#pragma once
// How much solid has passed a place.

#include <abrade/core/fields.hpp>
#include <abrade/dem/store/particles.hpp>

#include <optional>
#include <utility>
#include <vector>

namespace abrade {

/// Volume of stones [m3] that passed x = `place` [m], net downstream. Without a place it counts nothing.
class FlowCounter {
public:
    FlowCounter() = default;
    explicit FlowCounter(std::optional<Real> place) : place_(place) {}

    Real passed() const noexcept { return passed_; }

    void count(const Particles& particles) {
        if (!place_) return;
        for (Index b = 0; b < particles.bodies(); ++b) see(particles, b, particles.position[at(b)].x());
    }
    /// A stone that leaves from x, where it is now; `particles` may be older.
    void leave(const Particles& particles, Index body, Real x) {
        if (place_) see(particles, body, x);
    }

    /// Of bodies that have come since; `gone` [body] marks those that leave.
    void grow(const Particles& particles) {
        for (std::size_t b = past_.size(); b < particles.position.size(); ++b)
            past_.push_back(place_ && particles.position[b].x() >= *place_);
    }
    void remove(const std::vector<char>& gone) { remove_rows(past_, gone); }

    static void fields(auto&& field) {
        field("passed", "m3", &FlowCounter::passed_), field("past", &FlowCounter::past_);
    }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }
    void see(const Particles& particles, Index body, Real x) {
        if (particles.kind[at(body)] != Kind::stone) return;
        const char past = x >= *place_;
        passed_ += particles.volume[at(body)] * (past - std::exchange(past_[at(body)], past));
    }

    std::optional<Real> place_;
    Real passed_ = 0;
    std::vector<char> past_;  ///< [body]
};

}  // namespace abrade
