// Stones in water that resolves them, saved between two steps: the same bits afterwards, with any number of
// threads.
#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/coupling/exchange/one_fluid.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/geometry/stone_shapes.hpp>
#include <abrade/io/restart.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <cstring>

using namespace abrade;

namespace {

template <class Surface, class Solids>
auto stones_in_water() {
    using Water = GridFluid<3, Among<Solids, Surface>>;
    GridFluidParams<3> params{.grid = {.cells = {14, 12, 14}, .spacing = Vec3::Constant(0.05)},
                              .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                              .gravity = {0, 0, -9.81}};
    if constexpr (!std::same_as<Surface, FullBox>)
        params.water = [](const Vec3& x) { return 0.41 + 0.05 * x.x() - x.z(); };
    Scene scene;
    scene.gravity = params.gravity;
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    scene.add_sphere(0.07, {.position = {0.25, 0.3, 0.45}, .angular_velocity = {0, 5, 0}});
    scene.add_stone(make_stone(StoneShape::angular, 0.16), {.position = {0.45, 0.28, 0.1}});
    return simulate(scene).contact(LinearSpring{{.stiffness = 1e5, .restitution = 0.6}}).fluid(Water(params));
}

template <class Sim>
std::vector<Real> state(const Sim& sim) {
    std::vector<Real> all{sim.time(), sim.fluid_model().time(), sim.ledger().flow_work};
    for (const auto* column : {&sim.particles().position, &sim.particles().velocity,
                               &sim.particles().angular_momentum, &sim.particles().force})
        for (const Vec3& v : *column) all.insert(all.end(), v.data(), v.data() + 3);
    for (const auto& component : sim.fluid_model().velocity())
        for (Offset c = 0; c < component.size(); ++c) all.push_back(component[c]);
    return all;
}
bool same_bits(const std::vector<Real>& a, const std::vector<Real>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Real)) == 0;
}

template <class Surface, class Solids = MonolithicSolids<>>
void check(const std::string& name) {
    CAPTURE(name);
    constexpr Real end = 0.12;
    auto whole = stones_in_water<Surface, Solids>();
    int looks = 0;
    whole.run({.end_time = end, .time_step = 2e-4, .stop = [&] { return ++looks, false; }});
    CHECK(whole.ledger().residual_relative() < 1e-12);
    REQUIRE(looks > 4);
    const std::string path = name + ".h5";
    const int before = thread_count();
    for (const int threads : {1, 2, 3}) {
        CAPTURE(threads);
        auto first = stones_in_water<Surface, Solids>();
        int seen = 0;
        first.run({.end_time = end, .time_step = 2e-4, .stop = [&] {
                       if (++seen < looks / 2) return false;
                       save_state(path, name, StatePart{"simulation", first});
                       return true;
                   }});
        set_thread_count(threads);
        auto second = stones_in_water<Surface, Solids>();
        second.build();
        restore_state(path, name, StatePart{"simulation", second});
        second.run({.end_time = end, .time_step = 2e-4});
        CHECK(same_bits(state(second), state(whole)));
    }
    set_thread_count(before);
}

}  // namespace

TEST_CASE("in a full box") { check<FullBox>("resolved_box"); }
TEST_CASE("below a height") { check<HeightSurface>("resolved_height"); }
TEST_CASE("in a volume of fluid") { check<FreeSurface>("resolved_volume"); }
TEST_CASE("in one fluid") { check<HeightSurface, MixtureSolids>("resolved_mixture"); }
