#pragma once
// Which steps bodies take: all of them, many as one in free flight, none asleep.

#include <abrade/core/fields.hpp>
#include <abrade/core/types.hpp>

#include <algorithm>
#include <limits>
#include <vector>

namespace abrade {

/// `beside_sleeper` takes every step, and tells when it becomes fast. What comes after it takes none.
enum class IntegrationMode : std::uint8_t { every_step, beside_sleeper, flying, asleep };

/// Bodies that nothing can touch before lists are looked through again, and on which only their weight and a
/// fluid act, take all steps until then as one, at the acceleration of halfway. Fixed ones take none.
struct FreeFlight {
    bool allowed = true;
    Real kicks = 0;    ///< since they took off: sum of kicks [s]
    Real drifts = 0;   ///< of drifts [s]
    Real area = 0;     ///< of each drift times the kicks before it [s2]
    Real last = 0;     ///< the last drift [s]
    Real start = 0;    ///< time of the first kick's loads [s]
    Real now = 0;      ///< that of the places reached [s]
    Real fastest = 0;  ///< as they took off [m/s]
    Real hardest = 0;  ///< no acceleration of theirs is beyond this [m/s2]
    Real margin = 0;   ///< from where they took off to the nearest bound of space [m]
    Real horizon = std::numeric_limits<Real>::infinity();  ///< drag is slow over so long a flight [s]
    Index held = 0;                                        ///< spheres that would fly but for inner pairs
    bool sound = true;                                     ///< all that landed is where numbers are finite

    static void fields(auto&& field) {
        field("allowed", &FreeFlight::allowed), field("kicks", "s", &FreeFlight::kicks),
            field("drifts", "s", &FreeFlight::drifts), field("area", "s2", &FreeFlight::area),
            field("last", "s", &FreeFlight::last), field("start", "s", &FreeFlight::start),
            field("now", "s", &FreeFlight::now), field("fastest", "m/s", &FreeFlight::fastest),
            field("hardest", "m/s2", &FreeFlight::hardest), field("margin", "m", &FreeFlight::margin),
            field("horizon", "s", &FreeFlight::horizon), field("held", &FreeFlight::held),
            field("sound", &FreeFlight::sound);
    }

    void note(Real kick, Real drift, Real time) noexcept {
        if (kicks == 0) start = time;
        kicks += kick, drifts += drift, area += drift * kicks, now = time + drift;
        if (drift > 0) last = drift;
    }
    /// Begins anew from the places reached.
    void begin() noexcept {
        margin -= furthest(), fastest += kicks * hardest;
        kicks = drifts = area = last = 0, start = now;
    }

    /// No further than this have they come [m].
    Real furthest() const noexcept { return fastest * drifts + area * hardest; }
    Real fastest_now() const noexcept { return fastest + kicks * hardest; }  ///< [m/s]

    Vec3 velocity(const Vec3& from, const Vec3& acceleration) const noexcept {
        return from + kicks * acceleration;
    }
    Vec3 place(const Vec3& from, const Vec3& velocity, const Vec3& acceleration) const noexcept {
        return from + drifts * velocity + area * acceleration;
    }
    /// What forces are paired with in the ledger: the sum of kicks times mean velocities [m].
    Vec3 displacement(const Vec3& velocity, const Vec3& acceleration) const noexcept {
        return kicks * (velocity + 0.5 * kicks * acceleration);
    }
};

/// Bodies that have been slow for long and rest on something take no steps until something stirs them.
/// Contacts of two that rest are not evaluated: what they store stays as it is.
struct Sleep {
    static constexpr Index steps_between_looks = 200;
    /// A sleeper wakes where what supports it has changed by this share of the strongest force of its
    /// contacts, or of its weight if that is more [-].
    static constexpr Real allowed_change = 0.1;

    /// Share of the threshold below which nobody asks whether a body gets faster: round-off does that [-].
    static constexpr Real still = 0.01;

    struct Body {
        bool asleep = false;
        bool rouse = false;           ///< is to wake with the next look at the lists
        bool watched = false;         ///< was near one awake: its support may have changed
        Real slow_for = 0;            ///< [s]
        Real slowest2 = 0;            ///< square of the lowest speed in that time [m2/s2]
        Vec3 support = Vec3::Zero();  ///< of contacts and fluid, as it fell asleep [N]
        Real strongest = 0;           ///< of those forces and its weight [N]
        static void fields(auto&& field) {
            field("asleep", &Body::asleep), field("rouse", &Body::rouse), field("watched", &Body::watched),
                field("slow_for", "s", &Body::slow_for), field("slowest2", "m2/s2", &Body::slowest2),
                field("support", "N", &Body::support), field("strongest", "N", &Body::strongest);
        }
    };

    Real speed = 0;            ///< below which a body is slow, its centre and its rim; 0: nobody sleeps [m/s]
    Real after = 0;            ///< how long it must have been [s]
    Real toppling = 0;         ///< and how long over the root of its diameter [s/m^(1/2)]
    std::vector<Body> bodies;  ///< [body]; may be shorter: the rest is awake
    std::vector<char> rests;   ///< [slot, images too] asleep or fixed; empty where nobody is asleep
    Index count = 0;           ///< of those asleep
    bool stirred = false;      ///< somebody may have to wake
    bool watch_all = false;    ///< bodies left: anybody may have lost support
    bool changed = false;      ///< who sleeps, since `stored_at_rest` was asked for

    static void fields(auto&& field) {
        field("speed", "m/s", &Sleep::speed), field("after", "s", &Sleep::after),
            field("toppling", "s/m^(1/2)", &Sleep::toppling), field("bodies", &Sleep::bodies),
            field("rests", &Sleep::rests), field("count", &Sleep::count), field("stirred", &Sleep::stirred),
            field("watch_all", &Sleep::watch_all), field("changed", &Sleep::changed);
    }

    bool asleep(Index body) const noexcept {
        const auto b = static_cast<std::size_t>(body);
        return b < bodies.size() && bodies[b].asleep;
    }
    bool is_fast(Real speed2) const noexcept { return speed2 > speed * speed; }
};

}  // namespace abrade
