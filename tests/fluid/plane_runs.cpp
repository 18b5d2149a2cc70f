// Planes shared out to threads: every plane once, about as much water for each, runs that begin at even
// planes.
#include <abrade/fluid/mesh/wet_rows.hpp>

#include <doctest/doctest.h>

#include <atomic>

using namespace abrade;

namespace {

struct Threads {
    explicit Threads(int count) : before(thread_count()) { set_thread_count(count); }
    ~Threads() { set_thread_count(before); }
    int before;
};

}  // namespace

TEST_CASE("each plane has one run, which begins at an even plane and is not too short") {
    for (const int threads : {1, 2, 3, 7}) {
        const Threads use(threads);
        for (const int planes : {1, 2, 5, 24, 25, 40, 101})
            for (const int least : {2, 12}) {
                CAPTURE(threads);
                CAPTURE(planes);
                CAPTURE(least);
                const auto runs = detail::plane_runs(Layout<3>({planes, 6, 4}), least, [&](int plane, int) {
                    return RowRange{0, plane > planes / 2 ? 6 : 0};
                });
                CHECK(runs.front() == 0);
                CHECK(runs.back() == planes);
                const auto count = static_cast<int>(runs.size()) - 1;
                CHECK(count <= threads);
                CHECK(count >= std::min(threads, planes / least));
                for (int run = 1; run <= count; ++run) {
                    const int first = runs[static_cast<std::size_t>(run) - 1];
                    CHECK(first % 2 == 0);
                    if (count > 1) CHECK(runs[static_cast<std::size_t>(run)] - first >= least);
                }
            }
    }
}

TEST_CASE("parts have every plane once and begin at even planes, whoever helps") {
    for (const int threads : {1, 2, 3, 7}) {
        const Threads use(threads);
        for (const int planes : {1, 2, 5, 40, 101, 600})
            for (const int least : {2, 32}) {
                CAPTURE(threads);
                CAPTURE(planes);
                CAPTURE(least);
                const auto runs = detail::plane_runs(Layout<3>({planes, 6, 4}), 2, [&](int plane, int) {
                    return RowRange{0, plane > planes / 2 ? 6 : 0};
                });
                std::vector<std::atomic<int>> seen(static_cast<std::size_t>(planes));
                std::atomic<int> odd = 0;
                detail::parallel_parts(runs, least, [&](int first, int last) {
                    odd += first % 2;
                    for (int plane = first; plane < last; ++plane) ++seen[static_cast<std::size_t>(plane)];
                });
                CHECK(odd == 0);
                for (const auto& count : seen) CHECK(count == 1);
            }
    }
}

TEST_CASE("runs have about as much water, wherever it stands") {
    const Threads use(2);
    const auto runs = detail::plane_runs(Layout<2>({100, 50}), 2, [](int plane, int) {
        return RowRange{0, plane < 20 ? 50 : 0};
    });
    REQUIRE(runs.size() == 3);
    CHECK(runs[1] == 10);
}
