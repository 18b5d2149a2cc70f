#pragma once
// What is there before time starts: stones, concrete, boundaries, supply.

#include <abrade/geometry/lattice.hpp>
#include <abrade/geometry/surfaces.hpp>
#include <abrade/sim/scene/feed.hpp>
#include <abrade/wear/concrete.hpp>

#include <functional>
#include <optional>
#include <vector>

namespace abrade {

/// What becomes of a piece of several spheres that comes loose: they go on one by one, held together by the
/// bonds that they still have, or as one rigid clump. A clump no longer breaks and is no concrete.
enum class Fragments { bonded, clumps };

/// How the spheres of concrete answer what presses on them. `dynamic`: they move on their bonds.
/// `quasi_static`: they stand, and are let go as grains where equilibrium says that bonds no longer hold
/// them. `rigid`: they stand whatever presses. What stands is no body until something that moves comes near.
enum class ConcreteLevel { dynamic, quasi_static, rigid };

/// A body of bonded spheres. Its deepest layer is held fixed, as if cast on rock.
struct ConcreteBlock {
    Lattice lattice{};
    Real density = 2400;  ///< of the spheres [kg/m3]
    FractureVolume fracture_volume = FractureVolume::cell;
    Index material = 0;                       ///< number in a table of laws (MaterialPairs)
    Fragments fragments = Fragments::bonded;  ///< of dynamic concrete; else pieces go on sphere by sphere
    ConcreteLevel level = ConcreteLevel::dynamic;
    Index cluster = 0;  ///< of quasi-static concrete: bonds about a loaded sphere within which all give way
    WornOut worn_out = WornOut::fines;
    Overflow overflow = FillCrater{};
};

/// A wall that moves as a function of time [s]. Called between steps, one call after the other.
struct MovingWall {
    Index wall = 0;  ///< number of the wall
    std::function<PlanePlace(Real)> place{};
    Plane start{};

    /// Throws InputError where that is no number.
    PlanePlace at(Real t) const {
        const PlanePlace found = place(t);
        if (found.displacement.allFinite() && found.rotation.allFinite()) return found;
        const std::string name =
            "Scene.moving_walls: wall " + std::to_string(wall) + " at t = " + short_text(t) + " s, ";
        require_finite(found.displacement, name + "displacement", "m");
        require_finite(found.rotation, name + "rotation", "rad");
        return found;
    }
};

/// The inputs of a simulation. Plain data: fill it in, hand it to `simulate`.
struct Scene {
    struct Stone {
        Clump clump{};
        Real density = 2650;  ///< [kg/m3]
        BodyState state{};
        bool fixed = false;  ///< never moves, whatever hits it
    };

    Vec3 gravity{0, 0, -standard_gravity};  ///< [m/s2]
    std::vector<Stone> stones;
    std::vector<Plane> walls;
    std::vector<MovingWall> moving_walls;
    std::optional<ConcreteBlock> concrete;
    std::optional<FeedParams> feed;
    Box bounds;                            ///< leaving it is an error, unless it is periodic
    std::array<bool, 3> periodic_along{};  ///< x, y, z: what is outside the bounds here comes in there
    /// Bodies that pass this x leave the simulation as lists are renewed, at most 400 steps later [m].
    std::optional<Real> outlet;
    std::optional<Real> flow_counter;  ///< stones (Kind::stone) that pass this x are counted, no grains [m]

    /// A single sphere; returns the scene so that calls can be chained.
    Scene& add_sphere(Real radius, const BodyState& state, Real density = 2650) {
        require_positive(radius, "Scene.stones[" + std::to_string(stones.size()) + "].radius", "m");
        return add_stone(make_clump("sphere", {{Vec3::Zero(), radius}}), state, density);
    }
    Scene& add_stone(Clump clump, const BodyState& state, Real density = 2650) {
        stones.push_back({std::move(clump), density, state});
        return *this;
    }
    /// A stone that never moves: of a rough bed, or an obstacle.
    Scene& add_fixed(Clump clump, const Vec3& position,
                     const Quaternion& orientation = Quaternion::Identity(), Index material = 0) {
        stones.push_back({.clump = std::move(clump),
                          .state = {.position = position, .orientation = orientation, .material = material},
                          .fixed = true});
        return *this;
    }
    /// A plane through `point`; bodies are on the side that the normal points to. Throws InputError for a
    /// normal that is not finite or 0.
    Scene& add_wall(const Vec3& point, const Vec3& normal, Index material = 0) {
        require(normal.norm() > 0 && normal.allFinite(),
                {"Scene.walls[" + std::to_string(walls.size()) + "].normal", "finite and longer than 0", "",
                 "{0, 0, 1} is a floor"},
                normal.norm());
        walls.push_back({point, normal.normalized(), material});
        return *this;
    }

