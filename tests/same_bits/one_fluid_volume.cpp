// The same in a volume of fluid.
#include "stones_in_water.hpp"

#include <abrade/coupling/exchange/one_fluid.hpp>

using namespace same_bits;

namespace {

template <class Solids>
Numbers run() {
    return fall_in(GridFluid<3, Among<Solids>>(stone_tank<FreeSurface>()),
                   stones_above_floor(0), 0.2)
        .with({"flow_work"});
}

const Register mixture{"stones.volume_mixture", run<MixtureSolids>};

}  // namespace
