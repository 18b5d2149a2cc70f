// Stones and water as one fluid: with the density of the mixture, and with that of the water.
#include "stones_in_water.hpp"

#include <abrade/coupling/exchange/one_fluid.hpp>

using namespace same_bits;

namespace {

template <class Surface, class Solids>
Numbers run() {
    return fall_in(GridFluid<3, Among<Solids, Surface>>(stone_tank<Surface>()),
                   stones_above_floor(0), 0.2)
        .with({"flow_work"});
}

const Register mixture{"stones.height_mixture", run<HeightSurface, MixtureSolids>};
const Register direct{"stones.box_direct", run<FullBox, DirectForcing>};

}  // namespace
