// Stones in water on a grid that does not feel them: drag and buoyancy, and what unsteady water does beside.
#include "stones_in_water.hpp"

#include <abrade/coupling/drag/drag.hpp>

using namespace same_bits;

namespace {

template <class Drag>
Numbers run(const Drag& drag) {
    return fall_in(GridFluid<3>(stone_tank<FreeSurface>()), stones_above_floor(8), 0.3, drag)
        .with({"drag_input", "buoyancy_work"});
}

const Register drag{"stones.one_way_volume", [] { return run(CliftGauvin{}); }};
const Register inertia{"stones.one_way_inertia", [] { return run(WithInertia<>{}).with({"flow_work"}); }};

}  // namespace
