#pragma once
// What is known of faces that bodies cover, column by column.

#include <abrade/coupling/mapping/rigid_six.hpp>

#include <cstdint>
#include <vector>

namespace abrade {

/// Numbers of rows that follow each other, for range-based loops.
struct FaceRows {
    struct Iterator {
        std::size_t row;
        std::size_t operator*() const noexcept { return row; }
        Iterator& operator++() noexcept { return ++row, *this; }
        bool operator==(const Iterator&) const = default;
    };
    std::size_t first = 0, last = 0;
    Iterator begin() const noexcept { return {first}; }
    Iterator end() const noexcept { return {last}; }
};

/// A row is a face and one of the bodies that cover some of it (SolidFace). There are many, and each part of
/// an exchange reads few of the columns. Rows of a cloud come first.
struct FaceColumns {
    using Reals = std::vector<Real>;
    using Flags = std::vector<std::uint8_t>;

    std::size_t cloud = 0;            ///< how many rows are its
    std::vector<Offset> face, low;    ///< of the velocity component; cell below it
    std::vector<std::uint8_t> axis;   ///< that the face lies across
    std::vector<std::int32_t> plane;  ///< of the face
    std::vector<std::uint32_t> body;  ///< number of it; the cloud comes last
    std::vector<Vec3> arm;            ///< from the body's centroid to the face's centre; none of a cloud [m]
    Reals share;                      ///< sigma, of the control volume [-]
    Reals core;                       ///< share of a body whose surface is retracted [-]
    Reals friction;                   ///< rate of friction over C nu [1/m2]
    Reals volume;                     ///< of the control volume [m3]
    Reals gap;                        ///< between the centres of the cells [m]

    Reals open;          ///< share of the face that walls leave open; 0: no water passes [-]
    Reals water;         ///< share that bodies leave to the water, too [-]
    Reals covered;       ///< by the one body, of what is open; with all of them just what is no water [-]
    Reals part;          ///< of the one body in what all cover [-]
    Reals all_friction;  ///< of all bodies here; none of a cloud [1/m2]
    Reals lighter;       ///< the water's density over the face's, where `weigh` asks for it [-]
    Reals heavier;       ///< what the body adds to the face's density, over this [-]
    Reals per_gap;       ///< 1 over the distance of the pressures to both sides [1/m]
    Reals weight;        ///< share of the face's inertia that is below the surface [-]
    Flags high_wet, low_wet;            ///< cells to both sides: dry ones have no pressure
    Flags conducts;                     ///< whether a pressure's gradient pushes what is in it
    std::vector<std::uint32_t> detour;  ///< 1 + number in `detours`; 0: none
    Flags leaves;  ///< at a side where water leaves: only what is added to a pressure pushes there
    std::vector<std::uint32_t> surface;  ///< number of the face among those at the surface, if it is there

    Reals mass;      ///< of the control volume, as far as walls leave it open and it is wet [kg]
    Reals velocity;  ///< of the water, before a pressure acts [m/s]
    Reals solid;     ///< velocity that what covers it passes through with [m/s]
    Reals held;      ///< share of the way to `target` [m/s] that friction takes the water [-]
    Reals target;
    Reals taken;    ///< by friction in the first stage [m/s]
    Reals given;    ///< to the water beside friction [m/s]
    Reals unmixed;  ///< velocity before `mix` [m/s]

    /// Through a face that a body closes passes what it pushes into a pocket behind: as if it were faster by
    /// `of` times its velocity and spin.
    struct Detour {
        std::size_t row;
        detail::Six of;  ///< [-], [m]
    };
    std::vector<Detour> detours;

    // Of a cloud's rows:
    Reals mobility;       ///< what a gradient moves the cloud by, over water [-]
    Reals last_gradient;  ///< of the pressure that it has felt already [m/s2]
    Reals rate;           ///< of friction [1/s]

    std::size_t count() const noexcept { return face.size(); }
    void resize(std::size_t count, std::size_t of_cloud) {
        cloud = of_cloud, detours.clear();
        const auto all = [count](auto&... columns) { (columns.resize(count), ...); };
        all(face, low, axis, plane, body, arm, share, core, friction, volume, gap);
        all(open, water, covered, part, all_friction, lighter, heavier, per_gap, weight);
        all(high_wet, low_wet, conducts, leaves, surface, detour);
        all(mass, velocity, solid, held, target, taken, given, unmixed);
        for (Reals* column : {&mobility, &last_gradient, &rate}) column->resize(of_cloud);
    }
    void place(std::size_t i, const SolidFace& f, std::size_t by) noexcept {
        face[i] = f.face, low[i] = f.low, axis[i] = static_cast<std::uint8_t>(f.axis), plane[i] = f.plane;
        body[i] = static_cast<std::uint32_t>(by);
        share[i] = f.share, friction[i] = f.friction, volume[i] = f.volume(), gap[i] = f.gap;
        if (i >= cloud) arm[i] = f.arm, core[i] = f.core;
        given[i] = 0, detour[i] = 0;
    }

    /// What a face conducts per share of it that is open [m].
    Real conductance(std::size_t i) const noexcept { return volume[i] / square(gap[i]); }
    bool at_surface(std::size_t i) const noexcept { return high_wet[i] != low_wet[i]; }
    /// Between two cells with a pressure, as far as is known yet.
    void set_interior(std::size_t i) noexcept {
        high_wet[i] = low_wet[i] = 1, leaves[i] = 0, weight[i] = 1, per_gap[i] = 1 / gap[i];
    }
    /// From `open`, `water` and `part`: a closed face passes no water, not even what rounding leaves of it.
    void cover(std::size_t i) noexcept { covered[i] = open[i] > 0 ? part[i] * (1 - water[i] / open[i]) : 0; }
    /// Share of a gradient that moves what covers the face, where faces between two wet cells conduct it.
    Real yields(std::size_t i) const noexcept {
        return i >= cloud || at_surface(i) || leaves[i] ? 0 : mobility[i];
    }
    /// Of a pressure over density [m/s2].
    template <class Number>
    Real gradient(const Field<Number>& of, std::size_t i) const noexcept {
        const auto above = high_wet[i] ? static_cast<Real>(of[face[i]]) : 0;
        const auto below = low_wet[i] ? static_cast<Real>(of[low[i]]) : 0;
        return (above - below) * per_gap[i];
    }
    /// A field's value there.
    template <class Faces>
    decltype(auto) at(Faces& u, std::size_t i) const noexcept {
        return u[axis[i]][face[i]];
    }
    detail::Six coefficient(std::size_t i) const noexcept { return detail::coefficient(axis[i], arm[i]); }
    /// Of a body's velocity and spin.
    Real along(std::size_t i, const detail::Six& q) const noexcept {
        return detail::along(axis[i], arm[i], q);
    }
    /// Velocity with which it passes through the face, detours included [m/s].
    Real pushes(std::size_t i, const detail::Six& q) const noexcept {
        return along(i, q) + (detour[i] ? detours[detour[i] - 1].of.dot(q) : 0);
    }
};

}  // namespace abrade
