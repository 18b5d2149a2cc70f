#pragma once
// The vortices of G. Taylor and A. Green 1937, doi 10.1098/rspa.1937.0036, in three dimensions at Re 1600:
//   u = sin x cos y cos z, v = -cos x sin y cos z, w = 0 on (2 pi)^3,
// which stretch each other until they break up. The flow is the mirror of itself across x, y, z = 0 and pi,
// so an eighth of it between walls that glide is all of it: the same numbers for an eighth of the work.
// Measured against the direct simulation of T. Dairay et al. 2017, doi 10.1016/j.jcp.2017.02.035.

#include "reference_table.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

namespace taylor_green_3d {

using namespace abrade;

constexpr Real nu = 1.0 / 1600;

enum class Part { whole, eighth };

/// n cells to the period of 2 pi.
template <AdvectionScheme Scheme>
GridFluid<3, Advected<Scheme, FullBox>> vortices(int n, Part part = Part::eighth) {
    const int cells = part == Part::whole ? n : n / 2;
    return GridFluid<3, Advected<Scheme, FullBox>>(
        {.grid = {.cells = {cells, cells, cells}, .spacing = Point<3>::Constant(2 * pi / n)},
         .boundaries =
             BoundaryConditions<3>::all(part == Part::whole ? Boundary::periodic : Boundary::free_slip),
         .velocity =
             [](const Point<3>& x) {
                 return Point<3>(std::sin(x[0]) * std::cos(x[1]) * std::cos(x[2]),
                                 -std::cos(x[0]) * std::sin(x[1]) * std::cos(x[2]), 0);
             },
         .density = 1,
         .viscosity = nu});
}

/// Mean over the box of |u|^2 / 2.
Real energy(const auto& flow) {
    Real volume = 1;
    for (int a = 0; a < 3; ++a) volume *= flow.grid().high(a) - flow.grid().low(a);
    return flow.kinetic_energy() / volume;
}

/// Mean over the box of nu |grad u|^2: what friction takes of the motion that the grid knows.
Real dissipation(const auto& flow) {
    Real sum = 0;
    const auto& stride = flow.grid().layout().stride;
    flow.grid().for_each([&](const CellNumber<3>&, Offset c) {
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) {
                const Offset high = a == b ? c + stride[b] : c, low = a == b ? c : c - stride[b];
                sum += square(flow.velocity()[a][high] - flow.velocity()[a][low]);
            }
    });
    return nu * sum / square(flow.grid().size(0, 0)) / static_cast<Real>(flow.grid().layout().cell_count());
}

struct Sample {
    Real time = 0, energy = 0;
    Real loss = 0;         ///< - dE/dt, over the time since the sample before and until the next
    Real dissipation = 0;  ///< nu |grad u|^2: less than the loss where the scheme takes energy too
};

template <class Flow>
std::vector<Sample> decay(Flow& flow, Real end_time, Real between = 0.1) {
    std::vector<Sample> samples;
    const auto count = static_cast<int>(std::lround(end_time / between));
    for (int k = 0; k <= count + 1; ++k) {
        if (k > 0) flow.advance(k * between);
        samples.push_back({flow.time(), energy(flow), 0, dissipation(flow)});
    }
    samples[0].loss = samples[0].dissipation;
    for (std::size_t k = 1; k + 1 < samples.size(); ++k)
        samples[k].loss = (samples[k - 1].energy - samples[k + 1].energy) / (2 * between);
    samples.pop_back();
    return samples;
}

struct Peak {
    Real time = 0, loss = 0;
};

inline Peak peak(const std::vector<Sample>& samples) {
    std::size_t most = 1;
    for (std::size_t k = 1; k + 1 < samples.size(); ++k)
        if (samples[k].loss > samples[most].loss) most = k;
    // Of the parabola through three samples.
    const Real before = samples[most - 1].loss, at = samples[most].loss, after = samples[most + 1].loss;
    const Real curve = before - 2 * at + after, slope = 0.5 * (after - before);
    const Real between = samples[most].time - samples[most - 1].time;
    if (!(curve < 0)) return {samples[most].time, at};
    return {samples[most].time - between * slope / curve, at - 0.5 * slope * slope / curve};
}

/// Root mean square of the difference in loss to the direct simulation until the last sample, over its peak.
inline Real off(const std::vector<Sample>& samples) {
    Real sum = 0, most = 0;
    int count = 0;
    for (const ReferenceRow& row : reference_table("flu05_taylor_green_3D_Re1600_DNS.csv")) {
        most = std::max(most, row.at("eps_t"));
        for (const Sample& s : samples)
            if (std::abs(s.time - row.at("t")) < 1e-6) sum += square(s.loss - row.at("eps_t")), ++count;
    }
    return std::sqrt(sum / count) / most;
}

}  // namespace taylor_green_3d
