#pragma once
// Turbulence: what eddies below a cell do to the flow, as an eddy viscosity nu_t = l^2 |S|.

#include <abrade/core/require.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <string_view>

namespace abrade {

/// A mixing length for every place: `length(Delta, d)` [m], Delta the size of the cell, d its distance from
/// the nearest wall [m]; or none (`has_eddies` false), then no instruction is run for it. A model of the mean
/// flow also has what that flow's nu_t is at most, `largest(d)` [m2/s], and the share of Delta that eddies
/// have at most beside bodies that the water flows around, `beside_bodies` [-].
// clang-format off
template <class T>
concept TurbulenceModel = std::copyable<T> && requires {
    { T::name } -> std::convertible_to<std::string_view>;
    requires std::same_as<decltype(T::has_eddies), const bool>;
} && (!T::has_eddies || requires(const T& model, Real size) {
    { model.length(size, size) } noexcept -> std::same_as<Real>;
    model.validate();
});
// clang-format on

/// The flow is as the grid resolves it.
struct NoTurbulence {
    static constexpr std::string_view name = "NoTurbulence";
    static constexpr bool has_eddies = false;
};

/// Large-eddy simulation: eddies below a cell,
///   nu_t = l^2 |S|, |S| = sqrt(2 S_ij S_ij), l = min(C_s Delta, kappa d), Delta = (cell's volume)^(1/Dim).
/// J. Smagorinsky, doi 10.1175/1520-0493(1963)091<0099:GCEWTP>2.3.CO;2. C_s: 0.1 in channels (J. Deardorff,
/// doi 10.1017/S0022112070000691), 0.17 far from walls (D. Lilly, 1967). Near a wall eddies are no larger
/// than their distance from it lets them be; P. Mason and D. Thomson, doi 10.1017/S0022112092002271, round
/// off the corner of the same two limits. Van Driest's damping (doi 10.2514/8.3662) needs a smooth wall's
/// viscous layer, of which rough walls (WallLaw::logarithmic) have none.
/// Valid where the grid resolves the large eddies: in three dimensions, with many cells over the depth. It
/// is no model of the mean flow: where no eddies are resolved the water runs too fast.
struct Smagorinsky {
    static constexpr std::string_view name = "Smagorinsky";
    static constexpr bool has_eddies = true;
    Real constant = 0.1;  ///< C_s [-]
    Real karman = 0.41;   ///< kappa [-]

    void validate() const {
        require(constant > 0 && constant <= 0.5,
                {"Smagorinsky.constant", "in (0, 0.5]", "", "0.1 in channels, 0.17 far from walls"},
                constant);
        require_positive(karman, "Smagorinsky.karman", "", "0.41");
    }
    Real length(Real size, Real wall_distance) const noexcept {
        return std::min(constant * size, karman * std::max(wall_distance, Real(0)));
    }
};

/// Mean flow of a channel, all eddies modelled: L. Prandtl's mixing length (doi 10.1002/zamm.19250050212)
///   nu_t = l^2 |S|, l = kappa d sqrt(1 - d / h), at most kappa u* d (1 - d / h),
/// with which the profile of uniform flow of depth h is logarithmic and nu_t that parabola. Does not depend
/// on the grid. For coarse grids, and in two dimensions.
/// It is no model of wakes: there the strain makes nu_t some twenty times the mean flow's, which would hold
/// the body fast (drag of stones in a channel: four to nine times too large). So among bodies it asks for u*,
/// and beside them eddies are those that a cell does not resolve, l <= C_s Delta: none unless told otherwise,
/// for a wake on a coarse grid is viscous enough without.
struct MixingLength {
    static constexpr std::string_view name = "MixingLength";
    static constexpr bool has_eddies = true;
    Real depth = 0;  ///< h [m]
    /// u* = sqrt(g h S) of uniform flow [m/s]. Infinite: nu_t has no bound.
    Real friction_velocity = std::numeric_limits<Real>::infinity();
    Real karman = 0.41;      ///< kappa [-]
    Real beside_bodies = 0;  ///< C_s there; Smagorinsky's in channels is 0.1 [-]

    void validate() const {
        require_positive(depth, "MixingLength.depth", "m", "give the depth of uniform flow");
        require(friction_velocity > 0,
                {"MixingLength.friction_velocity", "> 0", "m/s",
                 "sqrt(g depth slope) of uniform flow; infinity sets no bound"},
                friction_velocity);
        require_positive(karman, "MixingLength.karman", "", "0.41");
        require_not_negative(beside_bodies, "MixingLength.beside_bodies", "");
    }
    Real length(Real /*size*/, Real wall_distance) const noexcept {
        return karman * within(wall_distance) * std::sqrt(1 - within(wall_distance) / depth);
    }
    Real largest(Real wall_distance) const noexcept {
        const Real d = within(wall_distance), parabola = karman * d * (1 - d / depth);
        return parabola > 0 ? friction_velocity * parabola : 0;
    }
    /// Throws InputError: what bodies need.
    void validate_among_bodies() const {
        require_finite(
            friction_velocity, "MixingLength.friction_velocity, among bodies", "m/s",
            "give sqrt(g depth slope) of uniform flow, or their wakes make nu_t twenty times too large");
    }

private:
    Real within(Real wall_distance) const noexcept { return std::clamp(wall_distance, Real(0), depth); }
};

static_assert(TurbulenceModel<NoTurbulence> && TurbulenceModel<Smagorinsky> && TurbulenceModel<MixingLength>);
static_assert(!TurbulenceModel<int>);

}  // namespace abrade
