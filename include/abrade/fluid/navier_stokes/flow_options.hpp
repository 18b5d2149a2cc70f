#pragma once
// What water on a grid is made of: chosen at compile time, by name.

#include <abrade/fluid/momentum/advection_schemes.hpp>
#include <abrade/fluid/momentum/forcing.hpp>
#include <abrade/fluid/momentum/turbulence.hpp>
#include <abrade/fluid/pressure/conjugate_gradients.hpp>
#include <abrade/fluid/pressure/solids_in_flow.hpp>

#include <concepts>
#include <string>
#include <type_traits>

namespace abrade {

enum class SurfaceKind { none, volume_of_fluid, height };

/// Water, everywhere and for ever. To change an option, derive and name it anew,
///     struct Eddying : FreeSurface { using Turbulence = Smagorinsky; };
///     GridFluid<3, Eddying> flow(params, Smagorinsky{{.constant = 0.1}});
/// or wrap it: GridFluid<3, Turbulent<Smagorinsky>>.
struct FullBox {
    static constexpr SurfaceKind surface = SurfaceKind::none;
    using Scheme = Koren;             ///< that advects momentum
    using Number = Real;              ///< of velocity and pressure; float in a full box without solids alone
    using Turbulence = NoTurbulence;  ///< what eddies below a cell do
    template <int Dim>
    using Pressure = ConjugateGradients<Dim>;  ///< who solves for it: a PressureSolver
    using Solids = NoSolids;                   ///< that move in it: how water and bodies are coupled
    using Forcing = NoForcing;                 ///< a user's force per volume, and water that is put in
};
/// Water below a surface (VolumeOfFluid); above it a void at pressure 0.
struct FreeSurface : FullBox {
    static constexpr SurfaceKind surface = SurfaceKind::volume_of_fluid;
};
/// The same, of a surface that is a height: z = h(x, y, t) (HeightOfFluid). For channels, rivers and tanks;
/// it knows no film, no void and no spray, and stops where the water wants to overturn.
struct HeightSurface : FullBox {
    static constexpr SurfaceKind surface = SurfaceKind::height;
};

// One option other than in `Options`; they nest: Among<MonolithicSolids<>, Turbulent<MixingLength,
// HeightSurface>>.
template <AdvectionScheme S, class Options = FreeSurface>
struct Advected : Options {
    using Scheme = S;
};
template <class N, class Options = FullBox>
struct InPrecision : Options {
    using Number = N;
};
template <TurbulenceModel T, class Options = FreeSurface>
struct Turbulent : Options {
    using Turbulence = T;
};
template <template <int> class S, class Options = FreeSurface>
struct SolvedBy : Options {
    template <int Dim>
    using Pressure = S<Dim>;
};
template <SolidsInFlow S, class Options = FreeSurface>
struct Among : Options {
    using Solids = S;
};

template <class F, class Options = FreeSurface>
struct Forced : Options {
    using Forcing = F;
};

template <class O>
concept FlowOptions = requires {
    { O::surface } -> std::convertible_to<SurfaceKind>;
    typename O::Number;
    { O::Forcing::name } -> std::convertible_to<std::string_view>;
}
&&std::floating_point<typename O::Number>&& AdvectionScheme<typename O::Scheme>&&
    TurbulenceModel<typename O::Turbulence>&& SolidsInFlow<typename O::Solids>;

/// "volume of fluid, Koren, double, ConjugateGradients, Wale(constant = 0.33), NoSolids, NoForcing".
template <FlowOptions O>
std::string describe_options(const typename O::Turbulence& turbulence) {
    std::string text = O::surface == SurfaceKind::none              ? "full box"
                       : O::surface == SurfaceKind::volume_of_fluid ? "volume of fluid"
                                                                    : "height";
    text.append(", ").append(O::Scheme::name);
    text.append(std::same_as<typename O::Number, float> ? ", float" : ", double");
    text.append(", ").append(O::template Pressure<3>::name);
    text.append(", ").append(describe(turbulence)).append(", ").append(O::Solids::name);
    text.append(", ").append(O::Forcing::name);
    return text;
}

static_assert(FlowOptions<FullBox> && FlowOptions<HeightSurface> && !FlowOptions<int>);
static_assert(FlowOptions<Turbulent<Smagorinsky, Advected<Central>>>);

}  // namespace abrade
