// expect: a simulation needs a contact law
// The one slot that has no default.
#include <abrade/sim/simulation.hpp>

int main() { abrade::simulate({}).run({.end_time = 1}); }
