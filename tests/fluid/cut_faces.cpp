// Friction along a plane wall at any angle: in a uniform shear, u = s d along the wall, what the water about
// a face brings is what the wall takes, for each face alone.
#include <abrade/fluid/embedded_boundary/open_friction.hpp>
#include <abrade/fluid/embedded_boundary/wall_friction.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real h = 0.1;

template <int Dim>
struct Shear {
    Point<Dim> normal;  ///< into the water, of any length
    Real offset;        ///< of the wall from the box's middle [m]

    Real distance(const Point<Dim>& x) const {
        return normal.normalized().dot(x - Point<Dim>::Constant(0.5)) + offset;
    }

    /// The largest of |brought - taken| over the shear on a cell's face, of all faces away from the sides.
    Real worst() const {
        const Grid<Dim> grid = [] {
            typename Grid<Dim>::Params box;
            for (int a = 0; a < Dim; ++a) box.cells[static_cast<std::size_t>(a)] = 10;
            box.spacing = Point<Dim>::Constant(h);
            return Grid<Dim>(box);
        }();
        const Layout<Dim>& layout = grid.layout();
        const auto boundaries = BoundaryConditions<Dim>::all(Boundary::free_slip);
        const EmbeddedBoundary<Dim> walls(grid, [this](const Point<Dim>& x) { return distance(x); },
                                          {.closed_below = 0});
        const auto open = detail::open_friction_of(walls, boundaries);
        FaceField<Dim> taken = face_field<Dim>(layout);
        for (const CutCell<Dim>& wall : walls.cut_cells())
            WallFriction<Dim>::each_held_face(grid, boundaries, walls, wall, [&](const auto& f) {
                taken[f.axis][f.face] += f.area / f.distance;
            });
        const Point<Dim> size = Point<Dim>::Constant(h);
        Real worst = 0;
        int cut = 0;
        grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            for (const int i : cell)
                if (i < 2 || i > 7) return;
            for (int a = 0; a < Dim; ++a) {
                const Field<Real>& area = walls.aperture()[a];
                const auto speed = [&](Offset face) {
                    const Point<Dim> centroid = detail::centroid_of_face<Dim>(normal, size, a, area[face]);
                    return distance(grid.face_centre(a, layout.number(face)) + h * centroid);
                };
                const Real here = speed(c);
                if (area[c] == 0 || here < WallFriction<Dim>::least_distance * h)
                    continue;  // held as if further
                Real brought = 0;
                for (int b = 0; b < Dim; ++b) {
                    const Offset up = layout.stride[b];
                    const auto& k = open[a][b];
                    if (k[c + up] > 0) brought += k[c + up] * (speed(c + up) - here) / h;
                    if (k[c] > 0) brought += k[c] * (speed(c - up) - here) / h;
                }
                const Real lost = taken[a][c] * here / std::pow(h, Dim - 1);
                cut += lost > 0;
                worst = std::max(worst, std::abs(brought - lost));
            }
        });
        CHECK(cut > 5);
        return worst;
    }
};

}  // namespace

TEST_CASE("a uniform shear along a plane wall stays as it is") {
    constexpr Real float_round_off = 1e-5;  // they are kept as float
    for (const Real degrees : {0.5, 10.0, 30.0, 45.0, 77.0, 135.0, 200.0, 290.0})
        for (const Real offset : {-0.03, 0.0, 0.017}) {
            const Real angle = degrees * pi / 180;
            CAPTURE(degrees);
            CAPTURE(offset);
            CHECK(Shear<2>{{-std::sin(angle), std::cos(angle)}, offset}.worst() < float_round_off);
        }
    for (const Point<3>& normal : {Point<3>{0, 0, 1}, Point<3>{0.1, 0, 1}, Point<3>{0.3, -0.2, 1},
                                   Point<3>{1, 1, 1}, Point<3>{-1, 0.5, 0.02}, Point<3>{0.7, 0.9, -0.4}})
        for (const Real offset : {-0.03, 0.014, 0.017}) {
            CAPTURE(normal.transpose());
            CAPTURE(offset);
            CHECK(Shear<3>{normal, offset}.worst() < float_round_off);
        }
}

TEST_CASE("the centroid of what a plane leaves open of a face") {
    constexpr int parts = 400;
    for (const auto& normal : {std::array<Real, 2>{1, 0}, std::array<Real, 2>{0.2, -1},
                               std::array<Real, 2>{-1, 1}, std::array<Real, 2>{-3, -0.7}})
        for (const Real reach : {-0.55, -0.3, 0.0, 0.2, 0.45}) {
            std::array<Real, 2> sum{};
            int count = 0;
            for (int i = 0; i < parts; ++i)
                for (int k = 0; k < parts; ++k) {
                    const Real x = (i + 0.5) / parts - 0.5, y = (k + 0.5) / parts - 0.5;
                    if (normal[0] * x + normal[1] * y < reach * (std::abs(normal[0]) + std::abs(normal[1])))
                        continue;
                    sum[0] += x, sum[1] += y, ++count;
                }
            if (count == 0) continue;
            const auto centroid = detail::open_centroid<2>(normal, Real(count) / (parts * parts));
            CAPTURE(normal[0]);
            CAPTURE(reach);
            for (std::size_t a = 0; a < 2; ++a) CHECK(std::abs(centroid[a] - sum[a] / count) < 2.0 / parts);
        }
    CHECK(detail::open_centroid<1>({2}, 0.5)[0] == doctest::Approx(0.25));
    CHECK(detail::open_centroid<1>({-2}, 0.25)[0] == doctest::Approx(-0.375));
}
