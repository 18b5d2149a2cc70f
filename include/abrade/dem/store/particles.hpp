#pragma once
// The columns of rigid bodies and of the spheres that they are made of.

#include <abrade/core/fields.hpp>
#include <abrade/core/require.hpp>
#include <abrade/geometry/sphere_union.hpp>

#include <vector>

namespace abrade {

/// What a body is. Loose concrete is a `grain`: it moves like a stone and still wears.
enum class Kind : std::uint8_t { stone, concrete, grain, fixed };

/// How a body enters the simulation.
struct BodyState {
    Vec3 position = Vec3::Zero();                     ///< of the centroid [m]
    Vec3 velocity = Vec3::Zero();                     ///< [m/s]
    Quaternion orientation = Quaternion::Identity();  ///< principal frame to world
    Vec3 angular_velocity = Vec3::Zero();             ///< world frame [rad/s]
    Index material = 0;                               ///< number in a table of laws (MaterialPairs)
};

/// Columns over bodies and over their member spheres. Member spheres of a body stand next to each other.
/// In a simulation they are as of the last observation; `velocity` and `angular_momentum` belong to the same
/// time as `position`.
struct Particles {
    // [body]
    std::vector<Vec3> position;           ///< [m]
    std::vector<Vec3> velocity;           ///< [m/s]
    std::vector<Quaternion> orientation;  ///< principal frame to world, unit length
    std::vector<Vec3> angular_momentum;   ///< world frame [kg m2/s]
    std::vector<Vec3> force, torque;      ///< everything that acts, at `position` [N], [N m]
    std::vector<Real> mass;               ///< [kg]
    std::vector<Real> inverse_mass;       ///< 0 for fixed bodies [1/kg]
    std::vector<Vec3> inverse_inertia;    ///< about the principal axes, 0 for fixed bodies [1/(kg m2)]
    std::vector<Real> volume;             ///< solid [m3]
    std::vector<Kind> kind;
    std::vector<Index> id;        ///< given once, never reused
    std::vector<Index> site;      ///< lattice site of the concrete that the body is, -1 for a stone
    std::vector<Index> material;  ///< as in BodyState
    std::vector<Index> first_sphere, sphere_count;

    // [sphere]
    std::vector<Index> body;
    std::vector<Vec3> offset;  ///< from the body's centroid, principal frame [m]
    std::vector<Real> radius;  ///< [m]
    std::vector<Vec3> centre;  ///< world frame [m]

    Index next_id = 0;

    Index bodies() const noexcept { return static_cast<Index>(position.size()); }
    Index spheres() const noexcept { return static_cast<Index>(body.size()); }

    bool isotropic(Index b) const noexcept {
        const Vec3& i = inverse_inertia[static_cast<std::size_t>(b)];
        return i.x() == i.y() && i.y() == i.z();
    }

    /// Angular velocity in the world frame that goes with an angular momentum at the present orientation.
    Vec3 angular_velocity(Index b, const Vec3& momentum) const noexcept {
        const auto i = static_cast<std::size_t>(b);
        if (isotropic(b)) return inverse_inertia[i].x() * momentum;
        const Vec3 in_body = orientation[i].conjugate() * momentum;
        return orientation[i] * Vec3(inverse_inertia[i].cwiseProduct(in_body));
    }
    Vec3 angular_velocity(Index b) const noexcept {
        return angular_velocity(b, angular_momentum[static_cast<std::size_t>(b)]);
    }

    /// Translation and rotation [J].
    Real kinetic_energy(Index b) const noexcept {
        const auto i = static_cast<std::size_t>(b);
        if (inverse_mass[i] == 0) return 0;
        return 0.5 * mass[i] * velocity[i].squaredNorm() + 0.5 * angular_momentum[i].dot(angular_velocity(b));
    }

