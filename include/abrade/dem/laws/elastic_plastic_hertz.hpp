#pragma once
// The elastic-plastic contact: Hertz until a material yields, then a restitution that falls with speed.

#include <abrade/dem/laws/contact_law.hpp>
#include <abrade/dem/laws/damping.hpp>
#include <abrade/dem/laws/elastic_pair.hpp>

namespace abrade {

/// Elastic, perfectly plastic spheres without adhesion, and Coulomb's slider. While the overlap delta is the
/// largest so far, delta_m:
///   f = 4/3 E* sqrt(R) delta^(3/2)                 up to delta_y = (pi p_y / 2 E*)^2 R
///   f = f_y + pi R p_y (delta - delta_y)           beyond, f_y the force at delta_y
/// Below delta_m, from f_m, the force there, along Hertz' line of a flatter contact:
///   f = f_m z^(3/2),  z = (delta - delta_p) / (delta_m - delta_p),  stored 2/5 f (delta - delta_p)
///   delta_p = (1 - f_m / f_e) delta_m,  f_e = 4/3 E* sqrt(R) delta_m^(3/2)
/// which is Hertz' force for the radius R_p = R f_e / f_m: the area of contact, pi a^2 = pi R delta_m z, does
/// not jump as unloading begins.
///   f_t = -k_t s - c_t v_t,  |f_t| <= mu f,  k_t = 8 G* a,  c_t = 2 zeta sqrt(k_t m)
/// f normal force [N]
/// delta, delta_y, delta_p overlap, at first yield, at which unloading ends (depth of the dent) [m]
/// R effective radius [m]
/// E*, G* effective moduli of the pair (ElasticPair) [Pa]
/// p_y yield pressure, that in the middle of the contact at first yield [Pa]
/// a half width of the contact [m]
/// s tangential spring [m], v_t slip velocity [m/s], k_t its stiffness [N/m]; it follows k_t as
/// HertzMindlin's incremental one does
/// mu friction [-], m effective mass [kg], zeta damping ratio for rest [-]
/// Validity: delta far below R, stones harder than what yields. A contact that opens loses its dent; one that
/// is found pressed, at the start of a run or as a bond breaks, has its dent from before.
/// Throws InputError for parameters out of their range.
/// Source: C. Thornton, Z. Ning, Powder Technol. 99 (1998) 154, doi:10.1016/S0032-5910(98)00099-0.
///
/// What the dent cost is lost while delta_m grows; a dashpot for rest acts while a contact is loaded again
/// (Reloading), so that an impact never meets it. A normal impact at speed v [m/s] loses nothing up to the
/// yield speed v_y; beyond it, with r = v_y / v,
///   v_y = (pi / 2 E*)^2 sqrt(8 pi R^3 / 15 m) p_y^(5/2)
///   e = sqrt(6 sqrt(3) / 5) sqrt(1 - r^2 / 6) (r / (r + 2 sqrt(6/5 - r^2 / 5)))^(1/4)
/// or e = 1.185 r^(1/4) far above it.
///
/// p_y is no property of concrete that handbooks list: for ductile materials it is 1.6 (first yield) to 3
/// times (fully plastic) the yield stress (K. L. Johnson, Contact Mechanics, 1985,
/// doi:10.1017/CBO9781139171731, 6.2 and 6.3); for concrete fit it to a measured restitution.
///
/// `softening` s divides the stiffness of the run, not the restitution: E* and G* are taken s-fold and p_y
/// s^(4/5)-fold, which keeps v_y and with it e at every speed.
///
/// `flat_radius`: concrete is made of spheres, but its surface is flat. Where contacts of this law have the
/// curvature of a sphere of that radius in them, it is taken out: 1/R = 1/r_i + 1/r_j - 1/flat_radius. Of two
/// concrete spheres one then counts as flat. Contacts that are less curved than such a sphere are with planes
/// and stay as they are. A contact does not say what its two are, so other pairs need a law without
/// `flat_radius`, in a table by materials (MaterialPairs): stones with each other, and planes that spheres
/// smaller than the concrete's may touch.
class ElasticPlasticHertz {
public:
    static constexpr std::string_view name = "ElasticPlasticHertz";

