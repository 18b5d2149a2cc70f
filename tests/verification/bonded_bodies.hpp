#pragma once
// Bodies of bonded spheres, regular and random: how they are made, hung, pressed, and what is seen in them.

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/sim/simulation.hpp>

#include <numeric>
#include <ostream>
#include <random>
#include <set>

namespace bonded_bodies {

using namespace abrade;

constexpr Real d = 0.02, density = 2400, tensile = 2.7e6;
constexpr Real kn = 4e7;  ///< a bond breaks at a stretch of a thousandth of d [N/m]
inline const Real mass = density * pi / 6 * cube(d), unit = std::sqrt(mass / kn);  ///< [kg], [s]

inline MohrCoulomb bond_law(Real ratio, Real damping) {
    return MohrCoulomb{{.tensile = tensile, .stiffness = kn, .stiffness_ratio = ratio, .damping = damping}};
}

/// Spheres that stand for a piece of a material each.
struct Material {
    std::vector<Vec3> centres;
    Real each = 0;  ///< volume that a sphere stands for [m3]; of one layer its area times d
};

/// Random dense packing in a box [d] that is periodic: spheres are put anywhere, without overlaps, and grow
/// to their size in steps, pushing each other about without friction. No wall has ordered it.
inline Material random_packing(const Vec3& box, Real solid = 0.63, unsigned seed = 1) {
    const Vec3 size = d * box;
    const auto count = static_cast<std::size_t>(std::lround(solid * box.prod() * 6 / pi));
    std::mt19937 random(seed);
    std::uniform_real_distribution<Real> u(0, 1);
    constexpr int growths = 10;
    Real diameter = d * std::cbrt(0.2 / solid);  // a fifth is solid
    const Real growth = std::pow(d / diameter, 1.0 / growths);
    std::vector<Vec3> centres;
    const auto free = [&](const Vec3& x) {
        for (const Vec3& other : centres) {
            Vec3 apart = x - other;
            for (int a = 0; a < 3; ++a) apart[a] -= size[a] * std::round(apart[a] / size[a]);
            if (apart.squaredNorm() < square(diameter)) return false;
        }
        return true;
    };
    while (centres.size() < count) {
        const Real x = u(random), y = u(random), z = u(random);
        if (const Vec3 at = size.cwiseProduct(Vec3(x, y, z)); free(at)) centres.push_back(at);
    }
    for (int n = 0; n < growths; ++n) {
        diameter *= growth;
        Scene scene;
        scene.gravity.setZero();
        scene.bounds = {Vec3::Zero(), size};
        scene.periodic_along = {true, true, true};
        for (const Vec3& x : centres) scene.add_sphere(0.5 * diameter, {.position = x}, density);
        auto sim = simulate(std::move(scene)).contact(LinearSpring{{.stiffness = kn, .restitution = 0.3}});
        sim.run({.end_time = (n + 1 < growths ? 100 : 400) * unit});
        centres = sim.particles().position;
    }
    for (Vec3& x : centres)
        for (int a = 0; a < 3; ++a) x[a] -= size[a] * (std::floor(x[a] / size[a]) + 0.5);
    return {std::move(centres), pi / 6 * cube(d) / solid};
}

/// One layer of a triangular lattice in the plane of x and z, rows along x, or along z.
inline Material triangular_sheet(Real length_x, Real length_z, bool rows_along_z) {
    Material sheet{{}, std::sqrt(0.75) * cube(d)};
    const Real along = rows_along_z ? length_z : length_x, across = rows_along_z ? length_x : length_z;
    const Real row = d * std::sqrt(0.75);
    for (int j = -static_cast<int>(across / row); j <= static_cast<int>(across / row); ++j)
        for (int i = -static_cast<int>(along / d); i <= static_cast<int>(along / d); ++i) {
            const Real a = (i + 0.5 * (j & 1)) * d, b = j * row;
            if (std::abs(a) > 0.5 * along + 1e-9 * d || std::abs(b) > 0.5 * across + 1e-9 * d) continue;
            sheet.centres.push_back(rows_along_z ? Vec3(b, 0, a) : Vec3(a, 0, b));
        }
    return sheet;
}

/// What of it is `inside`, bonded to neighbours whose gap is below 5 % of d; spheres that fewer than three
/// bonds would hold are left out. Those below `held_below` [m] are held.
template <class Inside>
Lattice cut(const Material& from, const Inside& inside,
            Real held_below = -std::numeric_limits<Real>::infinity()) {
    std::vector<Vec3> kept;
    for (const Vec3& x : from.centres)
        if (inside(x)) kept.push_back(x);
    const auto all = [&] {
        return lattice_of(kept, 0.5 * d, static_cast<Real>(kept.size()) * from.each, 0.05, held_below);
    };
    for (;;) {
        Lattice lattice = all();
        std::vector<int> bonds(kept.size());
        for (const auto& [i, j] : lattice.bonds)
            ++bonds[static_cast<std::size_t>(i)], ++bonds[static_cast<std::size_t>(j)];
        std::vector<Vec3> firm;
        for (std::size_t n = 0; n < kept.size(); ++n)
            if (bonds[n] >= 3 || lattice.sites[n].held) firm.push_back(kept[n]);
        if (firm.size() == kept.size()) return lattice;
        kept = std::move(firm);
    }
}

/// What bonds do and how spheres moved, of a body that is (nearly) at rest.
class Look {
public:
    template <class Sim>
    Look(const Sim& sim, const std::vector<Vec3>& start) : start_(start), now_(sim.particles().position) {
        now_.resize(start.size());
        auto network = sim.world().network();  // a copy, for what bonds remember is in packs
        network.unpack();
        const MohrCoulomb& law = sim.bond_law();
        const Real tan_phi = std::tan(radians(law.params().friction_angle));
        for (const auto& bond : network.bonds()) {
            if (bond.broken()) continue;
            const auto i = static_cast<std::size_t>(bond.bodies.first),
                       j = static_cast<std::size_t>(bond.bodies.second);
            const Vec3 apart = now_[i] - now_[j];
            const Real pull = law.stiffness() * (apart.norm() - bond.rest_length);
            const Vec3 shear = law.tangential_stiffness() * bond.memory.spring;
            bonds_.push_back({{bond.bodies.first, bond.bodies.second},
                              -pull * apart.normalized() - shear,
                              (pull + shear.norm() / tan_phi) / law.capacity(0.5 * d)});
        }
    }

