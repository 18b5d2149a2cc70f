#pragma once
// Which cells are water, and the faces at which its pressure is known.

#include <abrade/fluid/mesh/boundary_conditions.hpp>
#include <abrade/fluid/mesh/volume_tolerance.hpp>
#include <abrade/fluid/mesh/wet_rows.hpp>

#include <cstdint>
#include <span>

namespace abrade {

/// A face at which the pressure is known: between water and air, or where water leaves the box.
struct OpenFace {
    Offset face = 0;  ///< of the velocity component
    Offset cell = 0;  ///< the wet cell beside it
    int axis = 0;
    Real slope =
        0;  ///< 1 / distance from the cell's centre to the known pressure; negative if that lies above [1/m]
    Real plain =
        0;  ///< 1 / distance to the next centre, of the same sign [1/m]; 0: the old pressure has no part
    Real weight =
        1;  ///< share of what moves through the face that lies below the surface, and has weight [-]
};

/// A face of the velocity component along an axis.
struct WaterFace {
    Offset face = 0;
    int axis = 0;
};

/// Water that is put into a cell, or taken out (below 0).
struct CellSource {
    Offset cell = 0;
    Real rate = 0;    ///< of the cell's open volume [1/s]
    Real volume = 0;  ///< in the last step [m3]
};

/// What a step of the liquid did.
struct VolumeStep {
    Real courant = 0;        ///< largest share of a cell at the surface that left it in the step [-]
    Real redistributed = 0;  ///< volume that found no room where it flowed and was given to neighbours [m3]
    int not_redistributed = 0;  ///< cells whose neighbours could not take it: it is `volume_defect`
};

/// Cells that take part in a projection and what lies between them.
template <int Dim>
struct WaterCells {
    const Field<std::uint8_t>& wet;  ///< 1 where the pressure is unknown, ghosts included
    const WetRows<Dim>& rows;        ///< hold them, and those of the last time
    std::span<const OpenFace> open{};
    const Field<Real>* open_fraction = nullptr;  ///< share of each cell that walls leave open [-]; none: all
    const FaceField<Dim>* aperture = nullptr;    ///< share of each face that walls leave open [-]; none: all
};

}  // namespace abrade
