#pragma once
// Turbulence: what eddies below a cell do to the flow, as an eddy viscosity nu_t. Another model goes
// here: copy a class.

#include <abrade/core/law.hpp>
#include <abrade/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <string_view>

namespace abrade {

namespace detail {

/// nu_t = l^2 |S|, l = `length(Delta, d)` [m].
template <class T>
concept HasMixingLength = requires(const T& model, Real size) {
    { model.length(size, size) }
    noexcept->std::same_as<Real>;
};

/// Such a model of the mean flow also has what that flow's nu_t is at most, `largest(d)` [m2/s], and the
/// share of Delta that eddies have at most beside bodies that the water flows around, `beside_bodies()` [-].
template <class T>
concept ModelsMeanFlow = HasMixingLength<T> && requires(const T& model, Real size) {
    { model.largest(size) }
    noexcept->std::same_as<Real>;
    { model.beside_bodies() }
    noexcept->std::same_as<Real>;
    model.validate_among_bodies();
};

/// nu_t = `viscosity(g, Delta, d)` [m2/s], of the velocity's gradient g(a, b) = du_a/dx_b [1/s]; in a plane
/// its last row and column are 0.
template <class T>
concept HasEddyViscosity = requires(const T& model, Real size, const Mat3& gradient) {
    { model.viscosity(gradient, size, size) }
    noexcept->std::same_as<Real>;
};

}  // namespace detail

/// A law that gives nu_t for every place, from the size of the cell Delta, its distance d from the nearest
/// wall [m] and the velocity's gradient; or none (`has_eddies` false), then no instruction is run for it.
template <class T>
concept TurbulenceModel = Law<T> && std::same_as<decltype(T::has_eddies), const bool> &&
    (!T::has_eddies || detail::HasMixingLength<T> != detail::HasEddyViscosity<T>);

/// The flow is as the grid resolves it.
class NoTurbulence {
public:
    static constexpr std::string_view name = "NoTurbulence";
    static constexpr bool has_eddies = false;
    using Params = NoParams;

    NoTurbulence() = default;
    explicit NoTurbulence(Params) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
};

/// Large-eddy simulation: eddies below a cell.
///   nu_t = l^2 |S|,  |S| = sqrt(2 S_ij S_ij),  l = min(C_s Delta, kappa d),  Delta = (cell's volume)^(1/Dim)
/// nu_t eddy viscosity [m2/s], S strain rate [1/s], l mixing length, Delta the cell's size [m]
/// d distance from the nearest wall [m], kappa von Karman's constant [-]
/// C_s constant [-]: 0.1 in channels (J. Deardorff, doi:10.1017/S0022112070000691), 0.17 far from walls (D.
/// Lilly, 1967)
/// Validity: where the grid resolves the large eddies: in three dimensions, with many cells over the depth.
/// It is no model of the mean flow: where no eddies are resolved the water runs too fast.
/// Throws InputError for parameters out of their range.
/// Source: J. Smagorinsky, Mon. Weather Rev. 91 (1963) 99,
/// doi:10.1175/1520-0493(1963)091<0099:GCEWTP>2.3.CO;2.
///
/// Near a wall eddies are no larger than their distance from it lets them be; P. Mason and D. Thomson,
/// doi:10.1017/S0022112092002271, round off the corner of the same two limits. Van Driest's damping
/// (doi:10.2514/8.3662) needs a smooth wall's viscous layer, of which rough walls (WallLaw::logarithmic) have
/// none.
class Smagorinsky {
public:
    static constexpr std::string_view name = "Smagorinsky";
    static constexpr bool has_eddies = true;

    struct Params {
        Real constant = 0.1;  ///< C_s [-]
        Real karman = 0.41;   ///< kappa [-]

        void validate() const {
            require(constant > 0 && constant <= 0.5,
                    {"Smagorinsky.constant", "in (0, 0.5]", "", "0.1 in channels, 0.17 far from walls"},
                    constant);
            require_positive(karman, "Smagorinsky.karman", "", "0.41");
        }
        void visit(auto&& f) const { f("constant", constant, "-"), f("karman", karman, "-"); }
    };