    /// Adds a body and returns its index. A clump without spheres or volume, a density [kg/m3] of 0 or less,
    /// or a state that is not finite throws InputError.
    Index add(const Clump& clump, Real density, const BodyState& state, Kind body_kind) {
        require(!clump.members.empty() && clump.volume > 0,
                {"Clump.volume", "> 0, of at least one sphere", "m3", "make clumps with make_clump()"},
                clump.volume);
        require(clump.principal_moments.minCoeff() > 0,
                {"Clump.principal_moments", "> 0", "m5", "make clumps with make_clump()"},
                clump.principal_moments.minCoeff());
        require_positive(density, "Particles.add.density", "kg/m3", "stone has 2500 to 2800");
        require(std::abs(state.orientation.norm() - 1) < 1e-6,
                {"BodyState.orientation", "a unit quaternion", "", "normalise it"}, state.orientation.norm());
        require_finite(state.position, "BodyState.position", "m");
        require_finite(state.velocity, "BodyState.velocity", "m/s");
        require_finite(state.angular_velocity, "BodyState.angular_velocity", "rad/s");
        const Index b = bodies();
        const Real m = density * clump.volume;
        const bool held = body_kind == Kind::fixed;
        const Vec3 inertia = density * clump.principal_moments;
        position.push_back(state.position);
        velocity.push_back(held ? Vec3(Vec3::Zero()) : state.velocity);
        orientation.push_back(state.orientation.normalized());
        force.push_back(Vec3::Zero());
        torque.push_back(Vec3::Zero());
        mass.push_back(m);
        inverse_mass.push_back(held ? 0 : 1 / m);
        inverse_inertia.push_back(held ? Vec3(Vec3::Zero()) : Vec3(inertia.cwiseInverse()));
        angular_momentum.push_back(held ? Vec3(Vec3::Zero())
                                        : momentum_of(b, inertia, state.angular_velocity));
        volume.push_back(clump.volume);
        kind.push_back(body_kind);
        id.push_back(next_id++);
        site.push_back(-1);
        material.push_back(state.material);
        first_sphere.push_back(spheres());
        sphere_count.push_back(static_cast<Index>(clump.members.size()));
        for (const Sphere& member : clump.members) {
            body.push_back(b);
            offset.push_back(member.centre);
            radius.push_back(member.radius);
            centre.push_back(state.position + orientation.back() * member.centre);
        }
        return b;
    }

    /// Takes out the bodies marked in `gone` [body]; the order of the rest stays. Returns where each old
    /// sphere is now, -1 if gone.
    std::vector<Index> remove(const std::vector<char>& gone) {
        std::vector<Index> moved(static_cast<std::size_t>(spheres()), -1);
        std::size_t to = 0, sphere_to = 0;
        for (std::size_t from = 0; from < position.size(); ++from) {
            if (gone[from]) continue;
            const auto first = static_cast<std::size_t>(first_sphere[from]);
            for_each_body_column([&](auto& column) { column[to] = column[from]; });
            first_sphere[to] = static_cast<Index>(sphere_to);
            for (std::size_t s = first; s < first + static_cast<std::size_t>(sphere_count[to]);
                 ++s, ++sphere_to) {
                for_each_sphere_column([&](auto& column) { column[sphere_to] = column[s]; });
                body[sphere_to] = static_cast<Index>(to);
                moved[s] = static_cast<Index>(sphere_to);
            }
            ++to;
        }
        for_each_body_column([&](auto& column) { column.resize(to); });
        for_each_sphere_column([&](auto& column) { column.resize(sphere_to); });
        return moved;
    }

    static void fields(auto&& field) {
        field("position", "m", &Particles::position), field("velocity", "m/s", &Particles::velocity),
            field("orientation", &Particles::orientation),
            field("angular_momentum", "kg m2/s", &Particles::angular_momentum),
            field("force", "N", &Particles::force), field("torque", "N m", &Particles::torque),
            field("mass", "kg", &Particles::mass), field("inverse_mass", "1/kg", &Particles::inverse_mass),
            field("inverse_inertia", "1/(kg m2)", &Particles::inverse_inertia),
            field("volume", "m3", &Particles::volume), field("kind", &Particles::kind),
            field("id", &Particles::id), field("site", &Particles::site),
            field("material", &Particles::material), field("first_sphere", &Particles::first_sphere),
            field("sphere_count", &Particles::sphere_count), field("body", &Particles::body),
            field("offset", "m", &Particles::offset), field("radius", "m", &Particles::radius),
            field("centre", "m", &Particles::centre), field("next_id", &Particles::next_id);
    }

private:
    /// Angular momentum of an angular velocity, both in the world frame. Where all axes are alike, nothing is
    /// turned into the principal frame and back: a sphere must not feel how it is oriented, in no digit.
    Vec3 momentum_of(Index b, const Vec3& inertia, const Vec3& spin) const noexcept {
        if (isotropic(b)) return inertia.x() * spin;
        const Quaternion& turned = orientation[static_cast<std::size_t>(b)];
        return turned * Vec3(inertia.cwiseProduct(Vec3(turned.conjugate() * spin)));
    }

    void for_each_body_column(auto&& f) {
        f(position), f(velocity), f(orientation), f(angular_momentum), f(force), f(torque), f(mass),
            f(inverse_mass);
        f(inverse_inertia), f(volume), f(kind), f(id), f(site), f(material), f(first_sphere), f(sphere_count);
    }
    void for_each_sphere_column(auto&& f) { f(body), f(offset), f(radius), f(centre); }
};

/// Takes the rows of the bodies marked in `gone` [body] out of a column that stands beside Particles.
void remove_rows(auto& column, const std::vector<char>& gone) {
    std::size_t to = 0;
    for (std::size_t from = 0; from < column.size(); ++from)
        if (!gone[from]) column[to++] = column[from];
    column.resize(to);
}

}  // namespace abrade
