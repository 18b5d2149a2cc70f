// Walls on a grid: planes exactly, curved walls to second order, and what closes.
#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>

#include <abrade/geometry/sphere_union.hpp>

#include <doctest/doctest.h>

#include <array>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "../message_of.hpp"

using namespace abrade;

namespace {

using Two = std::integral_constant<int, 2>;
using Three = std::integral_constant<int, 3>;

/// One type for all shapes made up here: the tests compile in half the time.
template <int Dim>
using Shape = std::function<Real(const Point<Dim>&)>;

template <int Dim>
Grid<Dim> unit_box(int cells) {
    typename Grid<Dim>::Params params;
    params.cells.fill(cells);
    params.spacing.setConstant(1.0 / cells);
    return Grid<Dim>(params);
}

/// Cells of other sizes along each axis, growing upwards.
template <int Dim>
Grid<Dim> uneven_box() {
    typename Grid<Dim>::Params params;
    for (int a = 0; a < Dim; ++a) {
        params.cells[a] = 11 + 3 * a;
        params.low[a] = -0.4 + 0.1 * a;
        params.spacing[a] = 0.07 + 0.02 * a;
    }
    Real level = params.low[Dim - 1];
    for (int k = 0; k <= params.cells[Dim - 1]; ++k) {
        params.levels.push_back(level);
        level += 0.05 * std::pow(1.08, k);
    }
    return Grid<Dim>(params);
}

/// The unit box in cells of other sizes along each axis, flat ones below.
template <int Dim>
Grid<Dim> flat_cells() {
    typename Grid<Dim>::Params params;
    for (int a = 0; a < Dim; ++a) params.cells[a] = 14 + 9 * a, params.spacing[a] = 1.0 / params.cells[a];
    for (int k = 0; k <= params.cells[Dim - 1]; ++k)
        params.levels.push_back(std::pow(static_cast<Real>(k) / params.cells[Dim - 1], 1.5));
    return Grid<Dim>(params);
}

/// Nothing is closed for being small.
template <int Dim>
typename EmbeddedBoundary<Dim>::Params all_of_it(int levels = 0) {
    return {.closed_below = 0, .levels = levels};
}

/// Of all cells: wall area, and the largest vector that a cell's surface leaves, over its largest face.
struct Surface {
    Real area = 0, gap = 0;
};

template <int Dim>
Surface surface_of(const EmbeddedBoundary<Dim>& walls) {
    const Grid<Dim>& grid = walls.grid();
    Surface sum;
    std::size_t found = 0;
    grid.for_each([&](const CellNumber<Dim>& c, Offset cell) {
        Point<Dim> left;
        Real largest = 0;
        for (int a = 0; a < Dim; ++a) {
            const Real face = grid.volume(c) / grid.size(a, c[a]);
            const Field<Real>& share = walls.aperture()[a];
            left[a] = face * (share[cell + grid.layout().stride[a]] - share[cell]);
            largest = std::max(largest, face);
        }
        for (const CutCell<Dim>& wall : walls.cut_cells(cell, 1)) {
            left -= wall.area * wall.normal;
            sum.area += wall.area;
            ++found;
        }
        sum.gap = std::max(sum.gap, left.norm() / largest);
    });
    CHECK(found == walls.cut_cells().size());
    return sum;
}

/// Share of the unit box in which n.x + d > 0, by the sum over its corners
///   1/(Dim! prod n) sum (-1)^(lower coordinates) max(n.x + d, 0)^Dim,
/// and by how much that magnifies round-off.
std::pair<Real, Real> share_above(std::vector<Real> n, Real d) {
    Real scale = 0, lowest = d, highest = d;
    for (const Real each : n) {
        scale = std::max(scale, std::abs(each));
        lowest += std::min(each, 0.0), highest += std::max(each, 0.0);
    }
    if (lowest >= 0 || highest <= 0) return {lowest >= 0 ? 1 : 0, 1};
    Real sum = 0, product = 1, conditioning = 1;
    for (std::size_t corner = 0; corner < std::size_t{1} << n.size(); ++corner) {
        Real value = d, sign = 1;
        for (std::size_t a = 0; a < n.size(); ++a) {
            const bool upper = (corner >> a) & 1;
            if (upper) value += n[a];
            if (!upper) sign = -sign;
        }
        sum += sign * std::pow(std::max(value, 0.0), n.size());
    }
    for (std::size_t a = 0; a < n.size(); ++a) {
        product *= n[a] * static_cast<Real>(a + 1);
        conditioning *= std::abs(n[a]) / scale;
    }
    return {sum / product, 1 / conditioning};
}

/// Largest error of volumes and areas, less what the closed form loses itself.
template <int Dim>
Real error_of_plane(const EmbeddedBoundary<Dim>& walls, const Point<Dim>& p, const Point<Dim>& n) {
    const Grid<Dim>& grid = walls.grid();
    Real worst = 0;
    grid.for_each([&](const CellNumber<Dim>& c, Offset cell) {
        Point<Dim> low;
        for (int a = 0; a < Dim; ++a) low[a] = grid.face(a, c[a]);
        const auto compare = [&](int without, Real share) {
            std::vector<Real> along;
            for (int a = 0; a < Dim; ++a)
                if (a != without) along.push_back(n[a] * grid.size(a, c[a]));
            const auto [expected, magnified] = share_above(along, n.dot(low - p));
            worst = std::max(worst, std::abs(share - expected) / magnified);
        };
        compare(-1, walls.open_fraction()[cell]);
        for (int a = 0; a < Dim; ++a) compare(a, walls.aperture()[a][cell]);
    });
    return worst;
}

template <int Dim>
bool same(const Field<Real>& a, const Field<Real>& b) {
    return std::equal(a.data(), a.data() + a.size(), b.data(), b.data() + b.size());
}

/// The same bits.
template <int Dim>
bool same(const EmbeddedBoundary<Dim>& a, const EmbeddedBoundary<Dim>& b) {
    bool equal = same<Dim>(a.open_fraction(), b.open_fraction()) && a.open_cells() == b.open_cells();
    for (int axis = 0; axis < Dim; ++axis) equal = equal && same<Dim>(a.aperture()[axis], b.aperture()[axis]);
    const auto as_one = [](const CutCell<Dim>& x, const CutCell<Dim>& y) {
        return x.cell == y.cell && x.area == y.area && x.normal == y.normal && x.point == y.point;
    };
    return equal && std::equal(a.cut_cells().begin(), a.cut_cells().end(), b.cut_cells().begin(),
                               b.cut_cells().end(), as_one);
}

/// Spheres that overlap, about the middle of the unit box.
std::vector<Sphere> heap(int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<Real> place(0.25, 0.75), radius(0.06, 0.12);
    std::vector<Sphere> spheres;
    for (int n = 0; n < count; ++n) {
        Vec3 centre;
        for (Real& x : centre) x = place(random);
        spheres.push_back({centre, radius(random)});
    }
    return spheres;
}

}  // namespace

