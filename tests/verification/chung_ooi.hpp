#pragma once
// Single impacts as Chung & Ooi's tests 4 to 8 throw them, and what their figures show of them.
// Y. C. Chung, J. Y. Ooi, Granular Matter 13 (2011) 643, doi:10.1007/s10035-011-0277-0. Parameters: dem01.

#include "reference_table.hpp"

#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/sim/simulation.hpp>

namespace chung_ooi {

using namespace abrade;

struct Material {
    Real youngs = 0, poisson = 0, density = 0;  ///< [Pa], [-], [kg/m3]
};
inline constexpr Material aluminium_oxide{3.8e11, 0.23, 4000}, aluminium_alloy{7e10, 0.33, 2700},
    steel{2.08e11, 0.3, 7850}, polyethylene{1e9, 0.4, 1400}, nylon{2.5e9, 0.4, 1000},
    copper{1.2e11, 0.35, 8900};

/// A sphere that comes down with `normal` and `tangential` speed [m/s], turning so that its rim moves with
/// `rim` [m/s] in the direction of the tangential speed where it touches.
struct Impact {
    Material material;
    Real radius = 0, normal = 0, tangential = 0, rim = 0;
    Real restitution = 1, friction = 0;
    Real youngs_other = 1e25;  ///< of what it hits [Pa]: rigid, unless it is said
};

/// The same speeds as it leaves; `patch` is that of the surface at the contact: tangential + rim.
struct Rebound {
    Real normal = 0, tangential = 0, rim = 0, patch = 0;
    Ledger ledger;
};

/// What a code does where Mindlin's theory leaves it a choice.
struct Form {
    HertzMindlin::Spring spring = HertzMindlin::Spring::incremental;
    HertzMindlin::Slider slider = HertzMindlin::Slider::whole_force;
    bool tension = false;

    HertzMindlin operator()(const Impact& t) const {
        return HertzMindlin{{.youngs = t.material.youngs,
                             .poisson = t.material.poisson,
                             .restitution = t.restitution,
                             .friction = t.friction,
                             .tension = tension,
                             .spring = spring,
                             .slider = slider,
                             .youngs_other = t.youngs_other,
                             .poisson_other = t.material.poisson,
                             // One contact, not twelve: stable at steps that `stable_dt` would not grant.
                             .largest_overlap = 1e-4}};
    }
};
inline constexpr Form own_form{}, total_form{.spring = HertzMindlin::Spring::total},
    springs_form{
        .spring = HertzMindlin::Spring::total, .slider = HertzMindlin::Slider::springs, .tension = true};

/// Forms of the law that the library does not offer, for they make energy or books a negative loss. They keep
/// no account of energy.
class OtherHertzMindlin {
public:
    static constexpr std::string_view name = "OtherHertzMindlin";
    enum class Spring { incremental, total, unscaled };  ///< unscaled: the force stays while k_t falls, too
    struct Params {
        HertzMindlin base;
        Spring spring = Spring::incremental;
        Real shear = 1;              ///< k_t over Mindlin's
        bool limit_by_push = false;  ///< mu times the normal spring's push, not times the whole normal force

        void validate() const { require_positive(shear, "OtherHertzMindlin.shear"); }
        void visit(auto&& f) const { f("shear", shear, "-"); }
    };
    template <class Number>
    using Memory = HertzMindlin::Memory<Number>;

    explicit OtherHertzMindlin(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }
    Real effective_youngs() const noexcept { return params_.base.effective_youngs(); }
    ContactRigidity rigidity(Real radius) const noexcept { return params_.base.rigidity(radius); }
    Real stable_dt(Real mass, Real radius) const noexcept { return params_.base.stable_dt(mass, radius); }

