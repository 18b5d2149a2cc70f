// The free surface: planes found exactly beside walls too, volume kept to round-off whatever the velocities,
// fractions within their bounds, sides, threads, bad input.
#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/vof/fill_below.hpp>
#include <abrade/fluid/vof/volume_of_fluid.hpp>

#include <doctest/doctest.h>

#include "../message_of.hpp"

#include <random>

using namespace abrade;

namespace {

template <int Dim>
Grid<Dim> grid_of(const CellNumber<Dim>& cells, bool cubes, bool stretched) {
    typename Grid<Dim>::Params params{.cells = cells};
    for (int a = 0; a < Dim; ++a) params.spacing[a] = 0.1 * (cubes ? 1 : 1 + 0.2 * a);
    if (stretched) {
        params.levels = {0};
        for (int k = 0; k < cells[Dim - 1]; ++k)
            params.levels.push_back(params.levels.back() + 0.1 * std::pow(1.08, k));
    }
    return Grid<Dim>(params);
}

/// Random planes through a box, and those that are parallel to its sides.
template <int Dim>
void check_planes(bool stretched) {
    CellNumber<Dim> cells;
    for (int a = 0; a < Dim; ++a) cells[a] = 7 + a;
    const Grid<Dim> grid = grid_of<Dim>(cells, false, stretched);
    std::mt19937 random(1);
    std::normal_distribution<Real> normal;
    std::uniform_real_distribution<Real> part(0.3, 0.7);
    VolumeOfFluid<Dim> water(grid, BoundaryConditions<Dim>::all(Boundary::wall));
    Real worst = 0, worst_share = 0;
    long planes = 0, pairs = 0;
    for (int trial = 0; trial < 150; ++trial) {
        Point<Dim> n, through;
        for (int a = 0; a < Dim; ++a) {
            n[a] = normal(random);
            through[a] = grid.low(a) + part(random) * (grid.high(a) - grid.low(a));
        }
        if (trial % 5 == 0) {
            n.setZero();
            n[trial / 5 % Dim] = trial % 2 ? 1 : -1;
        }
        n.normalize();
        const auto distance = [&](const Point<Dim>& x) { return n.dot(x - through); };
        fill_below<Dim>(water.fraction(), grid, distance, 0);
        water.prepare();
        grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            const Real f = water.fraction()[c];
            // A plane that cuts off less is not told to 1e-10 by a fraction of 16 digits.
            if (std::min(f, 1 - f) > 1e-7) {
                const CellPlane<Dim> found = water.planes().plane(water.plane_of(c));
                Point<Dim> m;
                for (int a = 0; a < Dim; ++a)
                    m[a] = found.normal[static_cast<std::size_t>(a)] / grid.size(a, cell[a]);
                worst = std::max({worst, (m.normalized() - n).norm(),
                                  std::abs(found.distance / m.norm() + distance(grid.centre(cell))) / 0.1});
                ++planes;
            }
            if (f < 0.5) return;
            for (int a = 0; a < Dim; ++a)
                for (const int side : {-1, 1}) {
                    CellNumber<Dim> other = cell;
                    other[a] += side;
                    const int i = other[a];
                    if (i < 0 || i >= grid.cells(a) || water.fraction()[grid.layout().at(other)] >= 0.5)
                        continue;
                    const Real here = distance(grid.centre(cell)), there = distance(grid.centre(other));
                    const Real share = std::clamp(here / (here - there), 0.0, 1.0);
                    worst_share = std::max(worst_share,
                                           std::abs(share - water.surface_share(c, cell[Dim - 1], a, side)));
                    ++pairs;
                }
        });
    }
    CAPTURE(Dim);
    CAPTURE(stretched);
    CHECK(planes > 100 * Dim);
    CHECK(pairs > 100 * Dim);
    CHECK(worst < 1e-10);
    CHECK(worst_share < 1e-10);
}

