#pragma once
// The liquid between two surfaces that are nearer to each other than a flow's cells know of.

#include <abrade/dem/laws/contact_law.hpp>

#include <algorithm>
#include <cmath>

namespace abrade {

/// A contact law in a liquid. Before surfaces touch, and after they have parted, the film between them
/// resists at gaps h below a range h_c.
///   F = 6 pi mu R^2 (1/max(h, h_r) - 1/h_c) v,  0 < h < h_c
/// h gap, h_r roughness, h_c range [m]
/// R effective radius [m], m_eff effective mass [kg], v speed of approach [m/s], mu dynamic viscosity [Pa s]
/// Validity: the leading term of the resistance, less what is left of it at h_c. A flow on a grid that
/// resolves the bodies has the film down to about a cell itself, so h_c is a cell; where no flow resolves
/// them, h_c is some radii.
/// Throws InputError for parameters out of their range, those of the law included.
/// Source: H. Brenner, Chem. Eng. Sci. 16 (1961) 242, doi:10.1016/0009-2509(61)80035-3.
///
/// Surfaces that overlap are dry, but for the mean: the mean of 1/h over the way of a step counts, half of it
/// to either side, so a film that is crossed within a step takes what it takes in many: on an overlap of less
/// than half that way the film acts in part. Along one normal v loses in a step x v / (1 + x/2 + x^2), x = F
/// dt / (m_eff v): stable with neighbours all around, exact to second order; where x nears 1 a step is too
/// long for the film.
///
/// The film is there wherever the law is asked, above a surface of water, too. Its loss is of its own kind,
/// `lost_film`, and observers see the contact's force without the film's: it wears nothing. Contacts are
/// answered one by one, not in packs.
/// `Lubricated<RollingResistance<L>>` adds both; `RollingResistance<Lubricated<L>>` does not compile, for
/// this law offers no `normal_stiffness`.
template <ContactLaw Law>
class Lubricated {
public:
    static constexpr std::string_view name = "Lubricated";
    static constexpr bool resists_rolling = ResistsRolling<Law>;

    struct Params {
        typename Law::Params contact{};  ///< of the law of surfaces that touch
        Real viscosity = 0;              ///< mu, dynamic [Pa s]
        Real range = 0;                  ///< h_c [m]
        Real roughness = 0;              ///< h_r [m]

        void validate() const {
            contact.validate();
            require_positive(viscosity, "Lubricated.viscosity", "Pa s", "water at 10 degrees C has 1.31e-3");
            require_positive(range, "Lubricated.range", "m",
                             "a cell of the grid that resolves the bodies, or some of their radii");
            require(roughness > 0 && roughness <= range,
                    {"Lubricated.roughness", "in (0, range]", "m",
                     "polished spheres have 1e-4 of their radius, stones 1e-2"},
                    roughness);
        }
        void visit(auto&& f) const {
            contact.visit(f);
            f("film_viscosity", viscosity, "Pa s"), f("film_range", range, "m");
            f("film_roughness", roughness, "m");
        }
    };

    template <class Number>
    using Memory = typename Law::template Memory<Number>;

    explicit Lubricated(Params params) : params_(params), law_(params.contact) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    ContactResponse<Real, Memory<Real>> respond(const ContactKinematics<Real>& contact,
                                                const Memory<Real>& memory) const noexcept {
        auto answer = law_.respond(contact, memory);
        const Real approach = -contact.velocity.dot(contact.normal), dt = contact.time_step;
        // Of the way in the step; no shorter than rounding lets tell.
        const Real half =
            std::max(0.5 * std::abs(approach) * dt, 1e-6 * std::max(-contact.overlap, params_.roughness));
        const Real per_gap = (taken(half - contact.overlap) - taken(-half - contact.overlap)) / (2 * half);
        const Real rate = 6 * pi * params_.viscosity / square(contact.curvature) * per_gap;
        const Real x = rate * contact.inverse_mass * dt;
        const Real force = rate * approach / (1 + 0.5 * x + x * x);
        answer.load.film = force * contact.normal;
        answer.load.force += answer.load.film;
        answer.load.lost_film = force * (approach - 0.5 * force * contact.inverse_mass * dt) * dt;
        return answer;
    }

    Real range() const noexcept { return params_.range; }
    bool damps_free_mass() const noexcept requires MayDampFreeMass<Law> { return law_.damps_free_mass(); }
    Real restitution(Real speed, Real mass, Real radius) const noexcept requires requires(const Law& law) {
        law.restitution(Real{}, Real{}, Real{});
    }
    { return law_.restitution(speed, mass, radius); }
    ContactRigidity rigidity(Real radius) const noexcept { return law_.rigidity(radius); }
    ContactRigidity rigidity(const ContactKinematics<Real>& contact) const noexcept requires
        KnowsRigidityAsItStands<Law> {
        return law_.rigidity(contact);
    }
    Real stable_dt(Real mass, Real radius) const noexcept { return law_.stable_dt(mass, radius); }

private:
    /// Integral of 1/max(h, h_r) - 1/h_c from 0 to a gap [-].
    Real taken(Real gap) const noexcept {
        const Real within = std::clamp(gap, Real(0), params_.range), over = within / params_.roughness;
        return (over < 1 ? over : 1 + std::log(over)) - within / params_.range;
    }

    Params params_;
    Law law_;
};

}  // namespace abrade
