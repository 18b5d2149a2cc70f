#pragma once
// Concrete that loses strength as the test says: a load that stands still, on bonds that grow weaker, finds
// where they break without the swing that a load put on at once has.

#include <abrade/wear/wear_law.hpp>

/// Takes the place of a wear law; wears nothing itself.
class Ageing {
public:
    static constexpr std::string_view name = "Ageing";
    struct Params {
        const abrade::Real* left = nullptr;  ///< of the strength; may be changed between steps [-]

        void validate() const {}
        void visit(auto&& f) const { f("left", left ? *left : 1, "-"); }
    };

    explicit Ageing(Params params) : params_(params) {}
    const Params& params() const noexcept { return params_; }

    template <class Number>
    abrade::WearIncrement<Number> increment(const abrade::ContactKinematics<Number>&,
                                            const abrade::ContactLoad<Number>&) const noexcept {
        return {Number(0), Number(0)};
    }
    abrade::Real strength_left(abrade::Real) const noexcept { return *params_.left; }

private:
    Params params_;
};

static_assert(abrade::WearLaw<Ageing>);