/// A velocity that is divergence-free but for `noise` [m/s] on each face; nothing passes closed sides.
template <int Dim>
FaceField<Dim> stirred(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries, Real noise) {
    auto u = face_field<Dim>(grid.layout());
    std::mt19937 random(4);
    std::uniform_real_distribution<Real> uniform(-1, 1);
    constexpr int v = Dim - 1;
    const Real width = grid.high(0) - grid.low(0), height = grid.high(v) - grid.low(v);
    const auto stream = [&](Real x, Real z) {
        return std::sin(2 * pi * (x - grid.low(0)) / width) * std::sin(pi * (z - grid.low(v)) / height) *
               width / 10;
    };
    grid.for_each(
        [&](const CellNumber<Dim>& cell, Offset c) {
            const Real x = grid.face(0, cell[0]), z = grid.face(v, cell[v]);
            const Real dx = grid.size(0, cell[0]), dz = grid.size(v, cell[v]);
            u[0][c] = (stream(x, z + dz) - stream(x, z)) / dz;
            u[v][c] = -(stream(x + dx, z) - stream(x, z)) / dx;
            if (Dim == 3) u[1][c] = 0.3;
        },
        1);
    for (int a = 0; a < Dim; ++a)
        grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            u[a][c] += noise * uniform(random);
            // One face at both ends of a periodic axis; none at walls.
            if (cell[a] == 0) {
                if (is_closed(boundaries[a][0])) u[a][c] = 0;
                u[a][c + grid.cells(a) * grid.layout().stride[a]] = u[a][c];
            }
        });
    return u;
}

struct Bounds {
    Real low = 1, high = 0, deepest = 0, largest = 0;  ///< of fraction and volume defect
};
template <int Dim>
Bounds bounds_of(const VolumeOfFluid<Dim>& water) {
    Bounds b;
    water.grid().for_each([&](const CellNumber<Dim>&, Offset c) {
        b.low = std::min(b.low, water.fraction()[c]);
        b.high = std::max(b.high, water.fraction()[c]);
        b.deepest = std::min(b.deepest, water.volume_defect()[c]);
        b.largest = std::max(b.largest, water.volume_defect()[c]);
    });
    return b;
}

template <int Dim>
void check_volume(const BoundaryConditions<Dim>& boundaries, bool stretched, Real noise, int steps) {
    CellNumber<Dim> cells;
    cells.fill(Dim == 3 ? 10 : 24);
    cells[0] += 2;
    const Grid<Dim> grid = grid_of<Dim>(cells, false, stretched);
    VolumeOfFluid<Dim> water(grid, boundaries);
    FaceField<Dim> flux = face_field<Dim>(grid.layout());
    const Point<Dim> middle = 0.5 * (grid.centre(CellNumber<Dim>{}) + grid.centre(cells));
    fill_below<Dim>(
        water.fraction(), grid,
        [&](const Point<Dim>& x) { return std::min((x - middle).norm() - 0.3, x[Dim - 1] - 0.25); }, 2);
    water.prepare();
    const auto u = stirred<Dim>(grid, boundaries, noise);
    const Real before = water.volume(), dt = 0.9 * water.stable_step(u);
    REQUIRE(before > 0);
    Real worst = 0, low = 1, high = 0;
    for (int k = 0; k < steps; ++k) {
        water.advance(u, std::min(dt, 0.9 * water.stable_step(u)), flux);
        worst = std::max(worst, std::abs(water.volume() / before - 1));
        if (k % 50 != 0) continue;
        const Bounds b = bounds_of(water);
        low = std::min(low, b.low);
        high = std::max(high, b.high);
    }
    CAPTURE(Dim);
    CAPTURE(noise);
    // Each step rounds each cell's fraction once or twice, 1e-16 of it.
    CHECK(worst < 1e-12);
    CHECK(low >= 0);
    CHECK(high <= 1);
}

}  // namespace

