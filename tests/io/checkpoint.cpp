// Checkpoints come back bit for bit, and a failed save leaves the old one.
#include <abrade/io/checkpoint.hpp>

#include <doctest/doctest.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <vector>

using namespace abrade;

namespace {

bool same_bits(const std::vector<Real>& a, const std::vector<Real>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](Real x, Real y) {
               return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
           });
}

}  // namespace

TEST_CASE("a checkpoint comes back bit for bit") {
    std::mt19937_64 generator{7};
    std::vector<Real> any(3000);
    for (Real& value : any) value = std::bit_cast<Real>(generator());  // also NaN with a payload, subnormals
    const std::vector<Real> special{-0.0, std::numeric_limits<Real>::infinity(), 5e-324};
    const FieldView bodies[] = {{"position", "m", 3, any}, {"lost", "J", 3, any}};
    const FieldView spheres[] = {{"radius", "m", 1, special}};
    const FieldGroup groups[] = {{"spheres", spheres}, {"bodies", bodies}, {"contacts", {}}};
    save_fields("state.h5", groups,
                {{"time", 0.1}, {"step", std::int64_t{123456789012345}}, {"random", "1 2 3"}});
    CHECK(!std::filesystem::exists("state.h5.tmp"));

    const Checkpoint state = load_fields("state.h5");
    CHECK(state.groups.size() == 3);
    CHECK(state.groups.at("contacts").empty());
    CHECK(same_bits(state.column("bodies", "position").values, any));
    CHECK(state.column("bodies", "position").components == 3);
    CHECK(state.column("bodies", "lost").unit == "J");
    CHECK(same_bits(state.column("spheres", "radius").values, special));
    CHECK(state.attributes.size() == 3);
    CHECK(state.attribute<Real>("time") == 0.1);
    CHECK(state.attribute<std::int64_t>("step") == 123456789012345);
    CHECK(state.attribute<std::string>("random") == "1 2 3");
    CHECK(state.has("spheres", "radius"));
    CHECK(!state.has("spheres", "mass"));
    CHECK_THROWS_WITH_AS(state.column("spheres", "mass"),
                         "checkpoint has no column spheres/mass; it has: radius", InputError);
    CHECK_THROWS_AS(state.attribute<Real>("step"), InputError);
    CHECK_THROWS_WITH_AS(state.attribute<Real>("missing"),
                         "checkpoint has no attribute missing; it has: random step time", InputError);
}

TEST_CASE("a save that fails leaves the checkpoint that was there") {
    const std::vector<Real> two{1, 2}, three{1, 2, 3};
    const FieldView good[] = {{"x", "m", 1, two}};
    const FieldView uneven[] = {{"x", "m", 1, two}, {"y", "m", 1, three}};
    const FieldGroup first[] = {{"bodies", good}}, second[] = {{"bodies", uneven}};
    save_fields("kept.h5", first);
    CHECK_THROWS_WITH_AS(save_fields("kept.h5", second),
                         "checkpoint bodies.y must be as long as the other columns of its group (2), got 3 "
                         "rows; put it into another group",
                         InputError);
    CHECK(!std::filesystem::exists("kept.h5.tmp"));
    CHECK(load_fields("kept.h5").column("bodies", "x").values == two);

    std::filesystem::create_directories("in_the_way.h5/full");
    CHECK_THROWS_AS(save_fields("in_the_way.h5", first), FileError);
    CHECK(!std::filesystem::exists("in_the_way.h5.tmp"));
}

TEST_CASE("what is not a checkpoint is refused") {
    CHECK_THROWS_AS(load_fields("missing.h5"), InputError);
    Hdf5File::create("other.h5").close();
    CHECK_THROWS_WITH_AS(
        load_fields("other.h5"),
        "cannot read 'other.h5': it is an HDF5 file but not a checkpoint; name one that save_fields() wrote",
        InputError);
    Hdf5File newer = Hdf5File::create("newer.h5");
    newer.write_attribute("", checkpoint_version_name, checkpoint_version + 1);
    newer.close();
    CHECK_THROWS_AS(load_fields("newer.h5"), InputError);
}

TEST_CASE("a checkpoint that was cut off is refused") {
    const std::vector<Real> many(10000, 1.0);
    const FieldView fields[] = {{"x", "m", 1, many}};
    const FieldGroup groups[] = {{"bodies", fields}};
    save_fields("cut.h5", groups);
    std::filesystem::resize_file("cut.h5", std::filesystem::file_size("cut.h5") / 2);
    CHECK_THROWS_AS(load_fields("cut.h5"), InputError);
}
