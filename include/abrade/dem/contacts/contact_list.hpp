#pragma once
// All contacts: from Verlet pairs to sections, and what pairs remember while lists are renewed.

#include <abrade/dem/contacts/contact_section.hpp>
#include <abrade/dem/store/sphere_store.hpp>

namespace abrade {

/// A contact as it stands, seen one by one.
inline ContactKinematics<Real> contact_between(const HotArrays& lines, std::span<const Plane> planes,
                                               const SlotPair& pair, Real dt) noexcept {
    const auto i = static_cast<std::size_t>(pair.first);
    const SpherePlace& place = lines.place[i];
    const SphereMotion& motion = lines.motion[i];
    ContactKinematics<Real> contact{};
    contact.time_step = dt;
    contact.inverse_mass = motion.inverse_mass;
    contact.curvature = motion.curvature;
    contact.inverse_turning = motion.inverse_mass * square(motion.curvature);
    contact.spin = motion.curvature * motion.surface_velocity;
    Vec3 velocity = motion.velocity, surface_velocity = motion.surface_velocity;
    Real lambda = 1;
    if (pair.second < 0) {
        const Plane& plane = planes[static_cast<std::size_t>(-1 - pair.second)];
        contact.normal = plane.normal;
        contact.overlap = place.radius - plane.distance(place.centre);
        lambda = 1 - 0.5 * contact.overlap * contact.curvature;
        if (plane.moves) {
            const Vec3 on_wall = place.centre - plane.point - lambda * place.radius * plane.normal;
            velocity -= plane.last.velocity + plane.last.spin.cross(on_wall);
            contact.spin -= plane.last.spin;
        }
    } else {
        const auto j = static_cast<std::size_t>(pair.second);
        const Vec3 apart = place.centre - lines.place[j].centre;
        const Real distance = apart.norm(), reach = place.radius + lines.place[j].radius;
        contact.normal = apart / std::max(distance, tiny<Real>);
        contact.overlap = reach - distance;
        contact.inverse_mass += lines.motion[j].inverse_mass;
        contact.curvature += lines.motion[j].curvature;
        contact.inverse_turning += lines.motion[j].inverse_mass * square(lines.motion[j].curvature);
        contact.spin -= lines.motion[j].curvature * lines.motion[j].surface_velocity;
        velocity -= lines.motion[j].velocity, surface_velocity += lines.motion[j].surface_velocity;
        lambda = distance / reach;
    }
    contact.velocity = velocity - lambda * surface_velocity.cross(contact.normal);
    contact.displacement = dt * contact.velocity, contact.rotation = dt * contact.spin;
    return contact;
}

/// The same as the law sees it that is in charge, of a contact that touches.
template <class Law>
ContactKinematics<Real> contact_seen_by(const Law& law, const HotArrays& lines, std::span<const Plane> planes,
                                        const TouchingContact<Law>& touching, Real dt) noexcept {
    ContactKinematics<Real> contact = contact_between(lines, planes, touching.pair, dt);
    if (damps_free_mass(law) && (touching.held == HeldSides::first || touching.held == HeldSides::second)) {
        const Index other = touching.held == HeldSides::first ? touching.pair.second : touching.pair.first;
        const Real free = other < 0 ? 0 : lines.motion[static_cast<std::size_t>(other)].inverse_mass;
        if (free > 0) contact.inverse_mass = free;
    }
    return contact;
}

/// What a contact is to know of a body.
struct BodyMark {
    bool watched = false;  ///< an observer sees its contacts
    bool held = false;     ///< bonds hold it, see HeldSides
};

/// The contacts of all slabs.
template <ContactLaw Law>
class ContactList {
public:
    using Memory = typename Law::template Memory<Real>;

    struct Build {
        const Particles& particles;
        std::span<const Plane> planes;
        std::span<const SearchRole> role;   ///< [sphere]
        std::span<const BodyMark> marks;    ///< [body] none: nobody watched or held
        std::span<const VerletPair> known;  ///< pairs of spheres that are found already
        Real skin = 0;                      ///< [m]
        Vec3 period = Vec3::Zero();         ///< [m]; 0 where space is open
        bool by_material = false;           ///< whether each pair of materials has packs of its own
    };

