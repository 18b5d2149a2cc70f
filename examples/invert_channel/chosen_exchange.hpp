#pragma once
// How water and stones exchange momentum, chosen when the program runs: one engine is compiled for all ways.

#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/coupling/exchange/one_fluid.hpp>

#include <span>
#include <string_view>
#include <utility>

namespace abrade::examples {

/// One of the library's exchanges. Each call is handed on; it does its work on planes of faces or on all
/// bodies, so what a choice costs is not seen.
class ChosenExchange {
    static decltype(auto) visit(auto& self, auto&& use) {
        if (self.choice_ == 1) return use(self.mixture_);
        if (self.choice_ == 2) return use(self.direct_);
        return use(self.monolithic_);
    }

public:
    static constexpr std::string_view name = "ChosenExchange";
    static constexpr bool present = true;

    ChosenExchange() = default;
    ChosenExchange(MonolithicSolids<> one) : choice_(0), monolithic_(std::move(one)) {}
    ChosenExchange(MixtureSolids one) : choice_(1), mixture_(std::move(one)) {}
    ChosenExchange(DirectForcing one) : choice_(2), direct_(std::move(one)) {}

    auto bodies() const { return base().bodies(); }
    auto fastest() const { return base().fastest(); }
    auto parts() const { return base().parts(); }
    auto resolved_parts() const { return base().resolved_parts(); }
    auto fluxes() const { return base().fluxes(); }
    void mix_last(FaceField<3>& u) const { base().mix_last(u); }
    void to_superficial(FaceField<3>& u) {
        visit(*this, [&](auto& one) { one.to_superficial(u); });
    }
    void to_interstitial(FaceField<3>& u) const { base().to_interstitial(u); }
    void slow(FaceField<3>& u, const FlowStage& stage) {
        visit(*this, [&](auto& one) { one.slow(u, stage); });
    }
    void give_back(FaceField<3>& u, Real share) const {
        visit(*this, [&](const auto& one) { one.give_back(u, share); });
    }
    void mix(FaceField<3>& u) {
        visit(*this, [&](auto& one) { one.mix(u); });
    }
    void unmix(FaceField<3>& u) const { base().unmix(u); }
    Real water_share(std::size_t n) const { return base().water_share(n); }
    auto volumes(bool only_new) const { return base().volumes(only_new); }
    Vec3 moment(const Grid<3>& grid, const Field<Real>* fraction, bool only_new) const {
        return base().moment(grid, fraction, only_new);
    }
    Real lost_to_friction() const { return base().lost_to_friction(); }

    Index averaged() const {
        return visit(*this, [](const auto& one) { return one.averaged(); });
    }
    void find_closed_cells(const Poisson<3>& m) {
        visit(*this, [&](auto& one) { one.find_closed_cells(m); });
    }
    void place(const Grid<3>& grid, const BoundaryConditions<3>& boundaries, std::span<const FlowBody> bodies,
               const FaceField<3>* aperture, Real density) {
        visit(*this, [&](auto& one) { one.place(grid, boundaries, bodies, aperture, density); });
    }
    void close(Poisson<3>& m, std::span<const OpenFace> surface) {
        visit(*this, [&](auto& one) { one.close(m, surface); });
    }
    void force(FaceField<3>& u, const Field<Real>& pressure, const FlowStage& stage) {
        visit(*this, [&](auto& one) { one.force(u, pressure, stage); });
    }
    template <class Number>
    void push(const Field<Number>& of, Real factor) {
        visit(*this, [&](auto& one) { one.push(of, factor); });
    }
    template <class Number>
    void correct(FaceField<3>& u, const Field<Number>& of, Real factor, int plane, bool old) const {
        visit(*this, [&](const auto& one) { one.correct(u, of, factor, plane, old); });
    }
    Real add_product(const Field<float>& p, Field<float>& product) {
        return visit(*this, [&](auto& one) { return one.add_product(p, product); });
    }
    void settle(FaceField<3>& u, Field<Real>& pressure) {
        visit(*this, [&](auto& one) { one.settle(u, pressure); });
    }

    /// Those that were not chosen have nothing to save.
    static void fields(auto&& field) {
        field("monolithic", &ChosenExchange::monolithic_), field("mixture", &ChosenExchange::mixture_);
        field("direct", &ChosenExchange::direct_);
    }

private:
    const BodiesInFlow& base() const {
        if (choice_ == 1) return mixture_;
        if (choice_ == 2) return direct_;
        return monolithic_;
    }

    int choice_ = 0;
    MonolithicSolids<> monolithic_;
    MixtureSolids mixture_;
    DirectForcing direct_;
};
static_assert(SolidsInFlow<ChosenExchange>);

}  // namespace abrade::examples
