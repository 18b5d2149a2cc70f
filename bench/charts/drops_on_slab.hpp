#pragma once
// Single stones that fall straight on a slab: the share of its energy that a stone loses in contacts, for
// each level of concrete. The results are kept in a table, so that an interrupted chart goes on where it was.

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/sim/simulation.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace abrade::charts {

/// How the ground responds to a stone.
struct Ground {
    std::string title;
    ConcreteLevel level = ConcreteLevel::quasi_static;
    Real bond_over_contact = 1;  ///< stiffness [-]
    bool dashpot = false;        ///< LinearSpring; else LinearHysteretic
    bool plane = false;          ///< a flat wall instead of a slab
};

/// A stone that falls without spin and without gravity. Contacts are frictionless.
struct Drop {
    static constexpr Real restitution = 0.6;

    Ground ground;
    Real sphere_diameter = 0.02;  ///< of the slab [m]
    Real stone = 0.05;            ///< [m]
    Real speed = 1;               ///< [m/s]
    StoneShape shape = StoneShape::sphere;

    std::string label() const {
        return std::string(stone_shape_names[static_cast<std::size_t>(shape)]) + " of " + to_text(stone) +
               " m, " + to_text(speed) + " m/s, " + ground.title +
               (ground.plane ? "" : ", spheres of " + to_text(sphere_diameter) + " m");
    }
    /// Stiffness of contacts [N/m]: at 4 m/s a stone overlaps a sphere of 0.01 m by 15 % of its radius at
    /// most.
    Real stiffness() const {
        const Real mass = 2650 * pi / 6 * cube(stone), deepest = 0.15 * 0.005;
        return std::max(2e7, mass * square(4 / deepest));
    }
    /// The places of poses fill one cell of the slab evenly (golden ratio of two dimensions). An angular
    /// stone is turned at random, by the same rotation on each ground.
    BodyState pose(int number) const {
        const Real a = 0.7548776662466927 * number, b = 0.5698402909980532 * number;
        std::mt19937 random(static_cast<std::uint32_t>(number));
        std::normal_distribution<Real> normal;
        Quaternion turned = Quaternion::Identity();
        if (shape != StoneShape::sphere) {
            for (Real& part : turned.coeffs()) part = normal(random);
            turned.normalize();
        }
        return {.position = {(a - std::floor(a) - 0.5) * sphere_diameter,
                             (b - std::floor(b) - 0.5) * sphere_diameter, 0},
                .velocity = {0, 0, -speed},
                .orientation = turned};
    }
};

/// The share of its energy that the stone loses in contacts.
inline Real share_lost(const Drop& drop, int pose) {
    const Ground& ground = drop.ground;
    const Clump clump = make_stone(drop.shape, drop.stone);
    BodyState state = drop.pose(pose);
    Real lowest = 0;
    for (const Sphere& member : clump.members)
        lowest = std::min(lowest, (state.orientation * member.centre).z() - member.radius);
    constexpr Real gap = 1e-4;
    state.position.z() = gap - lowest;

    Scene scene;
    scene.gravity.setZero();
    scene.add_stone(clump, state);
    if (ground.plane) {
        scene.add_wall(Vec3::Zero(), Vec3::UnitZ());
    } else {
        const Real side = std::max(6 * drop.sphere_diameter, 0.12);
        scene.concrete = ConcreteBlock{
            .lattice = flat_lattice(side, side, {.sphere_diameter = drop.sphere_diameter, .layers = 3}),
            .level = ground.level};
    }
    const Real mass = scene.stones.front().density * clump.volume;
    const auto lost = [&](auto sim) {
        // A stone may sit in a hollow and touch several spheres one after the other; an angular one turns and
        // strikes with another corner. Out of reach, it is done.
        const Real way = drop.shape == StoneShape::sphere ? 0.3 * drop.sphere_diameter : 0.6 * drop.stone;
        const auto is_out_of_reach = [&] {
            const Particles& p = sim.particles();
            std::size_t stone = 0;
            while (p.kind[stone] != Kind::stone) ++stone;
            return p.velocity[stone].z() > 0 && p.position[stone].z() > clump.bounding_radius;
        };
        const Real contact_time = pi * std::sqrt(mass / drop.stiffness());
        sim.run({.end_time = (gap + way) / drop.speed + 10 * contact_time,
                 .safety = ground.level == ConcreteLevel::dynamic ? 0.8 : 0.1,  // dynamic: that of the bonds
                 .stop = is_out_of_reach});
        return sim.ledger().lost_normal / (0.5 * mass * square(drop.speed));
    };
    const auto with = [&](const auto& contact) {
        return lost(simulate(scene).contact(contact).bond(
            MohrCoulomb{{.tensile = 1e12, .stiffness = ground.bond_over_contact * drop.stiffness()}}));
    };
    if (ground.dashpot)
        return with(LinearSpring{{.stiffness = drop.stiffness(), .restitution = Drop::restitution}});
    return with(LinearHysteretic{{.stiffness = drop.stiffness(), .restitution = Drop::restitution}});
}

/// Shares lost of drops, one per pose.
class DropRuns {
public:
    /// Reads what is there already.
    explicit DropRuns(std::filesystem::path table) : table_(std::move(table)) {
        std::ifstream file(table_);
        std::string line, label, cell;
        while (std::getline(file, line)) {
            std::istringstream text(line);
            std::getline(text, label, ';');
            std::vector<Real>& shares = runs_[label];
            shares.clear();
            while (std::getline(text, cell, ';')) shares.push_back(std::stod(cell));
        }
    }

    /// Of poses 0 to `poses` - 1; runs those that are not there yet.
    std::vector<Real> shares(const Drop& drop, int poses) {
        const auto wanted = static_cast<std::size_t>(poses);
        std::vector<Real>& done = runs_[drop.label()];
        if (done.size() < wanted) {
            const std::clock_t start = std::clock();
            while (done.size() < wanted) done.push_back(share_lost(drop, static_cast<int>(done.size())));
            seconds_[drop.ground.title] += static_cast<Real>(std::clock() - start) / CLOCKS_PER_SEC;
            std::ofstream file(table_, std::ios::app);
            file << drop.label();
            for (const Real share : done) file << ';' << to_text(share);
            file << '\n';
        }
        return {done.begin(), done.begin() + poses};
    }

    /// Time of one core that was spent since the start, by ground [s].
    const std::map<std::string, Real>& seconds() const { return seconds_; }

private:
    std::filesystem::path table_;
    std::map<std::string, std::vector<Real>> runs_;
    std::map<std::string, Real> seconds_;
};

}  // namespace abrade::charts