    /// Puts aside what touching pairs remember, before the store is arranged anew. `moved` [sphere] says
    /// where spheres will be (-1: gone). Returns the elastic energy of pairs that go with them [J].
    template <class Laws>
    Real keep(const Laws& laws, const SphereStore& store, std::span<const Plane> planes,
              std::span<const Index> moved) {
        kept_.clear();
        Real gone = 0;
        each_touching([&](const TouchingContact<Law>& contact) {
            const auto lasting = [&](Index slot) { return moved[at(store.sphere_of(store.owner_of(slot)))]; };
            const SlotPair& pair = contact.pair;
            const Index first = lasting(pair.first),
                        second = pair.second < 0 ? pair.second : lasting(pair.second);
            if (first < 0 || (pair.second >= 0 && second < 0))
                gone += law_between(laws, contact.materials)
                            .respond(contact_between(store.lines, planes, pair, 0), contact.memory)
                            .load.stored;
            else
                kept_.push_back({first, second, contact.memory, contact.before});
        });
        return gone;
    }

    /// Finds Verlet pairs in a store that has just been arranged; makes the images that they and `requests`
    /// need. `holds(first, second)` [sphere] says which pairs are looked after elsewhere.
    template <class Holds>
    void rebuild(SphereStore& store, const Build& build, std::vector<SphereStore::ImageRequest> requests,
                 Holds&& holds) {
        const std::vector<VerletPair> near = find(store, build);
        std::vector<Listed> listed;
        listed.reserve(near.size());
        for (const VerletPair& pair : near)
            if (const Listed one = in_charge(store, pair); !holds(one.spheres_low, one.spheres_high)) {
                listed.push_back(one);
                if (one.needs_image) requests.push_back(one.image());
            }
        store.make_images(std::move(requests), build.period);
        for (Listed& one : listed)
            if (one.needs_image) one.other = store.image_slot(one.image());
        add_planes(store, build, listed);
        share_out(store, by_own_slot(listed, store.spheres()), kept_by_sphere(build.particles.spheres()));
    }

    /// Picks the inner lists of all sections: what may touch before surfaces have come `skin` [m] nearer.
    /// Pairs that both rest (`rests` [slot, images too], empty: none) are not among them.
    void refine(const HotArrays& lines, std::span<const Plane> planes, Real skin,
                std::span<const char> rests = {}) {
        parallel_tasks(static_cast<Index>(sections_.size()),
                       [&](Index s) { sections_[at(s)].refine(lines, planes, skin, rests); });
    }

    ContactSection<Law>& section(Index slab) noexcept { return sections_[at(slab)]; }

    /// Calls `visit(TouchingContact)` for each contact that touched when last evaluated and whose pair is
    /// `wanted`; those at rest are among them.
    template <class Visit, class Wanted>
    void each_touching(Visit&& visit, Wanted&& wanted) const {
        for (const ContactSection<Law>& section : sections_) section.each_touching(visit, wanted);
    }
    template <class Visit>
    void each_touching(Visit&& visit) const {
        each_touching(visit, [](const SlotPair&) { return true; });
    }
    template <class Visit>
    void each_inner_pair(Visit&& visit) const {
        for (const ContactSection<Law>& section : sections_) section.each_inner_pair(visit);
    }
    ContactCensus census() const noexcept {
        ContactCensus all;
        for (const ContactSection<Law>& section : sections_) all += section.census();
        return all;
    }

    static void fields(auto&& field) { field("sections", &ContactList::sections_); }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