TEST_CASE("planes are found exactly, whatever their tilt, beside sides too") {
    check_planes<2>(false);
    check_planes<2>(true);
    check_planes<3>(false);
    check_planes<3>(true);
}

TEST_CASE("volume to 1e-12 over 1000 steps, with divergence and without; bounds") {
    check_volume<2>(BoundaryConditions<2>::all(Boundary::wall), false, 0, 1000);
    check_volume<2>(BoundaryConditions<2>::all(Boundary::free_slip), true, 0.01, 1000);
    check_volume<2>(BoundaryConditions<2>::all(Boundary::periodic), false, 0.01, 1000);
    check_volume<3>(BoundaryConditions<3>::all(Boundary::wall), false, 1e-4, 400);
    BoundaryConditions<3> mixed = BoundaryConditions<3>::all(Boundary::periodic);
    mixed[2] = {Boundary::wall, Boundary::wall};
    check_volume<3>(mixed, true, 0.01, 1000);
}

TEST_CASE(
    "in the bulk the volume defect is minus dt div u, and the flow through faces tells all that changed") {
    const Grid<3> grid = grid_of<3>({8, 8, 8}, false, false);
    const auto boundaries = BoundaryConditions<3>::all(Boundary::wall);
    VolumeOfFluid<3> water(grid, boundaries);
    FaceField<3> flux = face_field<3>(grid.layout());
    fill_below<3>(
        water.fraction(), grid, [](const Point<3>& x) { return x[2] - 0.71; }, 0);
    water.prepare();
    const Field<Real> before = water.fraction();
    const auto u = stirred<3>(grid, boundaries, 0.05);
    const Real dt = 0.8 * water.stable_step(u);
    water.advance(u, dt, flux);
    Real worst = 0, worst_bulk = 0, largest = 0;
    int bulk = 0;
    grid.for_each([&](const CellNumber<3>& cell, Offset c) {
        Real out = 0, divergence = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const Offset up = c + grid.layout().stride[a];
            out += flux[a][up] - flux[a][c];
            divergence += (u[a][up] - u[a][c]) / grid.size(static_cast<int>(a), cell[a]);
        }
        const Real change = water.fraction()[c] + water.volume_defect()[c] - before[c];
        worst = std::max(worst, std::abs(change + out / grid.volume(cell)));
        if (cell[2] > 2) return;
        ++bulk;
        CHECK(water.fraction()[c] == 1);
        largest = std::max(largest, std::abs(dt * divergence));
        worst_bulk = std::max(worst_bulk, std::abs(water.volume_defect()[c] + dt * divergence));
    });
    CHECK(bulk == 3 * 64);
    CHECK(largest > 1e-3);
    CHECK(worst < 1e-14);
    CHECK(worst_bulk < 1e-15);
}

TEST_CASE("what divergence leaves in the bulk stays small where the velocity takes it back") {
    // The pressure is told volume defect / dt as its target: here the divergence of each step is just that,
    // and a residual of its own.
    const Grid<2> grid = grid_of<2>({16, 16}, true, false);
    VolumeOfFluid<2> water(grid, BoundaryConditions<2>::all(Boundary::wall));
    FaceField<2> flux = face_field<2>(grid.layout());
    fill_below<2>(
        water.fraction(), grid, [](const Point<2>& x) { return x[1] - 1.2; }, 0);
    water.prepare();
    const Real dt = 0.01, residual = 1e-4;
    std::mt19937 random(9);
    std::uniform_real_distribution<Real> uniform(-residual, residual);
    Real worst = 0;
    for (int k = 0; k < 50; ++k) {
        auto u = face_field<2>(grid.layout());
        // Column by column upwards, so that each cell's divergence is set.
        for (int i = 0; i < 16; ++i)
            for (int z = 0; z < 14; ++z) {
                const Offset c = grid.layout().at({i, z});
                const bool full = water.fraction()[c] == 1;
                u[1][c + 1] = u[1][c] + (full ? 0.1 * (water.volume_defect()[c] / dt + uniform(random)) : 0);
            }
        water.advance(u, dt, flux);
        for (int i = 0; i < 16; ++i)
            for (int z = 0; z < 10; ++z)
                worst = std::max(worst, std::abs(water.volume_defect()[grid.layout().at({i, z})]));
    }
    CHECK(worst > 0);
    CHECK(worst <= dt * residual * (1 + 1e-6));
}

