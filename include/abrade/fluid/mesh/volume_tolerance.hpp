#pragma once
// How little is nothing: the tolerances of volumes in cells.

#include <abrade/core/types.hpp>

/// Shares of a cell's volume [-]; less counts as none.
namespace abrade::volume_tolerance {

inline constexpr Real round_off = 1e-12;  ///< liquid or air of a cell: it goes to the cell's volume defect
inline constexpr Real mass = 1e-9;        ///< liquid of a control volume: no momentum
inline constexpr Real face = 1e-6;        ///< liquid about a face in the air: no velocity of its own
inline constexpr Real open = 1e-6;        ///< room that walls leave: none for liquid
inline constexpr Real film = 1e-5;        ///< liquid of a cell: no pressure of its own, no surface

}  // namespace abrade::volume_tolerance
