// Water below a surface in a box whose ends are one: nothing tells where they meet.
#include <abrade/fluid/momentum/turbulence.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real g = 9.81;

template <int Dim>
GridFluidParams<Dim> box(const CellNumber<Dim>& cells, Real spacing) {
    GridFluidParams<Dim> params;
    params.grid = {.cells = cells, .spacing = Point<Dim>::Constant(spacing)};
    params.boundaries = BoundaryConditions<Dim>::all(Boundary::free_slip);
    for (int a = 0; a < Dim - 1; ++a) params.boundaries[a] = {Boundary::periodic, Boundary::periodic};
    params.gravity[Dim - 1] = -g;
    params.tolerance = 1e-10;
    return params;
}

/// The same flow, begun `shift` cells farther along all periodic axes.
template <int Dim>
void same_wherever_it_begins(const GridFluidParams<Dim>& params, const CellNumber<Dim>& shift, int steps,
                             auto&& make) {
    const Grid<Dim> grid(params.grid);
    const auto moved = [&](Point<Dim> x) {
        for (int a = 0; a < Dim - 1; ++a) {
            const Real length = grid.high(a) - grid.low(a);
            x[a] -= shift[a] * grid.size(a, 0);
            x[a] -= length * std::floor((x[a] - grid.low(a)) / length);
        }
        return x;
    };
    GridFluidParams<Dim> other = params;
    other.water = [&](const Point<Dim>& x) { return params.water(moved(x)); };
    if (params.velocity) other.velocity = [&](const Point<Dim>& x) { return params.velocity(moved(x)); };
    auto flow = make(params), flow_moved = make(other);
    const Real volume = flow.liquid().volume();
    Real volume_off = 0;
    const auto run = [&](int count) {
        for (int k = 0; k < count; ++k) {
            const Real dt = std::min(flow.stable_step().seconds, flow_moved.stable_step().seconds);
            flow.step(dt), flow_moved.step(dt);
            volume_off = std::max(volume_off, std::abs(flow.liquid().volume() / volume - 1));
        }
    };
    const auto check = [&](Real most) {
        Real fraction_off = 0, speed_off = 0, fastest = 0;
        grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            CellNumber<Dim> to = cell;
            for (int a = 0; a < Dim - 1; ++a) to[a] = (cell[a] + shift[a]) % grid.cells(a);
            const Offset d = grid.layout().at(to);
            const auto &f = flow.liquid().fraction(), &f_moved = flow_moved.liquid().fraction();
            fraction_off = std::max(fraction_off, std::abs(f[c] - f_moved[d]));
            for (int a = 0; a < Dim && f[c] >= 0.5; ++a) {
                const auto &u = flow.velocity()[a], &u_moved = flow_moved.velocity()[a];
                speed_off = std::max(speed_off, std::abs(u[c] - u_moved[d]));
                fastest = std::max(fastest, std::abs(u[c]));
            }
        });
        MESSAGE("off by " << fraction_off << " of a cell, " << speed_off << " m/s of " << fastest
                          << "; volume by " << volume_off << " after " << flow.time() << " s");
        CHECK(fastest > 0.5);
        CHECK(fraction_off < most);
        CHECK(speed_off < most * fastest);
        CHECK(volume_off < 1e-12);
    };
    run(3);
    check(1e-6);
    // What is left of the pressure differs, and cells go from dry to wet by it: 1e-3 as well without a shift.
    run(steps - 3);
    check(5e-3);
}

template <int Dim>
GridFluid<Dim> plain(const GridFluidParams<Dim>& params) {
    return GridFluid<Dim>(params);
}

}  // namespace

TEST_CASE("periodic_surface: waves do not see where the ends meet, 2-D") {
    auto params = box<2>({24, 20}, 1.0 / 24);
    params.water = [](const Point<2>& x) {
        return 0.35 + 0.1 * std::sin(2 * pi * x[0]) + 0.02 * std::cos(4 * pi * x[0]) - x[1];
    };
    params.velocity = [](const Point<2>& x) { return Point<2>(0.8, 0.1 * std::sin(2 * pi * x[0])); };
    for (const int shift : {1, 11, 12, 23}) same_wherever_it_begins<2>(params, {shift, 0}, 40, plain<2>);
}

