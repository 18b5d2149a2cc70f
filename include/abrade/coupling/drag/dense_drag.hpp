#pragma once
// Drag of a body among others, of which water leaves room.

#include <abrade/core/pack.hpp>
#include <abrade/coupling/drag/drag.hpp>

namespace abrade {

/// A law gives what drag is times that of the body alone, at Re = eps rho |u - v| d / mu and at the water's
/// share eps of the volume; u is what the water flows with between the bodies.
// clang-format off
template <class D>
concept DenseDragLaw = Law<D> && requires(const D& law) {
    { law.coefficient(Real{}, Real{}) } noexcept -> std::same_as<Real>;
};
// clang-format on

/// Drag of a sphere among others.
///   C = C_d(Re) eps^(2 - chi),  Re = eps rho |u - v| d / mu,  chi = 3.7 - 0.65 exp(-(1.5 - log10 Re)^2 / 2)
/// C drag coefficient, C_d(Re) that of a sphere alone, Clift & Gauvin's [-]
/// eps porosity [-], u - v slip [m/s], d diameter [m], rho density [kg/m3], mu viscosity [Pa s]
/// Validity: Re up to 3e5, porosities from 0.2 to 1 (held there); the pressure's gradient acts on its own.
/// Throws InputError for parameters out of their range.
/// Source: R. Di Felice, Int. J. Multiphase Flow 20 (1994) 153, doi:10.1016/0301-9322(94)90011-6.
class DiFelice {
public:
    static constexpr std::string_view name = "DiFelice";
    using Params = CliftGauvin::Params;

    DiFelice() = default;
    explicit DiFelice(Params params) : alone_(params) {}  // Params{...} alone tells a wrong name
    const Params& params() const noexcept { return alone_.params(); }

    /// Of the force 1/2 C rho pi/4 d^2 |u - v| (u - v).
    Real coefficient(Real reynolds, Real porosity) const noexcept {
        const Real eps = std::clamp(porosity, 0.2, 1.0);
        const Real from = 1.5 - std::log10(std::max(reynolds, 1e-12));
        const Real chi = 3.7 - 0.65 * std::exp(-0.5 * from * from);
        return alone_.coefficient(reynolds) * std::pow(eps, 2 - chi);
    }

private:
    CliftGauvin alone_;
};

static_assert(DenseDragLaw<DiFelice>);

/// Radius of the ball that a body is spread over: of three diameters, or of three cells where these are wider
/// [m].
inline Real spread_radius(Real diameter, Real cell) noexcept { return 1.5 * std::max(diameter, cell); }
/// Half the width of the triangle that has the variance of a ball along an axis [m].
inline Real triangle_half(Real radius) noexcept { return std::sqrt(6.0 / 5) * radius; }

/// A body whose force is spread over water that feels it. What it meets there it has slowed itself: a force F
/// spread evenly over a ball of radius a makes F / R,
///   R = 5 pi mu a + 2 rho pi a^2 |u - v|
/// (the mean of Stokes' flow over the ball; a disc that takes the momentum of what goes through).
struct SpreadBody {
    Real diameter = 0;   ///< d, of a sphere of its volume [m]
    Real reach = 0;      ///< a [m]
    Real slip = 0;       ///< |u - v|, as the water is now [m/s]
    Real viscosity = 0;  ///< nu [m2/s]
    Real porosity = 1;   ///< [-]

    /// beta / rho of F = beta (u - v), with the slip as it is [m3/s].
    template <DenseDragLaw Law>
    Real drag(const Law& law) const noexcept {
        const Real reynolds = porosity * slip * diameter / std::max(viscosity, tiny<Real>);
        return pi / 8 * square(diameter) * slip * law.coefficient(reynolds, porosity);
    }
    /// The slip that it would have, had such a drag not made it less, over that which it has [-].
    Real put_back(Real drag) const noexcept {
        constexpr Real most = 0.6;
        const Real resists = 5 * pi * viscosity * reach + 2 * pi * square(reach) * slip;
        return 1 / (1 - std::min(drag / std::max(resists, tiny<Real>), most));
    }
};

}  // namespace abrade
