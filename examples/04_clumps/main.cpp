// How well do overlapping spheres stand for a stone, and how many does it take?
//
//   examples/run clumps [--out FOLDER]
//
// Problem. A stone of a given size, form and roundness is made of overlapping spheres; so is a stone that is
// known as a surface. What do the spheres leave out, of gap, volume, centre and inertia?
//
// Theory. What overlaps counts once. Two balls of radius r at a distance d share a lens,
//   V = 2 * 4/3 pi r^3 - pi (2 r - d)^2 (d^2 + 4 d r) / (12 d)
// and any number of them is cut into slices, whose exposed arcs give area and moments by Green's theorem.
// Spheres that touch a smooth surface from within leave a gap that falls as 1 / n: each covers a patch of
// radius a, n a^2 is the surface, and a gap a^2 (1/r - 1/R) / 2 is left at the edge of a patch.
// At the edges and corners of a crushed stone it falls more slowly.

#include "../common/textbook.hpp"

#include <abrade/abrade.hpp>
#include <abrade/io/stl_file.hpp>

using namespace abrade;
using namespace abrade::examples;

namespace {

/// A surface of an ellipsoid: an octahedron whose triangles are cut in four, again and again.
SurfaceMesh ellipsoid(const Vec3& half_axes, int times) {
    std::vector<std::array<Vec3, 3>> loose;
    for (int n = 0; n < 8; ++n)
        loose.push_back({Vec3(n & 1 ? 1 : -1, 0, 0), Vec3(0, n & 2 ? 1 : -1, 0), Vec3(0, 0, n & 4 ? 1 : -1)});
    for (int n = 0; n < times; ++n) {
        std::vector<std::array<Vec3, 3>> finer;
        for (const auto& [a, b, c] : loose) {
            const Vec3 ab = (a + b).normalized(), bc = (b + c).normalized(), ca = (c + a).normalized();
            for (const auto& part : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
                finer.push_back(part);
        }
        loose = finer;
    }
    for (auto& triangle : loose)
        for (Vec3& v : triangle) v = v.cwiseProduct(half_axes).eval();
    return mesh_of_triangles(loose);
}

SurfaceMesh box(const Vec3& sides) {
    std::vector<Vec3> v;
    for (int n = 0; n < 8; ++n) v.push_back(sides.cwiseProduct(Vec3(n & 1, n >> 1 & 1, n >> 2)));
    return {v,
            {{0, 2, 3},
             {0, 3, 1},
             {4, 5, 7},
             {4, 7, 6},
             {0, 1, 5},
             {0, 5, 4},
             {2, 6, 7},
             {2, 7, 3},
             {0, 4, 6},
             {0, 6, 2},
             {1, 3, 7},
             {1, 7, 5}}};
}

/// A clump seen along its shortest axis: members in order of height, the highest drawn last, as discs whose
/// value is the height that they reach. `at`: where its centre is drawn.
CircleSet view_of(const Clump& clump, const Vec3& at) {
    // In the principal frame the moments rise from x to z, so z is the shortest axis. Each sphere is drawn
    // as caps of falling radius, so that the spheres cut one another where they do in space.
    struct Disc {
        Circle circle;
        Real height;
    };
    std::vector<Disc> discs;
    constexpr int caps = 24;
    for (const Sphere& s : clump.members)
        for (int k = 0; k < caps; ++k) {
            const Real rise = (k + 0.5) / caps, r = s.radius * std::sqrt(1 - square(rise));
            const Real height = s.centre.z() + s.radius * rise;
            discs.push_back({{at.x() + s.centre.x(), at.y() + s.centre.y(), r, height}, height});
        }
    std::stable_sort(discs.begin(), discs.end(),
                     [](const Disc& a, const Disc& b) { return a.height < b.height; });
    CircleSet set;
    for (const Disc& d : discs) set.circles.push_back(d.circle);
    return set;
}

Summary clumps(const OutputFolder& folder) {
    constexpr Real size = 0.05, percent = 100, centimetre = 100;

    // 1. A plate of stones: roundness from left to right, form from top to bottom.
    struct Form {
        Real elongation, flatness;
    };
    const std::vector<Form> forms{{1.0, 1.0}, {1.0, 0.5}, {0.6, 1.0}, {0.6, 0.5}};
    const std::vector<Real> roundness{0.15, 0.3, 0.5, 0.7, 0.9, 1.0};
    CirclePicture plate{
        .title = "Stones of 5 cm: equant, flat, elongated, flat and elongated; roundness 0.15 to 1",
        .x = {.label = "x", .unit = "cm"},
        .y = {.label = "y", .unit = "cm"},
        .colour = {.label = "height above the centre", .unit = "cm"},
        .rows = 1};
    Real worst_form = 0, worst_volume = 0, worst_centre = 0;
    std::size_t fewest = 1000, most = 0;
    for (std::size_t row = 0; row < forms.size(); ++row)
        for (std::size_t column = 0; column < roundness.size(); ++column) {
            const Clump stone = make_gravel({.size = size,
                                             .elongation = forms[row].elongation,
                                             .flatness = forms[row].flatness,
                                             .roundness = roundness[column],
                                             .seed = 7 * row + column});
            Clump shown = stone;
            for (Sphere& s : shown.members) s.centre *= centimetre, s.radius *= centimetre;
            plate.sets.push_back(
                view_of(shown, {11.0 * static_cast<Real>(column), -7.0 * static_cast<Real>(row), 0}));
            const StoneForm form = form_of(stone);
            worst_form = std::max({worst_form, std::abs(form.elongation() - forms[row].elongation),
                                   std::abs(form.flatness() - forms[row].flatness)});
            worst_volume = std::max(worst_volume, relative_error(stone.volume, pi / 6 * cube(size)));
            worst_centre = std::max(worst_centre, union_moments(stone.members).centroid.norm() / size);
            fewest = std::min(fewest, stone.members.size());
            most = std::max(most, stone.members.size());
        }
    draw(plate, folder.path("stones.png"));

    // 2. How the errors fall with the number of spheres: a smooth pebble, and a box with sharp edges. The
    // pebble goes through a file, as a scanned stone would.
    write_stl(ellipsoid({0.035, 0.025, 0.0175}, 4), folder.path("pebble.stl"));
    const SurfaceMesh pebble = read_stl(folder.path("pebble.stl")), block = box({0.065, 0.05, 0.04});
    std::vector<Real> count, pebble_volume, pebble_inertia, block_volume, block_inertia, first_order;
    Summary at_100;
    for (const Index n : {1, 2, 5, 10, 20, 50, 100, 200}) {
        const SphereFillingResult a = fill_with_spheres(pebble, {.max_spheres = n}),
                                  b = fill_with_spheres(block, {.max_spheres = n});
        count.push_back(n);
        pebble_volume.push_back(percent * std::abs(a.error.volume));
        pebble_inertia.push_back(percent * a.error.inertia);
        block_volume.push_back(percent * std::abs(b.error.volume));
        block_inertia.push_back(percent * b.error.inertia);
        first_order.push_back(200.0 / n);
        if (n == 100)
            at_100 = {{"pebble_100_volume_error_relative", a.error.volume},
                      {"pebble_100_centroid_error_of_radius", a.error.centroid},
                      {"pebble_100_inertia_error_relative", a.error.inertia},
                      {"pebble_100_largest_gap_m", a.largest_gap},
                      {"block_100_volume_error_relative", b.error.volume},
                      {"block_100_inertia_error_relative", b.error.inertia},
                      {"block_100_largest_gap_m", b.largest_gap}};
    }
    draw(LineChart{.title = "Spheres in a surface: what they leave out",
                   .x = {.label = "spheres", .min = 0.9, .max = 250, .logarithmic = true},
                   .y = {.label = "error against the surface's own",
                         .unit = "%",
                         .min = 0.7,
                         .max = 200,
                         .logarithmic = true},
                   .curves = {{"pebble, volume", count, pebble_volume, CurveStyle::points},
                              {"pebble, inertia", count, pebble_inertia, CurveStyle::points},
                              {"block, volume", count, block_volume, CurveStyle::points},
                              {"block, inertia", count, block_inertia, CurveStyle::points},
                              {"1 / n", count, first_order, CurveStyle::dashed}}},
         folder.path("convergence.png"));

    // 3. Three spheres in a row, of which neighbours share a lens: the closed form, by slices.
    Real worst_row = 0;
    for (const Real d : evenly(1.05, 1.95, 10)) {
        const Real lens = pi * square(2 - d) * (d * d + 4 * d) / (12 * d);
        const Real exact = 4 * pi - 2 * lens;
        const Vec3 axis(0.48, -0.6, 0.64);
        const std::vector<Sphere> three{{0 * axis, 1}, {d * axis, 1}, {2 * d * axis, 1}};
        worst_row = std::max(worst_row, relative_error(union_moments(three).volume, exact));
    }

    Summary summary{
        {"row_of_three_volume_error_relative", worst_row},
        {"gravel_volume_error_relative", worst_volume},
        {"gravel_centre_error_of_size", worst_centre},
        {"gravel_form_error", worst_form},
        {"gravel_fewest_spheres", fewest},
        {"gravel_most_spheres", most},
        {"pebble_order_of_volume_error",
         measured_order({count.begin() + 3, count.end()}, {pebble_volume.begin() + 3, pebble_volume.end()})},
        {"block_order_of_volume_error",
         measured_order({count.begin() + 3, count.end()}, {block_volume.begin() + 3, block_volume.end()})}};
    summary.update(at_100);
    return summary;
}

}  // namespace

int main(int argc, char** argv) {
    return textbook_main(argc, argv, "04_clumps", "Clumps: stones made of spheres", clumps);
}
