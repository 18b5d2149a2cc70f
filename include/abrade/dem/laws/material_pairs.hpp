#pragma once
// Mixed materials: a contact law for each pair of them.

#include <abrade/dem/laws/contact_law.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace abrade {

/// A table of contact laws of one kind, one law for each two materials that may meet, in either order. Bodies
/// and walls say what they are made of by number (`BodyState::material`, `Plane::material`). Contacts of one
/// pair of materials stand in packs of their own, so the kernel always works with one law; a table of one
/// material gives the bits of its law alone.
///
/// The time step suits every law of the table on every body. Pairs that cannot meet may be left out; one that
/// can is an InputError before the first step. Throws InputError for a table that names a material or a pair
/// twice or a material it does not have, and for parameters that a law refuses.
template <ContactLaw One>
class MaterialPairs {
public:
    static constexpr std::string_view name = "MaterialPairs";
    using OfPair = One;

    struct Pair {
        std::string first, second;  ///< names of materials
        typename One::Params law{};
    };
    struct Params {
        std::vector<std::string> materials;  ///< names; their places are the materials' numbers
        std::vector<Pair> pairs;

        void validate() const {
            require(!materials.empty(),
                    {"MaterialPairs.materials", "at least one name", "",
                     "name what bodies are made of, such as stone"},
                    0);
            for (std::size_t a = 0; a < materials.size(); ++a)
                for (std::size_t b = 0; b < a; ++b)
                    if (materials[a] == materials[b])
                        fail({"MaterialPairs.materials", "different names", "", "rename or remove one"},
                             materials[a] + " twice");
            std::vector<MaterialPair> seen;
            for (const Pair& pair : pairs) {
                const auto which = MaterialPair::of(number(pair.first), number(pair.second));
                if (std::find(seen.begin(), seen.end(), which) != seen.end())
                    fail({"MaterialPairs.pairs", "one law for each two materials", "",
                          "remove one: their order does not matter"},
                         "two for " + pair.first + " with " + pair.second);
                seen.push_back(which);
                try {
                    pair.law.validate();
                } catch (const InputError& error) {
                    throw InputError("MaterialPairs, " + pair.first + " with " + pair.second + ": " +
                                     error.what());
                }
            }
        }
        void visit(auto&& f) const {
            for (const Pair& pair : pairs)
                pair.law.visit([&](std::string_view parameter, Real value, std::string_view unit) {
                    f(pair.first + "-" + pair.second + "." + std::string(parameter), value, unit);
                });
        }
        /// The number of a material; InputError, with the names that are there, for one that is not.
        Index number(std::string_view material) const {
            std::string known;
            for (std::size_t n = 0; n < materials.size(); ++n) {
                if (materials[n] == material) return static_cast<Index>(n);
                known += (n ? ", " : "") + materials[n];
            }
            fail({"MaterialPairs: a material", "one of " + known, "",
                  "mend its spelling or add it to MaterialPairs.materials"},
                 material);
        }
    };

    explicit MaterialPairs(Params params) : params_(std::move(params)) {
        params_.validate();
        of_.assign(params_.materials.size() * params_.materials.size(), -1);
        for (const Pair& pair : params_.pairs) {
            const Index first = number(pair.first), second = number(pair.second);
            of_[at(MaterialPair::of(first, second))] = static_cast<Index>(laws_.size());
            laws_.emplace_back(pair.law);
        }
    }
    const Params& params() const noexcept { return params_; }

    Index materials() const noexcept { return static_cast<Index>(params_.materials.size()); }
    /// The number of a material, to be given to bodies and walls; InputError for an unknown name.
    Index number(std::string_view material) const { return params_.number(material); }
    const std::string& material(Index number) const {
        return params_.materials[static_cast<std::size_t>(number)];
    }

    bool has(MaterialPair pair) const noexcept { return of_[at(pair)] >= 0; }
    /// The law of a pair that there is.
    const One& between(MaterialPair pair) const noexcept {
        return laws_[static_cast<std::size_t>(of_[at(pair)])];
    }

    /// Whether any law of the table does.
    bool damps_free_mass() const noexcept requires MayDampFreeMass<One> {
        return std::any_of(laws_.begin(), laws_.end(), [](const One& law) { return law.damps_free_mass(); });
    }

    /// The widest of the table.
    Real range() const noexcept requires ActsBeforeTouch<One> {
        Real most = 0;
        for (const One& law : laws_) most = std::max(most, law.range());
        return most;
    }
    /// The largest of each over the table.
    ContactRigidity rigidity(Real radius) const noexcept {
        ContactRigidity most;
        for (const One& law : laws_) {
            const ContactRigidity one = law.rigidity(radius);
            for (const auto of :
                 {&ContactRigidity::normal, &ContactRigidity::tangential, &ContactRigidity::damping_ratio,
                  &ContactRigidity::rolling, &ContactRigidity::rolling_damping_ratio})
                most.*of = std::max(most.*of, one.*of);
        }
        return most;
    }
    Real stable_dt(Real mass, Real radius) const noexcept {
        Real least = std::numeric_limits<Real>::infinity();
        for (const One& law : laws_) least = std::min(least, law.stable_dt(mass, radius));
        return least;
    }

private:
    std::size_t at(MaterialPair pair) const noexcept {
        return static_cast<std::size_t>(pair.low) * params_.materials.size() +
               static_cast<std::size_t>(pair.high);
    }

    Params params_;
    std::vector<One> laws_;
    std::vector<Index> of_;  ///< [low x high] into laws_, -1: none
};

}  // namespace abrade
