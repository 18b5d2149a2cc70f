#pragma once
// Spheres that stand for a body of concrete: cubic lattices (a slab, the bed of an invert), a hexagonal close
// packing, and any packing that came from elsewhere.

#include <abrade/geometry/invert.hpp>

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace abrade {

/// One sphere of a lattice and the piece of concrete that it stands for.
struct LatticeSite {
    Vec3 centre = Vec3::Zero();              ///< [m]
    Real cell_volume = 0;                    ///< [m3]; the cells fill the body without gaps
    Index along = 0, across = 0, layer = 0;  ///< of regular lattices; layer 0 is the surface
    Index column = 0;                        ///< of the surface that stands above it
    bool held = false;                       ///< fixed, as if cast on rock
};

/// Spheres of one radius. In regular lattices layers are counted from the surface down, and the order of
/// sites is `along`, then `across`, then `layer`, the last fastest.
struct Lattice {
    Real radius = 0;  ///< of the spheres [m]
    Index count_along = 0, count_across = 0, count_layers = 0;
    std::vector<LatticeSite> sites;
    std::vector<Real> column_area;                 ///< [column] surface of its top [m2]
    std::vector<std::pair<Index, Index>> bonds{};  ///< pairs of sites that are held together, first < second

    Index site(Index along, Index across, Index layer) const noexcept {
        return (along * count_across + across) * count_layers + layer;
    }

    /// Throws InputError that begins with `name` for a radius, volume or area that is not > 0, a centre that
    /// is not finite, a site in no column, two sites at one place; a bond that is no pair of sites, is given
    /// twice or is as long as two diameters: then another sphere has room between the two.
    void validate(const std::string& name = "Lattice") const;
};

namespace detail {

inline void check_sites(const Lattice& lattice, const std::string& name) {
    const auto& sites = lattice.sites;
    const auto site = [&](std::size_t n) { return name + ".sites[" + std::to_string(n) + "]"; };
    const auto positive = [](Real value) { return value > 0 && std::isfinite(value); };
    for (std::size_t c = 0; c < lattice.column_area.size(); ++c)
        if (const Real area = lattice.column_area[c]; !positive(area))
            require_positive(area, name + ".column_area[" + std::to_string(c) + "]", "m2",
                             "give it the area of the body's surface above the column");
    for (std::size_t n = 0; n < sites.size(); ++n) {
        if (!sites[n].centre.allFinite()) require_finite(sites[n].centre, site(n) + ".centre", "m");
        if (!positive(sites[n].cell_volume))
            require_positive(sites[n].cell_volume, site(n) + ".cell_volume", "m3",
                             "give it the volume of concrete that the sphere stands for");
        if (const Index c = sites[n].column;
            c < 0 || static_cast<std::size_t>(c) >= lattice.column_area.size())
            fail({site(n) + ".column",
                  "below the number of columns, " + std::to_string(lattice.column_area.size()), "",
                  "give each column its area"},
                 std::to_string(c));
    }
    std::vector<std::size_t> order(sites.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const Vec3 &x = sites[a].centre, &y = sites[b].centre;
        return std::tuple(x.x(), x.y(), x.z()) < std::tuple(y.x(), y.y(), y.z());
    });
    for (std::size_t n = 1; n < order.size(); ++n)
        if (sites[order[n - 1]].centre == sites[order[n]].centre)
            fail({site(order[n - 1]) + " and [" + std::to_string(order[n]) + "]: distance", "> 0", "m",
                  "take one of them out"},
                 "0");
}

inline void check_bonds(const Lattice& lattice, const std::string& name) {
    const auto& bonds = lattice.bonds;
    const auto bond = [&](std::size_t n) { return name + ".bonds[" + std::to_string(n) + "]"; };
    const auto ends = [&](std::size_t n) {
        return std::to_string(bonds[n].first) + " and " + std::to_string(bonds[n].second);
    };
    const auto sites = static_cast<Index>(lattice.sites.size());
    const auto centre = [&](Index n) -> const Vec3& {
        return lattice.sites[static_cast<std::size_t>(n)].centre;
    };
    const Real too_long = 4 * lattice.radius;
    for (std::size_t n = 0; n < bonds.size(); ++n) {
        const auto& [i, j] = bonds[n];
        if (!(i >= 0 && i < j && j < sites))
            fail({bond(n), "a pair of two sites below " + std::to_string(sites) + ", the smaller first", "",
                  "make it by flat_lattice() or lattice_of()"},
                 ends(n));
        if (const Real length = (centre(j) - centre(i)).norm(); !(length < too_long))
            fail({bond(n) + ": length, of " + ends(n), "below two diameters (" + to_text(too_long) + " m)",
                  "m", "bond neighbours only: between these two another sphere has room"},
                 to_text(length));
    }
    std::vector<std::size_t> order(bonds.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return bonds[a] < bonds[b]; });
    for (std::size_t n = 1; n < order.size(); ++n)
        if (bonds[order[n - 1]] == bonds[order[n]])
            fail({bond(order[n]), "another pair than " + bond(order[n - 1]), "", "leave one of them out"},
                 ends(order[n]));
}

}  // namespace detail

