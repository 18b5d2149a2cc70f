// expect: sample
// A fluid that is sampled with the wrong arguments: without the time.
#include <abrade/sim/simulation.hpp>

struct Frozen {
    static constexpr std::string_view name = "Frozen";
    using Params = abrade::NoParams;
    explicit Frozen(Params) {}
    const Params& params() const noexcept;
    abrade::FluidSample sample(const abrade::Vec3&) const noexcept;
};

int main() {
    abrade::simulate({})
        .contact(abrade::LinearSpring{{.stiffness = 1e6}})
        .fluid(Frozen{{}})
        .run({.end_time = 1});
}
