#pragma once
// Sediment supplied at the upstream end.

#include <abrade/dem/store/particles.hpp>
#include <abrade/geometry/stone_shapes.hpp>
#include <abrade/geometry/surfaces.hpp>

#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <span>

namespace abrade {

/// One class of stones in the supply.
struct StoneClass {
    Real size = 0;      ///< nominal diameter, that of a sphere of equal volume [m]
    Real fraction = 0;  ///< share of the solid volume [-]
    StoneShape shape = StoneShape::sphere;
    Index material = 0;  ///< number in a table of laws (MaterialPairs)
};

/// Stones supplied at a solid volume rate, at random in a box, all from one seeded sequence.
struct FeedParams {
    Real volume_rate = 0;  ///< solid [m3/s]
    std::vector<StoneClass> classes{};
    Real density = 2650;  ///< [kg/m3]
    Box region{};  ///< stones are placed inside it, whole in x and y, lifted where concrete is in the way [m]
    /// Height of the ground at (x, y) that region.z counts from [m]; none: 0.
    std::function<Real(Real, Real)> bed{};
    Vec3 velocity = Vec3::Zero();                      ///< [m/s]
    Real start = 0;                                    ///< [s]
    Real end = std::numeric_limits<Real>::infinity();  ///< no stone is due after it [s]
    std::uint32_t seed = 1;

    void validate() const {
        require_positive(volume_rate, "Feed.volume_rate", "m3/s");
        require_positive(density, "Feed.density", "kg/m3", "stone has 2500 to 2800");
        require_finite(velocity, "Feed.velocity", "m/s");
        require_finite(start, "Feed.start", "s");
        require(end > start,
                {"Feed.end", "after Feed.start (" + to_text(start) + " s)", "s", "leave it out to feed on"},
                end);
        require(!classes.empty(),
                {"Feed.classes", "at least one stone class", "", "or leave Scene.feed empty"}, 0);
        const auto name = [](std::size_t n) { return "Feed.classes[" + std::to_string(n) + "]"; };
        Real total = 0;
        for (std::size_t n = 0; n < classes.size(); ++n) {
            require_positive(classes[n].size, name(n) + ".size", "m");
            require_not_negative(classes[n].fraction, name(n) + ".fraction");
            total += classes[n].fraction;
        }
        require(std::abs(total - 1) < 1e-6,
                {"Feed.classes.fraction (sum)", "1", "", "let the fractions add up to 1"}, total);
        const Vec3 size = region.high - region.low;
        for (int a = 0; a < 3; ++a)
            require(size[a] > 0 && std::isfinite(size[a]),
                    {std::string("Feed.region along ") + "xyz"[a], "finite and low < high, high - low", "m",
                     "give both corners, the lower one first"},
                    size[a]);
        for (std::size_t n = 0; n < classes.size(); ++n) {
            const Real across = 2 * make_stone(classes[n].shape, classes[n].size).bounding_radius;
            require(across <= std::min(size.x(), size.y()),
                    {name(n) + ".size of " + to_text(classes[n].size) + " m: the stone's length",
                     "at most the feed region's " + to_text(std::min(size.x(), size.y())) + " m", "m",
                     "widen the region or feed smaller stones"},
                    across);
        }
    }
};

/// Turns a volume rate into stones one by one. A stone that finds no free place waits.
class Feed {
public:
    explicit Feed(FeedParams params) : params_(std::move(params)), random_(params_.seed) {
        params_.validate();
        Real share = 0;
        for (const StoneClass& c : params_.classes) {
            templates_.push_back(make_stone(c.shape, c.size));
            // Stones are drawn by number; their shares are by volume.
            share += c.fraction / templates_.back().volume;
            cumulative_.push_back(share);
        }
        draw();
    }

    const FeedParams& params() const noexcept { return params_; }
    Real supplied_volume() const noexcept { return supplied_; }  ///< solid [m3]
    Index supplied_stones() const noexcept { return count_; }

    /// Adds the stones that are due at time t and find a place. Calls `added(body)` for each. Concrete that
    /// is no body is asked for by `above(x, reach)`: the lowest z at which a sphere over x touches none.
    template <class Added>
    void supply(Particles& particles, std::span<const Plane> walls, Real t, Added&& added) {
        supply(particles, walls, t, added, [](const Vec3&, Real) { return nowhere; });
    }
    template <class Added, class Above>
    void supply(Particles& particles, std::span<const Plane> walls, Real t, Added&& added, Above&& above) {
        waits_ = false;
        while (next_is_due(t)) {
            const auto state = free_place(particles, walls, above);
            waits_ = !state;
            if (waits_) return;
            added(particles.add(templates_[next_], params_.density, *state, Kind::stone));
            supplied_ += templates_[next_].volume;
            ++count_;
            draw();
        }
    }

