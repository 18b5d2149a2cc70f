#pragma once
// Rigid bodies in water on a grid, whose velocities are found together with the pressure.

#include <abrade/core/fields.hpp>
#include <abrade/core/parallel.hpp>
#include <abrade/coupling/solid_shares.hpp>
#include <abrade/fluid/solids_in_flow.hpp>

#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// Solids as moving apertures (C. Batty, F. Bertails & R. Bridson 2007, doi:10.1145/1275808.1276502). A face
/// of which bodies cover the share sigma (SolidFace) lets pass
///   (1 - sigma) u + sigma v,  v = V + W x r,
/// and this mixture has no divergence. Pressure and rigid velocities q = (V, W) minimise
///   1/2 sum rho (1 - sigma) |u - u*|^2 + 1/2 sum (q - q*)^T M (q - q*)  under that:
///   [D (1 - sigma) rho^-1 D^T + sum over bodies J M^-1 J^T] p = -D ((1 - sigma) u* + sigma v*),
/// so any ratio of densities and any step are stable. J^T p is the force of the pressure.
///
/// Before that comes friction: in a control volume covered by sigma water is held back, implicitly in time,
///   du/dt = C nu / h^2 sigma / (1 - sigma) (v - u),  h^3 the volume,
/// and its body takes the impulse. Nothing else makes water stick; C is calibrated on the drag of a sphere.
/// What friction and advection bring to a control volume and its water does not keep, the body gets: momentum
/// is conserved. All of it acts upon velocities that the last pressure and the body's last load have acted on
/// already: where all is at rest, nothing is exchanged.
class MonolithicSolids {
    using Six = Eigen::Matrix<Real, 6, 1>;  ///< of a force and a torque, or a velocity and a spin
    using Matrix6 = Eigen::Matrix<Real, 6, 6>;

public:
    static constexpr std::string_view name = "MonolithicSolids";
    static constexpr bool present = true;

    struct Params {
        Real friction = 12;  ///< C [-]
        void validate() const {
            require(
                friction >= 0 && std::isfinite(friction),
                {"MonolithicSolids.friction", ">= 0 and finite", "", "12 is calibrated, 0 lets water glide"},
                friction);
        }
        void visit(auto&& f) const { f("friction", friction, "-"); }
    };

    MonolithicSolids() = default;
    explicit MonolithicSolids(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }
    std::span<const FlowBody> bodies() const noexcept { return bodies_; }
    std::span<const SolidCover> covers() const noexcept { return covers_; }  ///< [body]

    /// Bodies as they stand at the end of the water's step.
    void place(const Grid<3>& grid, const Sides<3>& sides, std::span<const FlowBody> bodies,
               const FaceField<3>* open_area) {
        bodies_.assign(bodies.begin(), bodies.end());
        covers_.resize(bodies_.size()), motion_.assign(bodies_.size(), {});
        const auto closed = [open_area](int axis, Offset face) {
            return open_area && (*open_area)[axis][face] == 0;
        };
        parallel_blocks(
            count(),
            [&](Index, Index first, Index last) {
                detail::SolidCoverFinder finder(grid, sides, closed);
                for (Index b = first; b < last; ++b) finder.find(bodies_[at(b)], covers_[at(b)]);
            },
            block_of_bodies);
        sort_by_plane(grid.layout().planes());
    }

    /// Takes from what faces conduct what bodies cover.
    void close(Poisson<3>& m) {
        const auto share = [&](const SolidFace& f) {
            return static_cast<Real>(m.face[f.axis][f.face]) * f.gap / f.area;
        };
        each_face([&](const SolidFace& f, Water& w, const Motion&) { w.open = share(f); });
        each_face([&](const SolidFace& f, Water&, const Motion&) {
            constexpr Real least = 1e-6;  // of a face: less conducts nothing
            const Real left = share(f) - f.share;
            m.face[f.axis][f.face] = left > least ? static_cast<float>(left * f.area / f.gap) : 0.0f;
        });
        each_face([&](const SolidFace& f, Water& w, const Motion&) {
            w.share = share(f);
            w.covered = w.open > 0 ? std::min(f.share / w.open, 1.0) : 0;
        });
    }
    /// Only cells that take part have a pressure.
    void keep_wet(const Poisson<3>& m) {
        for (SolidCover& cover : covers_)
            std::erase_if(cover.cells, [&](const SolidCell& c) { return !(m.inverse_diagonal[c.cell] > 0); });
    }

