// expect: strength
// A bond law that does not join the strengths of its two spheres.
#include <abrade/sim/simulation.hpp>

struct Eternal {
    static constexpr std::string_view name = "Eternal";
    using Params = abrade::NoParams;
    struct Memory {
        bool broken = false;
    };
    explicit Eternal(Params) {}
    const Params& params() const noexcept;
    abrade::BondResponse<Memory> respond(const abrade::BondKinematics&, abrade::Real,
                                         const Memory&) const noexcept;
    abrade::BondRigidity rigidity(abrade::Real, abrade::Real) const noexcept;
};

int main() {
    abrade::simulate({})
        .contact(abrade::LinearSpring{{.stiffness = 1e6}})
        .bond(Eternal{{}})
        .run({.end_time = 1});
}
