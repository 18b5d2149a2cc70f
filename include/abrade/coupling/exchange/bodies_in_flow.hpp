#pragma once
// Rigid bodies on a grid that water flows around: what each exchange of momentum between the two knows of
// them.

#include <abrade/core/fields.hpp>
#include <abrade/coupling/mapping/covered_faces.hpp>
#include <abrade/coupling/mapping/rigid_six.hpp>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// The part of SolidsInFlow that does not depend on the exchange: which shares sigma of the faces bodies
/// cover, what goes through these, and what is remembered of a body from step to step.
///
/// Momentum: what friction and advection bring to a control volume and its water does not keep, the body
/// gets. All of it acts upon velocities that the last pressure and the body's last load have acted on
/// already: where all is at rest, nothing is exchanged.
class BodiesInFlow {
public:
    std::span<const FlowBody> bodies() const noexcept { return bodies_; }
    std::span<const SolidCover> covers() const noexcept { return faces_.covers(); }  ///< [body]
    const FaceColumns& faces() const noexcept { return faces_.columns(); }
    Real fastest() const noexcept { return fastest_; }  ///< of the bodies [m/s]

    std::span<const SolidPart> parts() const noexcept { return faces_.parts(); }
    std::span<const SolidPart> resolved_parts() const noexcept { return faces_.parts_of_bodies(); }
    std::span<const SolidFlux> fluxes() const noexcept { return fluxes_; }
    void mix_last(FaceField<3>& u) const {
        for_fluxes([&](std::size_t i) { at(u, i) += beyond_[i]; });
    }
    void to_superficial(FaceField<3>& u) {
        interstitial_.resize(fluxes_.size());
        for_fluxes([&](std::size_t i) { interstitial_[i] = at(u, i); },
                   [&](std::size_t i) { at(u, i) += beyond_[i] - fluxes_[i].speed; });
    }
    void to_interstitial(FaceField<3>& u) const {
        for_fluxes([&](std::size_t i) { at(u, i) = interstitial_[i]; });
    }
    Real water_share(std::size_t n) const noexcept { return faces_.water_share(n); }
    void find_closed_cells(const Poisson<3>& m) { faces_.find_closed_cells(m); }
    void mix(FaceField<3>& u) {
        FaceColumns& f = faces_.columns();
        faces_.covered_by_planes(
            [&](std::size_t i) { f.unmixed[i] = f.at(u, i); },
            [&](std::size_t i) { f.at(u, i) += f.covered[i] * (f.solid[i] - f.at(u, i)); });
    }
    void unmix(FaceField<3>& u) const {
        const FaceColumns& f = faces();
        faces_.covered_by_planes([&](std::size_t i) { f.at(u, i) = f.unmixed[i]; });
    }

    std::vector<SolidVolume> volumes(bool only_new) const {
        const FaceColumns& f = faces();
        std::vector<SolidVolume> found;
        const auto add = [&](std::size_t i, Real share) {
            if (f.mass[i] > 0) found.push_back({f.face[i], f.axis[i], f.mass[i] * share / stage_.density});
        };
        for (std::size_t i = 0; i < f.count(); ++i)
            if (!only_new || (i >= f.cloud && is_new(f.body[i]))) add(i, f.share[i]);
        const SpreadCloud& cloud = faces_.cloud();
        for (std::size_t n = 0; only_new && n < cloud.count(); ++n)
            for (int a = 0; a < 3 && is_new(cloud.which()[n]); ++a)
                for (const SpreadPart& part : cloud.parts(n, a)) add(part.face, part.share);
        return found;
    }
    /// Bodies that are below the surface as a whole have their own place, others that of their cells.
    Vec3 moment(const Grid<3>& grid, const Field<Real>* fraction, bool only_new) const {
        Vec3 sum = Vec3::Zero();
        const auto below = [&](Offset cell) { return fraction ? (*fraction)[cell] : 1; };
        const auto add = [&](std::span<const SolidPart> parts) {
            for (const SolidPart& p : parts)
                sum += below(p.cell) * p.volume * grid.centre(grid.layout().number(p.cell));
        };
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            const SolidCover& cover = covers()[b];
            if (cover.averaged || (only_new && !is_new(b))) continue;
            const auto drowned = [&](const SolidPart& p) { return below(p.cell) == 1; };
            if (!cover.cut && std::ranges::all_of(cover.parts, drowned))
                sum += bodies_[b].volume * bodies_[b].position;
            else
                add(cover.parts);
        }
        if (!only_new) add(faces_.parts_of_cloud());
        const SpreadCloud& cloud = faces_.cloud();
        for (std::size_t n = 0; only_new && n < cloud.count(); ++n) {
            const std::size_t b = cloud.which()[n];
            for (int a = 0; a < 3 && is_new(b); ++a)
                for (const SpreadPart& part : cloud.parts(n, a))
                    sum += faces().mass[part.face] * part.share / (3 * stage_.density) * bodies_[b].position;
        }
        return sum;
    }
    Real lost_to_friction() const noexcept { return lost_to_friction_; }

    static void fields(auto&& field) {
        field("memory", &BodiesInFlow::memory_), field.bytes("fluxes", &BodiesInFlow::fluxes_);
        field("beyond", "m/s", &BodiesInFlow::beyond_), field("fastest", "m/s", &BodiesInFlow::fastest_);
        field("here", &BodiesInFlow::here_), field("flux_start", &BodiesInFlow::flux_start_);
    }

