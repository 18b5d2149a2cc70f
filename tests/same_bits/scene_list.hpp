#pragma once
// The scenes of this program, and the numbers that they give.

#include <abrade/core/types.hpp>

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace same_bits {

using abrade::Real;

/// What a scene computed, kind by kind: positions, forces, pressures. Differences are measured by the largest
/// of their kind. `figures` are a few names with values, by which a scene shows that something happened.
class Numbers {
public:
    struct Kind {
        std::string name;
        std::vector<Real> values;
    };
    struct Figure {
        std::string name;
        Real value;
    };

    /// What is added from here on is of this kind.
    Numbers& kind(std::string name) {
        kinds_.push_back({std::move(name), {}});
        return *this;
    }
    void add(Real value) { kinds_.back().values.push_back(value); }
    void add_vector(const auto& v) {
        for (const Real value : v) add(value);
    }
    void figure(std::string name, Real value) { figures_.push_back({std::move(name), value}); }

    const std::vector<Kind>& kinds() const noexcept { return kinds_; }
    const std::vector<Figure>& figures() const noexcept { return figures_; }
    std::size_t count() const noexcept {
        std::size_t sum = 0;
        for (const Kind& kind : kinds_) sum += kind.values.size();
        return sum;
    }

    /// Throws std::logic_error where a figure is not there, or 0: the scene does not do what it is for.
    Numbers&& with(std::initializer_list<std::string_view> wanted) && {
        for (const std::string_view name : wanted) {
            const auto found = std::ranges::find(figures_, name, &Figure::name);
            if (found == figures_.end())
                throw std::logic_error("there is no figure '" + std::string(name) + "'");
            if (found->value == 0)
                throw std::logic_error("'" + found->name + "' is 0: nothing of it happened");
        }
        return std::move(*this);
    }

private:
    std::vector<Kind> kinds_;
    std::vector<Figure> figures_;
};

/// Between programs of other instruction sets: largest difference over the largest of its kind [-].
constexpr Real usual_tolerance = 1e-10;

struct Scene {
    std::string name;
    std::function<Numbers()> run;
    Real tolerance = usual_tolerance;
};

/// All that files of this program have registered.
inline std::vector<Scene>& scenes() {
    static std::vector<Scene> all;
    return all;
}

/// A variable of this type registers a scene.
struct Register {
    Register(std::string name, std::function<Numbers()> run, Real tolerance = usual_tolerance) {
        scenes().push_back({std::move(name), std::move(run), tolerance});
    }
};

}  // namespace same_bits
