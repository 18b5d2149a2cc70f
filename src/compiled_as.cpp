// What a program asks of abrade::compiled as it is linked.

#include <abrade/core/compiled_as.hpp>

namespace abrade::detail {

template <int Lanes, int Alignment>
int CompiledAs<Lanes, Alignment>::same() {
    return Lanes;
}
template struct CompiledAs<pack_lanes, EIGEN_MAX_STATIC_ALIGN_BYTES>;

}  // namespace abrade::detail