protected:
    using Six = detail::Six;
    using Matrix6 = Eigen::Matrix<Real, 6, 6>;

    struct Motion {
        Six q = Six::Zero();            ///< velocity and spin [m/s], [rad/s]
        Six held = Six::Zero();         ///< the same while friction acts
        Six push = Six::Zero();         ///< its change by the last pressure
        Six by_friction = Six::Zero();  ///< [N], [N m]
        Real curvature = 0;
        Real covers = 0;         ///< mass of water in the body's place [kg]
        ContactVelocity struck;  ///< by contacts
    };
    /// What is known of a body from the last step.
    struct Memory {
        Index id = 0;
        Six q = Six::Zero();         ///< velocity and spin that it left [m/s], [rad/s]
        Six gained = Six::Zero();    ///< by these in the step [m/s2], [rad/s2]
        Real covers = 0;             ///< mass of water in the body's place [kg]
        Six slip = Six::Zero();      ///< of that water beyond the body's momentum [kg m/s], [kg m2/s]
        Six pressed = Six::Zero();   ///< force and torque of the pressure [N], [N m]
        Vec3 struck = Vec3::Zero();  ///< velocity by contacts [m/s]

        static void fields(auto&& field) {
            field("id", &Memory::id), field.bytes("q", &Memory::q), field.bytes("gained", &Memory::gained);
            field("covers", "kg", &Memory::covers), field.bytes("slip", &Memory::slip);
            field.bytes("pressed", &Memory::pressed), field.bytes("struck", &Memory::struck);
        }
    };

    /// Bodies of less than `resolved_from` cells to a diameter make a cloud; the others have a core.
    void stand(const Grid<3>& grid, const BoundaryConditions<3>& boundaries, std::span<const FlowBody> bodies,
               Real resolved_from, const FaceField<3>* aperture, Real density, Real retracted = 0) {
        seen_ = std::exchange(here_, {});
        for (const FlowBody& body : bodies) here_.push_back(body.id);
        std::ranges::sort(here_);
        bodies_.assign(bodies.begin(), bodies.end()), motion_.assign(bodies.size() + 1, {});
        faces_.place(grid, boundaries, bodies, resolved_from, aperture, retracted);
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            FlowBody& body = bodies_[b];
            if (faces_.cover(b).cut) body.inverse_mass = 0, body.inverse_inertia.setZero();
            body.inverse_inertia *= turns(body, density);
            body.load.torque /= turns(body, density);
            FaceColumns& f = faces_.columns();
            for (const std::size_t i : faces_.of(b)) f.solid[i] = f.along(i, detail::velocity_of(bodies_[b]));
        }
    }

    /// Share of its change of spin that a body takes. Between steps the water's momentum turns a body by what
    /// its spin was, which no pressure corrects on a sphere: of less than a tenth of the water's density it
    /// turns as one of that.
    static Real turns(const FlowBody& body, Real density) noexcept {
        constexpr Real least = 0.1;  // density over the water's; half of it is too little on 4 cells
        if (body.inverse_mass == 0) return 1;
        return std::min(1 / (least * body.inverse_mass * body.volume * density), 1.0);
    }
    void parallel_for_resolved(auto&& body) const {
        parallel_for(
            static_cast<Index>(bodies_.size()),
            [&](Index n) {
                const auto b = static_cast<std::size_t>(n);
                if (!faces_.cover(b).averaged) body(b);
            },
            block_of_bodies);
    }

    /// The water's velocity and mass at all faces, once the old pressure has acted.
    void look_at(const FaceField<3>& u, const Field<Real>& old, const FlowStage& stage) {
        stage_ = stage;
        FaceColumns& f = faces_.columns();
        faces_.for_each([&](std::size_t i) {
            f.velocity[i] = f.at(u, i) - (stage_.pushed ? 0 : stage_.dt * f.gradient(old, i));
            f.mass[i] = mass_of(i);
        });
    }

    /// The body's velocity `q` by all but the pressure, and `held`, with the pressure expected, as friction
    /// meets it. `held_of`: the share of the way to the body's velocity that friction takes a face's water.
    void find_motion(std::size_t b, const Field<Real>& old, auto&& held_of) {
        const FlowBody& body = bodies_[b];
        Motion& motion = motion_[b];
        const Memory* const before = with_id(memory_, body.id);
        const Real dt = stage_.dt;
        Matrix6 drag = Matrix6::Zero();  // impulse on the body = brought - drag q
        Six brought = Six::Zero(), within = Six::Zero();
        Vec3 flow = Vec3::Zero(), weight = Vec3::Zero();  // of the water in its place
        FaceColumns& f = faces_.columns();
        for (const std::size_t i : faces_.of(b)) {
            f.held[i] = held_of(i);
            const Real held = f.mass[i] * f.water[i] * f.held[i], covers = f.mass[i] * f.share[i];
            const Six c = f.coefficient(i);
            drag += held * c * c.transpose();
            brought += held * f.velocity[i] * c;
            motion.covers += covers / 3;
            flow[f.axis[i]] += covers * f.velocity[i], weight[f.axis[i]] += covers;
            if (before) within += covers * (unpushed(i, old) - f.along(i, before->q)) * c;
        }
        if (before && before->covers > 0) {
            // What has left through the surface has taken its part along; what has come meets the body as it
            // will be, not as it was: it may be heavier than the body.
            const Real kept = std::min(1.0, before->covers / motion.covers);
            brought += kept * within - std::min(1.0, motion.covers / before->covers) * before->slip;
            for (const std::size_t i : faces_.of(b)) {
                if (kept == 1) break;
                const Six c = f.coefficient(i);
                const Real comes = (1 - kept) * f.mass[i] * f.share[i];
                brought += comes * unpushed(i, old) * c, drag += comes * c * c.transpose();
            }
        }
        motion.held = motion.q = detail::velocity_of(body);
        if (body.inverse_mass > 0) {
            const Matrix6 inertia = detail::inertia_of(body);
            if (before)
                motion.struck = {body, before->q.template head<3>(), before->struck, stage_.falls, dt};
            else  // it meets the water at once
                motion.struck.velocity =
                    body.velocity - dt * stage_.falls - flow.cwiseQuotient(weight.cwiseMax(tiny<Real>));
            Six went = Six::Zero();  // what contacts gave to the water along with the body
            went.template head<3>() = body.load.added_mass * motion.struck.velocity - dt * body.load.shared;
            const Six begun =
                inertia * motion.q - dt * (Six() << body.load.force, body.load.torque).finished() + went;
            // Friction meets the last force of the pressure, whatever cells have become wet or dry since, and
            // what added mass makes of the rest.
            Matrix6 heavier = inertia;
            Six expected = before ? Six(dt * before->pressed)
                                  : dt * stage_.density * detail::pressed(faces_.cover(b), old);
            const Real added = of_a_sphere * motion.covers;
            heavier.template topLeftCorner<3, 3>().diagonal().array() += added;
            if (before)
                expected.template head<3>() += added * (before->q + dt * before->gained).template head<3>();
            else
                expected.template head<3>() += added * body.velocity;
            motion.held = (heavier + drag).ldlt().solve(begun + expected + brought);
            motion.q = inertia.ldlt().solve(begun + brought - drag * motion.held);
        }
        motion.by_friction = (brought - drag * motion.held) / dt;
    }

    /// The water's velocity by all but pressure and weight.
    Real unpushed(std::size_t i, const Field<Real>& old) const noexcept {
        const FaceColumns& f = faces();
        return f.velocity[i] + stage_.dt * (f.gradient(old, i) - f.weight[i] * stage_.falls[f.axis[i]]);
    }

    /// Once velocities are known: `q` and `load` of resolved bodies are handed out, and what the next step
    /// needs of them is remembered. `load_of(b, force and torque of the pressure)`.
    void hand_out(const FaceField<3>& u, const Field<Real>& pressure, auto&& load_of) {
        std::vector<Memory> next;
        next.reserve(bodies_.size());
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (faces_.cover(b).averaged) continue;
            FlowBody& body = bodies_[b];
            const Six& q = motion_[b].q;
            const Six pressed = stage_.density * detail::pressed(faces_.cover(b), pressure);
            Six load = load_of(b, pressed);
            load.template head<3>() +=
                motion_[b].struck.taken_by(of_a_sphere * motion_[b].covers, body, stage_.dt);
            body.velocity = q.template head<3>(), body.angular_velocity = q.template tail<3>();
            const Memory* const before = with_id(memory_, body.id);
            const Real lasts = before ? stage_.lasts() : 1;
            if (!faces_.cover(b).cut) {
                body.load.force += lasts * (load.template head<3>() - body.load.force);
                body.load.torque += lasts * (load.template tail<3>() - body.load.torque);
                motion_[b].struck.hand_out(body, of_a_sphere * motion_[b].covers, stage_.dt);
            }
            body.load.torque *= turns(body, stage_.density);
            Memory& now = next.emplace_back(before ? *before : Memory{.id = body.id});
            if (before) now.gained += lasts * ((q - before->q) / stage_.dt - before->gained);
            now.pressed += lasts * (pressed - now.pressed);
            now.q = q, now.covers = motion_[b].covers, now.slip = slip_of(b, u);
            now.struck = motion_[b].struck.velocity;
        }
        std::ranges::sort(next, {}, &Memory::id);
        memory_ = std::move(next);
    }

    /// Sums up what friction takes at each face [J].
    void find_loss(auto&& of_face) {
        lost_to_friction_ = parallel_sum<Real>(static_cast<Index>(faces().count()),
                                               [&](Index i) { return of_face(static_cast<std::size_t>(i)); });
    }
    void finish() {
        fastest_ = 0;
        for (const FlowBody& body : bodies_) fastest_ = std::max(fastest_, body.velocity.norm());
    }
    /// What goes through each face. `beyond(face)`: its part of the mixture's velocity beyond the water's.
    void find_fluxes(auto&& beyond) {
        flux_start_ = faces_.covered_before();
        fluxes_.resize(flux_start_.back()), beyond_.resize(fluxes_.size());
        FaceColumns& f = faces_.columns();
        faces_.number_covered(flux_start_, [&](std::size_t i, std::size_t n) {
            if (i >= f.cloud) f.solid[i] = f.pushes(i, motion_[f.body[i]].q);
            fluxes_[n] = {f.face[i], f.axis[i], f.covered[i] * f.solid[i]}, beyond_[n] = beyond(i);
        });
    }

    std::vector<FlowBody> bodies_;
    std::vector<Motion> motion_;  ///< [body], and 0 of the cloud
    CoveredFaces faces_;
    FlowStage stage_;

