#pragma once
// Resistance to rolling, added to a contact law.

#include <abrade/dem/laws/contact_law.hpp>

namespace abrade {

/// Knows its normal spring: f = k delta, where the secant k [N/m] may change with the overlap delta [m].
template <class L>
concept KnowsNormalStiffness = requires(const L& law) {
    { law.normal_stiffness(Real{}, Real{}) } -> std::same_as<Real>;
};

/// A contact law and a couple that resists rolling, equal and opposite on the two bodies, in two models:
///   M_max = mu_r R f_n
/// - elastic_plastic (model C of the source): spring, dashpot and slider,
///   M = -k_r theta - c_r w,  |M| <= M_max,  k_r = a k_n (mu_r R)^2,  c_r = 2 eta_r sqrt(I_r k_r)
/// - constant_torque (model A):
///   M = -M_max w/|w|, but no more than stops the rolling in some twelve steps
/// M couple [N m], f_n the law's normal force [N], k_n secant of its normal spring [N/m]
/// R effective radius [m], mu_r rolling friction [-], a stiffness ratio [-], eta_r damping ratio [-]
/// w relative angular velocity without its part about the normal [rad/s], theta its travel [rad]
/// I_r [kg m2], 1/I_r = sum 1/(1.4 m r^2)
/// Validity: torsion is not resisted. constant_torque holds nothing at rest: a pile creeps.
/// Throws InputError for parameters out of their range, those of the law included.
/// Source: J. Ai, J.-F. Chen, J. M. Rotter, J. Y. Ooi, Powder Technol. 206 (2011) 269,
/// doi:10.1016/j.powtec.2010.09.030; model C after K. Iwashita, M. Oda, J. Eng. Mech. 124 (1998) 285,
/// doi:10.1061/(ASCE)0733-9399(1998)124:3(285).
///
/// As k_n changes the spring follows as HertzMindlin's tangential one does: the couple stays while k_r grows,
/// falls with it while it falls. The dashpot acts as far as the limit leaves it room; in the paper it acts
/// beside the limit. The loss is of its own kind, `lost_rolling`: not sliding, so the library's wear laws
/// take nothing from it. With a film between the surfaces take `Lubricated<RollingResistance<L>>`:
/// `RollingResistance<Lubricated<L>>` does not compile, for Lubricated offers no `normal_stiffness`.
template <ContactLaw Law>
requires KnowsNormalStiffness<Law>
class RollingResistance {
public:
    static constexpr std::string_view name = "RollingResistance";
    static constexpr bool resists_rolling = true;

    enum class Model { elastic_plastic, constant_torque };

    struct Params {
        typename Law::Params contact{};  ///< of the law that gives the force
        Real friction = 0;             ///< mu_r: the tangent of the steepest slope that a sphere rests on [-]
        Real damping = 0.3;            ///< eta_r, share of critical damping [-]
        Real stiffness_factor = 2.25;  ///< a [-]: 2.25 for spheres, 3 for discs
        Model model = Model::elastic_plastic;

        void validate() const {
            contact.validate();
            require_not_negative(friction, "RollingResistance.friction", "",
                                 "it is the tangent of the steepest slope that a sphere rests on");
            require_not_negative(damping, "RollingResistance.damping", "",
                                 "it is a share of critical damping, 0 for none");
            require_positive(stiffness_factor, "RollingResistance.stiffness_factor", "",
                             "2.25 for spheres, 3 for discs");
        }
        void visit(auto&& f) const {
            contact.visit(f);
            f("rolling_friction", friction, "-");
            f("rolling_damping", damping, "-");
            f("rolling_stiffness_factor", stiffness_factor, "-");
            f("rolling_constant_torque", model == Model::constant_torque ? 1 : 0, "-");
        }
    };

    template <class Number>
    struct Memory {
        typename Law::template Memory<Number> contact{};
        Vec3Of<Number> rotation = Vec3Of<Number>::Zero();  ///< held by the rolling spring [rad]
        Number stiffness = Number(0);                      ///< k_r when it was stored [N m]
    };

