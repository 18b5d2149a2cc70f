// expect: respond
// A contact law that cannot answer.
#include <abrade/sim/simulation.hpp>

struct Mute {
    static constexpr std::string_view name = "Mute";
    using Params = abrade::NoParams;
    template <class Number>
    struct Memory {};
    explicit Mute(Params) {}
    const Params& params() const noexcept;
    abrade::Real stable_dt(abrade::Real, abrade::Real) const noexcept;
    abrade::ContactRigidity rigidity(abrade::Real) const noexcept;
};

int main() { abrade::simulate({}).contact(Mute{{}}).run({.end_time = 1}); }
