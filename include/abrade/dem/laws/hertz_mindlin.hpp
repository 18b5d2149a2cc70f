#pragma once
// The contact of elastic spheres: Hertz along the normal, Mindlin without slip along the tangent.

#include <abrade/dem/laws/contact_law.hpp>
#include <abrade/dem/laws/damping.hpp>
#include <abrade/dem/laws/elastic_pair.hpp>

namespace abrade {

/// Hertz-Mindlin with Coulomb's slider.
///   f_n = 4/3 E* sqrt(R delta) delta + c_n v_n,    stored 2/5 of f_elastic delta
///   f_t = -k_t s - c_t v_t,  |f_t| <= mu f_n,       k_t = 8 G* sqrt(R delta)
///   1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2,     1/G* = (2 - nu_1)/G_1 + (2 - nu_2)/G_2
///   G = E / (2 (1 + nu)),  c = 2 sqrt(5/6) zeta sqrt(S m),  S_n = 2 E* sqrt(R delta),  S_t = k_t
/// delta overlap [m], R effective radius [m]
/// E Young's and G shear modulus [Pa], nu Poisson's ratio [-]
/// k_t, S stiffness [N/m], c dashpots [N s/m]
/// v_n speed of approach [m/s], s tangential spring [m], v_t slip velocity [m/s]
/// mu friction [-], zeta damping ratio, from the restitution [-]
/// m effective mass [kg], 1/m = 1/m_i + 1/m_j or, with `DampingMass::free`, the sum over the free bodies
/// alone (see LinearSpring)
/// Validity: a small area of contact, delta below some 2 % of the radius.
/// Throws InputError for parameters out of their range.
/// Source: spring: C. Thornton, S. Cummins, P. Cleary, Powder Technol. 233 (2013) 30,
/// doi:10.1016/j.powtec.2012.08.012; damping: Y. Tsuji, T. Tanaka, T. Ishida, Powder Technol. 71 (1992) 239,
/// doi:10.1016/0032-5910(92)88030-L.
///
/// The damping makes restitution independent of speed; zeta follows from e by the closed form of the linear
/// spring, which holds here too, with or without tension. The tangential spring is incremental by default:
/// while k_t grows its force stays, while k_t falls the force falls with it, and it never makes energy. What
/// the spring gives up as k_t changes counts as lost to sliding: in a real contact it is lost to slip at the
/// rim of the area of contact. `Spring` and `Slider` offer what other codes do, to compare with them.
class HertzMindlin {
public:
    static constexpr std::string_view name = "HertzMindlin";

    /// How the tangential spring follows k_t.
    enum class Spring {
        incremental,  ///< the force stays while the contact stiffens, falls with k_t while it softens
        /// The stretch stays: f_t = k_t s. Then 1/2 k_t s^2 rises as the contact stiffens, though nobody did
        /// that work, and falls as it softens, though nobody received it. Neither is booked: what is made (or
        /// vanishes) in the end shows as a negative (or positive) integration residue that no smaller time
        /// step removes. For comparison with other codes, not for wear.
        total
    };
    /// What Coulomb's limit holds.
    enum class Slider {
        whole_force,  ///< spring and dashpot together: |f_t| <= mu f_n
        /// Springs only: |k_t s| <= mu 4/3 E* sqrt(R delta) delta. Dashpots act beside them, the tangential
        /// one only while the contact sticks. |f_t| may exceed mu f_n, above all where damping may pull.
        springs
    };

    struct Params {
        Real youngs = 0;       ///< E of the spheres [Pa]
        Real poisson = 0.25;   ///< nu of the spheres, in (-1, 0.5] [-]
        Real restitution = 1;  ///< of a normal impact, in (0, 1] [-]
        Real friction = 0;     ///< mu [-]
        bool tension = false;  ///< whether damping may pull; e is met either way
        Spring spring = Spring::incremental;
        Slider slider = Slider::whole_force;
        Real youngs_other = 0;  ///< E of the other partner [Pa]; 0: the same material
        Real poisson_other = 0.25;
        /// Overlap over radius up to which `stable_dt` is stable against an equal sphere [-]: contacts
        /// stiffen as they are pressed. Against a plane the tangents are sqrt(2) times as stiff.
        Real largest_overlap = 0.01;
        DampingMass damping_mass = DampingMass::both;  ///< what m counts

