// expect: Memory
// A contact law that does not say what it remembers.
#include <abrade/sim/simulation.hpp>

struct Forgetful {
    static constexpr std::string_view name = "Forgetful";
    using Params = abrade::NoParams;
    explicit Forgetful(Params) {}
    const Params& params() const noexcept;
    abrade::Real stable_dt(abrade::Real, abrade::Real) const noexcept;
    abrade::ContactRigidity rigidity(abrade::Real) const noexcept;
};

int main() { abrade::simulate({}).contact(Forgetful{{}}).run({.end_time = 1}); }