    struct Bond {
        BondedPair ends;
        Vec3 force;   ///< on the first [N]
        Real needed;  ///< share of its strength without which it breaks [-]
    };
    const std::vector<Bond>& bonds() const { return bonds_; }
    Vec3 middle(const BondedPair& pair) const {
        return 0.5 *
               (start_[static_cast<std::size_t>(pair.first)] + start_[static_cast<std::size_t>(pair.second)]);
    }
    Vec3 along(const BondedPair& pair) const {
        return (start_[static_cast<std::size_t>(pair.first)] - start_[static_cast<std::size_t>(pair.second)])
            .normalized();
    }
    /// Mean stress of the spheres that are `inside`, tension positive [Pa] (J. Christoffersen, M. M.
    /// Mehrabadi, S. Nemat-Nasser, J. Appl. Mech. 48 (1981) 339, doi:10.1115/1.3157619).
    template <class Inside>
    Mat3 stress(Real each, const Inside& inside) const {
        Mat3 sum = Mat3::Zero();
        Real volume = 0;
        for (const Vec3& x : start_) volume += inside(x) ? each : 0;
        for (const Bond& bond : bonds_) {
            const auto i = static_cast<std::size_t>(bond.ends.first),
                       j = static_cast<std::size_t>(bond.ends.second);
            const Real share = 0.5 * (inside(start_[i]) + inside(start_[j]));
            if (share > 0) sum -= share * bond.force * (now_[i] - now_[j]).transpose();
        }
        return 0.5 * (sum + sum.transpose()) / volume;
    }
    /// Mean strain there: displacements fitted by a straight line [-].
    template <class Inside>
    Mat3 strain(const Inside& inside) const {
        Mat3 spread = Mat3::Zero(), moved = Mat3::Zero();
        Vec3 x = Vec3::Zero(), u = Vec3::Zero();
        Real n = 0;
        for (std::size_t b = 0; b < start_.size(); ++b)
            if (inside(start_[b])) x += start_[b], u += now_[b] - start_[b], ++n;
        x /= n, u /= n;
        for (std::size_t b = 0; b < start_.size(); ++b) {
            if (!inside(start_[b])) continue;
            const Vec3 from = start_[b] - x;
            spread += from * from.transpose(), moved += (now_[b] - start_[b] - u) * from.transpose();
        }
        for (int a = 0; a < 3; ++a)
            if (spread(a, a) == 0) spread(a, a) = 1;  // a sheet
        const Mat3 gradient = moved * spread.inverse();
        return 0.5 * (gradient + gradient.transpose());
    }

private:
    const std::vector<Vec3>& start_;
    std::vector<Vec3> now_;
    std::vector<Bond> bonds_;
};

/// Of an isotropic solid, from one state of stress and strain: K from their traces, G from the rest.
struct Isotropic {
    Real bulk, shear;  ///< [Pa]
    static Isotropic of(const Mat3& stress, const Mat3& strain) {
        const Mat3 s = stress - stress.trace() / 3 * Mat3::Identity(),
                   e = strain - strain.trace() / 3 * Mat3::Identity();
        return {stress.trace() / (3 * strain.trace()), 0.5 * s.cwiseProduct(e).sum() / e.squaredNorm()};
    }
    Real youngs() const { return 9 * bulk * shear / (3 * bulk + shear); }
    Real poisson() const { return (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)); }
    Real constrained() const { return bulk + 4.0 / 3 * shear; }
};