    struct Params {
        Real youngs = 0;          ///< E of the one that yields [Pa]
        Real poisson = 0.25;      ///< nu, in (-1, 0.5] [-]
        Real yield_pressure = 0;  ///< p_y [Pa]
        Real friction = 0;        ///< mu [-]
        Real youngs_other = 0;    ///< E of the other partner [Pa]; 0: the same material
        Real poisson_other = 0.25;
        Real softening = 1;        ///< s, share of the moduli that the run has, in (0, 1] [-]
        Real flat_radius = 0;      ///< of the spheres that count as flat [m]; 0: none
        Real rest_damping = 0.02;  ///< zeta of loading again and of the tangential spring [-]
        /// Overlap over radius up to which `stable_dt` is stable [-]. Contacts stiffen as they are pressed.
        Real largest_overlap = 0.01;

        void validate() const {
            require_positive(youngs, "ElasticPlasticHertz.youngs", "Pa",
                             "give that of the material; softening makes the run's softer");
            require_in_pascal(youngs, "ElasticPlasticHertz.youngs");
            require_poisson(poisson, "ElasticPlasticHertz.poisson");
            require_positive(yield_pressure, "ElasticPlasticHertz.yield_pressure", "Pa",
                             "fit it to a measured restitution");
            require_not_negative(friction, "ElasticPlasticHertz.friction", "", "0 slides freely");
            require_not_negative(youngs_other, "ElasticPlasticHertz.youngs_other", "Pa",
                                 "0 means the same material");
            require_poisson(poisson_other, "ElasticPlasticHertz.poisson_other");
            require(softening > 0 && softening <= 1,
                    {"ElasticPlasticHertz.softening", "in (0, 1]", "",
                     "1 takes the moduli as they are, 0.01 a hundredth"},
                    softening);
            require_not_negative(flat_radius, "ElasticPlasticHertz.flat_radius", "m",
                                 "0 takes all curvatures as they are");
            require_rest_damping(rest_damping, "ElasticPlasticHertz.rest_damping");
            require(largest_overlap > 0 && largest_overlap <= 0.2,
                    {"ElasticPlasticHertz.largest_overlap", "in (0, 0.2]", "",
                     "it is a share of the radius; beyond 0.2 a run ends"},
                    largest_overlap);
        }
        void visit(auto&& f) const {
            f("youngs", youngs, "Pa");
            f("poisson", poisson, "-");
            f("yield_pressure", yield_pressure, "Pa");
            f("friction", friction, "-");
            f("youngs_other", youngs_other, "Pa");
            f("poisson_other", poisson_other, "-");
            f("softening", softening, "-");
            f("flat_radius", flat_radius, "m");
            f("rest_damping", rest_damping, "-");
            f("largest_overlap", largest_overlap, "-");
        }
    };

    template <class Number>
    struct Memory {
        Vec3Of<Number> spring = Vec3Of<Number>::Zero();  ///< f_t / k_t [m]
        Number stiffness = Number(0);                    ///< k_t when it was stored [N/m]
        Number deepest = Number(0);                      ///< delta_m [m]
    };