TEST_CASE_TEMPLATE("planes at any angle are exact", D, Two, Three) {
    constexpr int Dim = D::value;
    std::mt19937 random(1);
    std::normal_distribution<Real> normal;
    std::uniform_real_distribution<Real> within(-0.15, 0.2);
    for (const int levels : {0, 2})
        for (int trial = 0; trial < 20; ++trial) {
            const Grid<Dim> grid = trial % 2 ? uneven_box<Dim>() : unit_box<Dim>(12);
            Point<Dim> n, p;
            for (int a = 0; a < Dim; ++a) {
                n[a] = normal(random);
                p[a] = 0.5 * (grid.low(a) + grid.high(a)) + within(random);
            }
            n.normalize();
            const Shape<Dim> plane = PlaneWall<Dim>(p, n);
            const EmbeddedBoundary<Dim> walls(grid, plane, all_of_it<Dim>(levels));
            CHECK(error_of_plane(walls, p, n) < 1e-13);
            CHECK(surface_of(walls).gap < 1e-14);
            for (const CutCell<Dim>& c : walls.cut_cells()) {
                const Real largest = Dim == 2 ? 0.2 : 0.04;  // face of any cell here
                const Real round_off = 1e-15 * largest / c.area;
                CHECK((c.normal - n).norm() < 10 * round_off);
                CHECK(std::abs(plane(c.point)) < 10 * round_off);
            }
        }
}

TEST_CASE("a wall on a plane of the grid closes what is below it, however round-off falls") {
    const Grid<3> grid = unit_box<3>(8);
    for (const Real off : {0.0, 1e-17, 1e-16, 1e-15}) {
        const Shape<3> floor = [&](const Point<3>& x) {
            return x[2] - 0.25 + off * std::sin(1e5 * x[0] + 7e4 * x[1]);
        };
        const EmbeddedBoundary<3> walls(grid, floor);
        CHECK(walls.total_volume() == doctest::Approx(0.75).epsilon(1e-14));
        CHECK(walls.open_cells() == 8 * 8 * 6);
        REQUIRE(walls.cut_cells().size() == 64);
        for (const CutCell<3>& c : walls.cut_cells()) {
            CHECK(c.area == doctest::Approx(1.0 / 64).epsilon(1e-13));
            CHECK((c.normal - Vec3::UnitZ()).norm() < 1e-13);
            CHECK(c.point.z() == doctest::Approx(0.25).epsilon(1e-13));
        }
    }
}