/// A body between two heavy plates that move along z towards each other, or apart. Nothing else holds it, so
/// all its spheres can touch.
struct Machine {
    std::vector<Vec3> below, above;  ///< spheres of the body that a plate has been cast to
    bool apart = false;              ///< plates pull, at the other side of these spheres
    Real way = 0;                    ///< of each plate over `duration`, where nothing yields [m]
    Real energy = 0;                 ///< of the plates, far more than breaking takes [J]
    Real duration = 3000;            ///< [sqrt(m / k_n)]
    Real ratio = 0.2;                ///< k_s / k_n
    Real damping = 0.2;              ///< of bonds
};

/// How close to breaking a bond was.
struct Strained {
    Vec3 place, along;  ///< its middle [m], its direction, as built
    Real needed;        ///< share of its strength without which it breaks [-]
};

struct Crack {
    Vec3 place;  ///< of the bond as it was built [m]
    Real load;   ///< as it was found broken [N]
};

struct Loaded {
    std::vector<Real> load, moved;                      ///< [observation] [N]; both plates together [m]
    std::vector<Index> broken;                          ///< [observation] bonds
    Mat3 stress = Mat3::Zero(), strain = Mat3::Zero();  ///< sums over observations before a bond broke, ...
    Real load_then = 0;                                 ///< ... and of the load [N]; tension positive
    Real first = 0, peak = 0;                           ///< load at the first broken bond, the largest [N]
    std::vector<Crack> cracks;                          ///< in the order in which they were found
    std::vector<Vec3> spheres;                          ///< at the end
    std::vector<BondedPair> sound;                      ///< bonds left at the end
    std::vector<Strained> strained;                     ///< bonds as last seen before one broke, ...
    Real strained_load = 0;                             ///< ... under this load [N]
    Ledger start, end;
    Index parted = 0;  ///< spheres that sound bonds do not tie to the first any more
};

/// How many spheres the bonds do not tie to the first.
inline Index parted(std::size_t spheres, const std::set<BondedPair>& bonds) {
    std::vector<Index> piece(spheres);
    std::iota(piece.begin(), piece.end(), 0);
    const auto root = [&](Index n) {
        while (piece[static_cast<std::size_t>(n)] != n) n = piece[static_cast<std::size_t>(n)];
        return n;
    };
    for (const BondedPair& pair : bonds)
        piece[static_cast<std::size_t>(root(pair.first))] = root(pair.second);
    Index count = 0;
    for (Index n = 0; n < static_cast<Index>(spheres); ++n) count += root(n) != root(0);
    return count;
}

