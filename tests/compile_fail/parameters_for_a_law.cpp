// expect: these are a law's parameters
// Parameters of a law instead of the law.
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/sim/simulation.hpp>

int main() {
    abrade::simulate({}).contact(abrade::LinearSpring::Params{.stiffness = 1e5}).run({.end_time = 1});
}
