#pragma once
// What is known of each body for the sake of what acts on it beside contacts.

#include <abrade/coupling/drag/drag.hpp>
#include <abrade/dem/store/particles.hpp>

#include <vector>

namespace abrade {

/// Columns beside Particles; P: Policies.
template <class P>
struct BodiesInFluid {
    /// [body] that drag or the user's force was last reckoned with [m/s]; empty without either.
    std::vector<Vec3> velocity;
    std::vector<FlowLoad> load;  ///< [body] from the last exchange with a fluid that resolves bodies

    void grow(const Particles& particles) {
        if constexpr (P::looks_ahead)
            for (std::size_t b = velocity.size(); b < particles.velocity.size(); ++b)
                velocity.push_back(particles.velocity[b]);
        if constexpr (P::fluid_resolves) load.resize(particles.velocity.size());
    }
    void remove(const std::vector<char>& gone) {
        if constexpr (P::looks_ahead) remove_rows(velocity, gone);
        if constexpr (P::fluid_resolves) remove_rows(load, gone);
    }

    static void fields(auto&& field) {
        field("velocity", "m/s", &BodiesInFluid::velocity), field("load", &BodiesInFluid::load);
    }
};

}  // namespace abrade
