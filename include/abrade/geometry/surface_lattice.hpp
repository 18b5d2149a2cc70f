#pragma once
// Concrete whose top is any surface z = h(x, y): a lattice that follows it, or a packing that is cut by it.

#include <abrade/geometry/lattice.hpp>

#include <cmath>
#include <concepts>
#include <string>

namespace abrade {

/// A surface over the x-y plane: `surface(x, y)` is its height [m].
template <class H>
concept HeightField = requires(const H& surface, Real x) {
    { surface(x, x) } -> std::convertible_to<Real>;
};

namespace detail {

/// Height of a surface [m]; InputError names `function` and where it is not finite.
template <HeightField H>
Real height_at(const H& surface, Real x, Real y, const std::string& function) {
    const Real z = surface(x, y);
    if (!std::isfinite(z))
        fail({function + ".surface at x = " + short_text(x) + " m, y = " + short_text(y) + " m", "finite",
              "m", "give it a height all over the body"},
             to_text(z));
    return z;
}

/// One column of a lattice under a surface, and the piece of the surface that is its top.
struct TopOfColumn {
    Real x = 0, y = 0, height = 0;  ///< in the middle [m]
    Real steepness = 1;             ///< sqrt(1 + slope^2) [-]
    Real area = 0;                  ///< of the surface [m2]
};

/// From the middle and the four corners, which the neighbours share.
template <HeightField H>
TopOfColumn top_of_column(const H& surface, Real x, Real y, Real dx, Real dy) {
    const auto corner = [&](int i, int j) {
        const Real cx = x + 0.5 * i * dx, cy = y + 0.5 * j * dy;
        return Vec3(cx, cy, height_at(surface, cx, cy, "lattice_under"));
    };
    const Vec3 rising = corner(1, 1) - corner(-1, -1), falling = corner(-1, 1) - corner(1, -1);
    const Vec3 doubled = rising.cross(falling);
    return {x, y, height_at(surface, x, y, "lattice_under"), doubled.norm() / doubled.z(),
            0.5 * doubled.norm()};
}

/// Bonds each sphere along its column, and in each neighbouring column to the one nearest in height.
inline void bond_columns(Lattice& lattice, const std::vector<Real>& top) {
    const Real d = 2 * lattice.radius;
    for (const LatticeSite& s : lattice.sites) {
        const Index here = lattice.site(s.along, s.across, s.layer);
        if (s.layer + 1 < lattice.count_layers) lattice.bonds.emplace_back(here, here + 1);
        const auto bond_across = [&](Index i, Index j) {
            if (i >= lattice.count_along || j >= lattice.count_across) return;
            const auto other = static_cast<std::size_t>(i * lattice.count_across + j);
            const Real higher = top[other] - top[static_cast<std::size_t>(s.column)];
            const Index most = lattice.count_layers - 1;  // all on one layer where there is but one
            const auto steps = std::clamp(static_cast<Index>(std::lround(higher / d)), -most, most);
            const Index layer = s.layer + steps;
            if (layer < 0 || layer > most) return;
            lattice.bonds.emplace_back(here, lattice.site(i, j, layer));
        };
        bond_across(s.along, s.across + 1), bond_across(s.along + 1, s.across);
    }
}

}  // namespace detail

/// The body between a surface and its copy `layers` diameters d below, over `length` x `width` with its
/// middle at x = y = 0. Columns stand upright on a grid of dx x dy, both at least d, so no two spheres
/// overlap however steep the surface is. The first layer touches the surface's tangent plane from below: its
/// centres are r / cos theta under it, theta its slope; the others follow a diameter apart. Cells are the
/// columns' slices, dx dy d, and fill the body without gaps. Columns' areas are those of the surface, as
/// quadrilaterals have it (second order in dx, dy). A sphere is bonded to those above and below, and to the
/// nearest of each neighbouring column. The surface is seen at the columns' middles and corners; what is
/// finer than a sphere is not.
///
/// Throws InputError for a size as `flat_lattice` does, where a height is not finite, and where neighbouring
/// columns differ by more than a diameter in height: slope d/dx, 45 degrees where they stand close. Steeper,
/// the body, `layers` d cos theta thick, would be thin, and bonds would run along its layers no more.
template <HeightField H>
Lattice lattice_under(const H& surface, Real length, Real width, const LatticeSize& size) {
    check_size(size, length, width, "lattice_under.side");
    const Real d = size.sphere_diameter;
    Lattice lattice{
        0.5 * d, detail::spheres_that_fit(length, d), detail::spheres_that_fit(width, d), size.layers, {}, {},
        {}};
    const Real dx = length / lattice.count_along, dy = width / lattice.count_across;
    std::vector<detail::TopOfColumn> tops;
    std::vector<Real> first_centre;  // [column] height of the first layer [m]
    for (Index i = 0; i < lattice.count_along; ++i)
        for (Index j = 0; j < lattice.count_across; ++j) {
            const auto& here = tops.emplace_back(detail::top_of_column(surface, (i + 0.5) * dx - 0.5 * length,
                                                                       (j + 0.5) * dy - 0.5 * width, dx, dy));
            const auto check_slope = [&](Index before) {
                const detail::TopOfColumn& there = tops[static_cast<std::size_t>(before)];
                if (const Real step = std::abs(here.height - there.height); step > d * (1 + 1e-9))
                    fail(
                        {"lattice_under.surface: step between columns at x = " + short_text(there.x) +
                             " m, y = " + short_text(there.y) + " m and x = " + short_text(here.x) +
                             " m, y = " + short_text(here.y) + " m",
                         "at most a sphere diameter (" + to_text(d) + " m)", "m",
                         "turn the body so that its surface lies flatter, or cut a packing with cut_below()"},
                        to_text(step));
            };
            if (j > 0) check_slope(i * lattice.count_across + j - 1);
            if (i > 0) check_slope((i - 1) * lattice.count_across + j);
            lattice.column_area.push_back(here.area);
            first_centre.push_back(here.height - lattice.radius * here.steepness);
            for (Index k = 0; k < size.layers; ++k)
                detail::add_site(lattice, {here.x, here.y, first_centre.back() - k * d}, dx * dy * d, i, j,
                                 k);
        }
    detail::bond_columns(lattice, first_centre);
    return lattice;
}

namespace detail {

/// Tops of spheres, sought by squares of one diameter in the x-y plane.
class TopsInReach {
public:
    explicit TopsInReach(const Lattice& lattice) : d_(2 * lattice.radius), lattice_(lattice) {
        for (std::size_t n = 0; n < lattice.sites.size(); ++n) {
            const Vec3& x = lattice.sites[n].centre;
            sites_.push_back({square_of(x.x()), square_of(x.y()), n});
        }
        std::sort(sites_.begin(), sites_.end());
    }
    /// Highest top of a sphere whose middle is within a diameter of (x, y); -infinity for none [m].
    Real highest(Real x, Real y) const {
        Real top = -std::numeric_limits<Real>::infinity();
        const Real i = square_of(x), j = square_of(y);
        for (const Real along : {i - 1, i, i + 1}) {
            auto s = std::lower_bound(sites_.begin(), sites_.end(), Place{along, j - 1, 0});
            for (; s != sites_.end() && s->i == along && s->j <= j + 1; ++s) {
                const Vec3& c = lattice_.sites[s->site].centre;
                if (std::hypot(c.x() - x, c.y() - y) <= d_) top = std::max(top, c.z() + 0.5 * d_);
            }
        }
        return top;
    }

private:
    struct Place {
        Real i = 0, j = 0;
        std::size_t site = 0;
        auto operator<=>(const Place&) const = default;
    };
    Real square_of(Real x) const noexcept { return std::floor(x / d_); }

