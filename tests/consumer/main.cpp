// A user's program. It warns in two of the ways that our own builds forbid: were our flags to leak, it would
// not compile.
#include <abrade/core/require.hpp>

#include <cstdio>
#ifdef CONSUMER_HAS_IO
#include <hdf5.h>
#endif

int narrowed(double value) {
    int unused;
    int result = value;
    return result;
}

int main() {
#ifdef CONSUMER_HAS_IO
    unsigned major = 0, minor = 0, release = 0;
    if (H5get_libversion(&major, &minor, &release) < 0) return 1;
#endif
    try {
        abrade::require_positive(-1.0, "Consumer.size", "m");
    } catch (const abrade::InputError& error) {
        std::printf("OK %d: %s\n", narrowed(1.5), error.what());
        return 0;
    }
    return 1;
}