    explicit RollingResistance(Params params) : params_(params), law_(params.contact) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    ContactResponse<Number, Memory<Number>> respond(const ContactKinematics<Number>& contact,
                                                    const Memory<Number>& memory) const noexcept {
        ContactResponse<Number, Memory<Number>> all;
        const auto answer = law_.respond(contact, memory.contact);
        all.load = answer.load, all.memory.contact = answer.memory;

        const auto touching = contact.overlap > Number(0);
        const Vec3Of<Number> none = Vec3Of<Number>::Zero();
        const Number lever = Number(params_.friction) * reciprocal(contact.curvature);
        const Number push = max(answer.load.force.dot(contact.normal), Number(0));
        // What does not touch is held by any limit, and so stays out of the rarer branches.
        const Number limit = select(touching, lever * push, Number(std::numeric_limits<float>::max()));
        const Vec3Of<Number> rolling = contact.spin - contact.spin.dot(contact.normal) * contact.normal;
        const Number per_inertia = reciprocal(contact.inverse_turning);

        if (params_.model == Model::constant_torque) {
            const Real dt = contact.time_step;
            const Number brake =
                dt > 0 ? Number(0.4 / (12 * dt)) * per_inertia : Number(std::numeric_limits<float>::max());
            const auto slider = SlidingSpring<Number>::at(none, none, rolling, limit, Number(1), brake, dt);
            all.load.couple = select(touching, slider.force, none);
            all.load.lost_rolling = select(touching, slider.lost, Number(0));
            return all;
        }

        const Vec3Of<Number> rolled =
            contact.rotation - contact.rotation.dot(contact.normal) * contact.normal;
        const Number begun = begun_of(contact, touching);
        const Number acting = select(begun < Number(1), Number(0.5) + begun, Number(1));
        const Number a = Number(params_.stiffness_factor) * lever * lever, least = Number(tiny<Number>);
        const Number stiffness = max(a * law_.normal_stiffness(contact.overlap, contact.curvature), least);
        const Number dashpot =
            acting * Number(2 * params_.damping) * sqrt(Number(1.4) * per_inertia * stiffness);

        // Where a contact begins k_r is that of no overlap.
        const auto following = FollowingStiffness<Number>::of(
            max(memory.stiffness, a * law_.normal_stiffness(Number(0), contact.curvature)), stiffness,
            Number(1) / stiffness);
        const Vec3Of<Number> before =
            turn_into_plane(memory.rotation, contact.normal, Number(1) - following.grown);
        const auto spring = SlidingSpring<Number>::at(before, before + (following.mean * begun) * rolled,
                                                      rolling, limit, stiffness, dashpot, contact.time_step);
        const Number length2 = memory.rotation.dot(memory.rotation),
                     given_up = following.given_up(length2, before, spring.spring, rolled, begun),
                     held_before = Number(0.5) * memory.stiffness * length2;

        all.load.couple = select(touching, spring.force, none);
        all.load.stored += select(touching, spring.stored, Number(0));
        // A contact that opened gives back nothing.
        all.load.lost_rolling = select(touching, max(spring.lost + given_up, Number(0)), held_before);
        all.memory.rotation = select(touching, spring.spring, none);
        all.memory.stiffness = select(touching, stiffness, Number(0));
        return all;
    }

    /// k_n of the law without resistance to rolling, see KnowsNormalStiffness.
    template <class Number>
    Number normal_stiffness(Number overlap, Number curvature) const noexcept {
        return law_.normal_stiffness(overlap, curvature);
    }

    bool damps_free_mass() const noexcept requires MayDampFreeMass<Law> { return law_.damps_free_mass(); }

    /// With the rolling spring's, as on a plane, where R is largest.
    ContactRigidity rigidity(Real radius) const noexcept { return with_rolling(law_.rigidity(radius)); }
    ContactRigidity rigidity(const ContactKinematics<Real>& contact) const noexcept requires
        KnowsRigidityAsItStands<Law> {
        return with_rolling(law_.rigidity(contact));
    }
    Real stable_dt(Real mass, Real radius) const noexcept {
        return std::min(law_.stable_dt(mass, radius), stable_dt_among_twelve(rigidity(radius), mass));
    }

private:
    ContactRigidity with_rolling(ContactRigidity all) const noexcept {
        if (params_.model == Model::elastic_plastic) {
            all.rolling = params_.stiffness_factor * square(params_.friction) * all.normal;
            all.rolling_damping_ratio = params_.damping;
        }
        return all;
    }

    template <class Number, class Mask>
    static Number begun_of(const ContactKinematics<Number>& contact, Mask touching) noexcept {
        const Number far = Number(std::numeric_limits<float>::max());
        return begun_share(select(touching, contact.overlap, far), -contact.velocity.dot(contact.normal),
                           contact.time_step);
    }

    Params params_;
    Law law_;
};

}  // namespace abrade