    /// A wall that moves, and does work on what it touches (Ledger::wall_work): from `point` and `normal` at
    /// the start to what `place(t)` says, {.displacement [m], .rotation about `point` [rad]}. Where walls
    /// move nobody sleeps.
    Scene& add_moving_wall(const Vec3& point, const Vec3& normal, std::function<PlanePlace(Real)> place,
                           Index material = 0) {
        add_wall(point, normal, material);
        moving_walls.push_back({static_cast<Index>(walls.size()) - 1, std::move(place), walls.back()});
        return *this;
    }

    /// The periodic axes, with what they repeat.
    Periodic periodic() const {
        Periodic space;
        for (int a = 0; a < 3; ++a)
            if (periodic(a)) space.low[a] = bounds.low[a], space.period[a] = bounds.high[a] - bounds.low[a];
        return space;
    }

    /// The bounds that must not be left: those along periodic axes are none.
    Box open_bounds() const noexcept {
        Box space = bounds;
        for (int a = 0; a < 3; ++a)
            if (periodic(a)) space.low[a] = Box{}.low[a], space.high[a] = Box{}.high[a];
        return space;
    }

    /// Throws InputError for what cannot be simulated, by name.
    void validate() const {
        require_finite(gravity, "Scene.gravity", "m/s2");
        for (int a = 0; a < 3; ++a)
            require(bounds.low[a] < bounds.high[a],
                    {std::string("Scene.bounds along ") + "xyz"[a], "low < high, high - low", "m",
                     "swap them or widen the box"},
                    bounds.high[a] - bounds.low[a]);
        for (std::size_t n = 0; n < walls.size(); ++n)
            validate(walls[n], "Scene.walls[" + std::to_string(n) + "]");
        for (std::size_t n = 0; n < moving_walls.size(); ++n)
            require(moving_walls[n].place && moving_walls[n].wall >= 0 &&
                        moving_walls[n].wall < static_cast<Index>(walls.size()),
                    {"Scene.moving_walls[" + std::to_string(n) + "]", "a wall's number and a function", "",
                     "take add_moving_wall()"},
                    moving_walls[n].wall);
        for (std::size_t n = 0; n < stones.size(); ++n)
            validate(stones[n], "Scene.stones[" + std::to_string(n) + "]");
        for (int a = 0; a < 3; ++a) {
            const Real size = bounds.high[a] - bounds.low[a];
            require(!periodic(a) || std::isfinite(size),
                    {"Scene.bounds along a periodic axis", "finite", "m", "set both bounds of that axis"},
                    size);
        }
        for (const auto& [place, name] :
             {std::pair(outlet, "Scene.outlet"), std::pair(flow_counter, "Scene.flow_counter")})
            require(!place || std::isfinite(*place), {name, "finite", "m", "leave it out for none"},
                    place.value_or(0));
        if (concrete) {
            require_positive(concrete->density, "Scene.concrete.density", "kg/m3",
                             "concrete has 2200 to 2500");
            require(
                !concrete->lattice.sites.empty(),
                {"Scene.concrete.lattice", "of at least one sphere", "spheres", "make it by flat_lattice()"},
                0);
            concrete->lattice.validate("Scene.concrete.lattice");
            require(concrete->cluster >= 0 && concrete->cluster <= 4,
                    {"Scene.concrete.cluster", "from 0 to 4", "bonds",
                     "0 lets the loaded sphere alone give way; each bond more costs much"},
                    concrete->cluster);
            const Lattice& lattice = concrete->lattice;
            const Index wide = std::max(lattice.count_along, lattice.count_across);  // 1 where irregular
            const auto across = wide > 1 ? wide : static_cast<Index>(lattice.sites.size());
            require(concrete->cluster == 0 || 2 * concrete->cluster + 1 <= std::max(across, 3),
                    {"Scene.concrete.cluster: its spheres across",
                     "at most those of the block, " + std::to_string(across), "spheres",
                     "take a smaller cluster"},
                    2 * concrete->cluster + 1);
            require(concrete->level == ConcreteLevel::dynamic || concrete->fragments == Fragments::bonded,
                    {"Scene.concrete.fragments", "Fragments::bonded where concrete stands", "",
                     "clumps are for ConcreteLevel::dynamic"},
                    1);
            require(concrete->level != ConcreteLevel::dynamic || concrete->worn_out != WornOut::recedes,
                    {"Scene.concrete.worn_out", "not WornOut::recedes where concrete moves", "",
                     "take ConcreteLevel::quasi_static, or WornOut::fines"},
                    static_cast<Index>(concrete->worn_out));
            abrade::validate(concrete->overflow);
        }
        if (feed) feed->validate();
        for (int a = 0; a < 3; ++a) {
            if (!periodic(a)) continue;
            const auto require_inside = [&](Real low, Real high, const std::string& name) {
                require(low >= bounds.low[a] && high <= bounds.high[a],
                        {name + "." + "xyz"[a],
                         "inside Scene.bounds, from " + to_text(bounds.low[a]) + " to " +
                             to_text(bounds.high[a]) + ", along a periodic axis",
                         "m", "move it or widen the bounds"},
                        low < bounds.low[a] ? low : high);
            };
            if (feed) require_inside(feed->region.low[a], feed->region.high[a], "Feed.region");
            if (concrete)
                for (std::size_t n = 0; n < concrete->lattice.sites.size(); ++n) {
                    const Real x = concrete->lattice.sites[n].centre[a];
                    require_inside(x, x, "Scene.concrete.lattice.sites[" + std::to_string(n) + "].centre");
                }
        }
    }

private:
    bool periodic(int axis) const noexcept { return periodic_along[static_cast<std::size_t>(axis)]; }