        void validate() const {
            require_positive(youngs, "HertzMindlin.youngs", "Pa", "1e7 Pa is soft, stone is near 5e10 Pa");
            require_in_pascal(youngs, "HertzMindlin.youngs");
            require_poisson(poisson, "HertzMindlin.poisson");
            require_restitution(restitution, "HertzMindlin.restitution");
            require_not_negative(friction, "HertzMindlin.friction", "", "0 slides freely");
            require_not_negative(youngs_other, "HertzMindlin.youngs_other", "Pa",
                                 "0 means the same material");
            require_poisson(poisson_other, "HertzMindlin.poisson_other");
            require(largest_overlap > 0 && largest_overlap <= 0.2,
                    {"HertzMindlin.largest_overlap", "in (0, 0.2]", "",
                     "it is a share of the radius; beyond 0.2 a run ends"},
                    largest_overlap);
            require_damping_mass(damping_mass, "HertzMindlin.damping_mass");
        }
        void visit(auto&& f) const {
            f("youngs", youngs, "Pa");
            f("poisson", poisson, "-");
            f("restitution", restitution, "-");
            f("friction", friction, "-");
            f("tension", tension ? 1 : 0, "-");
            f("spring_total", spring == Spring::total ? 1 : 0, "-");
            f("slider_springs", slider == Slider::springs ? 1 : 0, "-");
            f("youngs_other", youngs_other, "Pa");
            f("poisson_other", poisson_other, "-");
            f("largest_overlap", largest_overlap, "-");
            f("damping_mass_free", damping_mass == DampingMass::free ? 1 : 0, "-");
        }
    };

    template <class Number>
    struct Memory {
        Vec3Of<Number> spring = Vec3Of<Number>::Zero();  ///< f_t / k_t [m]
        Number stiffness = Number(0);                    ///< k_t when it was stored [N/m]
    };

    explicit HertzMindlin(Params params) : params_(params) {  // Params{...} alone tells a wrong name
        params_.validate();
        const auto pair =
            ElasticPair::of(params_.youngs, params_.poisson, params_.youngs_other, params_.poisson_other);
        effective_youngs_ = pair.youngs, effective_shear_ = pair.shear;
        damping_ratio_ = params_.tension ? damping_ratio_with_tension(params_.restitution)
                                         : damping_ratio_without_tension(params_.restitution);
        per_width_ = tangents(1);
        width_over_tangential_ = 1 / per_width_.tangential;
        tangential_over_normal_dashpot_ = std::sqrt(per_width_.tangential / per_width_.normal);
    }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    ContactResponse<Number, Memory<Number>> respond(const ContactKinematics<Number>& contact,
                                                    const Memory<Number>& memory) const noexcept {
        const auto touching = contact.overlap > Number(0);
        const Number least = Number(tiny<Number>), far = Number(std::numeric_limits<float>::max());
        const Number overlap = max(contact.overlap, Number(0));
        // The half width of the area of contact, sqrt(R delta), and one over it.
        const Number root = rsqrt(max(overlap * contact.curvature, least));
        const Number half_width = overlap * root, per_half_width = contact.curvature * root;
        const Number sn = Number(per_width_.normal) * half_width,
                     kt = Number(per_width_.tangential) * half_width,
                     compliance = Number(width_over_tangential_) * per_half_width;

        const Number approach = -contact.velocity.dot(contact.normal);
        const Vec3Of<Number> slip = contact.velocity + approach * contact.normal;
        const Number begun = begun_share(select(touching, contact.overlap, far), approach, contact.time_step);
        const Number acting = select(begun < Number(1), Number(0.5) + begun, Number(1));
        // 2 sqrt(5/6) zeta sqrt(S_n m); S_t differs from S_n by a constant.
        const Number dashpot =
            acting * Number(2 * per_width_.damping_ratio) * sn * rsqrt(max(sn * contact.inverse_mass, least));

        const Number push = Number(2.0 / 3) * sn * overlap, held = Number(0.4) * push * overlap;
        const auto normal =
            params_.tension ? NormalSpring<Number>::pulling(push, held, dashpot, approach, contact.time_step)
                            : NormalSpring<Number>::pushing(push, held, dashpot, approach, contact.time_step);

        const bool total = params_.spring == Spring::total, by_springs = params_.slider == Slider::springs;
        const auto stiffness = total ? FollowingStiffness<Number>::constant(kt)
                                     : FollowingStiffness<Number>::of(memory.stiffness, kt, compliance);
        const Vec3Of<Number> before =
            turn_into_plane(memory.spring, contact.normal, Number(1) - stiffness.grown);
        const Vec3Of<Number> tangential_displacement =
            contact.displacement - contact.displacement.dot(contact.normal) * contact.normal;
        const Vec3Of<Number> trial = before + (stiffness.mean * begun) * tangential_displacement;
        const Number limit = select(
            touching, Number(params_.friction) * (by_springs ? push : max(normal.force, Number(0))), far);
        const Number beside = dashpot * Number(tangential_over_normal_dashpot_);
        auto tangential = SlidingSpring<Number>::at(before, trial, slip, limit, kt,
                                                    by_springs ? Number(0) : beside, contact.time_step);
        if (by_springs) {
            const Number damping = select(kt * kt * trial.dot(trial) <= limit * limit, beside, Number(0));
            tangential.force -= damping * slip;
            tangential.lost += damping * slip.dot(slip) * Number(contact.time_step);
        }

        const Number length2 = memory.spring.dot(memory.spring);
        const Number given_up =
            stiffness.given_up(length2, before, tangential.spring, tangential_displacement, begun);
        const Number held_before = Number(0.5) * memory.stiffness * length2;
        const Vec3Of<Number> none = Vec3Of<Number>::Zero();
        const Vec3Of<Number> force = normal.force * contact.normal + tangential.force;
        return {
            {select(touching, force, none), select(touching, normal.stored + tangential.stored, Number(0)),
             select(touching, normal.lost, Number(0)),
             select(touching, max(tangential.lost + given_up, Number(0)), held_before)},
            {select(touching, tangential.spring, none), select(touching, kt, Number(0))}};
    }

