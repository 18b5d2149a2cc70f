#pragma once
// What solids that move in water cover of a grid, cell by cell and face by face.

#include <abrade/fluid/mesh/grid.hpp>

namespace abrade {

/// What a solid covers of a cell.
struct SolidPart {
    Offset cell = 0;
    Real volume = 0;  ///< [m3]
};

/// Solid that goes through a face.
struct SolidFlux {
    Offset face = 0;
    int axis = 0;
    Real speed = 0;  ///< of the solid, times its share of what walls leave open [m/s]
};

/// Solid in the control volume of a face, or that went through it along the axis.
struct SolidVolume {
    Offset face = 0;
    int axis = 0;
    Real volume = 0;  ///< [m3]
};

}  // namespace abrade
