// Uniform flow of a channel from rest to its end state, with the eddies modelled: bed shear, profile and mean
// speed against the log law u/u* = ln(30 z/k_s)/kappa and Manning's formula. Periodic, between a logarithmic
// bed and a lid that the water glides along, driven by its weight g S.
#include "reference_table.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real g = 9.81, karman = WallFriction<2>::karman;

struct Bed {
    Real depth, slope, manning;

    Real roughness() const { return std::pow(26 * manning, 6); }
    Real friction_speed() const { return std::sqrt(g * depth * slope); }
    Real log_law(Real z) const { return friction_speed() / karman * std::log(30 * z / roughness()); }
    Real mean_log_law() const { return friction_speed() / karman * (std::log(30 * depth / roughness()) - 1); }
    Real mean_manning() const { return std::pow(depth, 2.0 / 3) * std::sqrt(slope) / manning; }
};

struct Found {
    Real friction_speed = 0;  ///< that the wall law gives [m/s]
    Real mean = 0;            ///< over the depth [m/s]
    Real profile = 0;         ///< largest difference to the log law, over that [-]
    Real change = 0;          ///< of the mean speed in the last fifth of the run, over it [-]
};

template <class Model>
Found found(const Bed& bed, int cells, Real length, Model model) {
    const Real h = bed.depth / cells;
    BoundaryConditions<2> boundaries;
    boundaries[0] = {Boundary::periodic, Boundary::periodic};
    boundaries[1] = {Boundary::wall, Boundary::free_slip};
    GridFluid<2, Turbulent<Model, FullBox>> flow(
        {.grid = {.cells = {4, cells}, .spacing = {length, h}},
         .boundaries = boundaries,
         .wall_law = {WallLaw::Kind::logarithmic, bed.roughness()},
         .velocity = [&](const Point<2>& x) { return Point<2>(bed.log_law(std::max(x[1], h / 2)), 0); },
         .gravity = {g * bed.slope, 0},
         .tolerance = 1e-9},
        model);
    const auto u = [&](int k) { return flow.velocity()[0][flow.grid().layout().at({2, k})]; };
    const auto mean = [&] {
        Real sum = 0;
        for (int k = 0; k < cells; ++k) sum += u(k) / cells;
        return sum;
    };
    const Real turns = bed.depth / bed.friction_speed();
    flow.advance(40 * turns);
    const Real before = mean();
    flow.advance(50 * turns);
    Found f;
    f.mean = mean(), f.change = f.mean / before - 1;
    f.friction_speed = u(0) * karman / std::log1p(15 * h / bed.roughness());
    for (int k = 0; k < cells; ++k) {
        const Real law = bed.log_law((k + 0.5) * h);
        f.profile = std::max(f.profile, std::abs(u(k) / law - 1));
    }
    return f;
}

Bed bed_of(const ReferenceRow& row) {
    return {.depth = row.at("h"), .slope = row.at("S"), .manning = row.at("n")};
}

Found told(const std::string& name, const Bed& bed, const Found& f) {
    MESSAGE(name << ": u* off by " << f.friction_speed / bed.friction_speed() - 1 << ", profile by "
                 << f.profile << ", mean " << f.mean << " m/s, off the log law by "
                 << f.mean / bed.mean_log_law() - 1 << ", off Manning by " << f.mean / bed.mean_manning() - 1
                 << "; still changes by " << f.change);
    return f;
}

}  // namespace

TEST_CASE("uniform flow with the mixing length: bed shear, log profile and mean speed") {
    const Bed bed = bed_of(reference_table("flu12_open_channel_uniform_flow.csv").front());
    MESSAGE("log law " << bed.mean_log_law() << " m/s, Manning " << bed.mean_manning() << " m/s");
    for (const int cells : {5, 10, 20}) {
        const Found f = told(std::to_string(cells) + " cells", bed,
                             found(bed, cells, bed.depth / cells, MixingLength{{.depth = bed.depth}}));
        CHECK(f.friction_speed == doctest::Approx(bed.friction_speed()).epsilon(0.05).scale(0));
        CHECK(f.profile < 0.1);
        CHECK(f.mean == doctest::Approx(bed.mean_log_law()).epsilon(0.05).scale(0));
        CHECK(f.mean == doctest::Approx(bed.mean_manning()).epsilon(0.1).scale(0));
    }
}

TEST_CASE("cells smaller than the bed is rough: the mean speed stays") {
    const Bed bed{.depth = 0.2, .slope = 0.01, .manning = 0.02};  // k_s = 0.0198 m
    for (const int cells : {8, 20, 40}) {
        const Found f = told(std::to_string(cells) + " cells, " +
                                 short_text(bed.depth / cells / bed.roughness()) + " k_s high",
                             bed, found(bed, cells, bed.depth / cells, MixingLength{{.depth = bed.depth}}));
        CHECK(f.mean == doctest::Approx(bed.mean_log_law()).epsilon(0.03).scale(0));
    }
}

TEST_CASE(
    "Smagorinsky's length is no model of the mean flow: without eddies of its own the water runs too fast") {
    const Bed bed = bed_of(reference_table("flu12_open_channel_uniform_flow.csv").front());
    for (const Real constant : {0.1, 0.17})
        for (const int cells : {5, 10, 20}) {
            const auto run = [&](Real shape) {
                return told(
                    "C_s " + short_text(constant) + ", " + std::to_string(cells) + " cells, " +
                        short_text(shape) + " times as long as high",
                    bed, found(bed, cells, shape * bed.depth / cells, Smagorinsky{{.constant = constant}}));
            };
            // Its length is a small share of the depth: the shear that carries the weight is too large.
            CHECK(run(1).mean > 1.3 * bed.mean_log_law());
            // In cells so long that only the bed limits eddies the length is kappa z.
            const Found flat = run(100);
            CHECK(flat.friction_speed == doctest::Approx(bed.friction_speed()).epsilon(0.05).scale(0));
            if (constant * std::sqrt(100.0) / cells > 0.08) CHECK(flat.profile < 0.1);
        }
}
