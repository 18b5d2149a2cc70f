#pragma once
// The moving state of all bodies, laid out for speed: spheres in slots, sorted slab by slab, with images
// where a slab's contacts reach beyond what its chunk owns.

#include <abrade/core/parallel.hpp>
#include <abrade/dem/store/hot_arrays.hpp>
#include <abrade/dem/store/neighbours.hpp>
#include <abrade/dem/store/particles.hpp>
#include <abrade/dem/store/slabs.hpp>
#include <abrade/geometry/surfaces.hpp>

#include <utility>

namespace abrade {

/// A body of several spheres in motion; its member spheres stand in consecutive slots.
struct MovingClump {
    Index body = -1, first_slot = 0, count = 0;
    Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();  ///< of the centroid [m], [m/s]
    Vec3 angular_momentum = Vec3::Zero();                   ///< in world axes [kg m2/s]
    Quaternion orientation = Quaternion::Identity();        ///< principal axes to world axes
    Mat3 rotation = Mat3::Identity();                       ///< the same
    Real mass = 0, inverse_mass = 0;                        ///< [kg], [1/kg]
    Vec3 inverse_inertia = Vec3::Zero();                    ///< about the principal axes [1/(kg m2)]

    static void fields(auto&& field) {
        field("body", &MovingClump::body), field("first_slot", &MovingClump::first_slot),
            field("count", &MovingClump::count), field("position", "m", &MovingClump::position),
            field("velocity", "m/s", &MovingClump::velocity),
            field("angular_momentum", "kg m2/s", &MovingClump::angular_momentum),
            field("orientation", &MovingClump::orientation), field("rotation", &MovingClump::rotation),
            field("mass", "kg", &MovingClump::mass),
            field("inverse_mass", "1/kg", &MovingClump::inverse_mass),
            field("inverse_inertia", "1/(kg m2)", &MovingClump::inverse_inertia);
    }

    /// In world axes, of an angular momentum in world axes.
    Vec3 angular_velocity(const Vec3& momentum) const noexcept {
        return rotation * inverse_inertia.cwiseProduct(rotation.transpose() * momentum);
    }
};

/// A copy of a sphere in a slot of its own: across a periodic boundary, or of the slab next door for the
/// chunk before it, so that no two chunks ever write the same line. Its place and motion follow its owner's,
/// what acts on it is added to its owner's load.
struct SphereImage {
    Index slot = 0, owner = 0;
    Vec3 shift = Vec3::Zero();  ///< [m]
};

/// Positions, velocities and loads in motion. `Particles` is where they come from and, at the time of an
/// observation, where they are written back to; a body's index there is its lasting one.
class SphereStore {
public:
    HotArrays lines;
    Slabs slabs;
    std::vector<MovingClump> clumps;  ///< sorted by slab

    Index spheres() const noexcept { return static_cast<Index>(sphere_of_.size()); }
    Index sphere_of(Index slot) const noexcept { return sphere_of_[at(slot)]; }  ///< lasting index
    Index slot_of(Index sphere) const noexcept { return slot_of_[at(sphere)]; }
    /// The slot that an image belongs to; any other slot itself.
    Index owner_of(Index slot) const noexcept {
        const Index image = slot - spheres();
        return image >= 0 && image < static_cast<Index>(images_.size()) ? images_[at(image)].owner : slot;
    }
    Index phantom() const noexcept { return phantom_; }

    /// Slots of single spheres of a slab, then those of its clumps.
    Index first_slot(Index slab) const noexcept { return first_slot_[at(slab)]; }
    Index first_clump_slot(Index slab) const noexcept { return first_clump_slot_[at(slab)]; }
    std::span<MovingClump> clumps_of(Index slab) noexcept {
        return std::span(clumps).subspan(at(first_clump_[at(slab)]),
                                         at(first_clump_[at(slab) + 1] - first_clump_[at(slab)]));
    }
    Index slab_of_slot(Index slot) const noexcept {
        const auto after = std::upper_bound(first_slot_.begin(), first_slot_.end(), slot);
        return static_cast<Index>(after - first_slot_.begin()) - 1;
    }
    std::span<const SphereImage> images_of(Index slab) const noexcept {
        return std::span(images_).subspan(at(first_image_[at(slab)]),
                                          at(first_image_[at(slab) + 1] - first_image_[at(slab)]));
    }

