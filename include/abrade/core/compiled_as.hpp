#pragma once
// A program and the compiled library that it links must lay out packs alike.

#include <abrade/core/simd.hpp>

namespace abrade::detail {

/// Where linking misses `CompiledAs<lanes>::same`, abrade::compiled was compiled for another processor than
/// the program: give both the same -march.
template <int Lanes>
struct CompiledAs {
    static int same();
};

#ifdef ABRADE_COMPILED
inline const int compiled_as_the_library = CompiledAs<pack_lanes>::same();
#endif

}  // namespace abrade::detail