    ContactResponse<Real, Memory<Real>> respond(const ContactKinematics<Real>& c,
                                                const Memory<Real>& memory) const noexcept {
        if (c.overlap <= 0) return {{Vec3::Zero(), 0, 0, 0}, {}};
        const HertzMindlin& law = params_.base;
        const Real half_width = std::sqrt(c.overlap / c.curvature);
        const Real sn = 2 * law.effective_youngs() * half_width,
                   kt = params_.shear * 8 * law.effective_shear() * half_width;
        const Real approach = -c.velocity.dot(c.normal);
        const Vec3 slip = c.velocity + approach * c.normal;
        const Real begun = begun_share(c.overlap, approach, c.time_step);
        const Real root = (begun < 1 ? 0.5 + begun : 1) * 2 * std::sqrt(5.0 / 6) * law.damping_ratio() /
                          std::sqrt(c.inverse_mass);
        const Real push = 2.0 / 3 * sn * c.overlap, whole = push + root * std::sqrt(sn) * approach;
        const Real normal = law.params().tension ? whole : std::max(whole, 0.0);

        const Real softer = memory.stiffness / kt;
        const Real kept = params_.spring == Spring::total      ? 1
                          : params_.spring == Spring::unscaled ? softer
                                                               : std::min(1.0, softer);
        const Vec3 way = c.displacement - c.displacement.dot(c.normal) * c.normal;
        Vec3 spring = kept * turn_into_plane(memory.spring, c.normal) + begun * way;
        Vec3 force = -kt * spring - root * std::sqrt(kt) * slip;
        const Real limit = law.params().friction * (params_.limit_by_push ? push : normal);
        // A sliding spring takes the whole limit, even where the dashpot had a part of it.
        if (force.norm() > limit) {
            force *= limit / force.norm();
            spring = -force / kt;
        }
        return {{normal * c.normal + force, 0, 0, 0}, {spring, kt}};
    }

private:
    Params params_;
};
static_assert(ContactLaw<OtherHertzMindlin>);

/// Makes `OtherHertzMindlin` for an impact.
struct OtherForm {
    OtherHertzMindlin::Spring spring = OtherHertzMindlin::Spring::incremental;
    Real shear = 1;
    bool limit_by_push = false, tension = false;

    OtherHertzMindlin operator()(const Impact& t) const {
        return OtherHertzMindlin{{Form{.tension = tension}(t), spring, shear, limit_by_push}};
    }
};

/// Hertz' time of contact of an elastic impact [s].
inline Real contact_time(Real speed, Real youngs, Real radius, Real mass) {
    return 2.943275 / speed * std::pow(15 * mass * square(speed) / (16 * youngs * std::sqrt(radius)), 0.4);
}

inline Real sphere_mass(Real radius, Real density) { return density * 4 / 3 * pi * cube(radius); }

inline Scene empty_scene() {
    Scene scene;
    scene.gravity.setZero();
    return scene;
}

/// Adds the sphere of an impact, half a step before it touches at height `floor`.
inline void add(Scene& scene, const Impact& t, Real floor, Real dt) {
    scene.add_sphere(t.radius,
                     {.position = {0, 0, floor + t.radius + 0.5 * dt * t.normal},
                      .velocity = {t.tangential, 0, -t.normal},
                      .angular_velocity = {0, -t.rim / t.radius, 0}},
                     t.material.density);
}

template <class Sim>
Rebound rebound_of(const Sim& sim, const Impact& t) {
    const Particles& p = sim.particles();
    const Vec3 v = p.velocity[0];
    const Real rim = -p.angular_velocity(0).y() * t.radius;
    if (!(v.z() > 0)) throw std::runtime_error("the sphere has not left");
    return {v.z(), v.x(), rim, v.x() + rim, sim.ledger()};
}

/// On a plane, with `steps` steps a contact.
template <class MakeLaw>
Rebound off_plane(const Impact& t, const MakeLaw& make_law, Real steps) {
    const auto law = make_law(t);
    const Real time =
        contact_time(t.normal, law.effective_youngs(), t.radius, sphere_mass(t.radius, t.material.density));
    Scene scene = empty_scene();
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    add(scene, t, 0, time / steps);
    auto sim = simulate(std::move(scene)).contact(law);
    sim.run({.end_time = 3 * time, .time_step = time / steps});
    return rebound_of(sim, t);
}

/// Of two bodies, about the origin.
struct Momenta {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();