    void mix(FaceField<3>& u) const {
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            const Six q = velocity_of(bodies_[b]);
            for (std::size_t k = 0; k < covers_[b].faces.size(); ++k) {
                const SolidFace& f = covers_[b].faces[k];
                Real& value = u[f.axis][f.face];
                value += water_[first_[b] + k].covered * (along(f, q) - value);
            }
        }
    }

    void force(FaceField<3>& u, const Field<Real>& pressure, const FlowStage& stage) {
        stage_ = stage;
        parallel_for_bodies([&](std::size_t b) { find_motion(b, u, pressure); });
        each_face([&](const SolidFace& f, Water& w, const Motion& body) {
            u[f.axis][f.face] += w.held * (along(f, body.held) - w.velocity);
        });
        each_face([&](const SolidFace& f, Water& w, const Motion&) { w.velocity = u[f.axis][f.face]; });
        each_face([&](const SolidFace& f, Water& w, const Motion& body) {
            u[f.axis][f.face] += w.covered * (along(f, body.q) - w.velocity);
        });
    }

    template <class Number>
    void push(const Field<Number>& of, Real factor) {
        parallel_for_bodies([&](std::size_t b) {
            Motion& motion = motion_[b];
            motion.push = accelerated(bodies_[b], stage_.density * factor * pressed(covers_[b], of));
            motion.q += motion.push;
        });
    }
    template <class Number>
    void correct(FaceField<3>& u, const Field<Number>& of, Real factor, int plane) const {
        for (std::size_t i = plane_start_[at(plane)]; i < plane_start_[at(plane + 1)]; ++i) {
            const auto [b, k] = by_plane_[i];
            const SolidFace& f = covers_[b].faces[k];
            const Water& w = water_[first_[b] + k];
            const Real back = w.share > 0 ? factor * gradient(of, f) : 0;
            u[f.axis][f.face] += w.covered * (back + along(f, motion_[b].push));
        }
    }
    Real add_product(const Field<float>& p, Field<float>& product) {
        parallel_for_bodies([&](std::size_t b) {
            Motion& motion = motion_[b];
            const Six sum = pressed(covers_[b], p);
            motion.push = accelerated(bodies_[b], stage_.density * sum);
            motion.curvature = sum.dot(motion.push);
        });
        Real sum = 0;
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            const Six& v = motion_[b].push;
            sum += motion_[b].curvature;
            for (const SolidCell& c : covers_[b].cells)
                product[c.cell] +=
                    static_cast<float>(c.way.dot(v.template head<3>()) + c.turn.dot(v.template tail<3>()));
        }
        return sum;
    }

    /// Velocities and loads of `bodies()` as the step leaves them. Cells within bodies get the pressure that
    /// goes on from around them.
    void settle(FaceField<3>& u, Field<Real>& pressure) {
        each_face([&](const SolidFace& f, Water& w, const Motion&) {
            if (w.share > 0)
                u[f.axis][f.face] = w.velocity - stage_.dt * (gradient(pressure, f) - w.gradient);
        });
        std::vector<Memory> next;
        next.reserve(bodies_.size());
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            FlowBody& body = bodies_[b];
            const Motion& motion = motion_[b];
            const Six by_pressure = stage_.density * pressed(covers_[b], pressure);
            const Six load = by_pressure + motion.by_friction;
            body.velocity = motion.q.template head<3>(), body.angular_velocity = motion.q.template tail<3>();
            body.load = {load.template head<3>(), load.template tail<3>()};
            fill_inside(b, by_pressure.template head<3>(), pressure);
            next.push_back({body.id, body.position, momentum_within(covers_[b], u), acting_friction(body.id),
                            motion.by_friction});
        }
        std::sort(next.begin(), next.end(), [](const Memory& a, const Memory& b) { return a.id < b.id; });
        memory_ = std::move(next);
    }
    /// The loads that came out last act from here on.
    void hand_over() noexcept {
        for (Memory& memory : memory_) memory.acting = memory.friction;
    }

    static void fields(auto&& field) { field("memory", &MonolithicSolids::memory_); }

