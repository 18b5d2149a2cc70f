// What a contact costs that touches and sticks, all of it in cache: gather, law, scatter.

#include <abrade/abrade.hpp>

#include <benchmark/benchmark.h>

using namespace abrade;

namespace {

/// Pairs of pressed spheres of 0.02 m that slide slowly over each other.
template <ContactLaw Law>
struct Pairs {
    static constexpr std::size_t count = 64 * pack_lanes;
    HotArrays lines;
    std::vector<ContactPack<Law>> packs{count / pack_lanes};

    Pairs() {
        const Real radius = 0.01;
        lines.resize(2 * count);
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 at(0.1 * static_cast<Real>(k), 0, 0), apart = Vec3(1, 2, 3).normalized();
            lines.place[2 * k] = {at, radius};
            lines.place[2 * k + 1] = {at + (2 - 1e-3) * radius * apart, radius};
            for (const std::size_t s : {2 * k, 2 * k + 1}) {
                const Real sign = s % 2 == 0 ? 1 : -1;
                lines.motion[s] = {sign * Vec3(1e-4, 2e-4, 1e-4), 100, sign * Vec3(1e-4, 0, 1e-4),
                                   1 / radius};
            }
            packs[k / pack_lanes].first[k % pack_lanes] = line_offset(static_cast<Index>(2 * k));
            packs[k / pack_lanes].second[k % pack_lanes] = line_offset(static_cast<Index>(2 * k + 1));
        }
    }
};

template <ContactLaw Law, WearLaw Wear = NoWear>
void contacts_in_cache(benchmark::State& state, const Law& law, const Wear& wear = {}) {
    Pairs<Law> pairs;
    constexpr KernelKind kind{.watched = !std::same_as<Wear, NoWear>};
    const std::vector<std::uint8_t> watched_sides(Pairs<Law>::count, 1);
    const PackRun run{.watched_sides = watched_sides.data()};
    for (auto _ : state)
        benchmark::DoNotOptimize(respond<kind>(law, WearObserver(wear), std::span(pairs.packs), run,
                                               pairs.lines, ContactStep{1e-7, 0.5}));
    state.counters["s/contact"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(Pairs<Law>::count),
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.SetLabel(std::string(instruction_set));
}

void linear_contacts(benchmark::State& state) {
    contacts_in_cache(state, LinearSpring{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.5}});
}
void hertz_contacts(benchmark::State& state) {
    contacts_in_cache(state,
                      HertzMindlin{{.youngs = 1e8, .poisson = 0.25, .restitution = 0.5, .friction = 0.5}});
}
void hysteretic_contacts(benchmark::State& state) {
    contacts_in_cache(state, LinearHysteretic{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.5}});
}
/// Dented some nine times deeper than where they begin to yield.
void elastic_plastic_contacts(benchmark::State& state) {
    contacts_in_cache(state, ElasticPlasticHertz{{.youngs = 1e8, .yield_pressure = 5e5, .friction = 0.5}});
}

/// The same contacts with concrete, by law: what wear adds to a contact.
template <WearLaw Wear>
void wear_of_linear_contacts(benchmark::State& state, const Wear& wear) {
    contacts_in_cache(state, LinearSpring{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.5}}, wear);
}

BENCHMARK(linear_contacts);
BENCHMARK(hertz_contacts);
BENCHMARK(hysteretic_contacts);
BENCHMARK(elastic_plastic_contacts);
BENCHMARK_CAPTURE(wear_of_linear_contacts, sub_particle, SubParticleAbrasion{{}});
BENCHMARK_CAPTURE(wear_of_linear_contacts, archard, Archard{{.coefficient = 1e-4, .hardness = 1e9}});
BENCHMARK_CAPTURE(wear_of_linear_contacts, finnie, Finnie{{.flow_stress = 1e8}});
BENCHMARK_CAPTURE(wear_of_linear_contacts, sklar_dietrich,
                  SklarDietrich{{.tensile = 2.7e6, .youngs = 2.7e10}});
BENCHMARK_CAPTURE(wear_of_linear_contacts, ishibashi, Ishibashi{{.impact = 1e-9, .friction = 1e-10}});

}  // namespace