    explicit ElasticPlasticHertz(Params params) : params_(params) {  // Params{...} alone tells a wrong name
        params_.validate();
        const auto pair =
            ElasticPair::of(params_.youngs, params_.poisson, params_.youngs_other, params_.poisson_other);
        effective_youngs_ = params_.softening * pair.youngs;
        effective_shear_ = params_.softening * pair.shear;
        yield_pressure_ = std::pow(params_.softening, 0.8) * params_.yield_pressure;
        flat_curvature_ = params_.flat_radius > 0 ? 1 / params_.flat_radius : 0;
        // A root more or less of round-off must not turn a plane into a sphere on a flat one.
        least_curved_ =
            params_.flat_radius > 0 ? flat_curvature_ * (1 + 1e-9) : std::numeric_limits<float>::max();
        root_yield_strain_ = 0.5 * pi * yield_pressure_ / effective_youngs_;
        yield_strain_ = square(root_yield_strain_);
        yield_force_ = 4.0 / 3 * effective_youngs_ * cube(root_yield_strain_);
        per_yield_strain_ = 1 / yield_strain_;
        dashpot_normal_ = 2 * params_.rest_damping * std::sqrt(2 * effective_youngs_);
        tangential_over_normal_dashpot_ = std::sqrt(4 * effective_shear_ / effective_youngs_);
    }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    ContactResponse<Number, Memory<Number>> respond(const ContactKinematics<Number>& contact,
                                                    const Memory<Number>& memory) const noexcept {
        const auto touching = contact.overlap > Number(0);
        const Number nothing(0), least = Number(tiny<Number>),
                                 far = Number(std::numeric_limits<float>::max());
        const Number approach = -contact.velocity.dot(contact.normal);
        const Vec3Of<Number> slip = contact.velocity + approach * contact.normal;

        const Number curvature = curvature_of(contact.curvature), radius = reciprocal(curvature);
        const Number overlap = max(contact.overlap, nothing), deepest = max(memory.deepest, overlap);
        const Number per_yield_overlap = Number(per_yield_strain_) * curvature;

        // x = delta_m / delta_y; yielded = f_m / f_e.
        const Number x = deepest * per_yield_overlap, per_root = rsqrt(max(x, least)), root = x * per_root;
        const Number yielded =
            select(x > Number(1), per_root * (Number(1.5) - Number(0.5) * per_root * per_root), Number(1));
        const Number recovered = deepest * yielded;  // delta_m - delta_p
        const Number share = max(Number(1) - (deepest - overlap) / max(recovered, least), nothing);
        const Number root_share = sqrt(share);
        const Number loading = Number(yield_force_) * radius * radius * (x * root * yielded);
        const Number push = loading * (share * root_share);
        const Number half_width = Number(root_yield_strain_) * radius * root * root_share;

        const Number root_mass = rsqrt(max(contact.inverse_mass, least));
        const Number dashpot = Number(dashpot_normal_) * sqrt(half_width) * root_mass;
        const auto normal = Reloading<Number>::at(push, loading, dashpot, approach, contact.time_step);
        // Most contacts of a bed yield no further: two roots and a division less.
        const Number pressed = pressed_before(contact, memory.deepest);
        Number dented = nothing;
        if (const auto yields = (deepest > pressed) & (x > Number(1)); any(yields)) {
            const Number unit = Number(yield_force_ * yield_strain_) * radius * radius * radius;
            const Number from = max(pressed * per_yield_overlap, Number(1));
            dented = select(yields, unit * dent(from, max(x, Number(1))), nothing);
        }

        const Number begun = begun_share(select(touching, contact.overlap, far), approach, contact.time_step);
        const Number acting = select(begun < Number(1), Number(0.5) + begun, Number(1));
        const Number kt = max(Number(8 * effective_shear_) * half_width, least);
        const auto stiffness = FollowingStiffness<Number>::of(memory.stiffness, kt, Number(1) / kt);
        const Vec3Of<Number> before =
            turn_into_plane(memory.spring, contact.normal, Number(1) - stiffness.grown);
        const Vec3Of<Number> tangential_displacement =
            contact.displacement - contact.displacement.dot(contact.normal) * contact.normal;
        const Number limit = select(touching, Number(params_.friction) * normal.force, far);
        const auto tangential = SlidingSpring<Number>::at(
            before, before + (stiffness.mean * begun) * tangential_displacement, slip, limit, kt,
            (acting * dashpot) * Number(tangential_over_normal_dashpot_), contact.time_step);

        const Number length2 = memory.spring.dot(memory.spring);
        const Number given_up =
            stiffness.given_up(length2, before, tangential.spring, tangential_displacement, begun);
        const Number held_before = Number(0.5) * memory.stiffness * length2;
        const Number stored = Number(0.4) * push * (recovered * share);
        const Vec3Of<Number> none = Vec3Of<Number>::Zero();
        const Vec3Of<Number> force = normal.force * contact.normal + tangential.force;
        return {{select(touching, force, none), select(touching, stored + tangential.stored, nothing),
                 select(touching, dented + normal.lost, nothing),
                 select(touching, max(tangential.lost + given_up, nothing), held_before)},
                {select(touching, tangential.spring, none), select(touching, kt, nothing),
                 select(touching, deepest, nothing)}};
    }

    Real effective_youngs() const noexcept { return effective_youngs_; }  ///< s E* [Pa]
    Real effective_shear() const noexcept { return effective_shear_; }    ///< s G* [Pa]
    Real yield_pressure() const noexcept { return yield_pressure_; }      ///< s^(4/5) p_y [Pa]
    /// delta_y [m] for an effective radius [m].
    Real yield_overlap(Real radius) const noexcept { return yield_strain_ * radius; }

