// Five hundred stones lie on concrete for ten seconds: the worn volume does not change in its last bit. Some
// minutes.
#include "deposit.hpp"

#include <doctest/doctest.h>

using namespace deposit;

namespace {

template <class Bond>
void check_rest(const Setting& setting, const Bond& bond) {
    const History h = lie(setting, bond, 13);
    MESSAGE("worn " << h.worn.back() << " m3, unchanged since " << h.unchanged_since()
                    << " s; kinetic energy " << h.kinetic.back() << " J, " << h.asleep << " asleep");
    CHECK(h.worn.back() > 1e-5);
    CHECK(h.unchanged_since() <= 3);
    CHECK(h.asleep == (setting.sleep_speed > 0 ? setting.stones : 0));
    CHECK(h.broken == 0);
    CHECK(h.residual < 1e-12);
}

}  // namespace

TEST_CASE("a static deposit does not wear: springs on a hexagonal lattice, stones asleep") {
    check_rest({}, springs);
}
TEST_CASE("a static deposit does not wear: springs on a hexagonal lattice, nobody asleep") {
    check_rest({.sleep_speed = 0}, springs);
}
TEST_CASE("a static deposit does not wear: beams on a cubic lattice, stones asleep") {
    check_rest({.slab = Slab::cubic}, beams);
}
TEST_CASE("a static deposit does not wear: standing concrete, stones asleep") {
    for (const Slab slab : {Slab::cubic, Slab::hexagonal})
        check_rest({.slab = slab, .level = ConcreteLevel::quasi_static}, springs);
}
TEST_CASE("a static deposit does not wear: standing concrete, nobody asleep") {
    check_rest({.slab = Slab::cubic, .sleep_speed = 0, .level = ConcreteLevel::quasi_static}, springs);
}
TEST_CASE("a static deposit does not wear: springs that resist twisting on a cubic lattice, nobody asleep") {
    check_rest({.slab = Slab::cubic, .sleep_speed = 0}, twist_springs);
}
