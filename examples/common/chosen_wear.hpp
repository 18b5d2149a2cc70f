#pragma once
// A wear law that is chosen when the program runs: one engine is compiled for all of them.

#include <abrade/wear/archard.hpp>
#include <abrade/wear/finnie.hpp>
#include <abrade/wear/ishibashi.hpp>
#include <abrade/wear/sklar_dietrich.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <string>
#include <variant>

namespace abrade::examples {

/// A law of one's own may be made of others.
struct ChosenWear {
    static constexpr std::string_view name = "ChosenWear";
    struct Params {
        Real acceleration = 1;  ///< beta of the law chosen [-]
        void validate() const {}
        void visit(auto&& f) const { f("acceleration", acceleration, "-"); }
    };
    std::variant<NoWear, SubParticleAbrasion, Archard, Finnie, SklarDietrich, Ishibashi> law;

    explicit ChosenWear(Params params) : params_(params) {}
    template <class Wear>
    requires(!std::same_as<Wear, ChosenWear> && !std::same_as<Wear, Params>) ChosenWear(const Wear& one)
        : law(one) {
        if constexpr (AcceleratedWear<Wear>) params_.acceleration = one.params().acceleration;
    }
    const Params& params() const noexcept { return params_; }
    /// Of the law chosen.
    std::string chosen() const {
        return std::visit([](const auto& one) { return std::string(one.name); }, law);
    }
    template <class Number>
    WearIncrement<Number> increment(const ContactKinematics<Number>& contact,
                                    const ContactLoad<Number>& load) const noexcept {
        return std::visit([&](const auto& one) { return one.increment(contact, load); }, law);
    }
    Real strength_left(Real fracture) const noexcept {
        return std::visit([&](const auto& one) { return one.strength_left(fracture); }, law);
    }

private:
    Params params_;
};
static_assert(AcceleratedWear<ChosenWear>);

}  // namespace abrade::examples
