// The seam for solids that move in water, with solids that are none: a fan and a piston.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

/// What does nothing: the seam's least.
struct Idle {
    static constexpr bool present = true;
    void place(const Grid<3>&, const BoundaryConditions<3>&, std::span<const FlowBody>, const FaceField<3>*,
               Real) {}
    void close(Poisson<3>&, std::span<const OpenFace>) {}
    void mix_last(FaceField<3>&) const {}
    void to_superficial(FaceField<3>&) const {}
    std::vector<SolidPart> parts() const { return {}; }
    std::vector<SolidPart> resolved_parts() const { return {}; }
    std::span<const SolidFlux> fluxes() const { return {}; }
    Real water_share(std::size_t) const { return 1; }
    void find_closed_cells(const Poisson<3>&) {}
    void slow(FaceField<3>&, const FlowStage&) {}
    void give_back(FaceField<3>&, Real) const {}
    void mix(FaceField<3>&) const {}
    void unmix(FaceField<3>&) const {}
    void to_interstitial(FaceField<3>&) const {}
    void force(FaceField<3>&, const Field<Real>&, const FlowStage&) {}
    void push(const auto&, Real) {}
    void correct(FaceField<3>&, const auto&, Real, int, bool) const {}
    Real add_product(const Field<float>&, Field<float>&) { return 0; }
    void settle(FaceField<3>&, Field<Real>&) {}
    std::vector<SolidVolume> volumes(bool) const { return {}; }
    Vec3 moment(const Grid<3>&, const Field<Real>*, bool) const { return Vec3::Zero(); }
    Real lost_to_friction() const { return 0; }
    Real fastest() const { return 0; }
    std::span<const FlowBody> bodies() const { return {}; }
    static void fields(auto&&) {}
};

/// A force per volume along x on the faces of one cell column.
struct Fan : Idle {
    std::vector<Offset> faces;
    Real force_per_volume = 0;  ///< [N/m3]
    void force(FaceField<3>& u, const Field<Real>&, const FlowStage& stage) {
        for (const Offset f : faces) u[0][f] += stage.dt * force_per_volume / stage.density;
    }
};

/// Faces across x that let pass what the piston's speed has them pass, and nothing else.
struct Piston : Idle {
    std::vector<Offset> faces;
    Real speed = 0;  ///< [m/s]
    void close(Poisson<3>& m, std::span<const OpenFace>) {
        for (const Offset f : faces) m.face[0][f] = 0;
    }
    void force(FaceField<3>& u, const Field<Real>&, const FlowStage&) {
        for (const Offset f : faces) u[0][f] = speed;
    }
};

static_assert(SolidsInFlow<Idle> && SolidsInFlow<Fan> && SolidsInFlow<Piston>);
struct HalfASolid {
    static constexpr bool present = true;
};
static_assert(!SolidsInFlow<HalfASolid>);

template <class Solids>
using Flow = GridFluid<3, Among<Solids, FullBox>>;

constexpr int n = 12;

GridFluidParams<3> box(Boundary side) {
    return {.grid = {.cells = {n, n, n}, .spacing = Vec3::Constant(0.1)},
            .boundaries = BoundaryConditions<3>::all(side),
            .density = 1000,
            .viscosity = 1,
            .tolerance = 1e-9};
}

}  // namespace

TEST_CASE("solids that do nothing leave the bits of a flow as they were") {
    auto params = box(Boundary::wall);
    params.velocity = [](const Vec3& x) { return Vec3(std::sin(7 * x[1]), std::sin(5 * x[2]), 0); };
    GridFluid<3, FullBox> plain(params);
    Flow<Idle> idle(params);
    for (int k = 0; k < 5; ++k) {
        const Real dt = plain.stable_step().seconds;
        plain.step(dt), idle.step(dt);
    }
    for (int a = 0; a < 3; ++a)
        plain.grid().for_each(
            [&](const auto&, Offset c) { REQUIRE(plain.velocity()[a][c] == idle.velocity()[a][c]); });
}

TEST_CASE("a force per volume: in a periodic box all of its impulse stays with the water") {
    const auto params = box(Boundary::periodic);
    const Grid<3> grid(params.grid);
    Fan fan;
    fan.force_per_volume = 300;
    for (int j = 4; j < 7; ++j) fan.faces.push_back(grid.layout().at({5, j, 6}));
    Flow<Fan> flow(params, {}, fan);
    while (flow.time() < 0.5) flow.advance(std::min(0.5, flow.time() + 0.02));
    Vec3 momentum = Vec3::Zero();
    for (int a = 0; a < 3; ++a)
        grid.for_each([&](const auto&, Offset c) { momentum[a] += 1000 * 1e-3 * flow.velocity()[a][c]; });
    const Real impulse = 300 * 3 * 1e-3 * 0.5;  // force per volume, volumes, time
    CHECK(momentum[0] == doctest::Approx(impulse).epsilon(1e-9));
    CHECK(std::abs(momentum[1]) + std::abs(momentum[2]) < 1e-9 * impulse);
}

TEST_CASE(
    "a source of divergence: a piston as wide as the box drives all of the water, a narrower one a jet") {
    auto params = box(Boundary::free_slip);
    params.boundaries[0] = {Boundary::periodic, Boundary::periodic};
    const Grid<3> grid(params.grid);
    for (const int width : {n, 4}) {
        Piston piston;
        piston.speed = 0.3;
        for (int j = 0; j < width; ++j)
            for (int k = 0; k < width; ++k) piston.faces.push_back(grid.layout().at({5, j, k}));
        Flow<Piston> flow(params, {}, piston);
        std::vector<FlowBody> nobody;
        for (int step = 0; step < 3; ++step) flow.advance(flow.time() + 0.01, nobody);
        CAPTURE(width);
        Real through = 0, worst = 0;
        grid.for_each([&](const CellNumber<3>& cell, Offset c) {
            if (cell[0] == 5) through += 0.01 * flow.velocity()[0][c];
            if (width == n) worst = std::max(worst, std::abs(flow.velocity()[0][c] - 0.3));
        });
        CHECK(worst < 1e-7);
        for (const Offset f : piston.faces) REQUIRE(flow.velocity()[0][f] == 0.3);
        // Beside a narrow one water flows back; the net flow is what inertia leaves of it.
        CHECK(through <= 0.01 * width * width * 0.3 * (1 + 1e-6));
        CHECK(flow.last_projection().after < 1e-8);
    }
}
