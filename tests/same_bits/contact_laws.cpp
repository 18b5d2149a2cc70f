// Laws by moduli: Hertz-Mindlin in its variants, and contacts that yield, by a table of materials.
#include "../verification/ledger_scenes.hpp"
#include "states.hpp"

#include <abrade/dem/laws/elastic_plastic_hertz.hpp>
#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/dem/laws/material_pairs.hpp>

using namespace same_bits;
using namespace ledger_scenes;

namespace {

Numbers hertz_gas(HertzMindlin::Spring spring, HertzMindlin::Slider slider, bool tension) {
    auto sim = simulate(gas(5)).contact(HertzMindlin{{.youngs = 5e8,
                                                      .restitution = 0.8,
                                                      .friction = 0.3,
                                                      .tension = tension,
                                                      .spring = spring,
                                                      .slider = slider}});
    sim.run({.end_time = 0.04});
    return state_of(sim).with({"lost_normal", "lost_sliding", "stored_contacts"});
}

/// Stones of two materials between steel plates.
Numbers of_materials() {
    const MaterialPairs<ElasticPlasticHertz> laws{
        {.materials = {"granite", "lime", "steel"},
         .pairs = {{"granite", "granite", {.youngs = 5e8, .yield_pressure = 2e7, .friction = 0.4}},
                   {"granite",
                    "lime",
                    {.youngs = 2e8, .yield_pressure = 5e6, .friction = 0.3, .youngs_other = 5e8}},
                   {"lime", "lime", {.youngs = 2e8, .yield_pressure = 5e6, .friction = 0.5}},
                   {"granite",
                    "steel",
                    {.youngs = 5e8, .yield_pressure = 2e7, .friction = 0.2, .youngs_other = 2e9}},
                   {"lime",
                    "steel",
                    {.youngs = 2e8, .yield_pressure = 5e6, .friction = 0.2, .youngs_other = 2e9}}}}};
    abrade::Scene scene = gas(5);
    for (std::size_t n = 0; n < scene.stones.size(); ++n)
        scene.stones[n].state.material = laws.number(n % 3 == 0 ? "lime" : "granite");
    for (Plane& wall : scene.walls) wall.material = laws.number("steel");
    auto sim = simulate(scene).contact(laws);
    sim.run({.end_time = 0.04});
    return state_of(sim).with({"lost_normal", "lost_sliding"});
}

const Register incremental{
    "grains.hertz_mindlin",
    [] { return hertz_gas(HertzMindlin::Spring::incremental, HertzMindlin::Slider::whole_force, false); }};
const Register total{"grains.hertz_mindlin_total", [] {
                         return hertz_gas(HertzMindlin::Spring::total, HertzMindlin::Slider::springs, true);
                     }};
const Register materials{"grains.elastic_plastic_materials", of_materials};

}  // namespace