TEST_CASE("a drop comes back where it was through periodic sides") {
    const auto error_of = [](int n) {
        const Grid<2> grid({.cells = {n, n}, .spacing = Point<2>::Constant(1.0 / n)});
        const auto boundaries = BoundaryConditions<2>::all(Boundary::periodic);
        VolumeOfFluid<2> water(grid, boundaries);
        FaceField<2> flux = face_field<2>(grid.layout());
        fill_below<2>(water.fraction(), grid,
                      [](const Point<2>& x) { return (x - Point<2>(0.5, 0.5)).norm() - 0.25; });
        water.prepare();
        const Field<Real> before = water.fraction();
        auto u = face_field<2>(grid.layout());
        u[0].fill(1);
        u[1].fill(-0.5);
        const int steps = 4 * n;
        for (int k = 0; k < steps; ++k) water.advance(u, 2.0 / steps, flux);
        Real error = 0;
        grid.for_each(
            [&](const CellNumber<2>&, Offset c) { error += std::abs(water.fraction()[c] - before[c]); });
        return error / n / n / (pi * square(0.25));
    };
    const Real coarse = error_of(16), fine = error_of(32);
    // Two turns; second order.
    CHECK(fine < 0.01);
    CHECK(coarse / fine > 3);
}

TEST_CASE("the same bits for one and two threads") {
    const int threads = thread_count();
    const auto run = [](int count) {
        set_thread_count(count);
        const Grid<3> grid = grid_of<3>({20, 18, 16}, false, false);
        BoundaryConditions<3> boundaries = BoundaryConditions<3>::all(Boundary::wall);
        boundaries[1] = {Boundary::periodic, Boundary::periodic};
        VolumeOfFluid<3> water(grid, boundaries);
        FaceField<3> flux = face_field<3>(grid.layout());
        fill_below<3>(water.fraction(), grid, [](const Point<3>& x) {
            return x[2] - 0.9 - 0.2 * std::sin(3 * x[0]) * std::cos(2 * x[1]);
        });
        water.prepare();
        const auto u = stirred<3>(grid, boundaries, 0.02);
        const Real dt = 0.9 * water.stable_step(u);
        for (int k = 0; k < 20; ++k) water.advance(u, std::min(dt, water.stable_step(u)), flux);
        return std::pair(water, flux);
    };
    const auto [one, through_one] = run(1);
    const auto [two, through_two] = run(2);
    set_thread_count(threads);
    bool same = one.planes().count() == two.planes().count();
    for (Offset c = 0; c < one.grid().layout().total; ++c) {
        same = same && one.fraction()[c] == two.fraction()[c] &&
               one.volume_defect()[c] == two.volume_defect()[c];
        for (int a = 0; a < 3; ++a) same = same && through_one[a][c] == through_two[a][c];
    }
    CHECK(same);
}

