// Eddy viscosity: what a given shear makes of it, where there is none, what walls let it be, and that the
// water feels it.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

template <int Dim, class Model = Smagorinsky, class Surface = FullBox>
using Flow = GridFluid<Dim, Turbulent<Model, Surface>>;

/// Velocity on all faces and ghosts, as a function of the place.
template <int Dim>
FaceField<Dim> velocity(const Grid<Dim>& grid, auto&& of) {
    FaceField<Dim> u = face_field<Dim>(grid.layout());
    grid.for_each(
        [&](const CellNumber<Dim>& cell, Offset c) {
            for (int a = 0; a < Dim; ++a) u[a][c] = of(grid.face_centre(a, cell))[a];
        },
        Layout<Dim>::ghosts);
    return u;
}

/// nu_t of a velocity that no side has touched; sides glide, so there are no walls.
template <int Dim, class Model>
std::vector<Real> eddies(const Grid<Dim>& grid, const Model& model, auto&& of) {
    GridFluidParams<Dim> params{.grid = grid.params(),
                                .boundaries = BoundaryConditions<Dim>::all(Boundary::free_slip)};
    detail::EddyViscosity<Dim, Real, Model> found(grid, params, model, nullptr);
    found.find(velocity(grid, of), VelocityBoundaries<Dim>(grid, params.boundaries, {}));
    std::vector<Real> values;
    grid.for_each([&](const auto&, Offset c) { values.push_back(found.field()[c]); });
    CHECK(found.largest() == *std::max_element(values.begin(), values.end()));
    return values;
}

/// Even levels and uneven ones.
std::vector<Grid<3>> grids() {
    return {Grid<3>({.cells = {5, 21, 4}, .spacing = {0.1, 0.2, 0.3}}),
            Grid<3>({.cells = {5, 21, 4}, .spacing = {0.1, 0.2, 0}, .levels = {0, 0.1, 0.3, 0.35, 0.5}})};
}
/// All components; its trace, the divergence, is 0.
Mat3 any_gradient() {
    Mat3 any;
    any << 0.3, -0.7, 1.1, 0.4, 0.5, -0.2, 2.0, 0.6, -0.8;
    return any;
}
/// nu_t = (C Delta)^2 rate in a flow of that gradient.
void check_any_gradient(const auto& model, Real constant, Real rate, Real tolerance) {
    for (const Grid<3>& grid : grids()) {
        const auto found = eddies(grid, model, [&](const Vec3& x) { return Vec3(any_gradient() * x); });
        std::size_t k = 0;
        grid.for_each([&](const CellNumber<3>& cell, Offset) {
            REQUIRE(found[k++] == doctest::Approx(square(constant * std::cbrt(grid.volume(cell))) * rate)
                                      .epsilon(tolerance)
                                      .scale(0));
        });
    }
}

}  // namespace

TEST_CASE("pure shear, stretch and all at once: nu_t = (C_s Delta)^2 |S|") {
    const Smagorinsky model{{.constant = 0.17}};
    const Grid<3> cubes = grids().front();
    Mat3 shear;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
            shear.setZero();
            shear(a, b) = 3;
            const Real rate = a == b ? std::sqrt(2.0) * 3 : 3;
            for (const Real nu : eddies(cubes, model, [&](const Vec3& x) { return Vec3(shear * x); }))
                REQUIRE(nu == doctest::Approx(square(0.17) * std::cbrt(square(0.006)) * rate).epsilon(1e-12));
        }
    const Mat3 strain = 0.5 * (any_gradient() + any_gradient().transpose());
    check_any_gradient(model, 0.17, std::sqrt(2 * strain.squaredNorm()), 1e-12);
    const Grid<2> plane({.cells = {4, 19}, .spacing = {0.1, 0.2}});
    for (const Real nu : eddies(plane, model, [](const Point<2>& x) { return Point<2>(2 * x[1], 0); }))
        REQUIRE(nu == doctest::Approx(square(0.17) * 0.02 * 2).epsilon(1e-12).scale(0));
}

TEST_CASE("no eddies at rest, none in water that turns as a solid body") {
    const Grid<3> grid({.cells = {6, 18, 5}, .spacing = {0.1, 0.2, 0.3}});
    const Vec3 spin(1, -2, 3);
    for (const Real nu : eddies(grid, Smagorinsky(), [](const Vec3&) { return Vec3(0, 0, 0); }))
        REQUIRE(nu == 0);
    for (const Real nu : eddies(grid, Smagorinsky(), [&](const Vec3& x) { return Vec3(spin.cross(x)); }))
        REQUIRE(nu < 1e-15);
}