    Real d_;
    const Lattice& lattice_;
    std::vector<Place> sites_{};
};

/// The spheres for which `keep[site]`, with the bonds between them.
inline Lattice part_of(const Lattice& lattice, const std::vector<char>& keep) {
    Lattice part{lattice.radius, lattice.count_along, lattice.count_across, 0, {}, lattice.column_area, {}};
    std::vector<Index> number(lattice.sites.size(), -1);
    for (std::size_t n = 0; n < keep.size(); ++n) {
        if (!keep[n]) continue;
        number[n] = static_cast<Index>(part.sites.size());
        part.sites.push_back(lattice.sites[n]);
    }
    for (const auto& [i, j] : lattice.bonds)
        if (const Index a = number[static_cast<std::size_t>(i)], b = number[static_cast<std::size_t>(j)];
            a >= 0 && b >= 0)
            part.bonds.emplace_back(a, b);
    return part;
}

}  // namespace detail

/// What of a lattice, a random packing for one, stands below a surface: the spheres that do not reach through
/// it, taken as a plane over each of them. Cells and columns stay as they are, so the body's volume is that
/// of the cells that are kept. Its top is as rough as the packing: spheres end up to some diameter below the
/// surface. `Lattice::site` means nothing any more.
///
/// Throws InputError where a height is not finite, and for a surface that the lattice does not reach: in the
/// middle of a column that held spheres, no kept one within a diameter around ends less than a diameter below
/// the surface.
template <HeightField H>
Lattice cut_below(const Lattice& lattice, const H& surface) {
    const Real r = lattice.radius, d = 2 * r;
    require_positive(r, "cut_below.lattice.radius", "m");
    const auto height = [&](Real x, Real y) { return detail::height_at(surface, x, y, "cut_below"); };
    std::vector<char> keep(lattice.sites.size());
    struct Middle {
        Real x = 0, y = 0, spheres = 0;
    };
    std::vector<Middle> middles(lattice.column_area.size());
    for (std::size_t n = 0; n < keep.size(); ++n) {
        const Vec3& c = lattice.sites[n].centre;
        const Real slope_x = (height(c.x() + r, c.y()) - height(c.x() - r, c.y())) / d,
                   slope_y = (height(c.x(), c.y() + r) - height(c.x(), c.y() - r)) / d;
        const Real below = height(c.x(), c.y()) - c.z();
        keep[n] = below >= r * std::sqrt(1 + square(slope_x) + square(slope_y)) * (1 - 1e-9);
        Middle& column = middles[static_cast<std::size_t>(lattice.sites[n].column)];
        column.x += c.x(), column.y += c.y(), ++column.spheres;
    }
    Lattice part = detail::part_of(lattice, keep);
    const detail::TopsInReach tops(part);
    for (const Middle& sum : middles) {
        if (sum.spheres == 0) continue;
        const Real x = sum.x / sum.spheres, y = sum.y / sum.spheres;
        if (const Real gap = height(x, y) - tops.highest(x, y); !(gap <= d))
            fail({"cut_below: gap between the surface and the spheres below it at x = " + short_text(x) +
                      " m, y = " + short_text(y) + " m",
                  "at most a sphere diameter (" + to_text(d) + " m)", "m",
                  "the lattice does not reach the surface there: make it higher, or lower the surface"},
                 short_text(gap));
    }
    return part;
}

}  // namespace abrade
