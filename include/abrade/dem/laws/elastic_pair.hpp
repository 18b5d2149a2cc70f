#pragma once
// The elastic constants of two materials in contact.

#include <abrade/core/require.hpp>

#include <string_view>

namespace abrade {

inline void require_poisson(Real value, std::string_view field) {
    require(value > -1 && value <= 0.5,
            {field, "in (-1, 0.5]", "", "concrete has about 0.2, rubber nearly 0.5"}, value);
}

/// What is softer than foam was most likely not meant in Pa.
inline void require_in_pascal(Real youngs, std::string_view field) {
    require(youngs >= 1e3, {field, "at least 1000 Pa", "Pa", "granite has 7e10 Pa: was it meant in GPa?"},
            youngs);
}

/// Effective moduli of two elastic materials in contact [Pa]:
///   1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2,  1/G* = (2 - nu_1)/G_1 + (2 - nu_2)/G_2,  G = E/(2 (1 + nu))
/// E Young's modulus [Pa], nu Poisson's ratio [-], G shear modulus [Pa]. K. L. Johnson, Contact Mechanics,
/// 1985, doi:10.1017/CBO9781139171731.
struct ElasticPair {
    Real youngs = 0, shear = 0;  ///< E*, G* [Pa]

    /// Of partners 1 and 2; `e2` = 0 means that both are of the first material.
    static ElasticPair of(Real e1, Real nu1, Real e2, Real nu2) noexcept {
        if (e2 == 0) e2 = e1, nu2 = nu1;
        return {1 / ((1 - square(nu1)) / e1 + (1 - square(nu2)) / e2),
                1 / (2 * (2 - nu1) * (1 + nu1) / e1 + 2 * (2 - nu2) * (1 + nu2) / e2)};
    }
};

}  // namespace abrade