    /// v_y [m/s] for an effective mass [kg] and effective radius [m].
    Real yield_speed(Real mass, Real radius) const noexcept {
        // 1/2 m v_y^2 = 2/5 f_y delta_y.
        return std::sqrt(0.8 * yield_force_ * yield_strain_ * cube(radius) / mass);
    }
    /// Of a normal impact at that speed [m/s], for an effective mass [kg] and effective radius [m].
    Real restitution(Real speed, Real mass, Real radius) const noexcept {
        const Real r = yield_speed(mass, radius) / speed;
        if (!(r < 1)) return 1;
        return std::sqrt(std::sqrt(27.0) * 0.4 * (1 - square(r) / 6) *
                         std::sqrt(r / (r + 2 * std::sqrt(1.2 - 0.2 * square(r)))));
    }
    /// Of Hertz' line, f / delta = 4/3 E* sqrt(R delta) [N/m].
    template <class Number>
    Number normal_stiffness(Number overlap, Number curvature) const noexcept {
        return Number(4.0 / 3 * effective_youngs_) * sqrt(max(overlap, Number(0)) / curvature_of(curvature));
    }

    /// Tangents at the largest overlap, against a plane; without friction nothing acts across the normal.
    /// Hertz' line bounds them: unloading has its tangent where it begins, and is softer from there.
    ContactRigidity rigidity(Real radius) const noexcept {
        return of_friction(tangents(radius * std::sqrt(params_.largest_overlap)));
    }
    /// The same of a contact as it stands.
    ContactRigidity rigidity(const ContactKinematics<Real>& contact) const noexcept {
        return of_friction(
            tangents(std::sqrt(std::max(contact.overlap, 0.0) / curvature_of(contact.curvature))));
    }
    Real stable_dt(Real mass, Real radius) const noexcept {
        return stable_dt_among_twelve(tangents(radius * std::sqrt(params_.largest_overlap)), mass);
    }

private:
    /// Without that of the partner that counts as flat [1/m].
    template <class Number>
    Number curvature_of(Number curvature) const noexcept {
        return select(curvature > Number(least_curved_), curvature - Number(flat_curvature_), curvature);
    }
    /// What a dent takes as delta_m / delta_y grows from a to b, both >= 1, over f_y delta_y:
    ///   3/4 b^2 - 1/2 b + 3/20 - (3 b - 1)^2 / (10 sqrt(b)), less the same of a,
    /// work less stored energy. Written with the difference of the roots as a factor, so that small growth
    /// does not drown in round-off.
    template <class Number>
    static Number dent(Number from, Number to) noexcept {
        const Number a = sqrt(from), b = sqrt(to), both = a + b, squares = a * a + b * b;
        const Number slope = Number(0.75) * both * squares - Number(0.9) * (squares + a * b) -
                             Number(0.5) * both + Number(0.6) + Number(0.1) / (a * b);
        return max((b - a) * slope, Number(0));
    }
    /// Where the area of contact has this half width [m].
    ContactRigidity tangents(Real half_width) const noexcept {
        return {2 * effective_youngs_ * half_width, 8 * effective_shear_ * half_width, params_.rest_damping};
    }
    ContactRigidity of_friction(ContactRigidity contact) const noexcept {
        if (params_.friction == 0) contact.tangential = 0;
        return contact;
    }

    Params params_;
    Real effective_youngs_ = 0, effective_shear_ = 0, yield_pressure_ = 0;  ///< of the run [Pa]
    Real flat_curvature_ = 0, least_curved_ = 0;                            ///< [1/m]
    /// delta_y / R [-], its root and inverse.
    Real yield_strain_ = 0, root_yield_strain_ = 0, per_yield_strain_ = 0;
    Real yield_force_ = 0;     ///< f_y / R^2 [Pa]
    Real dashpot_normal_ = 0;  ///< 2 zeta sqrt(2 E*); times sqrt(a m) [Pa^(1/2)]
    Real tangential_over_normal_dashpot_ = 0;
};

static_assert(ContactLaw<ElasticPlasticHertz>);
static_assert(!ContactLaw<ElasticPlasticHertz::Params>);

}  // namespace abrade
