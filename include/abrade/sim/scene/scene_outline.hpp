#pragma once
// What of a scene and its laws stays as it is for a whole run, written down: a checkpoint is of the same.

#include <abrade/sim/scene/policies.hpp>
#include <abrade/sim/scene/scene.hpp>

#include <algorithm>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

namespace abrade {

/// One line for each thing, with a tab before its value: how many there are, where and of what. Where stones
/// are and how fast is none of it. Numbers have twelve digits: another machine's sine may differ in the last.
class SceneOutline {
public:
    SceneOutline() = default;
    template <class P>
    SceneOutline(const Scene& scene, const P& policies) {
        add_head(scene, policies);
        const std::size_t head = built_.size();
        add_rest(scene);
        rest_ = built_.substr(head);
    }
    /// After walls or gravity have changed.
    template <class P>
    void renew(const Scene& scene, const P& policies) {
        built_.clear();
        add_head(scene, policies);
        lines_ = built_ += rest_;
    }

    static void fields(auto&& field) { field("outline", &SceneOutline::lines_); }
    /// Throws InputError by the first thing in which the checkpoint differs from what was built.
    void restored() {
        std::istringstream own(built_), its(lines_);
        for (std::string mine, saved; std::getline(own, mine);) {
            std::getline(its, saved);
            if (mine == saved) continue;
            const auto value = [](const std::string& of) { return of.substr(of.find('\t') + 1); };
            fail({mine.substr(0, mine.find('\t')), value(saved) + " as in the checkpoint", "",
                  "build the scene and its laws as they were when it was saved"},
                 value(mine));
        }
    }

private:
    template <class P>
    void add_head(const Scene& scene, const P& policies) {
        const auto law = [&](std::string_view name, const std::string& text) { line(name, text, ""); };
        law("contact law", describe(policies.contact)), law("bond law", describe(policies.bond));
        law("wear law", describe(policies.wear)), law("fluid", describe(policies.fluid));
        law("drag law", describe(policies.drag));
        add_space(scene), add_walls(scene.walls);
        number("Scene.moving_walls", scene.moving_walls.size());
    }
    /// What no change between runs changes.
    void add_rest(const Scene& scene) {
        add_stones(scene.stones);
        line("Scene.concrete", scene.concrete ? "given" : "none", "");
        if (scene.concrete) add_concrete(*scene.concrete);
        line("Scene.feed", scene.feed ? "given" : "none", "");
        if (scene.feed) add_feed(*scene.feed);
    }
    void line(std::string_view name, const std::string& value, std::string_view unit) {
        built_.append(name).append("\t").append(value);
        if (!unit.empty()) built_.append(" ").append(unit);
        built_.append("\n");
        lines_ = built_;
    }
    template <class Number>
    void number(std::string_view name, Number value, std::string_view unit = "") {
        char text[40];
        std::snprintf(text, sizeof text, "%.12g", static_cast<Real>(value));
        line(name, text, unit);
    }
    void place(const std::string& name, const Vec3& x, std::string_view unit) {
        for (int a = 0; a < 3; ++a) number(name + "." + "xyz"[a], x[a], unit);
    }
    static std::string nth(std::string_view name, std::size_t n) {
        return std::string(name) + "[" + std::to_string(n) + "]";
    }

    void add_space(const Scene& scene) {
        place("Scene.gravity", scene.gravity, "m/s2");
        place("Scene.bounds.low", scene.bounds.low, "m"), place("Scene.bounds.high", scene.bounds.high, "m");
        for (std::size_t a = 0; a < 3; ++a) number(nth("Scene.periodic_along", a), scene.periodic_along[a]);
        for (const auto& [name, x] :
             {std::pair("Scene.outlet", scene.outlet), std::pair("Scene.flow_counter", scene.flow_counter)})
            if (x)
                number(name, *x, "m");
            else
                line(name, "none", "");
    }
    void add_walls(const std::vector<Plane>& walls) {
        number("Scene.walls", walls.size());
        for (std::size_t n = 0; n < walls.size(); ++n) {
            const std::string name = nth("Scene.walls", n);
            place(name + ".point", walls[n].point, "m"), place(name + ".normal", walls[n].normal, "");
            number(name + ".material", walls[n].material);
        }
    }
    /// Of many only the sums.
    void add_stones(const std::vector<Scene::Stone>& stones) {
        Real volume = 0, mass = 0;
        std::size_t fixed = 0, spheres = 0;
        std::vector<Index> of_material;
        for (const Scene::Stone& stone : stones) {
            volume += stone.clump.volume, mass += stone.density * stone.clump.volume;
            fixed += stone.fixed, spheres += stone.clump.members.size();
            of_material.push_back(stone.state.material);
        }
        number("Scene.stones", stones.size()), number("Scene.stones that are fixed", fixed);
        number("Scene.stones: spheres", spheres), number("Scene.stones: volume", volume, "m3");
        number("Scene.stones: mass", mass, "kg");
        std::sort(of_material.begin(), of_material.end());
        for (std::size_t n = 0; n < of_material.size();) {
            const Index material = of_material[n];
            const std::size_t first = n;
            while (n < of_material.size() && of_material[n] == material) ++n;
            number("Scene.stones of material " + std::to_string(material), n - first);
        }
    }
    void add_concrete(const ConcreteBlock& concrete) {
        const auto choice = [&](std::string_view name, auto value) {
            number("Scene.concrete." + std::string(name), static_cast<Index>(value));
        };
        choice("level", concrete.level), choice("fragments", concrete.fragments);
        choice("worn_out", concrete.worn_out), choice("fracture_volume", concrete.fracture_volume);
        choice("overflow", concrete.overflow.index());
        choice("cluster", concrete.cluster), choice("material", concrete.material);
        number("Scene.concrete.density", concrete.density, "kg/m3");
        const Lattice& lattice = concrete.lattice;
        number("Scene.concrete.lattice.sites", lattice.sites.size());
        number("Scene.concrete.lattice.bonds", lattice.bonds.size());
        number("Scene.concrete.lattice.radius", lattice.radius, "m");
        Vec3 low = lattice.sites.front().centre, high = low;
        std::size_t held = 0;
        for (const LatticeSite& site : lattice.sites)
            low = low.cwiseMin(site.centre), high = high.cwiseMax(site.centre), held += site.held;
        number("Scene.concrete.lattice.sites that are held", held);
        place("Scene.concrete.lattice: lowest centre", low, "m");
        place("Scene.concrete.lattice: highest centre", high, "m");
    }
    void add_feed(const FeedParams& feed) {
        number("Feed.volume_rate", feed.volume_rate, "m3/s"), number("Feed.density", feed.density, "kg/m3");
        place("Feed.region.low", feed.region.low, "m"), place("Feed.region.high", feed.region.high, "m");
        place("Feed.velocity", feed.velocity, "m/s");
        number("Feed.start", feed.start, "s"), number("Feed.end", feed.end, "s");
        number("Feed.seed", feed.seed), number("Feed.classes", feed.classes.size());
        for (std::size_t n = 0; n < feed.classes.size(); ++n) {
            const std::string name = nth("Feed.classes", n);
            const StoneClass& stones = feed.classes[n];
            number(name + ".size", stones.size, "m"), number(name + ".fraction", stones.fraction);
            number(name + ".shape", static_cast<Index>(stones.shape));
            number(name + ".material", stones.material);
        }
    }

    std::string built_, lines_;  ///< of this scene; what is saved, or was read
    std::string rest_;           ///< part of the first that no change between runs changes
};

static_assert(ListsFields<SceneOutline>);

}  // namespace abrade
