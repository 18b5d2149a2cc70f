// What classes list as their fields comes back bit for bit.
#include <abrade/io/state_file.hpp>

#include <doctest/doctest.h>

#include <optional>
#include <random>

using namespace abrade;

namespace {

enum class Mood : std::uint8_t { calm, wild };

struct Leaf {
    Real weight = 0;
    Vec3 place = Vec3::Zero();
    bool green = false;
    static void fields(auto&& field) {
        field("weight", "kg", &Leaf::weight), field("place", "m", &Leaf::place), field("green", &Leaf::green);
    }
    bool operator==(const Leaf&) const = default;
};

struct Twig {
    std::vector<Leaf> leaves;
    std::vector<Index> marks;
    Mood mood = Mood::calm;
    static void fields(auto&& field) {
        field("leaves", &Twig::leaves), field("marks", &Twig::marks), field("mood", &Twig::mood);
    }
    bool operator==(const Twig&) const = default;
};

class Tree {
public:
    std::vector<Twig> twigs;
    std::optional<Leaf> fallen;
    std::array<std::vector<float>, 2> rings;
    std::mt19937_64 random{3};
    std::vector<std::array<Index, 2>> pairs;
    int told = 0;

    static void fields(auto&& field) {
        field("twigs", &Tree::twigs), field("fallen", &Tree::fallen), field("rings", &Tree::rings),
            field("random", &Tree::random), field("pairs", &Tree::pairs);
    }
    void restored() { ++told; }
};

Tree grown() {
    Tree tree;
    tree.twigs = {{{{1.5, {1, 2, 3}, true}, {-0.0, {4, 5, 6}, false}}, {7, 8}, Mood::wild},
                  {},
                  {{{5e-324, {7, 8, 9}, true}}, {9}, Mood::calm}};
    tree.fallen = Leaf{2, {0.1, 0.2, 0.3}, true};
    tree.rings = {std::vector<float>{1, 2}, std::vector<float>{3}};
    tree.random.discard(1234);
    tree.pairs = {{1, 2}, {3, 4}};
    return tree;
}

}  // namespace

TEST_CASE("numbers, vectors, classes and containers of them come back") {
    const Tree tree = grown();
    {
        Hdf5File file = Hdf5File::create("tree.h5");
        write_fields(file, "tree", tree);
        file.close();
    }
    Tree other;
    other.twigs.resize(7);  // what was there before makes no difference
    read_fields(Hdf5File::open("tree.h5"), "tree", other);
    CHECK(other.twigs == tree.twigs);
    CHECK(std::signbit(other.twigs[0].leaves[1].weight));
    CHECK(other.fallen == tree.fallen);
    CHECK(other.rings == tree.rings);
    CHECK(other.random == tree.random);
    CHECK(other.pairs == tree.pairs);
    CHECK(other.told == 1);
}

TEST_CASE("columns are where a reader looks for them, with their units") {
    {
        Hdf5File file = Hdf5File::create("columns.h5");
        write_fields(file, "tree", grown());
        file.close();
    }
    const Column weight = Hdf5File::open("columns.h5").read("tree/twigs/each/leaves/each/weight");
    CHECK(weight.unit == "kg");
    CHECK(weight.values == std::vector<Real>{1.5, -0.0, 5e-324});
}

TEST_CASE("a file of something else is refused by name") {
    {
        Hdf5File file = Hdf5File::create("leaf.h5");
        write_fields(file, "leaf", Leaf{});
        write_fields(file, "twig", Twig{});
        file.close();
    }
    const Hdf5File file = Hdf5File::open("leaf.h5");
    Tree tree;
    CHECK_THROWS_WITH_AS(read_fields(file, "leaf", tree),
                         "cannot read 'leaf.h5', leaf/twigs_count: no such dataset", InputError);
    Leaf leaf;
    CHECK_THROWS_AS(read_fields(file, "twig", leaf), InputError);
}
