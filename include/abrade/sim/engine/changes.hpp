#pragma once
// Changes between two runs: bodies and walls that come and go, gravity, what is let go or held.

#include <abrade/sim/scene/materials.hpp>
#include <abrade/sim/state/state.hpp>

#include <string>

namespace abrade {

/// What these do to a state whose `particles` are as of now and whose velocities are whole. What they put in
/// is the ledger's `fed_*`, what they take out its `left_*`. Lists must be renewed afterwards. With
/// `Acts::no` each only checks: it throws InputError where it cannot be, and leaves the state as it was.
template <class P>
class Changes {
public:
    enum class Acts : bool { no, yes };
    Changes(State<P>& state, Acts acts) : state_(state), acts_(acts == Acts::yes) {}

    /// Returns the body's id.
    Index add(const Scene::Stone& stone) {
        Scene scene = empty_scene();
        scene.stones.push_back(stone);
        scene.validate();
        if constexpr (!P::has_materials) {
            require_one_material(scene);
            if (!acts_) return 0;
        }
        BodyState at = stone.state;
        at.position += state_.scene.periodic().way_back(at.position);
        Particles& p = state_.particles;
        const Index body = p.add(stone.clump, stone.density, at, stone.fixed ? Kind::fixed : Kind::stone);
        if constexpr (P::has_materials) {
            const auto take_back = [&] {
                std::vector<char> last(at_of(p.bodies()), 0);
                last.back() = 1;
                p.remove(last), --p.next_id;
            };
            try {
                require_laws_for(state_.policies.contact, p, state_.scene);
            } catch (...) {
                take_back();
                throw;
            }
            if (!acts_) return take_back(), 0;
        }
        state_.scene.stones.push_back(stone), state_.stone_id.push_back(p.id[at_of(body)]);
        state_.accounts.sum.fed_kinetic += p.kinetic_energy(body);
        state_.accounts.sum.fed_potential += state_.potential_energy(body, p.position[at_of(body)]);
        return p.id[at_of(body)];
    }

    void remove(Index id) {
        const Index body = body_of(id);
        refuse_concrete(body, "remove");
        if (!acts_) return;
        const Particles& p = state_.particles;
        state_.accounts.sum.left_kinetic += p.kinetic_energy(body);
        state_.accounts.sum.left_potential += state_.potential_energy(body, p.position[at_of(body)]);
        state_.events.removed.push_back(body);
    }

    /// Lets go what was fixed: from now on it moves.
    void let_go(Index id) {
        const Index body = body_of(id);
        refuse_concrete(body, "let_go");
        require(state_.particles.kind[at_of(body)] == Kind::fixed,
                {"Simulation.let_go: id", "of a body that is fixed", "", "others move already"}, id);
        const Scene::Stone& stone = stone_of(id);
        if (!acts_) return;
        Particles& p = state_.particles;
        p.kind[at_of(body)] = Kind::stone;
        set_mobility(body, 1 / p.mass[at_of(body)],
                     Vec3((stone.density * stone.clump.principal_moments).cwiseInverse()));
        state_.accounts.sum.fed_potential += state_.potential_energy(body, p.position[at_of(body)]);
    }

    /// Holds what moves: from now on it is fixed where it is.
    void hold(Index id) {
        const Index body = body_of(id);
        Particles& p = state_.particles;
        require(p.kind[at_of(body)] == Kind::stone,
                {"Simulation.hold: id", "of a stone that moves", "", "concrete is held by its bonds"}, id);
        stone_of(id);  // so that it can be let go again
        if (!acts_) return;
        state_.accounts.sum.left_kinetic += p.kinetic_energy(body);
        state_.accounts.sum.left_potential += state_.potential_energy(body, p.position[at_of(body)]);
        p.kind[at_of(body)] = Kind::fixed;
        p.velocity[at_of(body)].setZero(), p.angular_momentum[at_of(body)].setZero();
        set_mobility(body, 0, Vec3::Zero());
    }

    /// Returns the wall's number.
    Index add_wall(const Vec3& point, const Vec3& normal, Index material) {
        Scene scene = empty_scene();
        scene.add_wall(point, normal, material);
        scene.validate();
        if constexpr (!P::has_materials) require_one_material(scene);
        state_.scene.walls.push_back(scene.walls.back());
        if constexpr (P::has_materials) {
            try {
                require_laws_for(state_.policies.contact, state_.particles, state_.scene);
            } catch (...) {
                state_.scene.walls.pop_back();
                throw;
            }
        }
        if (!acts_) state_.scene.walls.pop_back();
        return static_cast<Index>(state_.scene.walls.size()) - 1;
    }