    Vec3 position_of(const Particles& particles, Index body) const noexcept {
        const Index clump = clump_of_[at(body)];
        return clump >= 0 ? clumps[at(clump)].position
                          : lines.place[at(slot_of_[at(particles.first_sphere[at(body)])])].centre;
    }
    Vec3 velocity_of(const Particles& particles, Index body) const noexcept {
        const Index clump = clump_of_[at(body)];
        return clump >= 0 ? clumps[at(clump)].velocity
                          : lines.motion[at(slot_of_[at(particles.first_sphere[at(body)])])].velocity;
    }
    bool turns_soundly(const Particles& particles, Index body) const noexcept {
        const Index clump = clump_of_[at(body)];
        return clump >= 0 ? clumps[at(clump)].angular_momentum.allFinite()
                          : lines.motion[at(slot_of_[at(particles.first_sphere[at(body)])])]
                                .surface_velocity.allFinite();
    }
    Index clump_of(Index body) const noexcept { return clump_of_[at(body)]; }  ///< -1: a single sphere

    /// Puts all bodies of `particles` into slots anew. `moved` [old sphere] says where the spheres known so
    /// far are now in `particles` (-1: gone); the others enter as `particles` has them. Bodies may be near
    /// each other when their surfaces are nearer than `skin` [m].
    void arrange(const Particles& particles, std::span<const Index> moved, Real skin, const Periodic& space) {
        const auto bodies = static_cast<std::size_t>(particles.bodies());
        const auto count = static_cast<std::size_t>(particles.spheres());
        std::vector<Index> old_slot(count, -1), old_clump(bodies, -1);
        for (std::size_t s = 0; s < moved.size(); ++s)
            if (moved[s] >= 0) old_slot[at(moved[s])] = slot_of_[s];
        for (std::size_t c = 0; c < clumps.size(); ++c)
            if (const Index sphere = moved[at(sphere_of_[at(clumps[c].first_slot)])]; sphere >= 0)
                old_clump[at(particles.body[at(sphere)])] = static_cast<Index>(c);

        std::vector<Vec3> position(bodies);
        Slabs::Fit fit{Vec3::Constant(std::numeric_limits<Real>::infinity()), {}, 0, particles.spheres()};
        fit.high = -fit.low;
        Real reach = 0;
        for (std::size_t b = 0; b < bodies; ++b) {
            const auto first = at(particles.first_sphere[b]);
            position[b] = old_clump[b] >= 0      ? clumps[at(old_clump[b])].position
                          : old_slot[first] >= 0 ? lines.place[at(old_slot[first])].centre
                                                 : particles.position[b];
            fit.low = fit.low.cwiseMin(position[b]), fit.high = fit.high.cwiseMax(position[b]);
            for (std::size_t s = first; s < first + at(particles.sphere_count[b]); ++s)
                reach = std::max(reach, particles.offset[s].norm() + particles.radius[s]);
        }
        fit.thickness = 2 * reach + skin;
        for (int a = 0; a < 3; ++a)
            if (space.period[a] > 0) fit.low[a] = space.low[a], fit.high[a] = space.low[a] + space.period[a];
        if (bodies == 0) fit.low = fit.high = Vec3::Zero(), fit.thickness = 1;
        slabs.fit(fit);

        const std::vector<Index> order = order_of(particles, position, fit);
        HotArrays& next = spare_;  // kept from last time: fresh memory costs more than what is done here
        next.resize(count);
        std::vector<MovingClump> next_clumps;
        std::vector<Index> next_sphere_of(count);
        slot_of_.assign(count, 0);
        clump_of_.assign(bodies, -1);
        first_slot_.assign(at(slabs.count()) + 1, 0);
        first_clump_slot_.assign(at(slabs.count()), 0), first_clump_.assign(at(slabs.count()) + 1, 0);
        Index slot = 0, slab = -1;
        bool singles = false;
        const auto begin_slab = [&] {
            if (slab >= 0 && singles) first_clump_slot_[at(slab)] = slot;
            ++slab;
            first_slot_[at(slab)] = slot, first_clump_[at(slab)] = static_cast<Index>(next_clumps.size());
            singles = true;
        };
        for (const Index body : order) {
            const auto b = at(body);
            while (slab < slabs.of(position[b])) begin_slab();
            const bool single = particles.sphere_count[b] == 1;
            if (!single) {
                if (std::exchange(singles, false)) first_clump_slot_[at(slab)] = slot;
                clump_of_[b] = static_cast<Index>(next_clumps.size());
                next_clumps.push_back(old_clump[b] >= 0 ? clumps[at(old_clump[b])] : clump(particles, body));
                next_clumps.back().body = body, next_clumps.back().first_slot = slot;
            }
            const auto first = at(particles.first_sphere[b]);
            for (std::size_t s = first; s < first + at(particles.sphere_count[b]); ++s, ++slot) {
                slot_of_[s] = slot, next_sphere_of[at(slot)] = static_cast<Index>(s);
            }
        }
        parallel_for(slot, [&](Index n) {
            const auto to = at(n), s = at(next_sphere_of[to]);
            if (old_slot[s] < 0) return enter(next, to, particles, particles.body[s], s);
            const auto from = at(old_slot[s]);
            next.place[to] = lines.place[from], next.motion[to] = lines.motion[from],
            next.load[to] = lines.load[from];
        });
        while (slab + 1 < slabs.count()) begin_slab();
        if (singles) first_clump_slot_[at(slab)] = slot;
        first_slot_[at(slab) + 1] = slot, first_clump_[at(slab) + 1] = static_cast<Index>(next_clumps.size());
        slabs.share_out(first_slot_);
        std::swap(lines, spare_), clumps = std::move(next_clumps), sphere_of_ = std::move(next_sphere_of);
        images_.clear();
        first_image_.assign(at(slabs.count()) + 1, 0);
        phantom_ = lines.add_phantoms();
    }

