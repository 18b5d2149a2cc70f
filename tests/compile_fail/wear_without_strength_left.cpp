// expect: strength_left
// A wear law that does not say what it does to strength.
#include <abrade/sim/simulation.hpp>

struct Polishing {
    static constexpr std::string_view name = "Polishing";
    using Params = abrade::NoParams;
    explicit Polishing(Params) {}
    const Params& params() const noexcept;
    abrade::WearIncrement<abrade::Real> increment(const abrade::ContactKinematics<abrade::Real>&,
                                    const abrade::ContactLoad<abrade::Real>&) const noexcept;
};

int main() {
    abrade::simulate({})
        .contact(abrade::LinearSpring{{.stiffness = 1e6}})
        .wear(Polishing{{}})
        .run({.end_time = 1});
}