TEST_CASE("Wale: the closed form of any gradient, on even and uneven levels, and none in pure shear") {
    const Wale model{{.constant = 0.4}};
    const Mat3 any = any_gradient(), squared = any * any;
    // Index by index, as the paper writes it.
    Real s2 = 0, d2 = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            s2 += square((any(i, j) + any(j, i)) / 2);
            d2 += square((squared(i, j) + squared(j, i)) / 2 - (i == j ? squared.trace() / 3 : 0));
        }
    const Real rate = std::pow(d2, 1.5) / (std::pow(s2, 2.5) + std::pow(d2, 1.25));
    CHECK(rate > 0.1);
    check_any_gradient(model, 0.4, rate, 1e-11);
    for (const Grid<3>& grid : grids())
        for (const Real nu : eddies(grid, model, [](const Vec3& x) { return Vec3(3 * x.z(), 0, 0); }))
            REQUIRE(nu == 0);
}

TEST_CASE("Wale: beside a wall nu_t falls with the cube of the distance, Smagorinsky's with the square") {
    // No slip at z = 0: along the wall the velocity grows with z, off it with z^2, and it has no divergence.
    const auto gradient = [](Real z) {
        Mat3 g;
        g << 0.3 * z, 0.2 * z, 5, -0.4 * z, 0.1 * z, 1, 0.7 * z * z, -0.2 * z * z, -0.4 * z;
        return g;
    };
    const Wale model;
    const Real near = model.viscosity(gradient(1e-4), 0.01, 1e-4),
               nearer = model.viscosity(gradient(5e-5), 0.01, 5e-5);
    CHECK(nearer > 0);
    CHECK(near / nearer == doctest::Approx(8).epsilon(1e-2));
    const Smagorinsky by_length;
    CHECK(square(by_length.length(0.01, 1e-4) / by_length.length(0.01, 5e-5)) == doctest::Approx(4));
}

TEST_CASE("Wale: vortices decay beside a bed, below a surface; what eddies take is booked") {
    BoundaryConditions<3> boundaries = BoundaryConditions<3>::all(Boundary::wall);
    boundaries[0] = {Boundary::periodic, Boundary::periodic};
    Flow<3, Wale, FreeSurface> flow({.grid = {.cells = {16, 16, 12}, .spacing = Point<3>::Constant(0.05)},
                                     .boundaries = boundaries,
                                     .wall = [](const Point<3>& x) { return x[2] - 0.12; },
                                     .water = [](const Point<3>& x) { return 0.5 - x[2]; },
                                     .velocity =
                                         [](const Point<3>& x) {
                                             const Real k = 2 * pi / 0.8;
                                             return Point<3>(std::cos(k * x[0]) * std::sin(k * x[1]) + 0.5,
                                                             -std::sin(k * x[0]) * std::cos(k * x[1]), 0);
                                         },
                                     .gravity = {0, 0, -9.81}},
                                    Wale{{.constant = 0.5}});
    flow.open_energy_account();
    flow.advance(0.3);
    Real most = 0;
    flow.grid().for_each([&](const auto&, Offset c) {
        if (flow.liquid().fraction()[c] > 0) most = std::max(most, flow.eddy_viscosity()[c]);
    });
    CHECK(most > 0);
    const WaterEnergy& e = flow.energy();
    MESSAGE("of " << e.kinetic_start << " J of motion eddies took " << e.turbulent << ", viscosity "
                  << e.viscous << ", the bed " << e.wall_friction << "; numerical " << e.numerical);
    CHECK(e.kinetic < e.kinetic_start);
    CHECK(e.turbulent > 10 * e.viscous);
    CHECK(e.turbulent < e.kinetic_start - e.kinetic);
    CHECK(e.residual_relative() < 1e-12);
}

