#pragma once
// A program and the compiled library that it links must lay out packs and vectors alike.

#include <abrade/core/simd.hpp>
#include <abrade/core/types.hpp>

/// Before a function that is no template: `inline`, unless abrade::compiled (src/functions.cpp) holds its
/// body. Its header takes in the body where a program does without that library.
#ifdef ABRADE_COMPILED
#define ABRADE_INLINE
#else
#define ABRADE_INLINE inline
#endif

namespace abrade::detail {

/// Where linking misses `CompiledAs<lanes, alignment>::same`, abrade::compiled was compiled for another
/// processor than the program: give both the same -march.
template <int Lanes, int Alignment>
struct CompiledAs {
    static int same();
};

#ifdef ABRADE_COMPILED
inline const int compiled_as_the_library = CompiledAs<pack_lanes, EIGEN_MAX_STATIC_ALIGN_BYTES>::same();
#endif

}  // namespace abrade::detail
