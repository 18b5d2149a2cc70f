#pragma once
// How stones travel along a bed: their hops between two touches of it, and a regression for both.

#include <abrade/core/require.hpp>
#include <abrade/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace abrade::examples {

/// From one touch of the bed to the next.
struct Hop {
    Real height = 0;  ///< greatest, of the centroid over where it took off, normal to the bed [m]
    Real length = 0;  ///< along the channel [m]
};

/// Finds the hops of stones that are looked at often. A look sees a touch that lasts as long as the time
/// between two looks; of shorter ones it misses some, and then two hops are one.
class Flights {
public:
    /// What a look sees of a stone: a number of its own, its place along the channel, its centroid's height
    /// over the bed [m], whether it touches the bed. Returns the hop that ends here. What a stone does before
    /// its first touch is none.
    std::optional<Hop> look(Index id, Real x, Real height, bool touches) {
        Flight& flight = with_id(id);
        if (!touches) {
            flight.aloft = true, flight.highest = std::max(flight.highest, height);
            return std::nullopt;
        }
        std::optional<Hop> hop;
        if (flight.touched && flight.aloft) hop = Hop{flight.highest - flight.height, x - flight.x};
        flight = {.id = id, .touched = true, .x = x, .height = height, .highest = height};
        return hop;
    }

    static void fields(auto&& field) { field("flights", &Flights::flights_); }

private:
    struct Flight {
        Index id = 0;
        bool touched = false;                 ///< the bed, at all
        bool aloft = false;                   ///< since then
        Real x = 0, height = 0, highest = 0;  ///< at the last touch, and since then [m]

        static void fields(auto&& field) {
            field("id", &Flight::id), field("touched", &Flight::touched), field("aloft", &Flight::aloft),
                field("x", "m", &Flight::x), field("height", "m", &Flight::height),
                field("highest", "m", &Flight::highest);
        }
    };
    /// Stones are numbered as they come: a new one stands last.
    Flight& with_id(Index id) {
        const auto place = std::ranges::lower_bound(flights_, id, {}, &Flight::id);
        return place != flights_.end() && place->id == id ? *place : *flights_.insert(place, {.id = id});
    }

    std::vector<Flight> flights_;  ///< by id
};

/// Speed and height of the hops of a stone of diameter D in a stream that shears the bed with tau:
///   T = tau* / tau*_c,  tau* = tau / ((rho_s - rho) g D),  R = (rho_s - rho) / rho,
///   U_s = 1.56 sqrt(R g D) (T - 1)^0.56,  H_s = 1.44 D (T - 1)^0.5,
/// fitted to many, mostly subcritical, experiments, which scatter by a factor of 1.5 and more about it. Not a
/// number where T <= 1: such a stone stays. L. Sklar & W. Dietrich 2004, doi:10.1029/2003WR002496.
struct Saltation {
    struct Stone {
        Real diameter = 0, density = 0;  ///< [m], [kg/m3]
    };
    Real shear = 0;        ///< tau [Pa]
    Real water = 1000;     ///< rho [kg/m3]
    Real critical = 0.03;  ///< tau*_c [-]

    Real speed(const Stone& stone) const {  ///< [m/s]
        const Real weight = (stone.density / water - 1) * standard_gravity * stone.diameter;
        return 1.56 * std::sqrt(weight) * std::pow(excess(stone), 0.56);
    }
    Real height(const Stone& stone) const {  ///< [m]
        return 1.44 * stone.diameter * std::sqrt(excess(stone));
    }

private:
    Real excess(const Stone& stone) const {
        const Real shields = shear / ((stone.density - water) * standard_gravity * stone.diameter);
        return shields > critical ? shields / critical - 1 : std::numeric_limits<Real>::quiet_NaN();
    }
};

}  // namespace abrade::examples
