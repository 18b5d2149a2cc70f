#pragma once
// From a restitution to the damping that brings it about.

#include <abrade/core/require.hpp>

#include <cmath>
#include <string_view>

namespace abrade {

inline void require_restitution(Real value, std::string_view field) {
    require(value > 0 && value <= 1,
            {field, "in (0, 1]", "", "1 loses nothing, 0.5 three quarters of the energy"}, value);
}

/// Of the dashpot that brings pressed contacts to rest, in laws whose impacts lose by other means.
inline void require_rest_damping(Real value, std::string_view field) {
    require(value >= 0 && value <= 0.5,
            {field, "in [0, 0.5]", "", "it is a share of critical damping; 0 lets a pressed bed ring"},
            value);
}

/// Which masses set the dashpot of a contact, c = 2 zeta sqrt(k m).
enum class DampingMass {
    both,  ///< 1/m = 1/m_i + 1/m_j, whatever else holds the two; restitution e between two free bodies
    /// 1/m = sum of 1/m over the free bodies: a concrete sphere that bonds tie to the ground counts as held,
    /// like a fixed one. Where both are held, as `both`.
    free
};

inline void require_damping_mass(DampingMass value, std::string_view field) {
    require(value == DampingMass::both || value == DampingMass::free,
            {field, "DampingMass::both or DampingMass::free", "",
             "free counts a bonded concrete sphere as held, both as if no bond held it"},
            static_cast<Real>(value));
}

/// Ratio of critical damping zeta that gives restitution e when the contact cannot pull.
/// A contact that ends when its force falls to zero has
///   e = exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)),             zeta < 1,
///   e = exp(-2 zeta acosh(zeta) / sqrt(zeta^2 - 1)),            zeta > 1,
/// inverted here by bisection. Throws InputError for a restitution outside (0, 1]. T. Schwager, T. Poeschel,
/// Granular Matter 9 (2007) 465, doi:10.1007/s10035-007-0065-z.
inline Real damping_ratio_without_tension(Real restitution) {
    require_restitution(restitution, "damping_ratio_without_tension.restitution");
    const auto restitution_of = [](Real zeta) {
        const Real s2 = 1 - zeta * zeta;
        if (std::abs(s2) < 1e-12) return std::exp(-2.0);
        const Real angle = s2 > 0 ? std::acos(zeta) : std::acosh(zeta);
        return std::exp(-2 * zeta * angle / std::sqrt(std::abs(s2)));
    };
    Real low = 0, high = 1;
    while (restitution_of(high) > restitution) high *= 2;
    for (int i = 0; i < 200 && high - low > 1e-16 * high; ++i) {
        const Real middle = 0.5 * (low + high);
        (restitution_of(middle) > restitution ? low : high) = middle;
    }
    return restitution == 1 ? 0 : 0.5 * (low + high);
}

/// The same for a contact that may pull until its overlap ends: zeta = -ln e / sqrt(pi^2 + ln^2 e). Throws
/// InputError for a restitution outside (0, 1].
inline Real damping_ratio_with_tension(Real restitution) {
    require_restitution(restitution, "damping_ratio_with_tension.restitution");
    const Real log_e = std::log(restitution);
    return -log_e / std::sqrt(square(pi) + square(log_e));
}

}  // namespace abrade