/// Loads the body until it bears half its peak where it is pressed, and next to nothing where it is pulled.
/// Stress and strain are those of the spheres `inside`.
template <class Inside>
Loaded run(const Machine& machine, const Lattice& lattice, Real each, const Inside& inside) {
    std::vector<Vec3> start;
    for (const LatticeSite& site : lattice.sites) start.push_back(site.centre);
    Scene scene;
    scene.gravity.setZero();
    scene.concrete = ConcreteBlock{lattice, density};
    const Real speed = machine.way / (machine.duration * unit), plate_mass = machine.energy / square(speed);
    const Real outward = machine.apart ? 1 : -1;
    for (const Real side : {-1.0, 1.0}) {
        Clump plate{.name = "plate"};
        const std::vector<Vec3>& cast = side < 0 ? machine.below : machine.above;
        Vec3 middle = Vec3::Zero();
        for (const Vec3& x : cast) middle += x / static_cast<Real>(cast.size());
        for (const Vec3& x : cast)
            plate.members.push_back({x - outward * side * d * Vec3::UnitZ() - middle, 0.5 * d});
        plate.volume = cube(d);
        plate.principal_moments.setConstant(1e6 * square(d) * cube(d));  // keeps upright
        for (const Sphere& s : plate.members)
            plate.bounding_radius = std::max(plate.bounding_radius, s.centre.norm() + s.radius);
        scene.add_stone(plate, {.position = middle, .velocity = {0, 0, outward * side * speed}},
                        plate_mass / cube(d));
    }
    auto sim = simulate(scene)
                   .contact(LinearSpring{{.stiffness = kn}})
                   .bond(bond_law(machine.ratio, machine.damping));

    Loaded seen;
    std::set<BondedPair> sound;
    const std::size_t below = start.size(), above = below + 1;
    const Real every = machine.duration * unit / 300;
    Real fast = 2 * speed, gap = 0;
    const auto observe = [&] {
        const Particles& p = sim.particles();
        const Real v = outward * (p.velocity[above].z() - p.velocity[below].z());
        const Real apart = p.position[above].z() - p.position[below].z();
        if (seen.load.empty()) gap = apart, seen.start = sim.ledger();
        const Real load = seen.load.empty() ? 0 : 0.5 * plate_mass * (fast - v) / every;
        fast = v;
        seen.load.push_back(load), seen.moved.push_back(std::abs(apart - gap));
        seen.broken.push_back(sim.bonds_broken());
        const Look look(sim, start);
        std::set<BondedPair> still;
        for (const auto& bond : look.bonds()) still.insert(bond.ends);
        const std::size_t known = seen.cracks.size();
        for (const BondedPair& pair : sound)
            if (!still.contains(pair)) seen.cracks.push_back({look.middle(pair), load});
        sound = std::move(still);
        if (seen.cracks.size() > known) seen.parted = parted(start.size(), sound);
        if (sim.bonds_broken() == 0) {
            seen.strained.clear(), seen.strained_load = load;
            for (const auto& bond : look.bonds())
                seen.strained.push_back({look.middle(bond.ends), look.along(bond.ends), bond.needed});
        }
        seen.peak = std::max(seen.peak, load);
        if (seen.first == 0 && sim.bonds_broken() > 0) seen.first = load;
        if (sim.bonds_broken() == 0 && seen.load.size() > 30)
            seen.stress += look.stress(each, inside), seen.strain += look.strain(inside),
                seen.load_then += outward * load;
    };
    sim.run({.end_time = 0});
    observe();
    const auto over = [&] {
        if (seen.first == 0) return false;
        if (!machine.apart) return seen.load.back() < 0.5 * seen.peak;
        // Plates lose touch for a while as the body springs back.
        const auto last = std::min<std::ptrdiff_t>(std::ssize(seen.load), 30);
        return std::accumulate(seen.load.end() - last, seen.load.end(), 0.0) < 0.02 * seen.peak * 30;
    };
    for (int n = 1; n < 900 && !over(); ++n) {
        sim.run({.end_time = n * every});
        observe();
    }
    seen.spheres = sim.particles().position;
    seen.spheres.resize(start.size());
    seen.sound.assign(sound.begin(), sound.end());
    seen.end = sim.ledger();
    return seen;
}

/// Spheres of a body whose side towards `side` along z is free, so that a plate can be cast to them there.
template <class Where>
std::vector<Vec3> faces(const Lattice& lattice, Real side, const Where& where) {
    std::vector<Vec3> open;
    const auto& sites = lattice.sites;
    for (const LatticeSite& site : sites) {
        const Vec3& x = site.centre;
        if (!where(x)) continue;
        const Vec3 beyond = x + side * d * Vec3::UnitZ();
        if (std::none_of(sites.begin(), sites.end(), [&](const LatticeSite& other) {
                const Vec3 apart = other.centre - x;
                const Real height = side * apart.z();
                return (other.centre - beyond).squaredNorm() < square(d * (1 - 1e-9)) ||
                       (height > 0.6 * d && height < 3 * d && apart.head(2).norm() < 0.9 * d);
            }))
            open.push_back(x);
    }
    return open;
}