inline void Lattice::validate(const std::string& name) const {
    require_positive(radius, name + ".radius", "m");
    detail::check_sites(*this, name);
    detail::check_bonds(*this, name);
}

struct LatticeSize {
    Real sphere_diameter = 0.02;  ///< [m]
    Index layers = 3;
};

/// Throws InputError for a lattice over `length` x `width` [m] that has no sphere, or far too many.
inline void check_size(const LatticeSize& size, Real length, Real width,
                       const std::string& side = "lattice side") {
    for (const Real each : {length, width}) require_positive(each, side, "m");
    const Real shortest_side = std::min(length, width);
    require_positive(size.sphere_diameter, "LatticeSize.sphere_diameter", "m");
    require(size.layers >= 1,
            {"LatticeSize.layers", "at least 1", "", "a scene without concrete has no lattice"}, size.layers);
    require(shortest_side >= size.sphere_diameter,
            {side, "at least one sphere diameter (" + to_text(size.sphere_diameter) + " m)", "m",
             "take smaller spheres or a larger body"},
            shortest_side);
    constexpr Real most = 1e8;  // some 60 GB
    const Real spheres = length / size.sphere_diameter * (width / size.sphere_diameter) * size.layers;
    require(spheres <= most,
            {"LatticeSize.sphere_diameter of " + to_text(size.sphere_diameter) + " m: spheres",
             "at most " + to_text(most), "", "take larger spheres, fewer layers or a smaller body"},
            spheres);
}

namespace detail {

/// How many spheres fit; a body meant to hold n of them must not lose one to round-off.
inline Index spheres_that_fit(Real length, Real diameter) {
    return static_cast<Index>(std::floor(length / diameter * (1 + 1e-12)));
}

/// Appends a site at the next place in the order of a regular lattice.
inline void add_site(Lattice& lattice, const Vec3& centre, Real cell_volume, Index i, Index j, Index k) {
    lattice.sites.push_back({.centre = centre,
                             .cell_volume = cell_volume,
                             .along = i,
                             .across = j,
                             .layer = k,
                             .column = i * lattice.count_across + j,
                             .held = k + 1 == lattice.count_layers});
}

/// Bonds the twelve neighbours of a hexagonal lattice. Of two rows, or of two layers, one stands half a
/// sphere further on; every other layer stands a third of a row further across.
inline void bond_hexagonal(Lattice& lattice) {
    lattice.bonds.reserve(6 * lattice.sites.size());
    for (const LatticeSite& s : lattice.sites) {
        const auto bond = [&](Index i, Index j, Index k) {
            if (i < 0 || j < 0 || i >= lattice.count_along || j >= lattice.count_across ||
                k >= lattice.count_layers)
                return;
            const Index here = lattice.site(s.along, s.across, s.layer), there = lattice.site(i, j, k);
            lattice.bonds.emplace_back(std::min(here, there), std::max(here, there));
        };
        const Index left = s.along - 1 + (s.across + s.layer) % 2;  // of the two half a sphere off
        bond(s.along + 1, s.across, s.layer);
        for (const Index i : {left, left + 1}) bond(i, s.across + 1, s.layer), bond(i, s.across, s.layer + 1);
        bond(s.along, s.across + (s.layer % 2 ? 1 : -1), s.layer + 1);
    }
}

/// Bonds the nearest neighbours along the three directions of a cubic lattice.
inline void bond_cubic(Lattice& lattice) {
    lattice.bonds.reserve(3 * lattice.sites.size());
    for (const LatticeSite& s : lattice.sites) {
        const Index here = lattice.site(s.along, s.across, s.layer);
        if (s.layer + 1 < lattice.count_layers)
            lattice.bonds.emplace_back(here, lattice.site(s.along, s.across, s.layer + 1));
        if (s.across + 1 < lattice.count_across)
            lattice.bonds.emplace_back(here, lattice.site(s.along, s.across + 1, s.layer));
        if (s.along + 1 < lattice.count_along)
            lattice.bonds.emplace_back(here, lattice.site(s.along + 1, s.across, s.layer));
    }
}
}  // namespace detail