TEST_CASE_TEMPLATE("a circle and a sphere, full and hollow: volume and area of second order", D, Two, Three) {
    constexpr int Dim = D::value;
    const Real r = 0.31;
    const Real solid = Dim == 2 ? pi * r * r : 4 * pi / 3 * cube(r),
               area = Dim == 2 ? 2 * pi * r : 4 * pi * r * r;
    for (const bool hollow : {false, true}) {
        std::array<Real, 3> volume_error{}, area_error{};
        const int places = 8;  // single ones are uneven: cells that the wall just touches come and go
        for (int place = 0; place < places; ++place)
            for (std::size_t k = 0; k < 3; ++k) {
                Point<Dim> centre;
                for (int a = 0; a < Dim; ++a)
                    centre[a] = 0.5 + 0.011 * (place + 1) * std::cos(1.0 + place + a);
                const Shape<Dim> ball = [&](const Point<Dim>& x) {
                    return (hollow ? -1 : 1) * ((x - centre).norm() - r);
                };
                const EmbeddedBoundary<Dim> walls(unit_box<Dim>(12 << k), ball, all_of_it<Dim>());
                const Surface surface = surface_of(walls);
                const Real water = hollow ? solid : 1 - solid;
                volume_error[k] += std::abs(walls.total_volume() - water) / solid / places;
                area_error[k] += std::abs(surface.area - area) / area / places;
                CHECK(surface.gap < 1e-14);
            }
        MESSAGE(Dim << "-D, " << std::string(hollow ? "hollow" : "full") << ": volume off by "
                    << volume_error[0] << ", " << volume_error[1] << ", " << volume_error[2] << "; area by "
                    << area_error[0] << ", " << area_error[1] << ", " << area_error[2]);
        // Order 1.8 at least over two halvings of the cells.
        CHECK(volume_error[0] / volume_error[2] > std::pow(4, 1.8));
        CHECK(area_error[0] / area_error[2] > std::pow(4, 1.8));
    }
}

TEST_CASE("the invert's bed: volume below the edges and area, in a section and in space") {
    const Invert invert{.length = 1, .width = 1, .arc_radius = 1};
    const Real depth = 0.3;
    const Shape<2> across_it = InvertWall(invert);
    const Shape<3> along_it = InvertWall(invert);
    std::array<Real, 2> error{};
    for (std::size_t k = 0; k < 2; ++k) {
        const int across = 30 << k;
        const EmbeddedBoundary<2> section(Grid<2>({.cells = {across, across / 2},
                                                   .low = {-0.55, -0.05},
                                                   .spacing = {1.1 / across, 0.35 / (across / 2)}}),
                                          across_it, all_of_it<2>());
        error[k] = std::abs(section.total_volume() - invert.flow_area(depth));
        const Real round = invert.wetted_perimeter(depth);
        CHECK(std::abs(surface_of(section).area - round) < 0.01 * round);
        CHECK(surface_of(section).gap < 1e-14);
    }
    CHECK(error[1] < 2e-4 * invert.flow_area(depth));
    CHECK(error[0] / error[1] > std::pow(2, 1.8));
    const EmbeddedBoundary<3> channel(
        Grid<3>({.cells = {5, 30, 15}, .low = {0, -0.55, -0.05}, .spacing = {0.2, 1.1 / 30, 0.35 / 15}}),
        along_it, all_of_it<3>());
    const EmbeddedBoundary<2> section(
        Grid<2>({.cells = {30, 15}, .low = {-0.55, -0.05}, .spacing = {1.1 / 30, 0.35 / 15}}), across_it,
        all_of_it<2>());
    CHECK(channel.total_volume() == doctest::Approx(section.total_volume()).epsilon(1e-13));
    CHECK(surface_of(channel).area == doctest::Approx(surface_of(section).area).epsilon(1e-12));
}

