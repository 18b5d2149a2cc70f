#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/queries/flow_queries.hpp>
#include <iostream>

// A column of water, 0.2 m wide and 0.4 m high, collapses in a tank of 1 m (two dimensions: x and z).
int main() {
    abrade::GridFluidParams<2> tank{
        .grid = {.cells = {50, 30}, .spacing = {0.02, 0.02}},
        .boundaries = abrade::BoundaryConditions<2>::all(abrade::Boundary::free_slip)};
    tank.gravity = {0, -9.81};
    tank.water = [](const auto& x) { return std::min(0.2 - x[0], 0.4 - x[1]); };  // > 0: there is water

    abrade::GridFluid<2> flow(
        tank);  // the surface is a volume of fluid; <2, HeightSurface> is one that is a height
    flow.open_energy_account();
    for (int n = 0; n <= 4; ++n) {
        flow.advance(0.1 * n);  // [s], in as many steps as are stable
        std::cout << flow.time() << " s: level at x = 0.1 m " << abrade::gauge(flow, 0.1)
                  << " m, at x = 0.5 m " << abrade::gauge(flow, 0.5)
                  << " m; pressure at the foot of the left wall " << abrade::pressure_at(flow, {0.01, 0.01})
                  << " Pa\n";
    }
    const abrade::WaterEnergy& energy = flow.energy();
    std::cout << flow.steps() << " steps; kinetic energy " << energy.kinetic
              << " J per metre of width, of what fell " << energy.potential_start - energy.potential
              << " J\n";
}