TEST_CASE("inflow brings what it is given, outflow lets it leave") {
    const Grid<2> grid({.cells = {20, 10}, .spacing = Point<2>::Constant(0.1)});
    BoundaryConditions<2> boundaries = BoundaryConditions<2>::all(Boundary::free_slip);
    boundaries[0] = {Boundary::inflow, Boundary::outflow};
    VolumeOfFluid<2> water(grid, boundaries);
    FaceField<2> flux = face_field<2>(grid.layout());
    // Water 0.43 m deep beyond the inflow, none in the box.
    grid.for_each(
        [&](const CellNumber<2>& cell, Offset c) {
            if (cell[0] < 0) water.fraction()[c] = cell[1] < 4 ? 1 : cell[1] == 4 ? 0.3 : 0;
        },
        2);
    water.prepare();
    CHECK(water.volume() == 0);
    auto u = face_field<2>(grid.layout());
    u[0].fill(1);
    Real in = 0, out = 0;
    for (int k = 0; k < 100; ++k) {
        water.advance(u, 0.04, flux);
        for (int z = 0; z < 10; ++z) {
            in += flux[0][grid.layout().at({0, z})];
            out += flux[0][grid.layout().at({20, z})];
        }
        CHECK(std::abs(water.volume() - (in - out)) < 1e-13);
    }
    CHECK(std::abs(in - 100 * 0.04 * 0.43) < 1e-12);
    // Two lengths of the box later all of it stands 0.43 m deep, but for what is left of the front's waves.
    grid.for_each([&](const CellNumber<2>& cell, Offset c) {
        const Real expected = cell[1] < 4 ? 1 : cell[1] == 4 ? 0.3 : 0;
        CHECK(std::abs(water.fraction()[c] - expected) < 1e-5);
    });
}

TEST_CASE("walls that cut cells: the volume stays, nothing enters what is closed") {
    const Grid<2> grid({.cells = {24, 24}, .spacing = Point<2>::Constant(1.0 / 24)});
    // A floor that rises by 0.31 per metre.
    const auto wall = [](const Point<2>& x) { return 0.2 + 0.31 * x[0] - x[1]; };
    Field<Real> open(grid.layout().total, 0);
    fill_below<2>(open, grid, wall, 0);
    auto faces = face_field<2>(grid.layout());
    const Real h = 1.0 / 24;
    grid.for_each(
        [&](const CellNumber<2>& cell, Offset c) {
            const Real x = grid.face(0, cell[0]), z = grid.face(1, cell[1]);
            faces[0][c] = std::clamp((z + h - 0.2 - 0.31 * x) / h, 0.0, 1.0);
            const Real from = x, to = std::clamp((z - 0.2) / 0.31, from, from + h);
            faces[1][c] = (to - from) / h;
        },
        1);
    VolumeOfFluid<2> water(grid, BoundaryConditions<2>::all(Boundary::wall));
    FaceField<2> flux = face_field<2>(grid.layout());
    water.set_walls(&faces, &open);
    fill_below<2>(
        water.fraction(), grid, [](const Point<2>& x) { return x[1] - 0.6; }, 0);
    water.prepare();
    const Real before = water.volume();
    // The stream function is the flow through open faces: 0 along the wall.
    auto u = face_field<2>(grid.layout());
    const auto stream = [](Real x, Real z) {
        const Real above = std::max(z - 0.2 - 0.31 * x, 0.0);
        return std::sin(pi * x) * above * (1 - z);
    };
    grid.for_each(
        [&](const CellNumber<2>& cell, Offset c) {
            const Real x = grid.face(0, cell[0]), z = grid.face(1, cell[1]);
            if (faces[0][c] > 0) u[0][c] = (stream(x, z + h) - stream(x, z)) / (h * faces[0][c]);
            if (faces[1][c] > 0) u[1][c] = -(stream(x + h, z) - stream(x, z)) / (h * faces[1][c]);
            if (cell[0] == 0 || cell[0] == 24) u[0][c] = 0;
            if (cell[1] == 0 || cell[1] == 24) u[1][c] = 0;
        },
        1);
    Real worst = 0;
    for (int k = 0; k < 500; ++k) {
        water.advance(u, 0.9 * water.stable_step(u), flux);
        worst = std::max(worst, std::abs(water.volume() / before - 1));
    }
    CHECK(worst < 1e-12);
    const Bounds b = bounds_of(water);
    CHECK(b.low >= 0);
    CHECK(b.high <= 1);
    grid.for_each([&](const CellNumber<2>&, Offset c) {
        if (open[c] <= volume_tolerance::open) CHECK(water.fraction()[c] + water.volume_defect()[c] == 0);
    });
}

