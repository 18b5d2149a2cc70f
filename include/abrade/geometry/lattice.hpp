#pragma once
// Cubic lattices of spheres: a flat slab, and one bent along the arc of an invert.

#include <abrade/geometry/invert.hpp>

#include <utility>
#include <vector>

namespace abrade {

/// One sphere of a lattice and the piece of concrete that it stands for.
struct LatticeSite {
    Vec3 centre = Vec3::Zero();              ///< [m]
    Real cell_volume = 0;                    ///< [m3]; the cells fill the body without gaps
    Index along = 0, across = 0, layer = 0;  ///< layer 0 is the surface
};

/// Spheres of one radius on a cubic lattice; layers are counted from the surface down.
/// Order of sites: `along`, then `across`, then `layer`, the last fastest.
struct Lattice {
    Real radius = 0;  ///< of the spheres [m]
    Index count_along = 0, count_across = 0, count_layers = 0;
    std::vector<LatticeSite> sites;
    std::vector<Real> column_area;  ///< [along x across] surface of a column's top [m2]

    Index site(Index along, Index across, Index layer) const noexcept {
        return (along * count_across + across) * count_layers + layer;
    }

    /// The nearest neighbours along the three lattice directions, as pairs of sites (first < second).
    std::vector<std::pair<Index, Index>> neighbours() const {
        std::vector<std::pair<Index, Index>> pairs;
        pairs.reserve(3 * sites.size());
        for (Index i = 0; i < count_along; ++i)
            for (Index j = 0; j < count_across; ++j)
                for (Index k = 0; k < count_layers; ++k) {
                    if (k + 1 < count_layers) pairs.emplace_back(site(i, j, k), site(i, j, k + 1));
                    if (j + 1 < count_across) pairs.emplace_back(site(i, j, k), site(i, j + 1, k));
                    if (i + 1 < count_along) pairs.emplace_back(site(i, j, k), site(i + 1, j, k));
                }
        return pairs;
    }
};

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
}  // namespace detail

/// A slab with its surface at z = 0, its centre at x = y = 0. Spacing is stretched a little, never
/// squeezed, so that the cells fill `length` x `width`.
inline Lattice flat_lattice(Real length, Real width, const LatticeSize& size) {
    check_size(size, length, width, "flat_lattice.side");
    const Real d = size.sphere_diameter;
    Lattice lattice{
        0.5 * d, detail::spheres_that_fit(length, d), detail::spheres_that_fit(width, d), size.layers, {},
        {}};
    const Real dx = length / lattice.count_along, dy = width / lattice.count_across;
    for (Index i = 0; i < lattice.count_along; ++i)
        for (Index j = 0; j < lattice.count_across; ++j) {
            lattice.column_area.push_back(dx * dy);
            for (Index k = 0; k < size.layers; ++k)
                lattice.sites.push_back(
                    {{(i + 0.5) * dx - 0.5 * length, (j + 0.5) * dy - 0.5 * width, -(k + 0.5) * d},
                     dx * dy * d,
                     i,
                     j,
                     k});
        }
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
                    {}};
    const Real dx = invert.length / lattice.count_along, dtheta = span / lattice.count_across;
    for (Index i = 0; i < lattice.count_along; ++i)
        for (Index j = 0; j < lattice.count_across; ++j) {
            const Real theta = (j + 0.5) * dtheta - 0.5 * span;
            lattice.column_area.push_back(dx * dtheta * radius);
            for (Index k = 0; k < size.layers; ++k) {
                const Real r = radius + (k + 0.5) * d;
                lattice.sites.push_back({{(i + 0.5) * dx, r * std::sin(theta), radius - r * std::cos(theta)},
                                         dx * dtheta * r * d,
                                         i,
                                         j,
                                         k});
            }
        }
    return lattice;
}

}  // namespace abrade