    /// Whether a stone is due at time t [s] that has not been found to have no place.
    bool due(Real t) const noexcept { return !waits_ && next_is_due(t); }

    static void fields(auto&& field) {
        field("random", &Feed::random_), field("next", &Feed::next_),
            field("supplied", "m3", &Feed::supplied_), field("count", &Feed::count_),
            field("waits", &Feed::waits_);
    }

private:
    bool next_is_due(Real t) const noexcept {
        const Real time = std::max(0.0, std::min(t, params_.end) - params_.start);
        return supplied_ + templates_[next_].volume <= params_.volume_rate * time;
    }

    static constexpr Real nowhere = -std::numeric_limits<Real>::infinity();

    Real uniform() { return std::generate_canonical<Real, 53>(random_); }

    void draw() {
        const Real at = uniform() * cumulative_.back();
        next_ = 0;
        while (next_ + 1 < cumulative_.size() && cumulative_[next_] <= at) ++next_;
    }

    /// A random place whose bounding sphere touches neither a stone nor a wall; nothing after some tries.
    template <class Above>
    std::optional<BodyState> free_place(const Particles& particles, std::span<const Plane> walls,
                                        Above&& above) {
        constexpr int tries = 20;
        const Real reach = templates_[next_].bounding_radius;
        for (int attempt = 0; attempt < tries; ++attempt) {
            BodyState state;
            for (int a = 0; a < 3; ++a) {
                const Real low = params_.region.low[a] + reach,
                           high = std::max(low, params_.region.high[a] - reach);
                state.position[a] = low + uniform() * (high - low);
            }
            if (params_.bed) state.position.z() += params_.bed(state.position.x(), state.position.y());
            state.velocity = params_.velocity;
            state.material = params_.classes[next_].material;
            state.orientation = random_orientation();
            state.position.z() =
                std::max({state.position.z(), height_above_concrete(particles, state.position, reach),
                          above(state.position, reach)});
            const bool clear = std::all_of(walls.begin(), walls.end(), [&](const Plane& wall) {
                return wall.distance(state.position) >= reach;
            });
            if (clear && is_free(particles, state.position, reach)) return state;
        }
        return std::nullopt;
    }

    /// The lowest z at which a sphere of radius `reach` over x touches no concrete.
    static Real height_above_concrete(const Particles& particles, const Vec3& x, Real reach) {
        Real lowest = nowhere;
        for (std::size_t s = 0; s < particles.centre.size(); ++s) {
            const Kind kind = particles.kind[static_cast<std::size_t>(particles.body[s])];
            if (kind != Kind::concrete && kind != Kind::fixed) continue;
            const Real across2 = (particles.centre[s] - x).head<2>().squaredNorm();
            const Real room2 = square(particles.radius[s] + reach) - across2;
            if (room2 > 0) lowest = std::max(lowest, particles.centre[s].z() + std::sqrt(room2));
        }
        return lowest;
    }

    static bool is_free(const Particles& particles, const Vec3& x, Real reach) {
        for (Index s = particles.spheres() - 1; s >= 0; --s) {
            const auto i = static_cast<std::size_t>(s);
            const Kind kind = particles.kind[static_cast<std::size_t>(particles.body[i])];
            if (kind != Kind::stone && kind != Kind::grain) continue;
            if ((particles.centre[i] - x).squaredNorm() < square(particles.radius[i] + reach)) return false;
        }
        return true;
    }

    /// Uniform over all rotations. K. Shoemake, in Graphics Gems III (1992) 124.
    Quaternion random_orientation() {
        const Real u = uniform(), a = 2 * pi * uniform(), b = 2 * pi * uniform();
        const Real s = std::sqrt(1 - u), c = std::sqrt(u);
        return {c * std::cos(b), s * std::sin(a), s * std::cos(a), c * std::sin(b)};
    }

    FeedParams params_;
    std::mt19937_64 random_;
    std::vector<Clump> templates_;
    std::vector<Real> cumulative_;
    std::size_t next_ = 0;
    Real supplied_ = 0;
    Index count_ = 0;
    bool waits_ = false;  ///< the next found no place
};

}  // namespace abrade