TEST_CASE("a packing of spheres: halved cells find edges and gaps that corners do not see") {
    const std::vector<Sphere> spheres = heap(40, 3);
    const Real solid = union_moments(spheres).volume;
    const Shape<3> packing = SpherePacking(spheres);
    std::array<Real, 4> error{};
    for (int levels = 0; levels < 4; ++levels) {
        const EmbeddedBoundary<3> walls(unit_box<3>(20), packing, all_of_it<3>(levels));
        error[static_cast<std::size_t>(levels)] = std::abs(1 - solid - walls.total_volume()) / solid;
        CHECK(surface_of(walls).gap < 1e-14);
    }
    MESSAGE("40 spheres of 1.2 to 2.4 cells: volume off by " << error[0] << ", " << error[1] << ", "
                                                             << error[2] << ", " << error[3]);
    CHECK(error[1] < 0.4 * error[0]);
    CHECK(error[2] < 0.4 * error[1]);
    CHECK(error[2] < 2e-3);
}

TEST_CASE("the distance of a packing is that of its nearest sphere, and never grows faster than the way") {
    const std::vector<Sphere> spheres = heap(60, 4);
    SpherePacking packing(spheres);
    packing.remove(7);
    packing.set_radius(8, 0.01);
    const auto nearest = [&](const Vec3& x) {
        Real least = std::numeric_limits<Real>::infinity();
        for (std::size_t n = 0; n < spheres.size(); ++n)
            if (n != 7)
                least = std::min(least, (x - spheres[n].centre).norm() - (n == 8 ? 0.01 : spheres[n].radius));
        return least;
    };
    std::mt19937 random(5);
    std::uniform_real_distribution<Real> place(-1, 2), near(0, 1);
    std::normal_distribution<Real> step(0, 0.1);
    for (int n = 0; n < 20000; ++n) {
        Vec3 x, y;
        for (int a = 0; a < 3; ++a) x[a] = n % 2 ? place(random) : near(random), y[a] = x[a] + step(random);
        const Real d = packing(x), expected = nearest(x);
        if (expected < 0.2)
            CHECK(d == doctest::Approx(expected).epsilon(1e-12).scale(1));
        else
            CHECK((d >= 0.2 && d <= expected + 1e-12));
        CHECK(std::abs(packing(y) - d) <= (y - x).norm() * (1 + 1e-12));
    }
    const Vec3 above(0.5, 0.5, 1.3);
    Real highest = 1;
    for (const auto& [centre, radius] : spheres)
        highest = std::min(highest, (above - centre).norm() - radius);
    CHECK(packing(above) < highest);
    CHECK(SpherePacking(spheres, 0.6)(above) == doctest::Approx(highest).epsilon(1e-14));
    CHECK(packing(Point<2>(0.4, 0.6)) == packing(Vec3(0.4, 0, 0.6)));
}

TEST_CASE("cells far from a wall need no look inside: the same bits with and without") {
    const Shape<3> packing = SpherePacking(heap(30, 6));
    for (const int levels : {0, 2})
        for (const Grid<3>& grid : {unit_box<3>(23), flat_cells<3>()}) {
            auto params = all_of_it<3>(levels);
            const EmbeddedBoundary<3> skipping(grid, packing, params);
            params.bounded_slope = false;
            CHECK(same(skipping, EmbeddedBoundary<3>(grid, packing, params)));
        }
}

TEST_CASE_TEMPLATE("functions steeper than a distance are found out: all cells are looked at", D, Two,
                   Three) {
    constexpr int Dim = D::value;
    using P = Point<Dim>;
    const auto off_centre = [](const P& x, Real z) {
        P y = x - P::Constant(0.5);
        y[Dim - 1] = x[Dim - 1] - z;
        return y;
    };
    const auto ellipse = [&](const P& x) {  // half axes 0.4 and, upwards, 0.13
        P y = off_centre(x, 0.5) / 0.4;
        y[Dim - 1] *= 0.4 / 0.13;
        return y.squaredNorm() - 1;
    };
    std::vector<Shape<Dim>> shapes{ellipse, [&](const P& x) { return 1e4 * ellipse(x); }};
    for (const Real slope : {1.1, 1.5, 3.0, 100.0})
        for (int k = 0; k < 8; ++k)  // where blocks of four cells begin, end, and between
            for (int a = 0; a < Dim; ++a)
                shapes.push_back([=](const P& x) { return slope * (x[a] - 0.45 - k / 46.0); });
    auto params = all_of_it<Dim>(1);
    for (const Shape<Dim>& shape : shapes) {
        const Grid<Dim> grid = unit_box<Dim>(23);
        params.bounded_slope = true;
        const EmbeddedBoundary<Dim> found(grid, shape, params);
        params.bounded_slope = false;
        CHECK(same(found, EmbeddedBoundary<Dim>(grid, shape, params)));
        CHECK_FALSE(found.params().bounded_slope);
    }
    const Grid<Dim> grid = unit_box<Dim>(40);
    const Shape<Dim> floor = PlaneWall<Dim>(P::Constant(0.1), P::Unit(Dim - 1));
    EmbeddedBoundary<Dim> walls(grid, floor);
    CHECK(walls.params().bounded_slope);
    const Shape<Dim> steeper = [&](const P& x) {  // the same floor
        return floor(x) * (1 + 50 * std::max(0.0, 0.15 - off_centre(x, 0.1).norm()));
    };
    P low = P::Constant(0.3);
    low[Dim - 1] = -0.1;
    walls.update(steeper, low, P::Constant(0.7));
    CHECK(same(walls, EmbeddedBoundary<Dim>(grid, steeper)));
    CHECK_FALSE(walls.params().bounded_slope);
}

