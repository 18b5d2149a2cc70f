// expect: noexcept
// A contact law that may throw in the middle of a parallel loop.
#include <abrade/sim/simulation.hpp>

struct Throwing {
    static constexpr std::string_view name = "Throwing";
    using Params = abrade::NoParams;
    template <class Number>
    struct Memory {};
    explicit Throwing(Params) {}
    const Params& params() const noexcept;
    abrade::ContactResponse<abrade::Real, Memory<abrade::Real>> respond(
        const abrade::ContactKinematics<abrade::Real>&, const Memory<abrade::Real>&) const;
    abrade::Real stable_dt(abrade::Real, abrade::Real) const noexcept;
    abrade::ContactRigidity rigidity(abrade::Real) const noexcept;
};

int main() { abrade::simulate({}).contact(Throwing{{}}).run({.end_time = 1}); }
