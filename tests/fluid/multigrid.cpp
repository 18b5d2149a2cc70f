// The pressure's solver: against Eigen's conjugate gradients, flat iteration counts, singular boxes, threads.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/pressure/sparse_cholesky.hpp>

#include <doctest/doctest.h>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <random>

using namespace abrade;

namespace {

/// A box of cubes; `wet` says which cells take part, the others are air at e = 0 unless `closed`.
template <int Dim>
ConjugateGradients<Dim> system_of(const CellNumber<Dim>& cells, auto&& wet, bool closed,
                                  PerAxis<bool, Dim> periodic = {}, Real theta_low = 1) {
    const Layout<Dim> l(cells);
    ConjugateGradients<Dim> solver(l, Point<Dim>::Constant(1), periodic);
    Poisson<Dim>& m = solver.matrix();
    std::mt19937 random(7);
    std::uniform_real_distribution<float> theta(static_cast<float>(theta_low), 1);
    typename Grid<Dim>::Params box{.cells = cells, .spacing = Point<Dim>::Constant(1)};
    const Grid<Dim> grid(box);
    grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
        for (int a = 0; a < Dim; ++a) {
            CellNumber<Dim> other = cell;
            if (cell[a] == 0 && !periodic[a]) continue;
            other[a] = cell[a] == 0 ? cells[a] - 1 : cell[a] - 1;
            const bool here = wet(cell), there = wet(other);
            if (here && there) m.face[a][c] = 1;
            if (here != there && !closed) m.dirichlet[here ? c : l.at(other)] += 1 / theta(random);
        }
    });
    solver.build();
    return solver;
}

template <int Dim>
void fill_random(ConjugateGradients<Dim>& solver, const CellNumber<Dim>& cells) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> value(-1, 1);
    const Grid<Dim> grid({.cells = cells, .spacing = Point<Dim>::Constant(1)});
    grid.for_each([&](const CellNumber<Dim>&, Offset c) {
        const float v = value(random);
        solver.right_side()[c] = solver.matrix().inverse_diagonal[c] > 0 ? v : 0;
    });
}

/// Smooth and rough parts together, as a flow leaves them.
template <int Dim>
int iterations(const CellNumber<Dim>& cells, auto&& wet, bool closed, Real theta_low = 1) {
    auto solver = system_of<Dim>(cells, wet, closed, {}, theta_low);
    fill_random(solver, cells);
    auto first = solver.solve(0, 0);
    return solver.solve(1e-4 * first.before, 60).iterations;
}

}  // namespace

TEST_CASE("the same solution as Eigen's conjugate gradients with incomplete Cholesky") {
    constexpr CellNumber<3> cells{13, 10, 7};
    const auto wet = [](const CellNumber<3>& c) { return c[2] < 3 + c[0] % 4; };
    auto solver = system_of<3>(cells, wet, false, {}, 0.1);
    fill_random(solver, cells);
    const Poisson<3>& m = solver.matrix();
    const Layout<3>& l = m.layout;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(l.total);
    const Grid<3> grid({.cells = cells, .spacing = Point<3>::Constant(1)});
    grid.for_each([&](const CellNumber<3>&, Offset c) {
        const int i = static_cast<int>(c);
        if (m.inverse_diagonal[c] == 0) return;
        right[i] = static_cast<double>(solver.right_side()[c]);
        entries.emplace_back(i, i, static_cast<double>(m.dirichlet[c]));
        for (int a = 0; a < 3; ++a)
            for (const Offset side : {Offset{0}, l.stride[a]}) {
                const auto g = static_cast<double>(m.face[a][c + side]);
                if (g == 0) continue;
                entries.emplace_back(i, i, g);
                entries.emplace_back(i, static_cast<int>(side == 0 ? c - l.stride[a] : c + side), -g);
            }
    });
    for (Offset c = 0; c < l.total; ++c)
        if (m.inverse_diagonal[c] == 0) entries.emplace_back(static_cast<int>(c), static_cast<int>(c), 1.0);
    Eigen::SparseMatrix<double> matrix(l.total, l.total);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper,
                             Eigen::IncompleteCholesky<double>>
        reference(matrix);
    reference.setTolerance(1e-12);
    const Eigen::VectorXd expected = reference.solve(right);
    solver.solve(1e-6 * right.norm(), 50);
    Real worst = 0;
    for (Offset c = 0; c < l.total; ++c)
        if (m.inverse_diagonal[c] > 0)
            worst = std::max(worst, std::abs(static_cast<Real>(solver.solution()[c]) - expected[c]));
    MESSAGE("largest difference " << worst << " of " << expected.cwiseAbs().maxCoeff());
    CHECK(worst < 1e-5 * expected.cwiseAbs().maxCoeff());
}