TEST_CASE("periodic_surface: 3-D") {
    auto params = box<3>({12, 10, 12}, 1.0 / 12);
    params.water = [](const Vec3& x) {
        return 0.35 + 0.1 * std::sin(2 * pi * x[0] + 0.3) * std::cos(2.4 * pi * x[1] - 0.7) +
               0.03 * std::sin(2.4 * pi * x[1]) - x[2];
    };
    params.velocity = [](const Vec3& x) { return Vec3(0.8, 0.5, 0.1 * std::sin(2 * pi * x[0])); };
    for (const CellNumber<3> shift :
         {CellNumber<3>{6, 0, 0}, CellNumber<3>{11, 1, 0}, CellNumber<3>{1, 5, 0}})
        same_wherever_it_begins<3>(params, shift, 25, plain<3>);
}

TEST_CASE("periodic_surface: a block of water that ends where the ends meet, on a dry floor") {
    auto params = box<3>({6, 10, 8}, 0.1);
    params.water = [](const Vec3& x) { return std::min(0.5 - x[2], 0.18 - std::abs(x[1] - 0.5)); };
    params.velocity = [](const Vec3&) { return Vec3(0.8, 0.5, 0); };
    // Cells 3 to 6 across; moved, 6 to 9, and 0 to 3. Not for long: a steep front in the first or the last
    // cell is told from shorter columns (SurfaceNormals), which is seen from about 1e-4 of a cell on.
    for (const int shift : {3, 7}) same_wherever_it_begins<3>(params, {0, shift, 0}, 3, plain<3>);
}

TEST_CASE("periodic_surface: a film that runs around on a rough bed below whole cells, with eddies") {
    auto params = box<2>({24, 16}, 0.05);
    params.gravity[0] = 0.1;
    params.wall = [](const Point<2>& x) { return x[1] - 0.13; };
    params.wall_law = {WallLaw::Kind::logarithmic, 1e-3};
    params.water = [](const Point<2>& x) { return 0.45 + 0.06 * std::sin(2 * pi * x[0] / 1.2) - x[1]; };
    params.velocity = [](const Point<2>&) { return Point<2>(1, 0); };
    for (const int shift : {1, 13})
        same_wherever_it_begins<2>(params, {shift, 0}, 40, [](const GridFluidParams<2>& p) {
            return GridFluid<2, Turbulent<MixingLength>>(p, MixingLength{{.depth = 0.32}});
        });
}

TEST_CASE("periodic_surface: velocity and surface are asked for across the ends") {
    auto params = box<2>({16, 12}, 1.0 / 16);
    params.water = [](const Point<2>& x) { return 0.4 + 0.05 * std::cos(2 * pi * x[0] - 0.4) - x[1]; };
    params.velocity = [](const Point<2>& x) {
        const Real k = 2 * pi;
        return Point<2>(std::cos(k * x[0]) * std::cosh(k * x[1]), std::sin(k * x[0]) * std::sinh(k * x[1]));
    };
    const GridFluid<2> flow(params);
    const auto at = [&](Real x) { return flow.sample({x, 0, 0.2}, 0); };
    // Linear between centres: within the last half cell nothing jumps, and beyond the end it begins anew.
    const Real cell = 1.0 / 16;
    for (const Real x : {0.0, 0.3 * cell, 0.5}) {
        CHECK(at(x + 1).velocity.isApprox(at(x).velocity, 1e-12));
        CHECK(flow.surface_at({x - 2, 0}) == doctest::Approx(flow.surface_at({x, 0})).epsilon(1e-12));
    }
    const auto mean = [](Real a, Real b) { return doctest::Approx(0.5 * (a + b)).epsilon(1e-12); };
    CHECK(at(0).velocity.z() == mean(at(-0.5 * cell).velocity.z(), at(0.5 * cell).velocity.z()));
    CHECK(flow.surface_at({0.0, 0}) ==
          mean(flow.surface_at({0.5 * cell, 0}), flow.surface_at({1 - 0.5 * cell, 0})));
    CHECK(flow.surface_at({0.25 * cell, 0}) < flow.surface_at({0.5 * cell, 0}) - 1e-4);
}

TEST_CASE("periodic_surface: a wall that does not repeat itself is refused") {
    auto params = box<2>({16, 12}, 1.0 / 16);
    params.water = [](const Point<2>& x) { return 0.5 - x[1]; };
    params.wall = [](const Point<2>& x) { return x[1] - 0.1 - 0.02 * x[0]; };
    std::string said;
    try {
        const GridFluid<2> flow(params);
    } catch (const InputError& error) {
        said = error.what();
    }
    MESSAGE(said);
    CHECK(said.starts_with("GridFluid.wall at x = 0 m, z = 0.09375 m must be as far away as at the other"));
    params.wall = [](const Point<2>& x) { return x[1] - 0.1 - 0.02 * std::sin(2 * pi * x[0]); };
    CHECK_NOTHROW(GridFluid<2>{params});
}
