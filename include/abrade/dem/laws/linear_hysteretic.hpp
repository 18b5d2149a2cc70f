#pragma once
// The linear hysteretic contact: restitution without a dashpot, and so without a mass.

#include <abrade/dem/laws/contact_law.hpp>
#include <abrade/dem/laws/damping.hpp>

namespace abrade {

/// A spring that is stiffer while it unloads, and Coulomb's slider.
///   loading    f = k_1 delta                     where delta is the largest overlap so far, delta_max
///   below      f = max(k_2 (delta - delta_0), 0),  k_2 = k_1 / e^2,  delta_0 = (1 - e^2) delta_max
///   stored     f^2 / (2 k_2)
///   lost       dE = (1 - e^2) k_1 delta_max d delta_max
///   f_t = -k_t s - c_t v_t,  |f_t| <= mu f,  k_t = a k_1,  c_t = 2 zeta sqrt(k_t m)
/// f normal force [N]
/// delta overlap [m], delta_0 overlap at which unloading ends (depth of the dent) [m]
/// k_1, k_2 stiffness of loading, of unloading and reloading [N/m]
/// e restitution [-]: a normal impact loses the share 1 - e^2 at any speed, for any masses
/// s tangential spring [m], v_t slip velocity [m/s], k_t its stiffness [N/m], a tangential ratio [-]
/// mu friction [-], m effective mass [kg], zeta damping ratio for rest [-]
/// Validity: delta far below the radius. A contact that opens loses its dent; one that is struck again before
/// it opens (overlap below delta_0, but above 0) responds elastically up to delta_max.
/// Throws InputError for parameters out of their range.
/// Source: O. R. Walton, R. L. Braun, J. Rheol. 30 (1986) 949, doi:10.1122/1.549893.
///
/// Below delta_max the two branches are one elastic line, on which a pressed bed would ring for ever. A
/// dashpot acts there while the contact is loaded again (v_n, the speed of approach [m/s], is positive):
///   f_v = min(c v_n, f, k_1 delta_max - f),  c = 2 zeta sqrt(k_2 m)
/// An impact loads along the first line and unloads; it never loads again, and the dashpot takes nothing from
/// it, whatever the mass of the partner. The limits keep the total force continuous, at both ends of the
/// line.
///
/// A contact that is found pressed, at the start of a run or as a bond breaks, has its dent from before.
class LinearHysteretic {
public:
    static constexpr std::string_view name = "LinearHysteretic";

    struct Params {
        Real stiffness = 0;               ///< k_1 [N/m]
        Real restitution = 1;             ///< e of a normal impact, in (0, 1] [-]
        Real friction = 0;                ///< mu [-]
        Real tangential_ratio = 2.0 / 7;  ///< k_t / k_1 [-]
        Real rest_damping = 0.02;         ///< zeta of loading again and of the tangential spring [-]

        void validate() const {
            require_positive(stiffness, "LinearHysteretic.stiffness", "N/m",
                             "stones on concrete use 1e6 to 1e8 N/m");
            require_restitution(restitution, "LinearHysteretic.restitution");
            require_not_negative(friction, "LinearHysteretic.friction", "", "0 slides freely");
            require_positive(tangential_ratio, "LinearHysteretic.tangential_ratio", "",
                             "2/7 gives loading and the tangential spring the same period");
            require_rest_damping(rest_damping, "LinearHysteretic.rest_damping");
        }
        void visit(auto&& f) const {
            f("stiffness", stiffness, "N/m");
            f("restitution", restitution, "-");
            f("friction", friction, "-");
            f("tangential_ratio", tangential_ratio, "-");
            f("rest_damping", rest_damping, "-");
        }
    };

    template <class Number>
    struct Memory {
        Vec3Of<Number> spring = Vec3Of<Number>::Zero();  ///< [m]
        Number deepest = Number(0);                      ///< delta_max [m]
    };