/// A bar along z with a neck, round fillets, and heads by whose shoulders it is pulled [d].
struct Bar {
    Real neck_width = 6, neck_height = 3, root_width = 8, head_width = 12, head_height = 3.5;
    bool sheet = false;
    static constexpr Real fillet = 12;  ///< radius

    Real fillet_height() const { return std::sqrt(fillet * (root_width - neck_width)); }
    Real height() const { return neck_height + 2 * fillet_height() + 2 * head_height; }
    bool holds(const Vec3& x) const {
        const Real z = std::abs(x.z()) / d, beyond = std::max(z - 0.5 * neck_height, 0.0);
        Real half = 0.5 * neck_width + square(beyond) / (2 * fillet);
        if (beyond > fillet_height()) half = 0.5 * head_width;
        half += 1e-9;
        return z <= 0.5 * height() && std::abs(x.x()) <= half * d && (sheet || std::abs(x.y()) <= half * d);
    }
    bool on_shoulder(const Vec3& x, Real side) const {
        const Real wide = sheet ? std::abs(x.x()) : std::max(std::abs(x.x()), std::abs(x.y()));
        return side * x.z() > 0 && wide > 0.5 * root_width * d;
    }
};

/// What a bar shows that is drawn apart, in units of the bonds: k_n / d, A sigma_t / d^2.
struct Drawn {
    Isotropic solid;       ///< [Pa]
    Real youngs;           ///< stress over strain along the bar [k_n / d]
    Real first, strength;  ///< [A sigma_t / d^2]
    Real bonds;            ///< a sphere
    std::size_t spheres;
    Loaded seen;
};

inline std::ostream& operator<<(std::ostream& out, const Drawn& bar) {
    return out << bar.spheres << " spheres, " << bar.bonds << " bonds a sphere; E " << bar.youngs
               << " k_n/d; as an isotropic solid E " << bar.solid.youngs() / (kn / d) << ", nu "
               << bar.solid.poisson() << ", M " << bar.solid.constrained() / (kn / d) << "; first bond at "
               << bar.first << ", most " << bar.strength << " A sigma_t/d^2; " << bar.seen.cracks.size()
               << " bonds broken, the first at z " << bar.seen.cracks.at(0).place.z() / d << " d, "
               << bar.seen.parted << " spheres parted; lost " << bar.seen.end.lost() << " J, residue "
               << bar.seen.end.integration_residue() << " J, residual " << bar.seen.end.residual_relative();
}

inline Drawn draw_apart(const Material& material, const Bar& bar, Real ratio) {
    const Lattice lattice = cut(material, [&](const Vec3& x) { return bar.holds(x); });
    const Real area = bar.neck_width * d * (bar.sheet ? d : bar.neck_width * d);
    const Real stress = tensile * pi / 4, way = 2 * bar.height() * stress * square(d) / kn;
    const auto shoulder = [&](Real side) {
        return faces(lattice, -side, [&](const Vec3& x) { return bar.on_shoulder(x, side); });
    };
    const Machine machine{.below = shoulder(-1),
                          .above = shoulder(1),
                          .apart = true,
                          .way = way,
                          .energy = 10 * stress * area * way,
                          .ratio = ratio};
    // Where neither ends nor sides are near: spheres at sides lack bonds.
    const Real middle = 0.6 * bar.neck_height * d, core = (0.5 * bar.neck_width - 0.75) * d;
    const auto inside = [&](const Vec3& x) {
        return std::abs(x.z()) <= middle && std::max(std::abs(x.x()), std::abs(x.y())) <= core;
    };
    Drawn drawn{
        .solid = {},
        .youngs = 0,
        .first = 0,
        .strength = 0,
        .bonds = 2 * static_cast<Real>(lattice.bonds.size()) / static_cast<Real>(lattice.sites.size()),
        .spheres = lattice.sites.size(),
        .seen = run(machine, lattice, material.each, inside)};
    const Loaded& seen = drawn.seen;
    drawn.solid = Isotropic::of(seen.stress, seen.strain);
    drawn.youngs = seen.stress(2, 2) / seen.strain(2, 2) / (kn / d);
    drawn.first = seen.first / area / stress, drawn.strength = seen.peak / area / stress;
    return drawn;
}

/// A disc in the plane of x and z, pressed along z by plates cast to an arc of it.
struct Disc {
    Real radius = 0, thickness = d;  ///< [m]; of one layer d
    Real half_arc = 0.15;            ///< of the plates [rad]
    Real ratio = 0.2;                ///< k_s / k_n
};