    explicit Momenta(const Particles& p) {
        for (std::size_t b = 0; b < 2; ++b) {
            linear += p.mass[b] * p.velocity[b];
            angular += p.mass[b] * p.position[b].cross(p.velocity[b]) + p.angular_momentum[b];
        }
    }
};

/// Test 8: on a sphere at rest, of five times the radius and a thousand times the density. `check` is called
/// with the momenta before and after.
template <class MakeLaw, class Check>
Rebound off_sphere(const Impact& t, const MakeLaw& make_law, Real steps, Check&& check) {
    const auto law = make_law(t);
    const Real time = contact_time(t.normal, law.effective_youngs(), t.radius * 5 / 6,
                                   sphere_mass(t.radius, t.material.density));
    Scene scene = empty_scene();
    add(scene, t, 5 * t.radius, time / steps);
    scene.add_sphere(5 * t.radius, {}, 1000 * t.material.density);
    auto sim = simulate(std::move(scene)).contact(law);
    sim.run({.end_time = 0});
    const Momenta before(sim.particles());
    sim.run({.end_time = 3 * time, .time_step = time / steps});
    check(before, Momenta(sim.particles()));
    return rebound_of(sim, t);
}

// --- one point of a figure: the impact behind it, and what it plots -------------------------------------

inline Impact impact_4(Material material, Real degrees_from_normal) {
    return {.material = material,
            .radius = 0.0025,
            .normal = 3.9 * std::cos(radians(degrees_from_normal)),
            .tangential = 3.9 * std::sin(radians(degrees_from_normal)),
            .restitution = 0.98,
            .friction = 0.092};
}
/// Tangential restitution; angular velocity [rad/s]; angle of the patch's velocity from the normal [degrees].
inline Real figure_4(const std::string& quantity, const Impact& t, const Rebound& r) {
    return quantity == "tangential_restitution"   ? r.tangential / t.tangential
           : quantity == "angular_velocity_rad_s" ? -r.rim / t.radius
                                                  : std::atan(r.patch / r.normal) * 180 / pi;
}

inline Impact impact_5(Material material, Real x) {
    return {.material = material, .radius = 1e-5, .normal = 5, .tangential = x * 0.3 * 5, .friction = 0.3};
}
/// V_st' / (mu V_cn') and R w' / (mu V_cn), over x = V_t / (mu V_n).
inline Real figure_5(const std::string& quantity, const Impact& t, const Rebound& r) {
    return (quantity.starts_with("recoil") ? r.patch / r.normal : r.rim / t.normal) / t.friction;
}

/// Tests 6 and 8: beta over x = 3.5 mu (1 + e) V_n / V_st; recoil over x = V_st / V_n.
inline Impact impact_6(Material material, const std::string& quantity, Real x) {
    const Real mu = 0.4, e = 0.5, vn = 0.2;
    return {.material = material,
            .radius = 0.1,
            .normal = vn,
            .rim = quantity.starts_with("beta") ? 3.5 * mu * (1 + e) * vn / x : x * vn,
            .restitution = e,
            .friction = mu};
}
/// beta = -V_st' / V_st; recoil = V_st' / V_cn'.
inline Real figure_6(const std::string& quantity, const Impact& t, const Rebound& r) {
    return quantity.starts_with("beta") ? -r.patch / t.rim : r.patch / r.normal;
}
/// Both where the contact slides throughout: beyond V_st / V_n = 3.5 mu (1 + e).
inline Real sliding_6(const std::string& quantity, const Impact& t) {
    const Real slowed = 3.5 * t.friction * (1 + t.restitution) * t.normal;
    return quantity.starts_with("beta") ? slowed / t.rim - 1 : (t.rim - slowed) / (t.restitution * t.normal);
}
inline bool slides_throughout_6(const Impact& t) {
    return t.rim > 1.01 * 3.5 * t.friction * (1 + t.restitution) * t.normal;
}

/// C. Thornton, S. Cummins, P. Cleary, Powder Technol. 233 (2013) 30, doi:10.1016/j.powtec.2012.08.012.
inline Impact impact_thornton(Real psi, Real restitution) {
    const Real speed = 5, mu = 0.1;
    return {.material = {7e10, 0.3, 2650},
            .radius = 0.025,
            .normal = speed,
            .tangential = 0.5 * psi * mu * (1 + restitution) * speed,
            .restitution = restitution,
            .friction = mu,
            .youngs_other = 7e10};
}
/// 2 V_st' and 2 R w', in units of mu (1 + e) V_n; psi is 2 V_t in that unit.
inline Real figure_thornton(const std::string& quantity, const Impact& t, const Rebound& r) {
    return 2 * (quantity == "patch" ? r.patch : r.rim) / (t.friction * (1 + t.restitution) * t.normal);
}

}  // namespace chung_ooi
