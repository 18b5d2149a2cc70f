#pragma once
// Whether a table of laws has what a scene needs.

#include <abrade/dem/store/particles.hpp>
#include <abrade/sim/scene/scene.hpp>

namespace abrade {

/// Throws InputError where a material has no such number, or where two materials that can meet have no law.
/// What can meet: what moves with what moves and with what does not; a body does not meet itself.
template <class Table>
void require_laws_for(const Table& table, const Particles& particles, const Scene& scene) {
    const auto count = static_cast<std::size_t>(table.materials());
    std::vector<Index> moving(count, 0), standing(count, 0);  // [material], as far as two
    const auto add = [&](std::vector<Index>& to, Index material, const std::string& field, Index bodies) {
        require(material >= 0 && material < table.materials(),
                {field, "the number of a material, below " + std::to_string(count), "",
                 "MaterialPairs::number(name) gives it"},
                material);
        to[static_cast<std::size_t>(material)] += bodies;
    };
    for (std::size_t b = 0; b < particles.material.size(); ++b)
        add(particles.inverse_mass[b] > 0 ? moving : standing, particles.material[b], "BodyState.material",
            1);
    for (const Plane& wall : scene.walls) add(standing, wall.material, "Plane.material", 1);
    if (scene.feed)
        for (const StoneClass& stones : scene.feed->classes)
            add(moving, stones.material, "StoneClass.material", 2);
    for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = a; b < count; ++b) {
            const bool meet =
                a == b ? moving[a] > 1 || (moving[a] > 0 && standing[a] > 0)
                       : (moving[a] > 0 && moving[b] + standing[b] > 0) || (moving[b] > 0 && standing[a] > 0);
            const auto first = static_cast<Index>(a), second = static_cast<Index>(b);
            if (meet && !table.has({first, second}))
                fail({"MaterialPairs.pairs", "complete for what can meet in the scene", "",
                      "add a law for these two"},
                     "none for " + table.material(first) + " with " + table.material(second));
        }
}

/// Throws InputError where a material has a number though one law serves all contacts.
inline void require_one_material(const Scene& scene) {
    const auto check = [](Index material, const std::string& field) {
        require(material == 0,
                {field, "0 where one law serves all contacts", "",
                 "hand contact() a MaterialPairs table, whose number(name) gives it"},
                material);
    };
    for (std::size_t n = 0; n < scene.stones.size(); ++n)
        if (scene.stones[n].state.material != 0)
            check(scene.stones[n].state.material, "Scene.stones[" + std::to_string(n) + "].material");
    for (std::size_t n = 0; n < scene.walls.size(); ++n)
        if (scene.walls[n].material != 0)
            check(scene.walls[n].material, "Scene.walls[" + std::to_string(n) + "].material");
    if (scene.concrete) check(scene.concrete->material, "Scene.concrete.material");
    if (scene.feed)
        for (const StoneClass& stones : scene.feed->classes) check(stones.material, "StoneClass.material");
}

}  // namespace abrade
