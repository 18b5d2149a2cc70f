// Water that was saved between two steps goes on to the same bits, with any number of threads.
#include <abrade/fluid/momentum/turbulence.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/shallow_water/shallow_water.hpp>
#include <abrade/io/restart.hpp>

#include <doctest/doctest.h>

#include <cstring>

using namespace abrade;

namespace {

template <class Number>
void append(std::vector<Real>& all, const Field<Number>& field) {
    for (Offset c = 0; c < field.size(); ++c) all.push_back(static_cast<Real>(field[c]));
}
template <class Flow>
std::vector<Real> state(const Flow& flow) {
    std::vector<Real> all{flow.time(), flow.stable_step().seconds};
    if constexpr (requires { flow.columns(); }) {
        const auto columns = flow.columns();
        for (const FieldView& one : columns.fields())
            all.insert(all.end(), one.values.begin(), one.values.end());
        all.push_back(flow.volume_residual());
    } else {
        for (const auto& component : flow.velocity()) append(all, component);
        append(all, flow.pressure());
        if constexpr (requires { flow.liquid(); }) append(all, flow.liquid().fraction());
        if (flow.has_energy_account())
            flow.energy().visit([&](std::string_view, Real joules) { all.push_back(joules); });
    }
    return all;
}
bool same_bits(const std::vector<Real>& a, const std::vector<Real>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Real)) == 0;
}

/// To each of the times, without a break, and with one after each of them.
template <class Make>
void check_restarts(const std::string& name, const Make& make, const std::vector<Real>& times) {
    CAPTURE(name);
    const std::string path = name + ".h5";
    auto whole = make();
    std::vector<std::vector<Real>> seen;
    for (const Real time : times) whole.advance(time), seen.push_back(state(whole));
    const int before = thread_count();
    for (const int threads : {1, 2, 3}) {
        CAPTURE(threads);
        for (std::size_t n = 0; n < times.size(); ++n) {
            set_thread_count(n % 2 ? threads : 1);
            auto part = make();
            if (n > 0) restore_state(path, name, StatePart{"fluid", part});
            part.advance(times[n]);
            CAPTURE(times[n]);
            CHECK(same_bits(state(part), seen[n]));
            save_state(path, name, StatePart{"fluid", part});
        }
    }
    set_thread_count(before);
}

template <int Dim>
GridFluidParams<Dim> dam(Real h, Real wall_at) {
    GridFluidParams<Dim> params;
    params.grid.cells.fill(4);
    params.grid.cells[0] = 32, params.grid.cells[Dim - 1] = 16;
    params.grid.spacing = Point<Dim>::Constant(h);
    params.boundaries = BoundaryConditions<Dim>::all(Boundary::free_slip);
    params.wall = [=](const Point<Dim>& x) {
        return std::hypot(x[0] - wall_at, x[Dim - 1] - 2.3 * h) - 2.2 * h;
    };
    params.water = [=](const Point<Dim>& x) { return std::min(10 * h - x[0], 12 * h - x[Dim - 1]); };
    params.gravity[Dim - 1] = -9.81;
    return params;
}

}  // namespace

TEST_CASE("a dam that breaks on a cylinder, its energy counted") {
    const auto make = [] {
        GridFluid<2> flow(dam<2>(0.05, 1.03));
        flow.open_energy_account();
        return flow;
    };
    check_restarts("dam", make, {0.05, 0.3, 0.45, 0.7, 1.2});
    check_restarts("dam_3d", [] { return GridFluid<3>(dam<3>(0.05, 1.03)); }, {0.1, 0.5, 0.6});
}

TEST_CASE("a surface that is a height, eddies by a mixing length, water in and out") {
    const auto make = [] {
        auto params = dam<3>(0.05, 0.8);
        params.wall = [](const Point<3>& x) { return x[2] - 0.12 * std::exp(-square(x[0] - 0.8) / 0.02); };
        params.boundaries[0] = {Boundary::inflow, Boundary::outflow};
        params.wall_law = {WallLaw::Kind::logarithmic, 1e-3};
        params.boundary_velocity = [](const Point<3>&, Real t) {
            return Point<3>(1 + 0.5 * std::sin(9 * t), 0, 0);
        };
        params.inflow_water = [](const Point<3>& x) { return 0.4 - x[2]; };
        params.outflow_water = [](const Point<3>& x) { return 0.3 - x[2]; };
        params.steady_boundaries = false;
        return GridFluid<3, Turbulent<MixingLength, HeightSurface>>(params, MixingLength{{.depth = 0.4}});
    };
    check_restarts("height", make, {0.05, 0.3, 0.31, 0.8});
}

TEST_CASE("a full box") {
    const auto make = [] {
        GridFluidParams<2> params{.grid = {.cells = {24, 24}, .spacing = Point<2>::Constant(1.0 / 24)},
                                  .boundaries = BoundaryConditions<2>::all(Boundary::wall)};
        params.boundary_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] > 0.99 ? 1 : 0, 0); };
        params.viscosity = 2;
        GridFluid<2, FullBox> flow(params);
        flow.open_energy_account();
        return flow;
    };
    check_restarts("cavity", make, {0.5, 1.0, 3.0});
}

TEST_CASE("depth-averaged water that flows in below deep water") {
    const auto make = [] {
        ShallowWaterParams<1> params;
        params.high = {10}, params.cells = {50};
        params.boundaries[0][0] = ShallowBoundary::inflow(0.5);
        params.surface = [](Real x, Real) { return 1 + 0.2 * std::exp(-square(x - 3)); };
        return ShallowWater<1>(params);
    };
    check_restarts("inflow", make, {0.2, 0.5, 1.5});
}

TEST_CASE("depth-averaged water") {
    const auto make = [] {
        ShallowWaterParams<2> params;
        params.high = {6, 4}, params.cells = {60, 40};
        params.bed = [](Real x, Real y) { return 0.1 * std::sin(x) * std::cos(y); };
        params.surface = [](Real x, Real y) { return x < 2 && y < 2 ? 0.5 : 0.05; };
        return ShallowWater<2>(params);
    };
    check_restarts("shallow", make, {0.2, 0.5, 1.5});
}
