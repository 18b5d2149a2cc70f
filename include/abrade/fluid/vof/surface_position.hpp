#pragma once
// Where the surface of a VolumeOfFluid is on the way from one cell's centre to the next.

#include <abrade/fluid/vof/volume_of_fluid_class.hpp>

namespace abrade {

template <int Dim>
typename VolumeOfFluid<Dim>::Sight VolumeOfFluid<Dim>::sight_of(Offset cell, Index level,
                                                                int axis) const noexcept {
    if (!tells(cell)) return {};
    const auto k = static_cast<std::size_t>(plane_of_[cell]);
    const auto slope = [&](int a) { return planes_.normal[index(a)][k] / sizes_.edge(a, level); };
    Real squares = 0;
    for (int a = 0; a < Dim; ++a) squares += square(slope(a));
    const Real per_length = 1 / std::sqrt(squares), along = slope(axis) * per_length;
    return {true, square(along) < 0.1, planes_.position[k] * per_length, along};
}

template <int Dim>
Real VolumeOfFluid<Dim>::surface_share(Offset liquid, Index level, int axis, int side,
                                       Real least) const noexcept {
    const Offset air = liquid + side * layout_.stride[index(axis)];
    const bool along_vertical = axis == vertical;
    const Index air_level = along_vertical ? level + side : level;
    const Real edge = sizes_.edge(axis, level);
    const Real gap = along_vertical ? sizes_.gap(std::max(level, air_level)) : edge;
    const Real face = 0.5 * edge / gap, shallow = least * sizes_.edge(vertical, level);
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

}  // namespace abrade
