// expect: respond|Memory
// A law in the wrong slot.
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

int main() { abrade::simulate({}).contact(abrade::SubParticleAbrasion{{}}).run({.end_time = 1}); }