TEST_CASE_TEMPLATE("an update is what building anew gives, bit by bit, and takes no new memory", D, Two,
                   Three) {
    constexpr int Dim = D::value;
    std::vector<Sphere> spheres = heap(80, 7);
    if (Dim == 2)
        for (Sphere& sphere : spheres) sphere.centre.y() = 0;
    Grid<Dim> grid = unit_box<Dim>(Dim == 2 ? 90 : 30);
    SUBCASE("cubes") {}
    SUBCASE("flat cells") { grid = flat_cells<Dim>(); }
    SpherePacking packing(spheres);
    const Shape<Dim> shape = [&](const Point<Dim>& x) { return packing(x); };
    EmbeddedBoundary<Dim> walls(grid, shape);
    const auto place = [](const Vec3& x) {
        if constexpr (Dim == 2) {
            return Point<2>(x.x(), x.z());
        } else {
            return x;
        }
    };
    const Real* const volume = walls.open_fraction().data();
    const Real* const area = walls.aperture()[0].data();
    std::array<const CutCell<Dim>*, 2> lists{};
    for (std::size_t n = 0; n < 12; ++n) {
        const auto [centre, radius] = spheres[n];
        if (n % 3)
            packing.remove(n);
        else
            packing.set_radius(n, 0.7 * radius);
        walls.update(shape, place(centre - Vec3::Constant(radius)), place(centre + Vec3::Constant(radius)));
        CHECK(same(walls, EmbeddedBoundary<Dim>(grid, shape)));
        CHECK(walls.open_fraction().data() == volume);
        CHECK(walls.aperture()[0].data() == area);
        if (n == 8 || n == 9) lists[n % 2] = walls.cut_cells().data();
        if (n > 9) CHECK(walls.cut_cells().data() == lists[n % 2]);  // two lists that take turns
    }
    const EmbeddedBoundary<Dim> before = walls;
    walls.update(shape, Point<Dim>::Constant(3), Point<Dim>::Constant(4));
    CHECK(same(walls, before));
}

TEST_CASE("small cells and faces are closed together") {
    const Shape<3> packing = SpherePacking(heap(40, 8));
    const EmbeddedBoundary<3> walls(unit_box<3>(24), packing, {.closed_below = 0.05});
    const Grid<3>& grid = walls.grid();
    int closed = 0, small = 0;
    grid.for_each([&](const CellNumber<3>&, Offset cell) {
        Real largest = 0;
        for (int a = 0; a < 3; ++a)
            for (const Offset next : {Offset{0}, grid.layout().stride[a]}) {
                const Real share = walls.aperture()[a][cell + next];
                largest = std::max(largest, share);
                small += share > 0 && share < 0.05;
            }
        const Real volume = walls.open_fraction()[cell];
        small += volume > 0 && volume < 0.05;
        closed += volume == 0;
        CHECK((volume > 0) == (largest > 0));
    });
    CHECK(small == 0);
    CHECK(closed + walls.open_cells() == 24 * 24 * 24);
    CHECK(surface_of(walls).gap < 1e-14);
}

