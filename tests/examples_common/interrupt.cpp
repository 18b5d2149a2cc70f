// Ctrl-C asks once; the progress line says how long it takes.
#include "../../examples/common/interrupt.hpp"
#include "../../examples/common/progress.hpp"

#include <doctest/doctest.h>

#include <sys/wait.h>
#include <unistd.h>

using namespace abrade::examples;

namespace {

int handled_before = 0;
void earlier_handler(int) { ++handled_before; }

}  // namespace

TEST_CASE("the first signal sets a flag, and the earlier handler is back at the end") {
    struct sigaction before {};
    struct sigaction mine {};
    mine.sa_handler = &earlier_handler;
    sigaction(SIGTERM, &mine, &before);
    {
        const Interrupt interrupt;
        CHECK(!interrupt.requested());
        raise(SIGTERM);
        CHECK(interrupt.requested());
        CHECK(interrupt.signal_number() == SIGTERM);
        CHECK(handled_before == 0);
    }
    raise(SIGTERM);
    CHECK(handled_before == 1);
    CHECK(!Interrupt{}.requested());
    sigaction(SIGTERM, &before, nullptr);
}

TEST_CASE("the second signal kills") {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        const Interrupt interrupt;
        raise(SIGINT);
        raise(SIGINT);
        _exit(0);
    }
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == SIGINT);
}

TEST_CASE("the progress line") {
    const Progress progress{"channel", 5.0};
    CHECK(progress.line(1.0, 10.0, "12 stones") == "channel   20 %  1 of 5 s, 0:40 left, 12 stones");
    CHECK(progress.line(0.0, 10.0) == "channel    0 %  0 of 5 s");
    CHECK(progress.line(6.0, 10.0) == "channel  100 %  6 of 5 s, 0:00 left");
    CHECK(clock_text(95) == "1:35");
    CHECK(clock_text(4000) == "1:06:40");
}