    void validate(const Plane& wall, const std::string& name) const {
        wall.validate(name);
        for (int a = 0; a < 3; ++a)
            require(!periodic(a) || std::abs(wall.normal[a]) < 1e-9,
                    {name + ".normal." + "xyz"[a], "0, for space is periodic along that axis", "",
                     "turn the wall along the axis, or gravity instead of the wall"},
                    wall.normal[a]);
    }
    void validate(const Stone& stone, const std::string& name) const {
        const BodyState& state = stone.state;
        require_positive(stone.density, name + ".density", "kg/m3", "stone has 2500 to 2800");
        for (const auto& [speed, what, unit] :
             {std::tuple(state.velocity.norm(), ".velocity", "m/s"),
              std::tuple(state.angular_velocity.norm(), ".angular_velocity", "rad/s")})
            require(!stone.fixed || !(speed > 0),
                    {name + what, "0, for it is fixed", unit, "leave it out, or let the stone move"}, speed);
        require(!stone.clump.members.empty(),
                {name + ".clump", "of at least one sphere", "spheres", "make clumps with make_clump()"}, 0);
        for (std::size_t m = 0; m < stone.clump.members.size(); ++m) {
            const std::string member = name + ".clump.members[" + std::to_string(m) + "]";
            require_positive(stone.clump.members[m].radius, member + ".radius", "m");
            require_finite(stone.clump.members[m].centre, member + ".centre", "m");
        }
        require_positive(stone.clump.volume, name + ".clump.volume", "m3", "make clumps with make_clump()");
        require(stone.clump.principal_moments.minCoeff() > 0,
                {name + ".clump.principal_moments", "> 0", "m5", "make clumps with make_clump()"},
                stone.clump.principal_moments.minCoeff());
        const Real mass = stone.density * stone.clump.volume;
        require(mass >= 1e-30 && mass <= 1e30,  // beyond, products of what follows overflow
                {name + ": mass", "from 1e-30 to 1e+30 kg", "kg", "look at the units of density and radius"},
                mass);
        require_finite(state.position, name + ".position", "m");
        require_finite(state.velocity, name + ".velocity", "m/s");
        require_finite(state.angular_velocity, name + ".angular_velocity", "rad/s");
        require(std::abs(state.orientation.norm() - 1) < 1e-6,
                {name + ".orientation", "of length 1", "", "normalise it"}, state.orientation.norm());
        for (int a = 0; a < 3; ++a) {
            constexpr Real most_periods = 1e6;  // more leave too few digits for where in the period it is
            const Real beyond = periodic(a) ? most_periods * (bounds.high[a] - bounds.low[a]) : 0;
            if (state.position[a] >= bounds.low[a] - beyond && state.position[a] <= bounds.high[a] + beyond)
                continue;  // the text below would take longer than the rest for many stones
            fail({name + ".position." + "xyz"[a],
                  (periodic(a) ? "within a million periods of Scene.bounds, from "
                               : "inside Scene.bounds, from ") +
                      to_text(bounds.low[a]) + " to " + to_text(bounds.high[a]),
                  "m", "move the stone or widen the bounds"},
                 to_text(state.position[a]));
        }
    }
};

}  // namespace abrade
