// expect: stable_step
// A fluid that changes in time but does not say in which steps.
#include <abrade/sim/simulation.hpp>

struct Rising : abrade::NoFluid {
    using abrade::NoFluid::NoFluid;
    void advance(abrade::Real);
    abrade::Real time() const noexcept;
};

int main() {
    abrade::simulate({})
        .contact(abrade::LinearSpring{{.stiffness = 1e6}})
        .fluid(Rising{{}})
        .run({.end_time = 1});
}
