// expect: Params\{\.\.\.\} alone tells a wrong name
// A parameter that no law has.
#include <abrade/dem/laws/linear_spring.hpp>

const abrade::LinearSpring law{{.stifness = 1e5}};
