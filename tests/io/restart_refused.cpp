// What cannot be saved leaves the checkpoint that was there; what cannot be gone on from is refused by its
// reason.
#include <abrade/io/restart.hpp>

#include <doctest/doctest.h>

#include <signal.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>

using namespace abrade;

namespace {

// Files are closed here; after a full disk HDF5's own clean-up at exit would crash.
[[maybe_unused]] const int no_clean_up = H5dont_atexit();

struct Water {
    std::vector<Real> depth;
    std::array<std::vector<Real>, 2> speed;
    static void fields(auto&& field) {
        field("depth", "m", &Water::depth), field("speed", "m/s", &Water::speed);
    }
};
struct Stones {
    std::vector<Real> depth;
    static void fields(auto&& field) { field("depth", "m", &Stones::depth); }
};

Water water(std::size_t cells) { return {std::vector<Real>(cells, 1), {}}; }

const std::string about = "length = 45\nslope = 0.05\n";

void save(const std::string& path, const Water& from) { save_state(path, about, StatePart{"water", from}); }
Water restored(const std::string& path) {
    Water to;
    restore_state(path, about, StatePart{"water", to});
    return to;
}

}  // namespace

TEST_CASE("a save that fails leaves what was there") {
    save("kept.h5", water(3));
    CHECK(!std::filesystem::exists("kept.h5.tmp"));

    // A disk that is full after 100 kB.
    signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    rlimit small = before;
    small.rlim_cur = 100000;
    setrlimit(RLIMIT_FSIZE, &small);
    CHECK_THROWS_AS(save("kept.h5", water(100000)), FileError);
    setrlimit(RLIMIT_FSIZE, &before);
    CHECK(!std::filesystem::exists("kept.h5.tmp"));
    CHECK(restored("kept.h5").depth == water(3).depth);

    std::filesystem::create_directories("in_the_way.h5/full");
    CHECK_THROWS_AS(save("in_the_way.h5", water(3)), FileError);
    CHECK(!std::filesystem::exists("in_the_way.h5.tmp"));
    CHECK_THROWS_AS(save("nowhere/water.h5", water(3)), FileError);
}

TEST_CASE("what is no checkpoint, cut off, of another version or another processor") {
    CHECK_THROWS_AS(restored("missing.h5"), InputError);
    std::ofstream("text.h5") << "no HDF5";
    CHECK_THROWS_AS(restored("text.h5"), InputError);
    Hdf5File::create("other.h5").close();
    CHECK_THROWS_WITH_AS(
        restored("other.h5"),
        "cannot go on from 'other.h5': it is an HDF5 file but not what save_state() wrote; name a "
        "checkpoint of a run",
        InputError);
    const auto with = [](const std::string& path, std::int64_t version, std::int64_t lanes) {
        Hdf5File file = Hdf5File::create(path);
        file.write_attribute({}, detail::state_version_name, version);
        file.write_attribute({}, "pack_lanes", lanes);
        file.close();
    };
    with("older.h5", 0, pack_lanes);
    CHECK_THROWS_WITH_AS(restored("older.h5"), doctest::Contains("it is of version 0, not "), InputError);
    with("wide.h5", detail::state_version, 2 * pack_lanes);
    CHECK_THROWS_WITH_AS(restored("wide.h5"), doctest::Contains("numbers at a time"), InputError);

    save("cut.h5", water(10000));
    for (const std::uintmax_t part : {1u, 2u, 3u}) {
        std::filesystem::copy_file("cut.h5", "part.h5", std::filesystem::copy_options::overwrite_existing);
        std::filesystem::resize_file("part.h5", std::filesystem::file_size("cut.h5") * part / 4);
        CHECK_THROWS_WITH_AS(restored("part.h5"), doctest::Contains("truncated"), InputError);
    }
}

TEST_CASE("what is about something else, or made of something else") {
    save("water.h5", water(3));
    Water to;
    CHECK_THROWS_WITH_AS(
        restore_state("water.h5", "length = 45\nslope = 0.1\n", StatePart{"water", to}),
        "cannot go on from 'water.h5': it is about 'slope = 0.05', not 'slope = 0.1'; ask for "
        "the run that was saved",
        InputError);
    Stones stones;
    CHECK_THROWS_WITH_AS(restore_state("water.h5", about, StatePart{"stones", stones}),
                         "cannot read 'water.h5', stones/depth_count: no such dataset", InputError);
}

TEST_CASE("a checkpoint of which some bytes have changed is refused") {
    save("changed.h5", water(3000));
    std::string bytes;
    {
        std::ifstream in("changed.h5", std::ios::binary);
        bytes.assign(std::istreambuf_iterator<char>(in), {});
    }
    const Real one = 1;  // eight in the midst of the depths
    const std::string depths(reinterpret_cast<const char*>(&one), sizeof one);
    const std::size_t at = bytes.find(depths + depths + depths) + 1000 * sizeof one;
    REQUIRE(bytes.compare(at, sizeof one, depths) == 0);
    bytes.replace(at, sizeof one, sizeof one, '\xff');
    std::ofstream("changed.h5", std::ios::binary) << bytes;
    CHECK_THROWS_WITH_AS(restored("changed.h5"), doctest::Contains("it is damaged"), InputError);
}
