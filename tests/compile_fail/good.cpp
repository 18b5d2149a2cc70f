// expect: compiles
// The control: were the include folders wrong, every other case here would fail for the wrong reason.
#include <abrade/core/require.hpp>

int main() { abrade::require_positive(1.0, "Good.value"); }