    explicit LinearHysteretic(Params params) : params_(params) {  // Params{...} alone tells a wrong name
        params_.validate();
        dent_share_ = 1 - square(params_.restitution);
        unloading_ = params_.stiffness / square(params_.restitution);
        dashpot_normal_ = 2 * params_.rest_damping * std::sqrt(unloading_);
        dashpot_tangential_ = 2 * params_.rest_damping * std::sqrt(tangential_stiffness());
    }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    ContactResponse<Number, Memory<Number>> respond(const ContactKinematics<Number>& contact,
                                                    const Memory<Number>& memory) const noexcept {
        const auto touching = contact.overlap > Number(0);
        const Number nothing(0), far = Number(std::numeric_limits<float>::max());
        const Number approach = -contact.velocity.dot(contact.normal);
        const Vec3Of<Number> slip = contact.velocity + approach * contact.normal;
        const Number root_mass = rsqrt(max(contact.inverse_mass, Number(tiny<Number>)));

        const Number overlap = max(contact.overlap, nothing), deepest = max(memory.deepest, overlap);
        const Number loading = Number(params_.stiffness) * deepest;
        // From delta_max down: exact on the line of loading, where a dent and an overlap would round.
        const Number push = max(loading - Number(unloading_) * (deepest - overlap), nothing);
        const auto normal = Reloading<Number>::at(push, loading, root_mass * Number(dashpot_normal_),
                                                  approach, contact.time_step);
        // A product, never negative where a difference of squares may round to less than 0.
        const Number pressed = pressed_before(contact, memory.deepest);
        const Number dented =
            Number(0.5 * dent_share_ * params_.stiffness) * (deepest - pressed) * (deepest + pressed);

        // What does not touch must not send a pack into the rarer branches: deep, and held by any friction.
        const Number begun = begun_share(select(touching, contact.overlap, far), approach, contact.time_step);
        const Number acting = select(begun < Number(1), Number(0.5) + begun, Number(1));
        const Vec3Of<Number> before = turn_into_plane(memory.spring, contact.normal);
        const Vec3Of<Number> tangential_displacement =
            contact.displacement - contact.displacement.dot(contact.normal) * contact.normal;
        const Number kt = Number(tangential_stiffness());
        const Number limit = select(touching, Number(params_.friction) * normal.force, far);
        const auto tangential =
            SlidingSpring<Number>::at(before, before + begun * tangential_displacement, slip, limit, kt,
                                      (acting * root_mass) * Number(dashpot_tangential_), contact.time_step);

        const Vec3Of<Number> none = Vec3Of<Number>::Zero();
        const Vec3Of<Number> force = normal.force * contact.normal + tangential.force;
        const Number stored = Number(0.5 / unloading_) * push * push;
        // A contact that opened gives back nothing: what its tangential spring held is lost to sliding.
        const Number left_over = Number(0.5) * kt * memory.spring.dot(memory.spring);
        return {
            {select(touching, force, none), select(touching, stored + tangential.stored, nothing),
             select(touching, dented + normal.lost, nothing), select(touching, tangential.lost, left_over)},
            {select(touching, tangential.spring, none), select(touching, deepest, nothing)}};
    }

    Real stiffness() const noexcept { return params_.stiffness; }     ///< k_1 [N/m]
    Real unloading_stiffness() const noexcept { return unloading_; }  ///< k_2 [N/m]
    Real tangential_stiffness() const noexcept { return params_.stiffness * params_.tangential_ratio; }
    /// Of loading, k_1 at any overlap [N/m].
    template <class Number>
    Number normal_stiffness(Number /*overlap*/, Number /*curvature*/) const noexcept {
        return Number(params_.stiffness);
    }
    /// Of a normal impact: the same at any speed [m/s], effective mass [kg] and effective radius [m].
    Real restitution(Real /*speed*/, Real /*mass*/, Real /*radius*/) const noexcept {
        return params_.restitution;
    }

    /// Of unloading; without friction nothing acts across the normal.
    ContactRigidity rigidity(Real /*radius*/) const noexcept {
        return {unloading_, params_.friction > 0 ? tangential_stiffness() : 0, params_.rest_damping};
    }
    Real stable_dt(Real mass, Real /*radius*/) const noexcept {
        return stable_dt_among_twelve({unloading_, tangential_stiffness(), params_.rest_damping}, mass);
    }

private:
    Params params_;
    Real dent_share_ = 0, unloading_ = 0;               ///< 1 - e^2 [-], k_2 [N/m]
    Real dashpot_normal_ = 0, dashpot_tangential_ = 0;  ///< 2 zeta sqrt(k); times sqrt(m) [N s/m]
};

static_assert(ContactLaw<LinearHysteretic> && !MayDampFreeMass<LinearHysteretic>);
static_assert(!ContactLaw<LinearHysteretic::Params>);

}  // namespace abrade