    /// The numbers of the other walls stay.
    void remove_wall(Index number) {
        require(number >= 0 && number < static_cast<Index>(state_.scene.walls.size()),
                {"Simulation.remove_wall: number",
                 "of a wall, below " + std::to_string(state_.scene.walls.size()), "",
                 "add_wall returns it; those of the scene count from 0"},
                number);
        if (!acts_) return;
        state_.contacts.each_touching([&](const auto& touching) {
            if (touching.pair.second != -1 - number) return;
            const auto contact = contact_between(state_.store.lines, state_.scene.walls, touching.pair, 0);
            state_.accounts.sum.left_stored += law_between(state_.policies.contact, touching.materials)
                                                   .respond(contact, touching.memory)
                                                   .load.stored;
        });
        Plane& wall = state_.scene.walls[at_of(number)];
        wall.point = -1e100 * wall.normal;  // nothing is near it
        std::erase_if(state_.scene.moving_walls,
                      [&](const MovingWall& moving) { return moving.wall == number; });
        wall.moves = false;
    }

    void set_gravity(const Vec3& gravity) {
        require_finite(gravity, "Simulation.set_gravity", "m/s2");
        if (state_.standing || P::fluid_resolves)
            fail({"Simulation.set_gravity",
                  "asked of scenes without standing concrete and without water on a grid", "",
                  "both stand under the gravity that they were built with"},
                 state_.standing ? "standing concrete" : "water on a grid");
        if (!acts_) return;
        const auto potential = [&] {
            Real sum = 0;
            for (Index b = 0; b < state_.particles.bodies(); ++b)
                sum += state_.potential_energy(b, state_.particles.position[at_of(b)]);
            return sum;
        };
        const Real before = potential();
        state_.scene.gravity = gravity;
        state_.accounts.sum.fed_potential += potential() - before;
    }

private:
    static std::size_t at_of(Index i) noexcept { return static_cast<std::size_t>(i); }

    Scene empty_scene() const {
        Scene scene;
        scene.bounds = state_.scene.bounds, scene.periodic_along = state_.scene.periodic_along;
        return scene;
    }
    Index body_of(Index id) const {
        const auto& ids = state_.particles.id;
        for (Index b = 0; b < state_.particles.bodies(); ++b)
            if (ids[at_of(b)] == id && std::find(state_.events.removed.begin(), state_.events.removed.end(),
                                                 b) == state_.events.removed.end())
                return b;
        fail({"Simulation: id", "of a body that is there", "", "Particles::id has them"}, std::to_string(id));
    }
    void refuse_concrete(Index body, const std::string& call) const {
        require(state_.particles.site[at_of(body)] < 0,
                {"Simulation." + call + ": id", "of a stone", "", "concrete goes by wear and by breaking"},
                state_.particles.id[at_of(body)]);
    }
    const Scene::Stone& stone_of(Index id) const {
        for (std::size_t n = 0; n < state_.stone_id.size(); ++n)
            if (state_.stone_id[n] == id) return state_.scene.stones[n];
        fail({"Simulation: id", "of a stone of the scene or one that was added", "",
              "those that a feed brought cannot be held"},
             std::to_string(id));
    }
    void set_mobility(Index body, Real inverse_mass, const Vec3& inverse_inertia) {
        Particles& p = state_.particles;
        p.inverse_mass[at_of(body)] = inverse_mass, p.inverse_inertia[at_of(body)] = inverse_inertia;
        if (p.first_sphere[at_of(body)] >= state_.store.spheres()) return;  // it has just come
        const bool held = inverse_mass == 0;
        if (const Index c = state_.store.clump_of(body); c >= 0) {
            MovingClump& clump = state_.store.clumps[at_of(c)];
            clump.inverse_mass = inverse_mass, clump.inverse_inertia = inverse_inertia;
            if (held) clump.velocity.setZero(), clump.angular_momentum.setZero();
        }
        const Index first = state_.first_slot_of(body);
        for (Index slot = first; slot < first + p.sphere_count[at_of(body)]; ++slot) {
            SphereMotion& motion = state_.store.lines.motion[at_of(slot)];
            motion.inverse_mass = inverse_mass;
            if (held) motion.velocity.setZero(), motion.surface_velocity.setZero();
        }
    }

    State<P>& state_;
    bool acts_;
};

}  // namespace abrade