TEST_CASE("beside walls, at sides and inside, eddies are no larger than their distance lets them be") {
    // Flat cells: C_s Delta = 0.1 m, the first six levels are nearer than 0.1 / kappa.
    const auto shear = [](const Point<2>& x) { return Point<2>(4 * x[1], 0); };
    const Smagorinsky model{{.constant = 0.1}};
    BoundaryConditions<2> boundaries;
    boundaries[0] = {Boundary::periodic, Boundary::periodic};
    boundaries[1] = {Boundary::wall, Boundary::free_slip};
    GridFluidParams<2> params{.grid = {.cells = {4, 40}, .spacing = {25, 0.04}},
                              .boundaries = boundaries,
                              .wall_law = {WallLaw::Kind::logarithmic, 1e-3},
                              .velocity = shear};
    const Flow<2> box(params, model);
    for (int k = 0; k < 39; ++k) {
        const Real d = (k + 0.5) * 0.04, length = std::min(0.1, 0.41 * d);
        CHECK(box.eddy_viscosity()[box.grid().layout().at({2, k})] ==
              doctest::Approx(square(length) * 4).epsilon(1e-12).scale(0));
    }
    CHECK(Smagorinsky().length(1, 0) == 0);
    CHECK(Smagorinsky().length(1, -1) == 0);
    CHECK(MixingLength{{.depth = 1}}.length(7, 0.5) ==
          doctest::Approx(0.41 * 0.5 * std::sqrt(0.5)).epsilon(1e-14));
    CHECK(MixingLength{{.depth = 1}}.length(7, 2) == 0);

    // The mean flow's are bounded by what they are in uniform flow of that u*.
    const MixingLength bounded{{.depth = 1.6, .friction_velocity = 0.3}};
    const Flow<2, MixingLength> uniform(params, bounded);
    for (int k = 0; k < 39; ++k) {
        const Real d = (k + 0.5) * 0.04, free = square(bounded.length(7, d)) * 4;
        CHECK(uniform.eddy_viscosity()[uniform.grid().layout().at({2, k})] ==
              doctest::Approx(std::min(free, 0.41 * 0.3 * d * (1 - d / 1.6))).epsilon(1e-12).scale(0));
    }

    // A bed inside, which cuts the second level in the middle: what is open of it lies 0.01 m above the bed.
    params.boundaries[0] = {Boundary::free_slip, Boundary::free_slip};
    params.boundaries[1] = {Boundary::free_slip, Boundary::free_slip};
    params.wall = [](const Point<2>& x) { return x[1] - 0.06; };
    params.water = [](const Point<2>&) { return 1.0; };
    params.velocity = {};
    const Grid<2> grid(params.grid);
    const EmbeddedBoundary<2> walls(grid, params.wall);
    detail::EddyViscosity<2, Real, Smagorinsky> cut(grid, params, model, &walls);
    auto u = velocity(grid, shear);
    grid.for_each([&](const auto& cell, Offset c) { u[0][c] *= cell[1] > 0; });  // the solid's is 0
    cut.find(u, VelocityBoundaries<2>(grid, params.boundaries, {}));
    const auto at = [&](int k) { return cut.field()[grid.layout().at({2, k})]; };
    CHECK(at(0) == 0);
    CHECK(at(1) == doctest::Approx(square(0.41 * 0.01) * 4).epsilon(1e-12).scale(0));
    CHECK(at(2) == doctest::Approx(square(0.41 * 0.04) * 4).epsilon(1e-12).scale(0));
}

TEST_CASE("beside what bodies cover of cells eddies are those that a cell does not resolve") {
    const Grid<3> grid({.cells = {6, 7, 8}, .spacing = {0.1, 0.2, 0.3}});
    GridFluidParams<3> params{.grid = grid.params(),
                              .boundaries = BoundaryConditions<3>::all(Boundary::free_slip)};
    params.boundaries[0] = {Boundary::periodic, Boundary::periodic}, params.boundaries[2][0] = Boundary::wall;
    const MixingLength model{{.depth = 2.5, .friction_velocity = 1e3, .beside_bodies = 0.05}};
    detail::EddyViscosity<3, Real, MixingLength> found(grid, params, model, nullptr, true);
    const auto u = velocity(grid, [](const Vec3& x) { return Vec3(4 * x.z(), 0, 0); });
    const VelocityBoundaries<3> boundaries(grid, params.boundaries, {});
    const auto look = [&](std::initializer_list<CellNumber<3>> covered) {
        std::vector<SolidPart> parts;
        for (const auto& cell : covered) parts.push_back({grid.layout().at(cell), 1e-3});
        found.make_way(grid, params.boundaries, parts);
        found.find(u, boundaries);
        int near = 0;
        grid.for_each([&](const CellNumber<3>& at, Offset c) {
            const Real free = square(model.length(0, grid.centre(at).z())) * 4;
            const Real small = square(0.05) * std::pow(grid.volume(at), 2.0 / 3) * 4;
            const bool is_near = std::ranges::any_of(covered, [&](const CellNumber<3>& cell) {
                const int along = std::abs(at[0] - cell[0]);
                return std::min(along, 6 - along) <= 1 && std::abs(at[1] - cell[1]) <= 1 &&
                       std::abs(at[2] - cell[2]) <= 1;
            });
            REQUIRE(found.field()[c] ==
                    doctest::Approx(is_near ? std::min(free, small) : free).epsilon(1e-12).scale(0));
            near += is_near;
        });
        return near;
    };
    CHECK(look({}) == 0);
    CHECK(look({{2, 3, 4}}) == 27);
    CHECK(look({{2, 3, 4}, {3, 3, 4}}) == 36);
    CHECK(look({{0, 0, 7}}) == 12);  // round the periodic side, not beyond the others
    CHECK(look({}) == 0);            // and gone without a trace
    CHECK_THROWS_WITH_AS((detail::EddyViscosity<3, Real, MixingLength>(
                             grid, params, MixingLength{{.depth = 1}}, nullptr, true)),
                         "MixingLength.friction_velocity, among bodies must be finite, got inf m/s; give "
                         "sqrt(g depth slope) of uniform flow, or their wakes make nu_t twenty times too "
                         "large",
                         InputError);
}