/// A slab with its surface at z = 0, its centre at x = y = 0. Spacing is stretched a little, never
/// squeezed, so that the cells fill `length` x `width`.
inline Lattice flat_lattice(Real length, Real width, const LatticeSize& size) {
    check_size(size, length, width, "flat_lattice.side");
    const Real d = size.sphere_diameter;
    Lattice lattice{
        0.5 * d, detail::spheres_that_fit(length, d), detail::spheres_that_fit(width, d), size.layers, {}, {},
        {}};
    const Real dx = length / lattice.count_along, dy = width / lattice.count_across;
    for (Index i = 0; i < lattice.count_along; ++i)
        for (Index j = 0; j < lattice.count_across; ++j) {
            lattice.column_area.push_back(dx * dy);
            for (Index k = 0; k < size.layers; ++k)
                detail::add_site(
                    lattice, {(i + 0.5) * dx - 0.5 * length, (j + 0.5) * dy - 0.5 * width, -(k + 0.5) * d},
                    dx * dy * d, i, j, k);
        }
    detail::bond_cubic(lattice);
    return lattice;
}

/// The lattice under a concave invert. Layers follow the arc outward (down), so deeper layers are
/// spaced wider; the surface layer is the tightest and its spheres just touch at most.
inline Lattice invert_lattice(const Invert& invert, const LatticeSize& size) {
    invert.validate();
    check_size(size, invert.length, invert.width, "Invert.width or length");
    const Real d = size.sphere_diameter, radius = invert.arc_radius, span = 2 * invert.half_angle();
    Lattice lattice{0.5 * d,
                    detail::spheres_that_fit(invert.length, d),
                    detail::spheres_that_fit(span, 2 * std::asin(0.5 * d / (radius + 0.5 * d))),
                    size.layers,
                    {},
                    {},
                    {}};
    const Real dx = invert.length / lattice.count_along, dtheta = span / lattice.count_across;
    for (Index i = 0; i < lattice.count_along; ++i)
        for (Index j = 0; j < lattice.count_across; ++j) {
            const Real theta = (j + 0.5) * dtheta - 0.5 * span;
            lattice.column_area.push_back(dx * dtheta * radius);
            for (Index k = 0; k < size.layers; ++k) {
                const Real r = radius + (k + 0.5) * d;
                detail::add_site(lattice, {(i + 0.5) * dx, r * std::sin(theta), radius - r * std::cos(theta)},
                                 dx * dtheta * r * d, i, j, k);
            }
        }
    detail::bond_cubic(lattice);
    return lattice;
}

/// A slab of hexagonal close-packed spheres (coordination 12, solid fraction pi / sqrt(18)), its surface at
/// z = 0, its centre at x = y = 0. Rows lie along x; the next row is half a sphere further on, the next layer
/// in the hollows. Rows and spheres in them are spaced a little wider, never closer, so that they fill
/// `length` x `width`. Each sphere is bonded to its twelve neighbours. Throws InputError for sides too
/// short for rows that stand half a sphere on.
inline Lattice hexagonal_lattice(Real length, Real width, const LatticeSize& size) {
    check_size(size, length, width, "hexagonal_lattice.side");
    const Real d = size.sphere_diameter, row = d * std::sqrt(0.75), layer = d * std::sqrt(2.0 / 3);
    // Half a sphere more for the rows that stand half a sphere on, a third of a row for the layers that do.
    Lattice lattice{0.5 * d,
                    detail::spheres_that_fit(length - 0.5 * d, d),
                    detail::spheres_that_fit(width - d + row * 2 / 3, row),
                    size.layers,
                    {},
                    {},
                    {}};
    require(
        lattice.count_along >= 1 && lattice.count_across >= 1,
        {"hexagonal_lattice.side", "at least 1.5 sphere diameters of " + to_text(d) + " m along, 1.3 across",
         "m", "take smaller spheres or a larger body"},
        std::min(length, width));
    const Real dx = (length - d) / (lattice.count_along - 0.5),
               dy = (width - d) / (lattice.count_across - 2.0 / 3);
    const Real area = length * width / (lattice.count_along * lattice.count_across);
    for (Index i = 0; i < lattice.count_along; ++i)
        for (Index j = 0; j < lattice.count_across; ++j) {
            lattice.column_area.push_back(area);
            for (Index k = 0; k < size.layers; ++k) {
                const Real x = 0.5 * d + (i + 0.5 * ((j + k) % 2)) * dx,
                           y = 0.5 * d + (j + (k % 2) / 3.0) * dy;
                const Real beyond =
                    0.5 * (d - layer);  // of the first and the last layer, to the slab's faces
                const Real height = layer + beyond * ((k == 0) + (k + 1 == size.layers));
                detail::add_site(lattice, {x - 0.5 * length, y - 0.5 * width, -0.5 * d - k * layer},
                                 area * height, i, j, k);
            }
        }
    detail::bond_hexagonal(lattice);
    return lattice;
}