    Smagorinsky() = default;
    explicit Smagorinsky(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    Real length(Real size, Real wall_distance) const noexcept {
        return std::min(params_.constant * size, params_.karman * std::max(wall_distance, Real(0)));
    }

private:
    Params params_;
};

/// Large-eddy simulation whose eddies vanish beside a smooth wall as they do there, by the cube of the
/// distance, and in pure shear.
///   nu_t = (C_w Delta)^2 (Sd_ij Sd_ij)^(3/2) / ((S_ij S_ij)^(5/2) + (Sd_ij Sd_ij)^(5/4))
/// nu_t eddy viscosity [m2/s], S strain rate [1/s], Delta the cell's size [m]
/// Sd the symmetric, traceless part of the square of the velocity's gradient [1/s2]
/// C_w constant [-]: sqrt(10.6) C_s, so 0.33 for Smagorinsky's 0.1 in channels, 0.5 in their decaying
/// turbulence
/// Validity: where Smagorinsky's is, and where the cells beside a smooth wall resolve its viscous layer: it
/// asks for no distance from walls.
/// Throws InputError for parameters out of their range.
/// Source: F. Nicoud, F. Ducros, Flow, Turbulence and Combustion 62 (1999) 183, doi:10.1023/A:1009995426001.
class Wale {
public:
    static constexpr std::string_view name = "Wale";
    static constexpr bool has_eddies = true;

    struct Params {
        Real constant = 0.33;  ///< C_w [-]

        void validate() const {
            require(constant > 0 && constant <= 1,
                    {"Wale.constant", "in (0, 1]", "", "0.33 in channels, 0.5 far from walls"}, constant);
        }
        void visit(auto&& f) const { f("constant", constant, "-"); }
    };

    Wale() = default;
    explicit Wale(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    Real viscosity(const Mat3& gradient, Real size, Real /*wall_distance*/) const noexcept {
        const Mat3 strain = 0.5 * (gradient + gradient.transpose()), twice = gradient * gradient;
        Mat3 turn = 0.5 * (twice + twice.transpose());
        turn.diagonal().array() -= twice.trace() / 3;
        const Real s2 = strain.squaredNorm(), d2 = turn.squaredNorm();
        const Real below = s2 * s2 * std::sqrt(s2) + d2 * std::sqrt(std::sqrt(d2));
        return below > 0 ? square(params_.constant * size) * d2 * std::sqrt(d2) / below : 0;
    }

private:
    Params params_;
};

/// Mean flow of a channel, all eddies modelled.
///   nu_t = l^2 |S|,  l = kappa d sqrt(1 - d / h),  at most kappa u* d (1 - d / h)
/// nu_t eddy viscosity [m2/s], S strain rate [1/s], l mixing length [m]
/// d distance from the nearest wall, h depth [m], kappa von Karman's constant [-]
/// u* shear velocity [m/s]
/// Validity: channels, on coarse grids and in two dimensions. It is no model of wakes: there the strain makes
/// nu_t some twenty times the mean flow's, which would hold a body fast (drag of stones in a channel: four to
/// nine times too large).
/// Throws InputError for parameters out of their range.
/// Source: L. Prandtl, ZAMM 5 (1925) 136, doi:10.1002/zamm.19250050212.
///
/// The profile of uniform flow of depth h is logarithmic with it and nu_t that parabola, whatever the grid.
/// Among bodies it asks for u*, and beside them eddies are those that a cell does not resolve, l <= C_s
/// Delta: none unless given otherwise, for a wake on a coarse grid is viscous enough without.
class MixingLength {
public:
    static constexpr std::string_view name = "MixingLength";
    static constexpr bool has_eddies = true;

    struct Params {
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
        void visit(auto&& f) const {
            f("depth", depth, "m"), f("friction_velocity", friction_velocity, "m/s");
            f("karman", karman, "-"), f("beside_bodies", beside_bodies, "-");
        }
    };

    MixingLength() : MixingLength(Params{}) {}  ///< Throws InputError: no depth is right for all.
    explicit MixingLength(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    Real length(Real /*size*/, Real wall_distance) const noexcept {
        const Real d = within(wall_distance);
        return params_.karman * d * std::sqrt(1 - d / params_.depth);
    }
    Real largest(Real wall_distance) const noexcept {
        const Real d = within(wall_distance), parabola = params_.karman * d * (1 - d / params_.depth);
        return parabola > 0 ? params_.friction_velocity * parabola : 0;
    }
    Real beside_bodies() const noexcept { return params_.beside_bodies; }
    /// Throws InputError: what bodies need.
    void validate_among_bodies() const {
        require_finite(
            params_.friction_velocity, "MixingLength.friction_velocity, among bodies", "m/s",
            "give sqrt(g depth slope) of uniform flow, or their wakes make nu_t twenty times too large");
    }

private:
    Real within(Real wall_distance) const noexcept {
        return std::clamp(wall_distance, Real(0), params_.depth);
    }

    Params params_;
};

static_assert(TurbulenceModel<NoTurbulence> && TurbulenceModel<Smagorinsky> && TurbulenceModel<Wale> &&
              TurbulenceModel<MixingLength>);
static_assert(detail::ModelsMeanFlow<MixingLength> && !detail::ModelsMeanFlow<Smagorinsky>);
static_assert(!TurbulenceModel<int> && !TurbulenceModel<NoParams>);

}  // namespace abrade
