#pragma once
// The linear spring-dashpot-slider contact.

#include <abrade/dem/laws/contact_law.hpp>
#include <abrade/dem/laws/damping.hpp>

namespace abrade {

/// Linear spring, dashpot and Coulomb slider.
///   f_n = max(k_n delta + c_n v_n, 0),  c_n = 2 zeta sqrt(k_n m)
///   f_t = -k_t s - c_t v_t,  |f_t| <= mu f_n,  c_t = 2 zeta sqrt(k_t m)
/// delta overlap [m], v_n speed of approach [m/s]
/// s tangential spring [m], v_t slip velocity [m/s]
/// k_n, k_t stiffness [N/m], mu friction [-], zeta damping ratio, from the restitution [-]
/// m effective mass [kg], 1/m = 1/m_i + 1/m_j
/// Validity: overlaps far below the radius. A contact lasts pi sqrt(m / k_n) (undamped).
/// Throws InputError for parameters out of their range.
/// Source: P. A. Cundall, O. D. L. Strack, Geotechnique 29 (1979) 47, doi:10.1680/geot.1979.29.1.47.
///
/// `DampingMass::free` takes 1/m over the free bodies alone. On a concrete sphere of `dynamic` concrete (mass
/// m_j) the dashpot is then sqrt(1 + m_i/m_j) times as strong, and a stone (mass m_i) on stiff bonds loses
/// 1 - e^2 of its energy as on a rigid bed. The light sphere must follow that dashpot: with friction the
/// engine's step falls to about m_j/(7 c_n) where that is less than the springs allow.
class LinearSpring {
public:
    static constexpr std::string_view name = "LinearSpring";

    struct Params {
        Real stiffness = 0;               ///< k_n [N/m]
        Real restitution = 1;             ///< of a normal impact, in (0, 1] [-]
        Real friction = 0;                ///< mu [-]
        Real tangential_ratio = 2.0 / 7;  ///< k_t / k_n [-]; 2/7 gives both directions the same period
        DampingMass damping_mass = DampingMass::both;  ///< what m counts

        void validate() const {
            require_positive(stiffness, "LinearSpring.stiffness", "N/m",
                             "stones on concrete use 1e6 to 1e8 N/m");
            require_restitution(restitution, "LinearSpring.restitution");
            require_not_negative(friction, "LinearSpring.friction", "", "0 slides freely");
            require_positive(tangential_ratio, "LinearSpring.tangential_ratio", "",
                             "2/7 gives both directions the same period");
            require_damping_mass(damping_mass, "LinearSpring.damping_mass");
        }
        void visit(auto&& f) const {
            f("stiffness", stiffness, "N/m");
            f("restitution", restitution, "-");
            f("friction", friction, "-");
            f("tangential_ratio", tangential_ratio, "-");
            f("damping_mass_free", damping_mass == DampingMass::free ? 1 : 0, "-");
        }
    };

    template <class Number>
    struct Memory {
        Vec3Of<Number> spring = Vec3Of<Number>::Zero();  ///< [m]
    };

    explicit LinearSpring(Params params) : params_(params) {  // Params{...} alone tells a wrong name
        params_.validate();
        damping_ratio_ = damping_ratio_without_tension(params_.restitution);
        dashpot_normal_ = 2 * damping_ratio_ * std::sqrt(stiffness());
        dashpot_tangential_ = 2 * damping_ratio_ * std::sqrt(tangential_stiffness());
    }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    ContactResponse<Number, Memory<Number>> respond(const ContactKinematics<Number>& contact,
                                                    const Memory<Number>& memory) const noexcept {
        const auto kn = Number(params_.stiffness), kt = Number(tangential_stiffness());
        const auto touching = contact.overlap > Number(0);
        const Number approach = -contact.velocity.dot(contact.normal);
        const Vec3Of<Number> slip = contact.velocity + approach * contact.normal;
        // What does not touch must not send a pack into the rarer branches: deep, and held by any friction.
        const Number far = Number(std::numeric_limits<float>::max());
        const Number begun = begun_share(select(touching, contact.overlap, far), approach, contact.time_step);
        const Number acting = select(begun < Number(1), Number(0.5) + begun, Number(1));
        const Number root_mass = acting / sqrt(contact.inverse_mass);

        const Number overlap = max(contact.overlap, Number(0)), push = kn * overlap;
        const auto normal =
            NormalSpring<Number>::pushing(push, Number(0.5) * push * overlap,
                                          root_mass * Number(dashpot_normal_), approach, contact.time_step);
        const Vec3Of<Number> before = turn_into_plane(memory.spring, contact.normal);
        const Vec3Of<Number> tangential_displacement =
            contact.displacement - contact.displacement.dot(contact.normal) * contact.normal;
        const Vec3Of<Number> trial = before + begun * tangential_displacement;
        const Number limit = select(touching, Number(params_.friction) * normal.force, far);
        const auto tangential = SlidingSpring<Number>::at(
            before, trial, slip, limit, kt, root_mass * Number(dashpot_tangential_), contact.time_step);

        const Vec3Of<Number> none = Vec3Of<Number>::Zero();
        const Vec3Of<Number> force = normal.force * contact.normal + tangential.force;
        // A contact that opened gives back nothing: what its tangential spring held is lost to sliding.
        const Number left_over = Number(0.5) * kt * memory.spring.dot(memory.spring);
        return {
            {select(touching, force, none), select(touching, normal.stored + tangential.stored, Number(0)),
             select(touching, normal.lost, Number(0)), select(touching, tangential.lost, left_over)},
            {select(touching, tangential.spring, none)}};
    }

    Real stiffness() const noexcept { return params_.stiffness; }
    /// k_n at any overlap [N/m].
    template <class Number>
    Number normal_stiffness(Number /*overlap*/, Number /*curvature*/) const noexcept {
        return Number(params_.stiffness);
    }
    Real tangential_stiffness() const noexcept { return params_.stiffness * params_.tangential_ratio; }
    Real damping_ratio() const noexcept { return damping_ratio_; }
    bool damps_free_mass() const noexcept { return params_.damping_mass == DampingMass::free; }
    /// Of a normal impact: the same at any speed [m/s], effective mass [kg] and effective radius [m].
    Real restitution(Real /*speed*/, Real /*mass*/, Real /*radius*/) const noexcept {
        return params_.restitution;
    }

    /// Without friction nothing acts across the normal.
    ContactRigidity rigidity(Real /*radius*/) const noexcept {
        return {stiffness(), params_.friction > 0 ? tangential_stiffness() : 0, damping_ratio_};
    }
    Real stable_dt(Real mass, Real /*radius*/) const noexcept {
        return stable_dt_among_twelve({stiffness(), tangential_stiffness(), damping_ratio_}, mass);
    }

private:
    Params params_;
    Real damping_ratio_ = 0;
    Real dashpot_normal_ = 0, dashpot_tangential_ = 0;  ///< 2 zeta sqrt(k); times sqrt(m) [N s/m]
};

static_assert(ContactLaw<LinearSpring> && MayDampFreeMass<LinearSpring>);
static_assert(!ContactLaw<NoParams>);

}  // namespace abrade