/// A body from spheres that stand somewhere already, a random packing for one: those whose gap is at most
/// `gap` times the diameter are bonded, those that stand below `held_below` [m] are fixed, and each stands
/// for an equal share of `volume` [m3]. Columns are squares of one diameter. Throws InputError for no
/// spheres, a centre that is not finite, a radius or volume that is not > 0, a negative gap, spheres that
/// are far too scattered, and two that stand at one place.
inline Lattice lattice_of(const std::vector<Vec3>& centres, Real radius, Real volume, Real gap = 0.05,
                          Real held_below = -std::numeric_limits<Real>::infinity()) {
    require(!centres.empty(), {"lattice_of.centres", "at least 1", "", "a body without spheres is none"}, 0);
    require_positive(radius, "lattice_of.radius", "m");
    require_positive(volume, "lattice_of.volume", "m3");
    require_not_negative(gap, "lattice_of.gap");
    Lattice lattice{radius, 0, 0, 0, {}, {}, {}};
    Vec3 low = centres.front(), high = low;
    for (std::size_t n = 0; n < centres.size(); ++n) {
        require_finite(centres[n], "lattice_of.centres[" + std::to_string(n) + "]", "m");
        low = low.cwiseMin(centres[n]), high = high.cwiseMax(centres[n]);
    }
    const Real d = 2 * radius;
    constexpr Real most = 1e8;  // some GB
    const Real columns = ((high.x() - low.x()) / d + 1) * ((high.y() - low.y()) / d + 1);
    require(columns <= most,
            {"lattice_of: columns of one diameter over the spheres' extent", "at most " + to_text(most), "",
             "look for a sphere that stands far from the others"},
            columns);
    lattice.count_along = static_cast<Index>((high.x() - low.x()) / d) + 1;
    lattice.count_across = static_cast<Index>((high.y() - low.y()) / d) + 1;
    lattice.column_area.assign(
        static_cast<std::size_t>(lattice.count_along) * static_cast<std::size_t>(lattice.count_across),
        d * d);
    for (const Vec3& x : centres) {
        const auto i = static_cast<Index>((x.x() - low.x()) / d),
                   j = static_cast<Index>((x.y() - low.y()) / d);
        lattice.sites.push_back({.centre = x,
                                 .cell_volume = volume / static_cast<Real>(centres.size()),
                                 .along = i,
                                 .across = j,
                                 .column = i * lattice.count_across + j,
                                 .held = x.z() < held_below});
    }
    // Along the longest axis in order, so that only those within reach along it are compared.
    int axis = 0;
    (high - low).maxCoeff(&axis);
    std::vector<Index> order(centres.size());
    for (std::size_t n = 0; n < order.size(); ++n) order[n] = static_cast<Index>(n);
    const auto at = [&](Index n) -> const Vec3& { return centres[static_cast<std::size_t>(n)]; };
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return at(a)[axis] < at(b)[axis]; });
    const Real reach = (1 + gap) * d;
    for (auto a = order.begin(); a != order.end(); ++a)
        for (auto b = a + 1; b != order.end() && at(*b)[axis] - at(*a)[axis] <= reach; ++b)
            if (const Real apart2 = (at(*b) - at(*a)).squaredNorm(); apart2 <= reach * reach) {
                if (apart2 < 0.25 * d * d)
                    fail({"lattice_of.centres[" + std::to_string(std::min(*a, *b)) + "] and [" +
                              std::to_string(std::max(*a, *b)) + "]",
                          "at least a radius apart", "m", "take one of them out"},
                         to_text(std::sqrt(apart2)));
                lattice.bonds.emplace_back(std::min(*a, *b), std::max(*a, *b));
            }
    std::sort(lattice.bonds.begin(), lattice.bonds.end());
    return lattice;
}

}  // namespace abrade
