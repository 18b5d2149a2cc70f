#pragma once
// Where the surface of a VolumeOfFluid is on the way from one cell's centre to the next.

#include <abrade/fluid/vof/surface_reconstruction.hpp>

#include <algorithm>
#include <cmath>

namespace abrade::detail {

/// What planes and fractions tell of the surface; see VolumeOfFluid for what it answers.
template <int Dim>
class SurfacePosition {
    static constexpr int vertical = Grid<Dim>::vertical;
    /// Without a pressure of its own a cell that holds more than this takes in more than it has room for [-].
    static constexpr Real nearly_full = 0.9;

public:
    SurfacePosition(const LiquidCells<Dim>& liquid, const SurfaceReconstruction<Dim>& surface) noexcept
        : liquid_(liquid), surface_(surface) {}

    bool is_liquid(Offset cell) const noexcept {
        const Real f = liquid_.fraction[cell];
        if (!is_reconstructed(cell) || f < volume_tolerance::film || f > nearly_full) return f >= 0.5;
        return position(cell) >= 0;
    }
    bool is_wall_dry(Offset dry) const noexcept {
        return is_reconstructed(dry) && liquid_.fraction[dry] < volume_tolerance::film && position(dry) >= 0;
    }
    Real share(Offset liquid, Index level, int axis, int side, Real least) const noexcept;

private:
    /// A cell's plane, seen along an axis; not known where there is none, or a trace of air or of water.
    struct Sight {
        bool known = false, nearly_level = false;  ///< level: along the axis
        Real depth = 0;                            ///< of the centre below the plane, along its normal [m]
        Real slope = 0;                            ///< component of the unit normal
    };
    Sight sight_of(Offset cell, Index level, int axis) const noexcept;

    Real position(Offset cell) const noexcept {
        return surface_.planes().position[static_cast<std::size_t>(surface_.plane_of(cell))];
    }
    bool is_reconstructed(Offset cell) const noexcept {
        const Index i = surface_.plane_of(cell);
        return i >= 0 && surface_.planes().reconstructed[static_cast<std::size_t>(i)] != 0;
    }
    /// A trace of air or of water tells nothing of where the surface is, but in a cell that a wall cuts.
    bool tells(Offset cell) const noexcept {
        const Real f = liquid_.fraction[cell];
        return surface_.plane_of(cell) >= 0 &&
               (is_reconstructed(cell) || (f > surface_.smallest_void() && f < surface_.full()));
    }

    const LiquidCells<Dim>& liquid_;
    const SurfaceReconstruction<Dim>& surface_;
};

template <int Dim>
typename SurfacePosition<Dim>::Sight SurfacePosition<Dim>::sight_of(Offset cell, Index level,
                                                                    int axis) const noexcept {
    if (!tells(cell)) return {};
    const SurfacePlanes<Dim>& planes = surface_.planes();
    const auto k = static_cast<std::size_t>(surface_.plane_of(cell));
    const auto slope = [&](int a) {
        return planes.normal[static_cast<std::size_t>(a)][k] / liquid_.sizes.edge(a, level);
    };
    Real squares = 0;
    for (int a = 0; a < Dim; ++a) squares += square(slope(a));
    const Real per_length = 1 / std::sqrt(squares), along = slope(axis) * per_length;
    return {true, square(along) < 0.1, planes.position[k] * per_length, along};
}

template <int Dim>
Real SurfacePosition<Dim>::share(Offset liquid, Index level, int axis, int side, Real least) const noexcept {
    const CellSizes<Dim>& sizes = liquid_.sizes;
    const Offset air = liquid + side * liquid_.layout.stride[axis];
    const bool along_vertical = axis == vertical;
    const Index air_level = along_vertical ? level + side : level;
    const Real edge = sizes.edge(axis, level);
    const Real gap = along_vertical ? sizes.gap(std::max(level, air_level)) : edge;
    const Real face = 0.5 * edge / gap, shallow = least * sizes.edge(vertical, level);
    Sight own = sight_of(liquid, level, axis), other = sight_of(air, air_level, axis);
    if (std::abs(own.depth) < shallow) own.depth = shallow;
    // Along a surface that is nearly level a crossing may lie anywhere; the pressure of a column's height
    // falls by the difference of both: the share is that of the distances of both centres from their
    // planes.
    if (own.nearly_level && other.nearly_level && own.depth >= 0 && other.depth < 0)
        return own.depth / (own.depth - other.depth);
    // Beyond its own half a plane counts only where it is the only one, and then no farther than the
    // other centre.
    const auto crossing = [&](const Sight& of, Real from, Real per_gap) {
        const Real fall = of.slope * side;
        if (!of.known) return face;
        if (!(fall > 1e-9 * std::abs(of.depth) / per_gap)) return from == 0 ? Real(1) : Real(0);
        return from + of.depth / fall * per_gap;
    };
    const Real near = crossing(own, 0, 1 / gap), far = crossing(other, 1, 1 / gap);
    Real share = face;
    if (own.known && (!other.known || near <= face))
        share = near;
    else if (other.known && (!own.known || far >= face))
        share = far;
    else if (own.known)
        share = 0.5 * (near + far);
    return std::clamp(share, least, Real(1));
}

}  // namespace abrade::detail
