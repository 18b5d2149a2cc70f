// expect: validate
// A contact law whose parameters do not check themselves; asked by its author, as our own headers do.
#include <abrade/dem/laws/contact_law.hpp>

struct Trusting {
    static constexpr std::string_view name = "Trusting";
    struct Params {
        double stiffness;
        void visit(auto&&) const {}
    };
    template <class Number>
    struct Memory {};
    explicit Trusting(Params) {}
    const Params& params() const noexcept;
    abrade::ContactResponse<abrade::Real, Memory<abrade::Real>> respond(
        const abrade::ContactKinematics<abrade::Real>&, const Memory<abrade::Real>&) const noexcept;
    abrade::Real stable_dt(abrade::Real, abrade::Real) const noexcept;
    abrade::ContactRigidity rigidity(abrade::Real) const noexcept;
};
static_assert(abrade::ContactLaw<Trusting>);