TEST_CASE("a step that eddies allow, and parameters that make none") {
    GridFluidParams<2> params{
        .grid = {.cells = {8, 8}, .spacing = {0.1, 0.1}},
        .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
        .velocity = [](const Point<2>& x) { return Point<2>(std::sin(pi * x[1] / 0.1), 0); },
        .viscosity = 0,
        .courant = 1};
    params.boundaries[0] = {Boundary::periodic, Boundary::periodic};
    const Flow<2> flow(params, Smagorinsky{{.constant = 0.5}});
    Real most = 0;
    flow.grid().for_each([&](const auto&, Offset c) { most = std::max(most, flow.eddy_viscosity()[c]); });
    CHECK(most > 0);
    CHECK(flow.stable_step().limit == "viscosity");
    CHECK(describe(flow).starts_with(
        "GridFluid[full box, Koren, double, ConjugateGradients, "
        "Smagorinsky(constant = 0.5, karman = 0.41), NoSolids, NoForcing](cells_x = 8, "));
    constexpr Real speed = 1 / 0.1;  // sum |u| / h, in one limit with 2 nu sum 1/h2 [1/s]
    CHECK(flow.stable_step().seconds ==
          doctest::Approx(1 / (speed + 2 * most * 200)).epsilon(1e-12).scale(0));
    CHECK_THROWS_WITH_AS((Flow<2>(params, Smagorinsky{{.constant = -1}})),
                         "Smagorinsky.constant must be in (0, 0.5], got -1; 0.1 in channels, 0.17 far from "
                         "walls",
                         InputError);
    CHECK_THROWS_AS((Flow<2, MixingLength>(params)), InputError);
}

TEST_CASE("eddies of slow water do not shorten the step of fast water beside it") {
    // The lower half shears to and fro, the upper one goes as a whole.
    const auto speed = [](Real z) { return z < 0.8 ? 0.6 * std::sin(pi * z / 0.1) : 1.0; };
    GridFluidParams<2> params{.grid = {.cells = {16, 16}, .spacing = {0.1, 0.1}},
                              .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                              .velocity = [&](const Point<2>& x) { return Point<2>(speed(x[1]), 0); },
                              .viscosity = 0,
                              .courant = 1};
    params.boundaries[0] = {Boundary::periodic, Boundary::periodic};
    Flow<2> flow(params, Smagorinsky{{.constant = 0.5}});
    const Layout<2>& layout = flow.grid().layout();
    const auto nu = [&](int i, int k) { return flow.eddy_viscosity()[layout.at({i, std::clamp(k, 0, 15)})]; };
    Real together = 0, most = 0;
    for (int k = 0; k < 16; ++k) {
        const Real friction = 2 * nu(8, k) + nu(8, k) + 0.5 * (nu(8, k - 1) + nu(8, k + 1));
        together = std::max(together, std::abs(speed(0.1 * (k + 0.5))) / 0.1 + friction / 0.01);
        most = std::max(most, nu(8, k));
    }
    CHECK(flow.stable_step().seconds == doctest::Approx(1 / together).epsilon(1e-12).scale(0));
    CHECK(flow.stable_step().seconds > 1.15 / (1 / 0.1 + 4 * most / 0.01));
    Real energy = std::numeric_limits<Real>::infinity();
    for (int n = 0; n < 200; ++n) {
        flow.step(flow.stable_step().seconds);
        Real now = 0;
        flow.grid().for_each([&](const auto&, Offset c) {
            for (int a = 0; a < 2; ++a) now += square(flow.velocity()[a][c]);
        });
        REQUIRE(now <= energy);
        energy = now;
    }
}