TEST_CASE("a planar surface is exact up to walls that cut cells") {
    // Half-filled round channel, its water level tilted: the fractions of open volume come from sub-cells.
    const int n = 24;
    const Grid<2> grid({.cells = {n, n}, .spacing = Point<2>::Constant(1.0 / n)});
    std::mt19937 random(6);
    std::uniform_real_distribution<Real> uniform(-0.5, 0.5);
    Real worst = 0;
    int pairs = 0;
    for (int trial = 0; trial < 10; ++trial) {
        const Point<2> up = Point<2>(0.6 * uniform(random), 1).normalized(),
                       through(0.5, 0.45 + 0.2 * uniform(random));
        const auto water_level = [&](const Point<2>& x) { return up.dot(x - through); };
        const auto in_wall = [](const Point<2>& x) { return (x - Point<2>(0.5, 0.6)).norm() - 0.47; };
        Field<Real> open(grid.layout().total, 0), plane = open;
        fill_below<2>(open, grid, in_wall, 4);
        fill_below<2>(plane, grid, water_level, 0);
        const EmbeddedBoundary<2> walls(grid, [&](const Point<2>& x) { return -in_wall(x); });
        VolumeOfFluid<2> water(grid, BoundaryConditions<2>::all(Boundary::wall));
        water.set_walls(&walls.aperture(), &open);
        grid.for_each([&](const CellNumber<2>& cell, Offset c) {
            const auto at = [&](const Point<2>& unit) {
                return -water_level({grid.face(0, cell[0]) + unit[0] * grid.size(0, cell[0]),
                                     grid.face(1, cell[1]) + unit[1] * grid.size(1, cell[1])});
            };
            if (open[c] > volume_tolerance::open)
                water.fraction()[c] = open[c] == 1
                                          ? plane[c]
                                          : detail::WaterAmongWalls<2>::share(
                                                walls.aperture(), grid.layout().stride, c, open[c], at);
        });
        water.prepare();
        grid.for_each([&](const CellNumber<2>& cell, Offset c) {
            if (open[c] < 0.02 || water.plane_of(c) < 0 || water.fraction()[c] == 0) return;
            const Real here = water_level(grid.centre(cell));
            // Where a wall leaves less than two whole cells of surface nothing tells its tilt: not here.
            if (std::abs(here) > 1e-9) CHECK(water.is_liquid(c) == (here < 0));
            if (!water.is_liquid(c)) return;
            for (int a = 0; a < 2; ++a)
                for (const int side : {-1, 1}) {
                    CellNumber<2> other = cell;
                    other[a] += side;
                    const Offset o = grid.layout().at(other);
                    const Real there = water_level(grid.centre(other));
                    if (open[o] < 0.02 || there <= 0) continue;
                    const Real share = std::clamp(here / (here - there), 0.0, 1.0);
                    worst = std::max(worst, std::abs(share - water.surface_share(c, cell[1], a, side)));
                    ++pairs;
                }
        });
    }
    CHECK(pairs > 100);
    CHECK(worst < 1e-10);
}