/// Stresses of an elastic disc under two forces P along z (H. Hertz 1883; S. P. Timoshenko, J. N. Goodier,
/// Theory of Elasticity, McGraw-Hill 1951), across and along the load, in units of 2 P / (pi D t).
inline std::pair<Real, Real> two_forces(const Vec3& x, Real radius) {
    const Real up = radius - x.z(), down = radius + x.z(), x2 = square(x.x());
    const Real r1 = square(x2 + up * up), r2 = square(x2 + down * down), diameter = 2 * radius;
    return {1 - diameter * x2 * (up / r1 + down / r2), 1 - diameter * (cube(up) / r1 + cube(down) / r2)};
}

/// 2 P / (pi D t) in A sigma_t / d^2 at the first broken bond and at most, ...
struct Pressed {
    Real first, strength;
    Real tension, pressure;  ///< ... stresses at the centre over the closed form's, before a bond broke
    Loaded seen;
};

inline Pressed press(const Material& material, const Disc& disc) {
    const Real R = disc.radius;
    const Lattice lattice = cut(material, [&](const Vec3& x) {
        return std::hypot(x.x(), x.z()) <= R && std::abs(x.y()) <= 0.5 * disc.thickness;
    });
    const Real stress = tensile * pi / 4, way = 6 * R * stress * d / kn;
    const auto arc = [&](Real side) {
        return faces(lattice, side, [&](const Vec3& x) {
            return side * x.z() > 0 && std::abs(x.x()) <= R * std::sin(disc.half_arc);
        });
    };
    const auto centre = [&](const Vec3& x) { return std::hypot(x.x(), x.z()) < 0.2 * R; };
    const Real per_stress = 0.5 * pi * 2 * R * disc.thickness;
    Pressed pressed{.first = 0,
                    .strength = 0,
                    .tension = 0,
                    .pressure = 0,
                    .seen = run({.below = arc(-1),
                                 .above = arc(1),
                                 .way = way,
                                 .energy = 10 * per_stress * stress * way,
                                 .ratio = disc.ratio},
                                lattice, material.each, centre)};
    Real across = 0, along = 0, spheres = 0;
    for (const LatticeSite& site : lattice.sites)
        if (centre(site.centre)) {
            const auto [s, p] = two_forces(site.centre, R);
            across += s, along += p, ++spheres;
        }
    const Loaded& seen = pressed.seen;
    const Real scale = -seen.load_then / per_stress / spheres;
    pressed.tension = seen.stress(0, 0) / (scale * across);
    pressed.pressure = seen.stress(2, 2) / (scale * along);
    pressed.first = seen.first / per_stress / stress, pressed.strength = seen.peak / per_stress / stress;
    return pressed;
}

/// The front of a plane wave that leaves the held base of a slab, as gravity g is put on at once: before it
/// has come spheres fall freely, w = 1/2 g t^2; afterwards their way is short of that by 1/2 g (t - z/c)^2.
/// So sqrt(2 short / g) falls with z as -z/c. [m/s]
inline Real front_speed(const Lattice& lattice, Real base, Real expected, Real low, Real high, Real aside,
                        Real ratio) {
    Scene scene;
    const Real gravity = 1e-5 * d / square(unit), time = high / 0.6 / expected;
    scene.gravity = {0, 0, gravity};
    scene.concrete = ConcreteBlock{lattice, density};
    auto sim =
        simulate(scene)
            .contact(LinearSpring{{.stiffness = kn}})
            .bond(MohrCoulomb{{.tensile = 1e12, .stiffness = kn, .stiffness_ratio = ratio, .damping = 0}});
    sim.run({.end_time = time, .time_step = 0.05 * unit});
    Real x = 0, y = 0, xx = 0, xy = 0, n = 0;
    for (std::size_t b = 0; b < lattice.sites.size(); ++b) {
        const Vec3& start = lattice.sites[b].centre;
        const Real z = start.z() - base;
        if (z < low || z > high || std::max(std::abs(start.x()), std::abs(start.y())) > aside) continue;
        const Real lacks = 0.5 * gravity * square(time) - (sim.particles().position[b].z() - start.z());
        const Real since = std::sqrt(2 * std::max(lacks, 0.0) / gravity);
        x += z, y += since, xx += z * z, xy += z * since, ++n;
    }
    return -(xx - x * x / n) / (xy - x * y / n);
}

}  // namespace bonded_bodies