    /// A slot that the contacts of one chunk need and do not own.
    struct ImageRequest {
        Index owner, chunk;
        ImageShift shift;
        auto operator<=>(const ImageRequest&) const = default;
    };
    /// Makes the images that are asked for, each once; `image_slot` finds them.
    void make_images(std::vector<ImageRequest> requests, const Vec3& period) {
        std::sort(requests.begin(), requests.end());
        requests.erase(std::unique(requests.begin(), requests.end()), requests.end());
        requests_ = std::move(requests);
        images_.clear();
        lines.resize(sphere_of_.size());  // without the old ones, which new ones must not take after
        lines.resize(sphere_of_.size() + requests_.size());
        first_image_.assign(at(slabs.count()) + 1, 0);
        for (const ImageRequest& r : requests_) {
            images_.push_back(
                {spheres() + static_cast<Index>(images_.size()), r.owner, r.shift.times(period)});
            ++first_image_[at(slab_of_slot(r.owner)) + 1];
        }
        for (std::size_t s = 1; s < first_image_.size(); ++s) first_image_[s] += first_image_[s - 1];
        phantom_ = lines.add_phantoms();
        for (const SphereImage& image : images_) refresh(image);
    }
    Index image_slot(const ImageRequest& request) const noexcept {
        const auto found = std::lower_bound(requests_.begin(), requests_.end(), request);
        return spheres() + static_cast<Index>(found - requests_.begin());
    }

    /// Place and motion of an image, from its owner's.
    void refresh(const SphereImage& image) noexcept {
        SpherePlace& place = lines.place[at(image.slot)];
        place = lines.place[at(image.owner)];
        place.centre += image.shift;
        lines.motion[at(image.slot)] = lines.motion[at(image.owner)];
    }
    void refresh_images() noexcept {
        for (const SphereImage& image : images_) refresh(image);
    }
    /// Hands what acts on an image to its owner.
    void collect(const SphereImage& image) noexcept {
        SphereLoad &from = lines.load[at(image.slot)], &to = lines.load[at(image.owner)];
        to.force += from.force, to.observed += from.observed,
            to.torque_over_radius += from.torque_over_radius;
        from = {};
    }

    /// Puts the member spheres of a clump to where a `drift` [s] has led it. Their velocity is that of the
    /// way from the places they had, `spin` that of the turn.
    void place_members(const MovingClump& clump, const Particles& particles, const Vec3& spin,
                       Real drift) noexcept {
        using detail::quad, detail::same;
        const std::array<Quad, 3> axis{quad(clump.rotation.col(0)), quad(clump.rotation.col(1)),
                                       quad(clump.rotation.col(2))};
        const Quad position = quad(clump.position), turning = quad(spin), per_drift = same(1 / drift);
        const auto first = at(particles.first_sphere[at(clump.body)]);
        for (std::size_t m = 0; m < at(clump.count); ++m) {
            Quad& place = quad(lines.place[at(clump.first_slot) + m]);
            SphereMotion& motion = lines.motion[at(clump.first_slot) + m];
            const Vec3& offset = particles.offset[first + m];
            const Quad radius = same(place.value[3]);
            const Quad centre = position + same(offset.x()) * axis[0] + same(offset.y()) * axis[1] +
                                same(offset.z()) * axis[2];
            quad(motion, 0) = with_fourth(per_drift * (centre - place), motion.inverse_mass);
            quad(motion, 1) = with_fourth(radius * turning, motion.curvature);
            place = with_fourth(centre, radius.value[3]);
        }
    }

