// Loops give the same bits with one thread and with several.
#include <abrade/core/parallel.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <random>
#include <thread>

using namespace abrade;

namespace {

struct Threads {
    explicit Threads(int count) : before(thread_count()) { set_thread_count(count); }
    ~Threads() { set_thread_count(before); }
    Threads(const Threads&) = delete;
    Threads& operator=(const Threads&) = delete;
    int before;
};

bool same_bits(Real a, Real b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace

TEST_CASE("every item is visited exactly once") {
    for (const Index items : {0, 1, 255, 256, 257, 511, 512, 513, 10000})
        for (const int threads : {1, 2}) {
            CAPTURE(items);
            const Threads scope(threads);
            std::vector<std::atomic<int>> visits(static_cast<std::size_t>(items));
            parallel_for(items, [&](Index i) { ++visits[static_cast<std::size_t>(i)]; });
            int wrong = 0;
            for (const auto& count : visits) wrong += count != 1;
            CHECK(wrong == 0);
        }
}

TEST_CASE("blocks cover the range without gaps, and an empty range has none") {
    CHECK(block_count(0) == 0);
    CHECK(block_count(1) == 1);
    CHECK(block_count(block_size) == 1);
    CHECK(block_count(block_size + 1) == 2);
    parallel_blocks(0, [](Index, Index, Index) { FAIL("an empty range has no block"); });
}

TEST_CASE("a sum has the same bits with one thread and with two") {
    std::mt19937 random(7);
    std::uniform_real_distribution<Real> exponent(-12, 12);
    std::vector<Real> values(100'003);
    // Sizes and signs so mixed that any other order of adding up shows.
    for (Real& v : values) v = std::pow(10, exponent(random)) * (random() % 2 ? 1 : -1);
    const auto sum = [&] {
        return parallel_sum<Real>(static_cast<Index>(values.size()),
                                  [&](Index i) { return values[static_cast<std::size_t>(i)]; });
    };
    Real one = 0, two = 0, three = 0;
    {
        const Threads scope(1);
        one = sum();
    }
    {
        const Threads scope(2);
        two = sum();
    }
    {
        const Threads scope(3);
        three = sum();
    }
    CHECK(same_bits(one, two));
    CHECK(same_bits(one, three));
    Real backwards = 0;
    for (auto v = values.rbegin(); v != values.rend(); ++v) backwards += *v;
    CHECK_MESSAGE(!same_bits(one, backwards), "the values do not test the order");
}

TEST_CASE("a sum over nothing is zero, and counting is exact") {
    CHECK(parallel_sum<Real>(0, [](Index) { return 1.0; }) == 0);
    CHECK(parallel_sum<Real>(1000, [](Index i) { return static_cast<Real>(i); }) == 999 * 500);
}

TEST_CASE("asking for fewer than one thread gives one") {
    const Threads scope(-3);
    CHECK(thread_count() == 1);
}

TEST_CASE("a loop asks for other threads where it has work for them, however many items that is") {
    const Threads scope(2);
    detail::share_every_loop = false;
    // In how many of 1000 calls another thread worked.
    const auto shared = [](Index items, auto&& wait) {
        detail::LoopWork work;
        int calls = 0;
        for (int call = 0; call < 1000; ++call) {
            std::atomic<bool> helped{false};
            const auto self = std::this_thread::get_id();
            work.run(items, items, [&](Index) {
                if (std::this_thread::get_id() != self) helped = true;
                wait();
            });
            calls += helped;
        }
        return calls;
    };
    const auto nothing = [] {};
    const auto a_while = [] {
        const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(100);
        while (std::chrono::steady_clock::now() < until) continue;
    };
    const int light = shared(200, nothing), heavy = shared(8, a_while);
    detail::share_every_loop = true;
    MESSAGE("shared: " << light << " of 1000 light loops, " << heavy << " of 1000 heavy ones");
    CHECK(light < 50);  // one that was held up as it was timed
    // Nobody comes where the machine has no core.
    CHECK((heavy > 0 || std::thread::hardware_concurrency() < 2));
}

TEST_CASE("loops within loops, and of two threads at once, visit each item once") {
    const Threads scope(3);
    const auto visits_wrong = [] {
        std::vector<std::atomic<int>> visits(64 * 1000);
        parallel_tasks(64, [&](Index task) {
            parallel_for(1000, [&](Index i) { ++visits[static_cast<std::size_t>(1000 * task + i)]; });
        });
        int wrong = 0;
        for (const auto& count : visits) wrong += count != 1;
        return wrong;
    };
    int other = 0;
    std::thread beside([&] {
        for (int n = 0; n < 100; ++n) other += visits_wrong();
    });
    int own = 0;
    for (int n = 0; n < 100; ++n) own += visits_wrong();
    beside.join();
    CHECK(own == 0);
    CHECK(other == 0);
}

TEST_CASE("many loops one after the other: none is left waiting") {
    const Threads scope(4);
    std::atomic<Index> count{0};
    for (int n = 0; n < 1000000 / 8; ++n)
        parallel_tasks(3 + n % 5, [&](Index) { count.fetch_add(1, std::memory_order_relaxed); });
    Index expected = 0;
    for (int n = 0; n < 1000000 / 8; ++n) expected += 3 + n % 5;
    CHECK(count == expected);
}