private:
    /// What is at a face that a body covers some of.
    struct Water {
        Real open = 0;      ///< share of it that walls leave open [-]
        Real share = 0;     ///< and that bodies leave to the water [-]
        Real covered = 0;   ///< by the one body, of what is open [-]
        Real held = 0;      ///< share of the way to the body's velocity that friction takes it [-]
        Real velocity = 0;  ///< of the water, before the new pressure acts [m/s]
        Real gradient = 0;  ///< of the old pressure [m/s2]
    };
    struct Motion {
        Six q = Six::Zero();            ///< velocity and spin [m/s], [rad/s]
        Six held = Six::Zero();         ///< the same while friction acts
        Six push = Six::Zero();         ///< its change by the last pressure
        Six by_friction = Six::Zero();  ///< [N], [N m]
        Real curvature = 0;
    };
    struct Memory {
        Index id = 0;
        Vec3 position = Vec3::Zero();  ///< [m]
        Six momentum = Six::Zero();    ///< of water in the body's place [kg m/s], [kg m2/s]
        Six acting = Six::Zero(), friction = Six::Zero();  ///< by friction: until now, from now on [N], [N m]

        static void fields(auto&& field) {
            field("id", &Memory::id), field("position", "m", &Memory::position),
                field.bytes("momentum", &Memory::momentum), field.bytes("acting", &Memory::acting),
                field.bytes("friction", &Memory::friction);
        }
    };

    static std::size_t at(std::integral auto i) noexcept { return static_cast<std::size_t>(i); }
    Index count() const noexcept { return static_cast<Index>(bodies_.size()); }

    static Six coefficient(const SolidFace& f) noexcept {
        Six c = Six::Zero();
        c[f.axis] = 1, c.template tail<3>() = f.lever();
        return c;
    }
    static Real along(const SolidFace& f, const Six& q) noexcept {
        return q[f.axis] + q.template tail<3>().dot(f.lever());
    }
    static Six velocity_of(const FlowBody& body) noexcept {
        return (Six() << body.velocity, body.angular_velocity).finished();
    }
    static Six accelerated(const FlowBody& body, const Six& impulse) noexcept {
        Six q;
        q.template head<3>() = body.inverse_mass * impulse.template head<3>();
        q.template tail<3>() = body.inverse_inertia * impulse.template tail<3>();
        return q;
    }
    template <class Number>
    static Real gradient(const Field<Number>& of, const SolidFace& f) noexcept {
        return static_cast<Real>(of[f.face] - of[f.low]) / f.gap;
    }
    /// J^T of a pressure.
    template <class Number>
    static Six pressed(const SolidCover& cover, const Field<Number>& of) noexcept {
        Six sum = Six::Zero();
        for (const SolidCell& c : cover.cells) {
            const auto p = static_cast<Real>(of[c.cell]);
            sum.template head<3>() += p * c.way, sum.template tail<3>() += p * c.turn;
        }
        return sum;
    }
    Six momentum_within(const SolidCover& cover, const FaceField<3>& u) const noexcept {
        Six sum = Six::Zero();
        for (const SolidFace& f : cover.faces)
            sum += stage_.density * f.share * f.volume() * u[f.axis][f.face] * coefficient(f);
        return sum;
    }

    void parallel_for_bodies(auto&& body) const {
        parallel_blocks(
            count(),
            [&](Index, Index first, Index last) {
                for (Index b = first; b < last; ++b) body(at(b));
            },
            block_of_bodies);
    }
    void each_face(auto&& visit) {
        for (std::size_t b = 0; b < bodies_.size(); ++b)
            for (std::size_t k = 0; k < covers_[b].faces.size(); ++k)
                visit(std::as_const(covers_[b].faces[k]), water_[first_[b] + k], std::as_const(motion_[b]));
    }
    void sort_by_plane(int planes) {
        first_.assign(1, 0), plane_start_.assign(at(planes) + 1, 0);
        for (const SolidCover& cover : covers_) {
            first_.push_back(first_.back() + cover.faces.size());
            for (const SolidFace& f : cover.faces) ++plane_start_[at(f.plane) + 1];
        }
        for (std::size_t p = 1; p < plane_start_.size(); ++p) plane_start_[p] += plane_start_[p - 1];
        water_.assign(first_.back(), {}), by_plane_.resize(first_.back());
        std::vector<std::size_t> next = plane_start_;
        for (std::size_t b = 0; b < covers_.size(); ++b)
            for (std::size_t k = 0; k < covers_[b].faces.size(); ++k)
                by_plane_[next[at(covers_[b].faces[k].plane)]++] = {b, k};
    }

    const Memory* memory_of(Index id) const noexcept {
        const auto found = std::lower_bound(memory_.begin(), memory_.end(), id,
                                            [](const Memory& m, Index wanted) { return m.id < wanted; });
        return found != memory_.end() && found->id == id ? &*found : nullptr;
    }
    Six acting_friction(Index id) const noexcept {
        const Memory* const before = memory_of(id);
        return before ? before->acting : Six(Six::Zero());
    }

    /// The body's velocity with friction, and with the old pressure as it acts on it where it is now.
    void find_motion(std::size_t b, const FaceField<3>& u, const Field<Real>& pressure) {
        const FlowBody& body = bodies_[b];
        Motion& motion = motion_[b];
        const Real dt = stage_.dt;
        Matrix6 drag = Matrix6::Zero();  // impulse on the body = brought - drag q
        Six brought = Six::Zero(), within = Six::Zero();
        for (std::size_t k = 0; k < covers_[b].faces.size(); ++k) {
            const SolidFace& f = covers_[b].faces[k];
            Water& w = water_[first_[b] + k];
            w.velocity = u[f.axis][f.face], w.gradient = gradient(pressure, f);
            const Real rate = params_.friction * stage_.viscosity * dt / std::pow(f.volume(), 2.0 / 3);
            const Real stiff = rate * f.share, left = 1 - f.share;
            w.held = stiff > 0 ? stiff / (left + stiff) : 0;
            const Real mass = stage_.density * f.volume(), held = mass * w.share * w.held;
            const Six c = coefficient(f);
            drag += held * c * c.transpose();
            brought += held * w.velocity * c;
            within += mass * f.share * (w.velocity + dt * (w.gradient - stage_.falls[f.axis])) * c;
        }
        if (const Memory* const before = memory_of(body.id)) {
            const Vec3 moved = body.position - before->position;
            Six momentum = before->momentum;
            momentum.template tail<3>() -= moved.cross(momentum.template head<3>());
            brought += within - momentum;
        }
        const Six acting = acting_friction(body.id);
        motion.held = velocity_of(body);
        if (body.inverse_mass > 0) {
            Matrix6 inertia = Matrix6::Zero();
            inertia.template topLeftCorner<3, 3>() = Mat3::Identity() / body.inverse_mass;
            inertia.template bottomRightCorner<3, 3>() = body.inverse_inertia.inverse();
            motion.held = (inertia + drag).ldlt().solve(inertia * motion.held - dt * acting + brought);
        }
        motion.by_friction = (brought - drag * motion.held) / dt;
        const Six load = (Six() << body.load.force, body.load.torque).finished();
        const Six more = stage_.density * pressed(covers_[b], pressure) - (load - acting);
        motion.q = motion.held + accelerated(body, dt * more);
    }

    /// As if the force were that of one gradient.
    void fill_inside(std::size_t b, const Vec3& force, Field<Real>& pressure) const noexcept {
        const SolidCover& cover = covers_[b];
        if (cover.cells.empty()) return;
        Real mean = 0;
        Vec3 middle = Vec3::Zero();
        for (const SolidCell& c : cover.cells) mean += pressure[c.cell], middle += c.arm;
        const auto cells = static_cast<Real>(cover.cells.size());
        const Vec3 slope = -force / (stage_.density * bodies_[b].volume);
        for (const SolidCell& c : cover.inside)
            pressure[c.cell] = mean / cells + slope.dot(c.arm - middle / cells);
    }

    Params params_;
    std::vector<FlowBody> bodies_;
    std::vector<SolidCover> covers_;  ///< [body]
    std::vector<Motion> motion_;      ///< [body]
    std::vector<std::size_t> first_;  ///< [body] of its faces in `water_`
    std::vector<Water> water_;        ///< [face], body by body
    struct Entry {
        std::size_t body, face;
    };
    std::vector<Entry> by_plane_;           ///< faces in the order of their planes
    std::vector<std::size_t> plane_start_;  ///< [plane] in `by_plane_`
    std::vector<Memory> memory_;            ///< by id
    FlowStage stage_;
};

static_assert(SolidsInFlow<MonolithicSolids>);

}  // namespace abrade