    Real effective_youngs() const noexcept { return effective_youngs_; }  ///< E* [Pa]
    Real effective_shear() const noexcept { return effective_shear_; }    ///< G* [Pa]
    Real damping_ratio() const noexcept { return damping_ratio_; }
    bool damps_free_mass() const noexcept { return params_.damping_mass == DampingMass::free; }
    /// Of a normal impact: the same at any speed [m/s], effective mass [kg] and effective radius [m].
    Real restitution(Real /*speed*/, Real /*mass*/, Real /*radius*/) const noexcept {
        return params_.restitution;
    }
    /// Secant, f_n / delta = 4/3 E* sqrt(R delta) [N/m].
    template <class Number>
    Number normal_stiffness(Number overlap, Number curvature) const noexcept {
        return Number(4.0 / 3 * effective_youngs_) * sqrt(max(overlap, Number(0)) / curvature);
    }

    /// Tangents of the force at the largest overlap, against an equal sphere; without friction nothing acts
    /// across the normal.
    ContactRigidity rigidity(Real radius) const noexcept {
        return of_friction(tangents(radius * std::sqrt(0.5 * params_.largest_overlap)));
    }
    /// The same of a contact as it stands.
    ContactRigidity rigidity(const ContactKinematics<Real>& contact) const noexcept {
        return of_friction(tangents(std::sqrt(std::max(contact.overlap, 0.0) / contact.curvature)));
    }
    Real stable_dt(Real mass, Real radius) const noexcept {
        return stable_dt_among_twelve(tangents(radius * std::sqrt(0.5 * params_.largest_overlap)), mass);
    }

private:
    /// Where the area of contact has this half width [m].
    ContactRigidity tangents(Real half_width) const noexcept {
        return {2 * effective_youngs_ * half_width, 8 * effective_shear_ * half_width,
                std::sqrt(5.0 / 6) * damping_ratio_};
    }
    ContactRigidity of_friction(ContactRigidity contact) const noexcept {
        if (params_.friction == 0) contact.tangential = 0;
        return contact;
    }

    Params params_;
    Real effective_youngs_ = 0, effective_shear_ = 0, damping_ratio_ = 0;
    ContactRigidity per_width_{};  ///< stiffnesses over the half width [N/m2]
    Real width_over_tangential_ = 0, tangential_over_normal_dashpot_ = 0;  ///< [m2/N], [-]
};

static_assert(ContactLaw<HertzMindlin> && MayDampFreeMass<HertzMindlin>);
static_assert(!ContactLaw<HertzMindlin::Params>);

}  // namespace abrade