    /// A Verlet pair on its way into a section: `own` lies in the section's slab, `other` there or in the
    /// next.
    struct Listed {
        Index section = 0, chunk = 0, own = 0, other = 0;  ///< slots
        Index spheres_low = 0, spheres_high = 0;           ///< lasting indices
        ImageShift shift{};                                ///< of the other
        bool needs_image = false, own_is_high = false;
        bool own_held = false, other_held = false;
        MaterialPair materials{};
        std::uint8_t watched_sides = 0;
        SphereStore::ImageRequest image() const noexcept { return {other, chunk, shift}; }
    };

    std::vector<VerletPair> find(const SphereStore& store, const Build& build) {
        const auto count = at(store.spheres());
        std::vector<Vec3> centre(count);
        std::vector<Real> radius(count);
        std::vector<Index> body(count);
        std::vector<SearchRole> role(count);
        for (std::size_t s = 0; s < count; ++s) {
            const auto sphere = at(store.sphere_of(static_cast<Index>(s)));
            centre[s] = store.lines.place[s].centre, radius[s] = store.lines.place[s].radius;
            body[s] = build.particles.body[sphere], role[s] = build.role[sphere];
        }
        slab_.resize(count), mark_.assign(count, {});
        for (Index slab = 0; slab < store.slabs.count(); ++slab)
            std::fill(slab_.begin() + store.first_slot(slab), slab_.begin() + store.first_slot(slab + 1),
                      slab);
        if (!build.marks.empty())
            for (std::size_t s = 0; s < count; ++s) mark_[s] = build.marks[at(body[s])];
        material_.assign(count, 0);
        if (build.by_material)
            for (std::size_t s = 0; s < count; ++s) material_[s] = build.particles.material[at(body[s])];
        std::vector<VerletPair> near = verlet_pairs({centre, radius, body, role, build.skin, build.period});
        near.reserve(near.size() + build.known.size());
        for (const VerletPair& pair : build.known)
            near.push_back(
                detail::ordered(at(store.slot_of(pair.first)), at(store.slot_of(pair.second)), pair.shift));
        return near;
    }

    /// Which slab a pair belongs to: the first of its two, across the edge of a periodic axis the last slab.
    Listed in_charge(const SphereStore& store, const VerletPair& pair) const noexcept {
        const int across = pair.shift.along(store.slabs.axis());
        Listed one;
        one.own = pair.first, one.other = pair.second, one.shift = pair.shift;
        if (across < 0 || (across == 0 && slab_[at(pair.second)] < slab_[at(pair.first)])) {
            std::swap(one.own, one.other);
            one.shift = -one.shift;
        }
        one.section = slab_[at(one.own)];
        one.chunk = store.slabs.chunk_of(one.section);
        one.needs_image = !one.shift.none() || store.slabs.chunk_of(slab_[at(one.other)]) != one.chunk;
        one.spheres_low = store.sphere_of(one.own), one.spheres_high = store.sphere_of(one.other);
        // A pair keeps its direction, whatever slots its spheres get: what it remembers has a sign.
        one.own_is_high = one.spheres_low > one.spheres_high;
        if (one.own_is_high) std::swap(one.spheres_low, one.spheres_high);
        one.watched_sides =
            static_cast<std::uint8_t>(mark_[at(one.own)].watched + mark_[at(one.other)].watched);
        one.own_held = mark_[at(one.own)].held, one.other_held = mark_[at(one.other)].held;
        one.materials = MaterialPair::of(material_[at(one.own)], material_[at(one.other)]);
        return one;
    }

    void add_planes(const SphereStore& store, const Build& build, std::vector<Listed>& listed) const {
        if (build.planes.empty()) return;
        for (Index slot = 0; slot < store.spheres(); ++slot) {
            const Index sphere = store.sphere_of(slot);
            if (build.role[at(sphere)] != SearchRole::all) continue;
            const SpherePlace& place = store.lines.place[at(slot)];
            for (Index p = 0; p < static_cast<Index>(build.planes.size()); ++p) {
                if (!(build.planes[at(p)].distance(place.centre) < place.radius + 0.5 * build.skin)) continue;
                Listed one;
                one.section = slab_[at(slot)];
                one.own = slot, one.other = -1 - p;
                one.spheres_low = sphere, one.spheres_high = -1 - p;
                one.watched_sides = mark_[at(slot)].watched;
                if (build.by_material)
                    one.materials = MaterialPair::of(material_[at(slot)], build.planes[at(p)].material);
                listed.push_back(one);
            }
        }
    }