TEST_CASE("several walls in one, and none") {
    const Grid<2> grid = unit_box<2>(20);
    const Shape<2> both = WallUnion(PlaneWall<2>({0, 0.2}, {0, 1}),
                                    [](const Point<2>& x) { return (x - Point<2>(0.5, 0.6)).norm() - 0.2; });
    const EmbeddedBoundary<2> walls(grid, both);
    CHECK(walls.total_volume() == doctest::Approx(0.8 - pi * 0.04).epsilon(1e-3));
    const EmbeddedBoundary<2> open(grid);
    CHECK(open.total_volume() == doctest::Approx(1).epsilon(1e-14));
    CHECK(open.cut_cells().empty());
    CHECK(open.open_cells() == 400);
    const Shape<2> nowhere = [](const Point<2>&) { return std::numeric_limits<Real>::infinity(); };
    CHECK(same(EmbeddedBoundary<2>(grid, nowhere), open));
}

TEST_CASE("the same bits with one thread and with two") {
    const Shape<3> packing = SpherePacking(heap(60, 9));
    const int threads = thread_count();
    set_thread_count(1);
    const EmbeddedBoundary<3> one(unit_box<3>(30), packing);
    set_thread_count(2);
    const EmbeddedBoundary<3> two(unit_box<3>(30), packing);
    CHECK(one.total_volume() == two.total_volume());
    set_thread_count(threads);
    CHECK(same(one, two));
}

TEST_CASE("what cannot be used is named") {
    const Grid<3> grid = unit_box<3>(10);
    const Shape<3> root = [](const Point<3>& x) { return std::sqrt(x[0] - 0.35); };
    CHECK(message_of([&] {
              EmbeddedBoundary<3>(grid, root);
          }).starts_with("EmbeddedBoundary: distance at x = "));
    const Shape<3> seldom = [](const Point<3>& x) {
        return std::abs(x[0] - 0.325) < 0.01 ? std::numeric_limits<Real>::quiet_NaN() : 1.0;
    };
    CHECK(message_of([&] {  // where only halves of halves of cells are asked, of what is near
              EmbeddedBoundary<3>(grid, WallUnion(SpherePacking(heap(30, 6)), seldom), {.levels = 2});
          })
              .starts_with("EmbeddedBoundary: distance at x = 0.325 m"));
    const Shape<3> throws = [](const Point<3>& x) -> Real {
        throw std::domain_error("no map at x = " + std::to_string(x[0]));
    };
    CHECK(message_of<std::domain_error>([&] {
              EmbeddedBoundary<3>(grid, throws);
          }).starts_with("no map at x = "));
    CHECK(message_of<std::domain_error>([&] {
              EmbeddedBoundary<3>(grid, WallUnion(SpherePacking(heap(30, 6)), throws));
          }).starts_with("no map at x = "));
    const Shape<3> solid = [](const Point<3>&) { return -1.0; };
    CHECK(message_of([&] { EmbeddedBoundary<3>(grid, solid); }) ==
          "EmbeddedBoundary: distance, cells of the grid that it leaves open must be at least 1, got 0 "
          "cells; is the "
          "distance above 0 in the water, and does the grid cover some of it?");
    CHECK(message_of([&] { EmbeddedBoundary<3>(grid, solid, {.closed_below = 0.5}); }) ==
          "EmbeddedBoundary.closed_below must be from 0 to 0.1, got 0.5; 1e-3 costs no accuracy: few cells "
          "are that "
          "small");
    CHECK(message_of([&] {
              EmbeddedBoundary<3>(grid, solid, {.levels = 9});
          }).starts_with("EmbeddedBoundary.levels must be from 0 to 6"));
    CHECK(message_of([&] {
              EmbeddedBoundary<3>(grid).update(solid, Vec3::Zero(), Vec3::Ones());
          }).starts_with("EmbeddedBoundary.update must be called on walls"));
    CHECK(
        message_of([&] {
            EmbeddedBoundary<3> walls(grid, Shape<3>(PlaneWall<3>({0, 0, 0.3}, Vec3::UnitZ())));
            walls.update(solid, {0, 1, 0}, {1, 0, 1});
        }) ==
        "EmbeddedBoundary.update: high.y must be at least low (1 m), got 0 m; give lower corner, then upper");
    CHECK(message_of([] {
              PlaneWall<3>(Vec3::Zero(), Vec3::Zero());
          }).starts_with("PlaneWall.normal: length must be finite and > 0, got 0"));
    CHECK(message_of([] {
              SpherePacking(std::vector<Sphere>{{Vec3::Zero(), 0}});
          }).starts_with("SpherePacking.spheres[0].radius must be finite and > 0"));
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    const Shape<3> hidden = [&](const Point<3>&) { return nan; };
    CHECK(std::isnan(WallUnion(hidden, solid)(Vec3(1, 2, 3))));
    CHECK(std::isnan(WallUnion(solid, hidden)(Vec3(1, 2, 3))));
}
