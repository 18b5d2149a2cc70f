#pragma once
// Scenes of the wear tests and charts: concrete that is one great sphere, as flat as a plane where it is hit,
// and a wear law that keeps a record of the contact instead of wearing it.

#include "../../examples/common/chosen_wear.hpp"

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/sim/simulation.hpp>

#include <utility>
#include <vector>

namespace abrade::verification {

/// Rigid concrete of one sphere [m] with its top at the origin, so much of it that it never wears through.
inline ConcreteBlock flat_concrete(Real radius) {
    const LatticeSite site{.centre = {0, 0, -radius}, .cell_volume = 1};
    const Lattice ground{radius, 1, 1, 1, {site}, {1}};
    return {.lattice = ground};
}

using examples::ChosenWear;

/// A sphere that is thrown at that concrete, without gravity, and touches when the share `phase` of a step is
/// over.
struct Throw {
    Real radius = 5e-3, mass = 1e-3;  ///< [m], [kg]
    Real along = 1, across = 0;       ///< speeds: at the concrete, past it [m/s]
    Real stiffness = 1e7;             ///< [N/m]
    Real restitution = 0.6, friction = 0.3;
    Real steps = 50;  ///< a contact lasts, undamped
    Real phase = 0.5;
    Real ground = 100;  ///< radius of the concrete: it falls off by far less than an overlap [m]

    Real contact_time() const { return pi * std::sqrt(mass / stiffness); }
    Real time_step() const { return contact_time() / steps; }
    LinearSpring law() const {
        return LinearSpring{{.stiffness = stiffness, .restitution = restitution, .friction = friction}};
    }
    Scene scene() const {
        Scene scene;
        scene.gravity.setZero();
        scene.concrete = flat_concrete(ground);
        const Real before = (1 + phase) * time_step();
        scene.add_sphere(
            radius,
            {.position = {-before * across, 0, radius + before * along}, .velocity = {across, 0, -along}},
            mass / (4.0 / 3 * pi * cube(radius)));
        return scene;
    }
};

/// After the sphere has left again.
template <WearLaw Wear>
auto thrown(const Throw& impact, const Wear& wear) {
    auto sim = simulate(impact.scene()).contact(impact.law()).wear(wear);
    sim.run(
        {.end_time = 2 * impact.contact_time() + 4 * impact.time_step(), .time_step = impact.time_step()});
    return sim;
}
inline Real worn_by(const Throw& impact, const ChosenWear& wear) {
    return thrown(impact, wear).concrete().worn_volume();
}

/// What may be booked of the energy dE = f . (v_j - v_i) dt that flows into a contact [J].
struct Bookings {
    Real running = 0;     ///< as it flows: negative while strain energy comes back
    Real never_back = 0;  ///< as it flows, but for what is negative
    Real at_end = 0;      ///< over each contact when it opens; nothing of those still closed
    Real still_owed = 0;  ///< over the contacts still closed
    Real dissipated = 0;  ///< what dashpot and slider took
};

/// Adds up the bookings of all contacts of one stone. The work over a step is that of the mean force before
/// and after it over the way really travelled, which is what leapfrog's kicks do. Contacts are told apart by
/// their normals, which turn by far less in a step than those of two contacts differ.
class BookingRecord {
public:
    void see(const ContactKinematics<Real>& contact, const ContactLoad<Real>& load) {
        const bool touches = contact.overlap > 0;
        auto open = open_.begin();
        while (open != open_.end() && !(open->normal.dot(contact.normal) > 0.95)) ++open;
        if (open == open_.end()) {
            if (!touches) return;
            open_.push_back({contact.normal, Vec3::Zero(), 0});
            open = open_.end() - 1;
        }
        const Real flows = -0.5 * (open->force + load.force).dot(contact.displacement);
        open->owed += flows, open->force = load.force, open->normal = contact.normal;
        sums_.running += flows;
        sums_.never_back += std::max(flows, 0.0);
        sums_.dissipated += load.lost_normal + load.lost_tangential;
        if (touches) return;
        sums_.at_end += std::max(open->owed, 0.0);
        ++contacts_;
        open_.erase(open);
    }
    Bookings sums() const {
        Bookings all = sums_;
        for (const Open& one : open_) all.still_owed += one.owed;
        return all;
    }
    int contacts() const noexcept { return contacts_; }  ///< that opened again

private:
    struct Open {
        Vec3 normal, force;
        Real owed;
    };
    std::vector<Open> open_;
    Bookings sums_;
    int contacts_ = 0;
};

/// Shows contacts to a record, one by one; wears nothing.
struct RecordingWear {
    static constexpr std::string_view name = "RecordingWear";
    using Params = NoParams;

    explicit RecordingWear(Params) {}
    explicit RecordingWear(BookingRecord& record) : record_(&record) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
    WearIncrement<Real> increment(const ContactKinematics<Real>& contact,
                                  const ContactLoad<Real>& load) const noexcept {
        if (record_) record_->see(contact, load);
        return {0, 0};
    }
    Real strength_left(Real) const noexcept { return 1; }

private:
    BookingRecord* record_ = nullptr;
};

inline Bookings bookings_of(const Throw& impact) {
    BookingRecord record;
    thrown(impact, RecordingWear{record});
    return record.sums();
}

}  // namespace abrade::verification
