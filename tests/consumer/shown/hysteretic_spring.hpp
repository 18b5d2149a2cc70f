#pragma once
#include <abrade/dem/laws/contact_law.hpp>

/// A contact that keeps a dent until it opens; no friction:
///   f = max(k_2 (delta - (1 - e^2) delta_max), 0),  k_2 = k_1 / e^2
/// delta overlap [m], delta_max the largest so far: where it grows, f = k_1 delta. Restitution e at any
/// speed. O. R. Walton, R. L. Braun, J. Rheol. 30 (1986) 949, doi:10.1122/1.549893.
class HystereticSpring {
public:
    static constexpr std::string_view name = "HystereticSpring";
    struct Params {
        double stiffness = 0;    ///< k_1 [N/m]
        double restitution = 1;  ///< e, in (0, 1] [-]
        void validate() const {
            abrade::require_positive(stiffness, "HystereticSpring.stiffness", "N/m");
            abrade::require(restitution > 0 && restitution <= 1,
                            {"HystereticSpring.restitution", "in (0, 1]"}, restitution);
        }
        void visit(auto&& f) const { f("stiffness", stiffness, "N/m"), f("restitution", restitution, "-"); }
    };
    template <class Number>
    struct Memory {
        Number deepest = Number(0);  ///< delta_max [m]
    };

    explicit HystereticSpring(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    abrade::ContactResponse<Number, Memory<Number>> respond(const abrade::ContactKinematics<Number>& contact,
                                                            const Memory<Number>& memory) const noexcept {
        using abrade::max, abrade::select;
        const double k1 = params_.stiffness, e2 = abrade::square(params_.restitution);
        const Number none(0), overlap = max(contact.overlap, none), deepest = max(memory.deepest, overlap);
        const Number spring = max(overlap - Number(1 - e2) * deepest, none), force = Number(k1 / e2) * spring;
        const Number grown2 = (deepest - memory.deepest) * (deepest + memory.deepest);  // never below 0
        return {{force * contact.normal, Number(0.5) * force * spring, Number(0.5 * k1 * (1 - e2)) * grown2,
                 none},
                {select(contact.overlap > none, deepest, none)}};
    }
    abrade::ContactRigidity rigidity(double /*radius*/) const noexcept {
        return {.normal = params_.stiffness / abrade::square(params_.restitution)};  // k_2, the stiffer one
    }
    double stable_dt(double mass, double radius) const noexcept {
        return abrade::stable_dt_among_twelve(rigidity(radius), mass);
    }

private:
    Params params_;
};