    static void fields(auto&& field) {
        field("lines", &SphereStore::lines), field("slabs", &SphereStore::slabs),
            field("clumps", &SphereStore::clumps), field("sphere_of", &SphereStore::sphere_of_),
            field("slot_of", &SphereStore::slot_of_), field("clump_of", &SphereStore::clump_of_),
            field("first_slot", &SphereStore::first_slot_),
            field("first_clump_slot", &SphereStore::first_clump_slot_),
            field("first_clump", &SphereStore::first_clump_), field.bytes("images", &SphereStore::images_),
            field.bytes("requests", &SphereStore::requests_),
            field("first_image", &SphereStore::first_image_), field("phantom", &SphereStore::phantom_);
    }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

    static MovingClump clump(const Particles& particles, Index body) {
        const auto b = at(body);
        return {.body = body,
                .first_slot = 0,
                .count = particles.sphere_count[b],
                .position = particles.position[b],
                .velocity = particles.velocity[b],
                .angular_momentum = particles.angular_momentum[b],
                .orientation = particles.orientation[b],
                .rotation = particles.orientation[b].toRotationMatrix(),
                .mass = particles.mass[b],
                .inverse_mass = particles.inverse_mass[b],
                .inverse_inertia = particles.inverse_inertia[b]};
    }

    static void enter(HotArrays& lines, std::size_t slot, const Particles& particles, Index body,
                      std::size_t sphere) {
        const auto b = at(body);
        const Vec3 spin = particles.angular_velocity(body);
        const Vec3 arm = particles.centre[sphere] - particles.position[b];
        const Real radius = particles.radius[sphere];
        lines.place[slot] = {particles.centre[sphere], radius};
        lines.motion[slot] = {particles.velocity[b] + spin.cross(arm), particles.inverse_mass[b],
                              radius * spin, 1 / radius};
        lines.load[slot] = {.mass = particles.mass[b]};
    }

    /// Bodies slab by slab, in each slab single spheres first, then by cells, so that neighbours in space are
    /// neighbours in memory.
    std::vector<Index> order_of(const Particles& particles, std::span<const Vec3> position,
                                const Slabs::Fit& fit) const {
        const int axis = slabs.axis(), second = (axis + 1) % 3, third = (axis + 2) % 3;
        const Vec3 size = fit.high - fit.low;
        // About eight bodies to a cell.
        const Real wanted = std::max(1.0, static_cast<Real>(position.size()) / 8 / slabs.count());
        const Real cell = std::max({std::sqrt(size[second] * size[third] / wanted), size[second] / 1000,
                                    size[third] / 1000, 1e-300});
        const auto cells = [&](int a) { return static_cast<std::size_t>(size[a] / cell) + 1; };
        const std::size_t cells2 = cells(second), cells3 = cells(third), per_half = cells2 * cells3;
        std::vector<std::size_t> key(position.size());
        std::vector<Index> start(2 * per_half * at(slabs.count()) + 1, 0), order(position.size());
        for (std::size_t b = 0; b < position.size(); ++b) {
            const Vec3 from_low = position[b] - fit.low;
            const bool single = particles.sphere_count[b] == 1;
            const auto cell_along = [&](int a, std::size_t count) {  // what was fed may lie a little outside
                return static_cast<std::size_t>(
                    std::clamp(from_low[a] / cell, 0.0, static_cast<Real>(count - 1)));
            };
            key[b] =
                ((at(slabs.of(position[b])) * 2 + (single ? 0 : 1)) * cells2 + cell_along(second, cells2)) *
                    cells3 +
                cell_along(third, cells3);
            ++start[key[b] + 1];
        }
        for (std::size_t k = 1; k < start.size(); ++k) start[k] += start[k - 1];
        for (std::size_t b = 0; b < position.size(); ++b) order[at(start[key[b]]++)] = static_cast<Index>(b);
        return order;
    }

    std::vector<Index> sphere_of_, slot_of_;                                         ///< [slot], [sphere]
    std::vector<Index> clump_of_;                                                    ///< [body]
    std::vector<Index> first_slot_{0, 0}, first_clump_slot_{0}, first_clump_{0, 0};  ///< [slab]
    std::vector<SphereImage> images_;                                                ///< sorted by owner
    std::vector<ImageRequest> requests_;                                             ///< likewise
    std::vector<Index> first_image_{0, 0};                                           ///< [slab]
    Index phantom_ = 0;
    HotArrays spare_;  ///< of the arrangement before
};

}  // namespace abrade
