#pragma once
// How walls hold the water that flows along them: the law of the shear.

#include <abrade/core/require.hpp>
#include <abrade/fluid/mesh/boundary_conditions.hpp>

#include <cmath>

namespace abrade {

/// How water is held by walls.
struct WallLaw {
    enum class Kind {
        no_slip,      ///< shear nu u / d: the wall's layer is resolved
        slip,         ///< none
        logarithmic,  ///< rho u*^2, u* = kappa u / ln(1 + 30 d / k_s): rough walls whose layer is below a
                      ///< cell
    };
    Kind kind = Kind::no_slip;
    Real roughness = 0;  ///< k_s, equivalent sand roughness of a logarithmic wall [m]

    static constexpr Real karman = 0.41;

    /// The shear of water at a distance d > 0 [m] is rho nu u / d or rho (kappa / ln(1 + 30 d / k_s))^2 |u|
    /// u: of that the factor beside rho nu u [1/m], or rho |u| u [-].
    Real drag(Real distance) const noexcept {
        if (kind == Kind::slip) return 0;
        return kind == Kind::no_slip ? 1 / distance : square(karman / std::log1p(30 * distance / roughness));
    }

    void validate() const {
        if (kind == Kind::logarithmic)
            require_positive(roughness, "WallLaw.roughness", "m",
                             "k_s = (26 n)^6 by Strickler: 3.5e-3 m for Manning's n = 0.015");
        else
            require_not_negative(roughness, "WallLaw.roughness", "m",
                                 "leave it out, or make the wall logarithmic");
    }
};

/// Sides whose friction is added apart let the water glide.
template <int Dim>
BoundaryConditions<Dim> with_free_slip(BoundaryConditions<Dim> boundaries, const WallLaw& law) {
    if (law.kind == WallLaw::Kind::no_slip) return boundaries;
    for (auto& ends : boundaries.kind)
        for (Boundary& side : ends)
            if (side == Boundary::wall) side = Boundary::free_slip;
    return boundaries;
}

}  // namespace abrade
