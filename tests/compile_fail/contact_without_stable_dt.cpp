// expect: stable_dt
// A contact law that does not say how large a step it bears.
#include <abrade/sim/simulation.hpp>

struct Reckless {
    static constexpr std::string_view name = "Reckless";
    using Params = abrade::NoParams;
    template <class Number>
    struct Memory {};
    explicit Reckless(Params) {}
    const Params& params() const noexcept;
    abrade::ContactResponse<abrade::Real, Memory<abrade::Real>> respond(
        const abrade::ContactKinematics<abrade::Real>&, const Memory<abrade::Real>&) const noexcept;
    abrade::ContactRigidity rigidity(abrade::Real) const noexcept;
};

int main() { abrade::simulate({}).contact(Reckless{{}}).run({.end_time = 1}); }