TEST_CASE("Courant limits: bounds beyond the stable step, and an error that names the cell beyond the end") {
    const Grid<2> grid({.cells = {16, 16}, .spacing = Point<2>::Constant(0.1)});
    const auto boundaries = BoundaryConditions<2>::all(Boundary::wall);
    VolumeOfFluid<2> water(grid, boundaries);
    FaceField<2> flux = face_field<2>(grid.layout());
    fill_below<2>(water.fraction(), grid,
                  [](const Point<2>& x) { return (x - Point<2>(0.8, 0.8)).norm() - 0.4; });
    water.prepare();
    const auto u = stirred<2>(grid, boundaries, 0);
    const Real before = water.volume();
    for (int k = 0; k < 200; ++k) {
        const VolumeStep step = water.advance(u, 1.9 * water.stable_step(u), flux);
        CHECK(step.courant == doctest::Approx(0.95).epsilon(1e-9));
    }
    const Bounds b = bounds_of(water);
    CHECK(b.low >= 0);
    CHECK(b.high <= 1);
    CHECK(std::abs(water.volume() / before - 1) < 1e-12);

    const std::string message =
        message_of<InputError>([&] { water.advance(u, 2.1 * water.stable_step(u), flux); });
    CHECK(message.find("VolumeOfFluid.advance: dt must be small enough") != std::string::npos);
    CHECK(message.find("times cell [") != std::string::npos);
    CHECK(message.find("take at most stable_step()") != std::string::npos);
    auto still = face_field<2>(grid.layout());
    CHECK(std::isinf(water.stable_step(still)));

    VolumeOfFluid<2> faster(grid, boundaries, {.courant = 0.9});
    faster.fraction() = water.fraction();
    faster.prepare();
    CHECK(faster.stable_step(u) == doctest::Approx(1.8 * water.stable_step(u)).epsilon(1e-12));
    CHECK(message_of<InputError>([&] { VolumeOfFluid<2>(grid, boundaries, {.courant = 2}); }) ==
          "VolumeOfFluid.courant must be in (0, 1], got 2; 0.5 is usual");
}

TEST_CASE("a single wet cell, a full box, an empty box") {
    const Grid<3> grid = grid_of<3>({6, 6, 6}, true, false);
    const auto boundaries = BoundaryConditions<3>::all(Boundary::wall);
    const auto u = stirred<3>(grid, boundaries, 0.01);
    VolumeOfFluid<3> water(grid, boundaries);
    FaceField<3> flux = face_field<3>(grid.layout());
    CHECK(water.advance(u, 0.1, flux).courant == 0);
    CHECK(water.volume() == 0);
    water.fraction()[grid.layout().at({2, 3, 3})] = 0.4;
    water.prepare();
    const Real drop = water.volume();
    for (int k = 0; k < 100; ++k) water.advance(u, 0.9 * std::min(1.0, water.stable_step(u)), flux);
    CHECK(std::abs(water.volume() / drop - 1) < 1e-12);
    water.fraction().fill(1);
    water.prepare();
    CHECK(water.planes().count() == 0);
    water.advance(u, 0.1, flux);
    CHECK(std::abs(water.volume() - 0.216) < 1e-14);
    CHECK(bounds_of(water).low == 1);
}

TEST_CASE("bad input") {
    BoundaryConditions<2> boundaries;
    boundaries[0] = {Boundary::periodic, Boundary::outflow};
    const Grid<2> grid({.cells = {4, 4}, .spacing = Point<2>::Constant(0.1)});
    CHECK(message_of<InputError>([&] { VolumeOfFluid<2> water(grid, boundaries); }) ==
          "BoundaryConditions.x must be periodic at both ends or at none, got periodic and outflow; what "
          "leaves at one "
          "end must "
          "come back at the other");
    VolumeOfFluid<2> water(grid, BoundaryConditions<2>::all(Boundary::wall));
    FaceField<2> flux = face_field<2>(grid.layout());
    water.fraction()[grid.layout().at({1, 2})] = 1.5;
    CHECK(message_of<InputError>([&] { water.prepare(); }) ==
          "VolumeOfFluid.fraction[1, 2] must be from 0 to 1, got 1.5; give the share of the cell's open "
          "volume that "
          "is liquid");
    water.fraction().fill(0.5);
    water.prepare();
    auto u = face_field<2>(grid.layout());
    CHECK_THROWS_AS(water.advance(u, -1, flux), InputError);
    CHECK_THROWS_AS(water.advance(u, std::numeric_limits<Real>::quiet_NaN(), flux), InputError);
}