TEST_CASE("iterations do not grow with the box") {
    const auto all = [](const auto&) { return true; };
    const auto bumpy = [](const CellNumber<3>& c) {
        return c[2] < 8 + 4 * std::sin(0.3 * c[0]) * std::cos(0.2 * c[1]);
    };
    const int small = iterations<3>({16, 16, 16}, all, true), large = iterations<3>({64, 64, 64}, all, true);
    const int bumpy_small = iterations<3>({24, 24, 16}, bumpy, false, 1e-4),
              bumpy_large = iterations<3>({96, 96, 16}, bumpy, false, 1e-4);
    const int channel = iterations<3>({500, 25, 13}, bumpy, false, 1e-4);
    const int flat = iterations<2>({256, 256}, all, true);
    MESSAGE("closed boxes " << small << ", " << large << "; under a bumpy surface " << bumpy_small << ", "
                            << bumpy_large << "; a channel " << channel << "; 2-D " << flat);
    CHECK(large <= small + 2);
    CHECK(bumpy_large <= bumpy_small + 2);
    for (const int n : {large, bumpy_large, channel, flat}) CHECK(n <= 10);
}

TEST_CASE("a periodic box is solved but for a constant, odd sizes too") {
    for (const int n : {16, 15}) {
        auto solver = system_of<2>({n, n}, [](const auto&) { return true; }, true, {true, true});
        CHECK(solver.floating());
        const Grid<2> grid({.cells = {n, n}, .spacing = Point<2>::Constant(1)});
        const Real k = 2 * pi / n, eigenvalue = 4 - 2 * std::cos(k) - 2 * std::cos(k);
        const auto wave = [&](const CellNumber<2>& c) {
            return std::sin(k * c[0] + 0.3) * std::cos(k * c[1]);
        };
        grid.for_each([&](const CellNumber<2>& cell, Offset c) {
            solver.right_side()[c] = static_cast<float>(eigenvalue * wave(cell));
        });
        solver.solve(1e-6, 40);
        const auto error = [&](const CellNumber<2>& cell, Offset c) {
            return static_cast<Real>(solver.solution()[c]) - wave(cell);
        };
        Real worst = 0, mean = 0;
        grid.for_each([&](const CellNumber<2>& cell, Offset c) { mean += error(cell, c) / (n * n); });
        grid.for_each([&](const CellNumber<2>& cell, Offset c) {
            worst = std::max(worst, std::abs(error(cell, c) - mean));
        });
        CHECK(worst < 1e-4);
    }
}

TEST_CASE("the same bits for one thread and two") {
    constexpr CellNumber<3> cells{48, 32, 24};
    std::vector<float> one;
    for (const int threads : {1, 2}) {
        set_thread_count(threads);
        auto solver = system_of<3>(cells, [](const auto& c) { return c[2] < 12 + c[0] % 5; }, false,
                                   {true, false, false});
        fill_random(solver, cells);
        solver.solve(1e-3, 5);
        const std::vector<float> bits(solver.solution().data(),
                                      solver.solution().data() + solver.solution().size());
        if (threads == 1)
            one = bits;
        else
            CHECK(std::memcmp(one.data(), bits.data(), bits.size() * sizeof(float)) == 0);
    }
    set_thread_count(1);
}

static_assert(PressureSolver<ConjugateGradients<2>, 2> && PressureSolver<SparseCholesky<3>, 3>);
static_assert(!PressureSolver<Multigrid<2>, 2>);

TEST_CASE_TEMPLATE("a flow is the same whoever solves for its pressure", Surface, FullBox, FreeSurface,
                   HeightSurface) {
    GridFluidParams<2> params{
        .grid = {.cells = {24, 16}, .spacing = Point<2>::Constant(0.05)},
        .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
        .velocity = [](const Point<2>& x) { return Point<2>(std::sin(5 * x[1]), 0.3 * std::cos(4 * x[0])); },
        .gravity = {0, -9.81},
        .tolerance = 1e-10};
    if constexpr (Surface::surface != SurfaceKind::none)
        params.water = [](const Point<2>& x) { return 0.45 + 0.1 * std::cos(2.6 * x[0]) - x[1]; };
    GridFluid<2, Surface> iterated(params);
    GridFluid<2, SolvedBy<SparseCholesky, Surface>> direct(params);
    const Real dt = 0.5 * iterated.stable_step().seconds;
    for (int k = 0; k < 20; ++k) iterated.step(dt), direct.step(dt);
    Real off = 0, fastest = 0;
    iterated.grid().for_each([&](const CellNumber<2>&, Offset c) {
        for (int a = 0; a < 2; ++a) {
            off = std::max(off, std::abs(iterated.velocity()[a][c] - direct.velocity()[a][c]));
            fastest = std::max(fastest, std::abs(iterated.velocity()[a][c]));
        }
    });
    MESSAGE("off by " << off << " m/s of " << fastest);
    CHECK(fastest > 0.1);
    CHECK(off < 1e-6);  // what the tolerance leaves of 20 steps; 1.5e-7 was found
}
