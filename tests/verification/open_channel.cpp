// Uniform flow along a rough bed with a logarithmic wall: the bed's friction holds the weight, u*^2 = g h S.
// There is no turbulence model: an eddy viscosity is given here, the mean over the depth of that of the log
// law,
//   nu = kappa u* h / 6, with which u = u_1 + (u*^2 / nu) (z - z^2 / (2 h)), less its value in the lowest
//   cell.
#include "reference_table.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real g = 9.81, karman = WallFriction<2>::karman;

/// Water between the bed and a lid that it glides along, which stands for a level surface.
struct RoughBed {
    Real depth, slope, manning;
    int cells;
    Real plug = 0;  ///< speed of a plug flow that comes in and knows no viscosity; 0: the profile above

    Real roughness() const { return std::pow(26 * manning, 6); }
    Real size() const { return depth / cells; }
    Real friction_speed() const { return std::sqrt(g * depth * slope); }
    Real eddy_viscosity() const { return plug > 0 ? 0 : karman * friction_speed() * depth / 6; }
    /// u / u* of the wall law at the centre of the lowest cell.
    Real law() const { return std::log1p(30 * 0.5 * size() / roughness()) / karman; }
    Real speed(Real z) const {
        if (plug > 0) return plug;
        const auto shape = [&](Real at) { return at - 0.5 * at * at / depth; };
        return friction_speed() * law() +
               square(friction_speed()) / eddy_viscosity() * (shape(z) - shape(0.5 * size()));
    }
};

struct Found {
    Real friction_speed = 0;  ///< that the wall law gives in the middle [m/s]
    Real balance = 0;         ///< weight less the push of the pressure, over the bed's friction [-]
    Real profile = 0;         ///< largest relative difference to the profile that comes in
};

Found found(const RoughBed& bed) {
    const int length = std::max(16, 4 * bed.cells);
    BoundaryConditions<2> boundaries = BoundaryConditions<2>::all(Boundary::free_slip);
    boundaries[0] = {Boundary::inflow, Boundary::outflow};
    boundaries[1][0] = Boundary::wall;
    const auto everywhere = [](const Point<2>&) { return 1.0; };
    GridFluid<2> flow(
        {.grid = {.cells = {length, bed.cells}, .spacing = {bed.size(), bed.size()}},
         .boundaries = boundaries,
         .boundary_velocity = [bed](const Point<2>& x,
                                    Real) { return Point<2>(x[0] > 0 ? 0 : bed.speed(x[1]), 0); },
         .wall_law = {WallLaw::Kind::logarithmic, bed.roughness()},
         .water = everywhere,
         .inflow_water = everywhere,
         .velocity = [bed](const Point<2>& x) { return Point<2>(bed.speed(x[1]), 0); },
         .gravity = {g * bed.slope, 0},
         .viscosity = 1000 * bed.eddy_viscosity(),
         .tolerance = 1e-9});
    flow.advance(10);  // 50 depths and more flow by
    const auto at = [&](int i, int k) { return flow.grid().layout().at({i, k}); };
    const auto pressure = [&](int i) { return flow.pressure()[at(i, bed.cells / 2)]; };
    const int a = length / 4, b = 3 * length / 4;
    Found f;
    f.friction_speed = flow.velocity()[0][at(length / 2, 0)] / bed.law();
    f.balance = (g * bed.slope - (pressure(b) - pressure(a)) / ((b - a) * bed.size())) /
                (square(f.friction_speed) / bed.depth);
    for (int k = 0; k < bed.cells; ++k)
        f.profile = std::max(
            f.profile, std::abs(flow.velocity()[0][at(b, k)] / bed.speed(flow.grid().centre(1, k)) - 1));
    return f;
}

}  // namespace

TEST_CASE("uniform flow: the bed's friction holds the weight, the profile stays") {
    const ReferenceRow row = reference_table("flu12_open_channel_uniform_flow.csv").front();
    for (const int cells : {10, 20}) {
        const RoughBed bed{
            .depth = row.at("h"), .slope = row.at("S"), .manning = row.at("n"), .cells = cells};
        const Found f = found(bed);
        MESSAGE(cells << " cells: u* " << f.friction_speed << " m/s, balance " << f.balance
                      << ", profile off by " << f.profile);
        CHECK(f.friction_speed == doctest::Approx(row.at("ustar")).epsilon(0.05).scale(0));
        CHECK(f.balance == doctest::Approx(1).epsilon(0.005).scale(0));
        CHECK(f.profile < 0.1);
    }
}

TEST_CASE("a plug flow of one cell: the pressure takes what friction and weight leave") {
    for (const Real speed : {0.25, 0.5, 1.0}) {
        const RoughBed bed{.depth = 0.1, .slope = 0.001, .manning = 0.012, .cells = 1, .plug = speed};
        const Found f = found(bed);
        MESSAGE(speed << " m/s: u* " << f.friction_speed << " m/s, balance " << f.balance);
        CHECK(f.friction_speed == doctest::Approx(speed / bed.law()).epsilon(1e-6).scale(0));
        CHECK(f.balance == doctest::Approx(1).epsilon(0.005).scale(0));
    }
}