TEST_CASE("shear and weight are in balance: the water feels just nu + nu_t") {
    // Between a bed that holds it and a lid, periodic: what the bed takes is what the weight gives.
    BoundaryConditions<3> boundaries;
    boundaries[0] = {Boundary::periodic, Boundary::periodic};
    boundaries[1] = {Boundary::periodic, Boundary::periodic};
    boundaries[2] = {Boundary::wall, Boundary::free_slip};
    const int n = 8;
    Flow<3> flow({.grid = {.cells = {4, 4, n}, .spacing = {1, 1, 1.0 / n}},
                  .boundaries = boundaries,
                  .gravity = {1, 0, 0},
                  .density = 1,
                  .viscosity = 0.1,
                  .tolerance = 1e-9});
    flow.advance(70);
    const auto u = [&](int k) { return flow.velocity()[0][flow.grid().layout().at({1, 2, k})]; };
    const auto nu_t = [&](int k) { return flow.eddy_viscosity()[flow.grid().layout().at({1, 2, k})]; };
    CHECK(nu_t(3) > 0.001);
    for (int k = 1; k < n; ++k)
        CHECK((0.1 + 0.5 * (nu_t(k) + nu_t(k - 1))) * (u(k) - u(k - 1)) * n ==
              doctest::Approx(1 - Real(k) / n).epsilon(1e-6).scale(0));
    CHECK(0.1 * u(0) * 2 * n == doctest::Approx(1).epsilon(1e-6).scale(0));  // no eddies at the wall
}

TEST_CASE("eddies at a surface: none in the air, the same bits for one thread and two") {
    std::vector<Real> bits;
    for (const int threads : {1, 2}) {
        set_thread_count(threads);
        Flow<3, Smagorinsky, FreeSurface> flow(
            {.grid = {.cells = {40, 12, 24}, .spacing = Point<3>::Constant(0.05)},
             .boundaries = BoundaryConditions<3>::all(Boundary::wall),
             .wall = [](const Point<3>& x) { return (x - Point<3>(1, 0.3, 0)).norm() - 0.2; },
             .wall_law = {WallLaw::Kind::logarithmic, 1e-3},
             .water = [](const Point<3>& x) { return std::min(0.6 - x[0], 0.8 - x[2]); },
             .gravity = {0, 0, -9.81}},
            Smagorinsky{{.constant = 0.17}});
        flow.advance(0.15);
        std::vector<Real> now;
        Real most = 0;
        flow.grid().for_each([&](const auto&, Offset c) {
            for (const auto& u : flow.velocity()) now.push_back(u[c]);
            if (flow.liquid().fraction()[c] > 0) {
                now.push_back(flow.eddy_viscosity()[c]);
                most = std::max(most, now.back());
                REQUIRE(now.back() >= 0);
            }
        });
        CHECK(most > 0);
        if (threads == 1)
            bits = now;
        else
            CHECK((bits.size() == now.size() &&
                   std::memcmp(bits.data(), now.data(), now.size() * sizeof(Real)) == 0));
    }
}

TEST_CASE("single precision, and a full box along a logarithmic bed that goes wrong and is left as it was") {
    BoundaryConditions<2> boundaries;
    boundaries[0] = {Boundary::periodic, Boundary::periodic};
    boundaries[1] = {Boundary::wall, Boundary::free_slip};
    GridFluidParams<2> params{.grid = {.cells = {8, 16}, .spacing = {0.1, 0.05}},
                              .boundaries = boundaries,
                              .wall_law = {WallLaw::Kind::logarithmic, 1e-3},
                              .velocity = [](const Point<2>&) { return Point<2>(1, 0); },
                              .velocity_limit = 2};
    GridFluid<2, Turbulent<Smagorinsky, InPrecision<float, FullBox>>> single(params);
    Flow<2> flow(params);
    flow.advance(0.5), single.advance(0.5);
    const Offset low = flow.grid().layout().at({0, 0}), high = flow.grid().layout().at({0, 15});
    CHECK(flow.velocity()[0][low] < 0.98);  // the bed holds it
    CHECK(flow.velocity()[0][high] > 0.99);
    for (const Offset c : {low, high})
        CHECK(single.velocity()[0][c] == doctest::Approx(flow.velocity()[0][c]).epsilon(1e-5));

    params.gravity = {10, 0};
    Flow<2> wrong(params);
    const auto before = wrong.velocity();
    CHECK_THROWS_AS(wrong.step(1), FluidError);
    for (int a = 0; a < 2; ++a)
        wrong.grid().for_each(
            [&](const auto&, Offset c) { REQUIRE(wrong.velocity()[a][c] == before[a][c]); });
}