private:
    static constexpr Real of_a_sphere = 0.5;  ///< added mass over that of its place [-]

    Real& at(FaceField<3>& u, std::size_t i) const noexcept { return u[fluxes_[i].axis][fluxes_[i].face]; }
    /// Plane by plane in parallel, each of the visits to all fluxes of a plane before the next.
    void for_fluxes(auto&&... visits) const {
        const auto visit_plane = [&](Index plane, auto& visit) {
            const auto p = static_cast<std::size_t>(plane);
            for (std::size_t i = flux_start_[p]; i < flux_start_[p + 1]; ++i) visit(i);
        };
        parallel_for(
            static_cast<Index>(flux_start_.size()) - 1,
            [&](Index plane) { (visit_plane(plane, visits), ...); }, CoveredFaces::planes_at_once);
    }

    bool is_new(std::size_t b) const noexcept { return !std::ranges::binary_search(seen_, bodies_[b].id); }
    /// Of the control volume of a face, as far as walls leave it open and it lies below the surface [kg].
    Real mass_of(std::size_t i) const noexcept {
        const FaceColumns& f = faces();
        if (f.open[i] == 0) return 0;
        const Real all = stage_.density * f.volume[i];
        if (!stage_.liquid_fraction) return all;
        return all *
               std::min(0.5 * ((*stage_.liquid_fraction)[f.face[i]] + (*stage_.liquid_fraction)[f.low[i]]) /
                            f.open[i],
                        1.0);
    }
    Six slip_of(std::size_t b, const FaceField<3>& u) const noexcept {
        const FaceColumns& f = faces();
        Six sum = Six::Zero();
        for (const std::size_t i : faces_.of(b))
            sum += f.mass[i] * f.share[i] * (f.at(u, i) - f.along(i, motion_[b].q)) * f.coefficient(i);
        return sum;
    }

    std::vector<Memory> memory_;           ///< by id
    std::vector<SolidFlux> fluxes_;        ///< as the last step left them, plane by plane
    std::vector<Real> beyond_;             ///< mixture's velocity beyond the water's there [m/s]
    std::vector<Real> interstitial_;       ///< the water's own, while the superficial one is asked for [m/s]
    std::vector<std::size_t> flux_start_;  ///< [plane] in them
    Real fastest_ = 0;
    Real lost_to_friction_ = 0;       ///< in the last step [J]
    std::vector<Index> seen_, here_;  ///< ids of the bodies of the last step and of this one, sorted
};

}  // namespace abrade