    /// Sorts by own slot, and so by section; pairs of one slot keep their order.
    static std::vector<Listed> by_own_slot(const std::vector<Listed>& listed, Index slots) {
        std::vector<Index> start(at(slots) + 1, 0);
        for (const Listed& one : listed) ++start[at(one.own) + 1];
        for (std::size_t s = 1; s < start.size(); ++s) start[s] += start[s - 1];
        std::vector<Listed> sorted(listed.size());
        for (const Listed& one : listed) sorted[at(start[at(one.own)]++)] = one;
        return sorted;
    }

    /// Sorts `kept_` by first sphere; returns where each sphere's begin.
    std::vector<Index> kept_by_sphere(Index spheres) {
        std::vector<Index> start(at(spheres) + 1, 0);
        for (const auto& k : kept_) ++start[at(k.first) + 1];
        for (std::size_t s = 1; s < start.size(); ++s) start[s] += start[s - 1];
        std::vector<KeptContact<Law>> sorted(kept_.size());
        std::vector<Index> next(start.begin(), start.end() - 1);
        for (const auto& k : kept_) sorted[at(next[at(k.first)]++)] = k;
        kept_ = std::move(sorted);
        return start;
    }

    void share_out(const SphereStore& store, const std::vector<Listed>& listed,
                   const std::vector<Index>& first_kept) {
        const auto kind_of = [](const Listed& one) {
            return ContactKind{one.other < 0 ? -1 - one.other : -1, one.materials, one.watched_sides > 0};
        };
        const Index slabs = store.slabs.count();
        std::vector<std::size_t> first(at(slabs) + 1, 0);
        for (const Listed& one : listed) ++first[at(one.section) + 1];
        for (std::size_t s = 1; s < first.size(); ++s) first[s] += first[s - 1];
        sections_.resize(at(slabs));
        parallel_tasks(slabs, [&](Index slab) {
            const auto mine =
                std::span(listed).subspan(first[at(slab)], first[at(slab) + 1] - first[at(slab)]);
            std::vector<ContactKind> kinds;
            for (const Listed& one : mine)
                if (std::find(kinds.begin(), kinds.end(), kind_of(one)) == kinds.end())
                    kinds.push_back(kind_of(one));
            std::sort(kinds.begin(), kinds.end());
            std::vector<typename ContactSection<Law>::Near> near;
            near.reserve(mine.size());
            for (const ContactKind& kind : kinds)
                for (const Listed& one : mine)
                    if (kind_of(one) == kind) near.push_back(near_of(one, first_kept));
            sections_[at(slab)].set_near(near, kinds, kept_, store.phantom());
        });
    }

    typename ContactSection<Law>::Near near_of(const Listed& one,
                                               const std::vector<Index>& first_kept) const {
        Index kept = -1;
        const auto low = at(one.spheres_low);
        for (Index k = first_kept[low]; k < first_kept[low + 1]; ++k)
            if (kept_[at(k)].second == one.spheres_high) kept = k;
        const SlotPair pair = one.own_is_high ? SlotPair{one.other, one.own} : SlotPair{one.own, one.other};
        const HeldSides held = one.own_is_high ? held_sides(one.other_held, one.own_held)
                                               : held_sides(one.own_held, one.other_held);
        return {pair, one.materials, one.watched_sides, held, kept};
    }

    std::vector<ContactSection<Law>> sections_;  ///< [slab]
    std::vector<KeptContact<Law>> kept_;         ///< sorted by first sphere
    std::vector<Index> slab_;                    ///< [slot]
    std::vector<BodyMark> mark_;                 ///< [slot]
    std::vector<Index> material_;                ///< [slot]
};

}  // namespace abrade
