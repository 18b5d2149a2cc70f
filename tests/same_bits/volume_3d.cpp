// Water in three dimensions by volume of fluid: a dam that breaks onto walls.
#include "states.hpp"

#include <abrade/fluid/embedded_boundary/solid_shapes.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/queries/flow_queries.hpp>
#include <abrade/fluid/queries/wall_loads.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

constexpr Real h = 0.05;

GridFluidParams<3> tank(int along = 26) {
    GridFluidParams<3> params{.grid = {.cells = {along, 12, 16}, .spacing = Vec3::Constant(h)},
                              .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                              .gravity = {0, 0, -9.81}};
    params.water = [](const Vec3& x) { return std::min(0.5 - x.x(), 0.6 + 0.1 * x.y() - x.z()); };
    return params;
}
Numbers run(const GridFluidParams<3>& params) {
    GridFluid<3> flow(params);
    flow.open_energy_account();
    flow.advance(0.35);
    Numbers numbers = state_of_water(flow);
    if (params.wall) {
        const auto load = wall_load(flow, {0.8, 0.3, 0});
        numbers.kind("wall load").add_vector(load.pressure.force), numbers.add_vector(load.shear.force);
        numbers.add_vector(load.total().moment), numbers.add(load.wetted);
        numbers.figure("wall load", load.pressure.force.norm());
    }
    const auto side = side_load(flow, {0, false}, {0, 0, 0});
    numbers.kind("side load").add_vector(side.pressure.force), numbers.add_vector(side.total().moment);
    numbers.kind("asked").add(gauge(flow, 0.7, 0.31)), numbers.add(section(flow, 0, 0.6).discharge);
    numbers.add(pressure_at(flow, {0.21, 0.33, 0.17}));
    return std::move(numbers).with({"fastest water", "water numerical"});
}

const Register free{"water3.volume_dam", [] { return run(tank()); }};
/// So long that threads share it: waves that run along a channel over a bump.
const Register longer{"water3.volume_long", [] {
                          auto params = tank(90);
                          params.water = [](const Vec3& x) {
                              return 0.3 + 0.12 * std::cos(5 * x.x()) + 0.05 * x.y() - x.z();
                          };
                          params.wall = BallWall<3>({0.8, 0.31, -0.05}, 0.17);
                          return run(params);
                      }};
/// Onto a round pier and a block, which hold the water.
const Register pier{"water3.volume_pier", [] {
                        auto params = tank();
                        params.wall = WallUnion(CylinderWall({0.78, 0.21, -0.2}, {0.78, 0.24, 0.9}, 0.13),
                                                BoxWall<3>({0.95, 0.34, -1}, {1.18, 0.71, 0.22}));
                        return run(params).with({"wall load"});
                    }};
/// Onto boulders of concrete, rough.
const Register boulders{"water3.volume_boulders", [] {
                            auto params = tank();
                            std::vector<Sphere> spheres;
                            for (int n = 0; n < 6; ++n)
                                spheres.push_back({{0.6 + 0.2 * (n % 3), 0.16 + 0.27 * (n / 3), 0.03}, 0.11});
                            params.wall = SpherePacking(spheres);
                            params.wall_law = {WallLaw::Kind::logarithmic, 0.004};
                            return run(params).with({"wall load", "water wall_friction"});
                        }};
/// Onto a ball without friction.
const Register ball{"water3.volume_ball", [] {
                        auto params = tank();
                        params.wall = BallWall<3>({0.8, 0.31, 0.12}, 0.17);
                        params.wall_law.kind = WallLaw::Kind::slip;
                        return run(params).with({"wall load"});
                    }};

}  // namespace
