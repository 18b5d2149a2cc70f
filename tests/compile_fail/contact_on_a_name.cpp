// expect: fill the slots in one go
// A slot of a simulation that has a name.
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/sim/simulation.hpp>

int main() {
    auto sim = abrade::simulate({});
    sim.contact(abrade::LinearSpring{{.stiffness = 1e5}}).run({.end_time = 1});
}
