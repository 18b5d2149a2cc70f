#pragma once
// Bodies that the water's box cannot hold: too large for it, or gone through a side that lets nothing pass.

#include <abrade/fluid/flow_body.hpp>
#include <abrade/fluid/fluid_model.hpp>
#include <abrade/fluid/mesh/boundary_conditions.hpp>

#include <string>

namespace abrade::detail {

/// Throws FluidError where a body is as large as the box, and where a free body's centroid lies beyond a
/// closed side, of which its contacts know nothing. Above a surface there is air.
inline void refuse_lost(const Grid<3>& grid, const BoundaryConditions<3>& boundaries,
                        std::span<const FlowBody> bodies, bool has_surface) {
    Real box = 1;
    for (int a = 0; a < 3; ++a) box *= grid.high(a) - grid.low(a);
    for (const FlowBody& body : bodies) {
        if (!(body.volume < box))
            throw FluidError("the body with id " + std::to_string(body.id) + " has " +
                             short_text(body.volume) + " m3, no less than the " + short_text(box) +
                             " m3 of the water's box; make the box larger or the body smaller");
        for (int a = 0; a < 3 && body.inverse_mass > 0; ++a)
            for (const bool high : {false, true}) {
                const Real x = body.position[a], side = high ? grid.high(a) : grid.low(a);
                if (!is_closed(boundaries[a][high]) || !(high ? x > side : x < side) ||
                    (has_surface && high && a == 2))
                    continue;
                const std::string axis(1, Grid<3>::axis_name(a));
                throw FluidError(
                    "the body with id " + std::to_string(body.id) + " is beyond the closed side at " + axis +
                    " = " + short_text(side) + " m, at " + axis + " = " + short_text(x) +
                    " m; boundaries hold water, not bodies: give them a wall there (Scene::add_wall)");
            }
    }
}

}  // namespace abrade::detail
