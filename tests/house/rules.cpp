// The headers keep the rules of the house, and the check of that can fail.

#include "rules.hpp"

#include <doctest/doctest.h>

namespace fs = std::filesystem;

namespace {

/// A made-up include folder, gone at the end of the test. Tests run in a folder of their own.
class MadeUpTree {
public:
    MadeUpTree() { fs::remove_all(dir_); }
    ~MadeUpTree() { fs::remove_all(dir_); }
    MadeUpTree(const MadeUpTree&) = delete;
    MadeUpTree& operator=(const MadeUpTree&) = delete;

    void add(const std::string& path, const std::string& text) const {
        fs::create_directories((dir_ / path).parent_path());
        std::ofstream(dir_ / path) << text;
    }
    /// All offences, one a line.
    std::string offences() const {
        std::string all;
        for (const std::string& offence : house::offences(dir_)) all += offence + "\n";
        return all;
    }

private:
    fs::path dir_ = "made_up_tree";
};

const std::string once = "#pragma once\n";

}  // namespace

TEST_CASE("the library keeps the rules of the house") {
    for (const std::string& offence : house::offences(ABRADE_INCLUDE_DIR)) FAIL_CHECK(offence);
    for (const std::string& arrow : house::needless_arrows(ABRADE_INCLUDE_DIR))
        FAIL_CHECK(arrow << " is allowed, and no header does it");
}

TEST_CASE("a tree that keeps the rules has no offence") {
    MadeUpTree tree;
    tree.add("abrade/core/types.hpp", once + "#include <Eigen/Core>\n");
    tree.add("abrade/dem/time/stepper.hpp",
             once + "#include <abrade/core/types.hpp>\n#include <" + std::string(house::odeint_tag) + ">\n");
    tree.add("abrade/dem/time/odeint_steppers.hpp",
             once + "#include <boost/numeric/odeint/stepper/velocity_verlet.hpp>\n");
    tree.add("abrade/dem/linear.hpp",
             once + "#include <abrade/dem/time/stepper.hpp>\n// #include <iostream>\n");
    tree.add("abrade/abrade.hpp", once + "#include <abrade/dem/linear.hpp>\n");
    tree.add("abrade/dem/declared.hpp",
             once + "#ifndef ABRADE_COMPILED\n#include <abrade/dem/bodies.hpp>\n#endif\n");
    tree.add("abrade/dem/bodies.hpp", once + "#include <abrade/dem/declared.hpp>\n");
    CHECK(tree.offences() == "");
}

TEST_CASE("each rule can be broken") {
    MadeUpTree tree;
    tree.add("abrade/core/types.hpp", once);

    const auto says = [&](const std::string& path, const std::string& text) {
        tree.add(path, text);
        return tree.offences();
    };
    SUBCASE("a room below") {
        tree.add("abrade/dem/linear.hpp", once);
        CHECK(says("abrade/geometry/sphere.hpp", once + "\n#include <abrade/dem/linear.hpp>\n") ==
              "abrade/geometry/sphere.hpp:3: includes abrade/dem/linear.hpp, which is in a room below its "
              "own\n");
    }
    SUBCASE("each pair of rooms") {
        for (std::size_t above = 0; above < house::rooms.size(); ++above)
            for (std::size_t below = above + 1; below < house::rooms.size(); ++below) {
                MadeUpTree pair;
                const std::string a = "abrade/" + std::string(house::rooms[above]) + "/a.hpp";
                const std::string b = "abrade/" + std::string(house::rooms[below]) + "/b.hpp";
                pair.add(a, once);
                pair.add(b, once + "#include <" + a + ">\n");
                CHECK(pair.offences() == "");
                pair.add(a, once + "#include <" + b + ">\n");
                pair.add(b, once);
                CHECK(pair.offences() == a + ":2: includes " + b + ", which is in a room below its own\n");
            }
    }
    SUBCASE("a cycle inside a room") {
        tree.add("abrade/dem/a.hpp", once + "#include <abrade/dem/b.hpp>\n");
        CHECK(says("abrade/dem/b.hpp", once + "#include <abrade/dem/a.hpp>\n") ==
              "cycle: abrade/dem/a.hpp -> abrade/dem/b.hpp -> abrade/dem/a.hpp\n");
    }
    SUBCASE("a cycle by way of a header's bodies") {
        tree.add("abrade/dem/bodies.hpp",
                 once + "#include <abrade/dem/slices.hpp>\n#include <abrade/dem/declared.hpp>\n");
        tree.add("abrade/dem/declared.hpp",
                 once + "#ifndef ABRADE_COMPILED\n#include <abrade/dem/bodies.hpp>\n#endif\n");
        CHECK(says("abrade/dem/slices.hpp", once + "#include <abrade/dem/declared.hpp>\n") ==
              "cycle: abrade/dem/bodies.hpp -> abrade/dem/slices.hpp -> abrade/dem/declared.hpp -> "
              "abrade/dem/bodies.hpp\n");
    }
    SUBCASE("no pragma once first") {
        CHECK(says("abrade/core/a.hpp", "// a\n#pragma once\n") ==
              "abrade/core/a.hpp:1: must begin with #pragma once\n");
    }
    SUBCASE("a folder of the room that its own may not include") {
        tree.add("abrade/fluid/vof/a.hpp", once);
        tree.add("abrade/fluid/mesh/b.hpp", once);
        CHECK(says("abrade/fluid/mesh/a.hpp", once + "#include <abrade/fluid/vof/a.hpp>\n") ==
              "abrade/fluid/mesh/a.hpp:2: includes abrade/fluid/vof/a.hpp, which fluid/mesh may not\n");
        CHECK(says("abrade/fluid/mesh/a.hpp", once + "#include <abrade/fluid/mesh/b.hpp>\n") == "");
        CHECK(says("abrade/fluid/a.hpp", once + "#include <abrade/fluid/mesh/b.hpp>\n") ==
              "abrade/fluid/a.hpp:2: includes abrade/fluid/mesh/b.hpp, which fluid may not\n");
        CHECK(says("abrade/coupling/drag/a.hpp", once + "#include <abrade/fluid/mesh/b.hpp>\n") ==
              "abrade/fluid/a.hpp:2: includes abrade/fluid/mesh/b.hpp, which fluid may not\n");
    }
    SUBCASE("an arrow that is allowed and that no header needs") {
        const auto needless = [] {
            const auto all = house::needless_arrows("made_up_tree");
            return std::count(all.begin(), all.end(), "fluid/vof -> fluid/mesh");
        };
        CHECK(needless() == 1);
        tree.add("abrade/fluid/vof/a.hpp", once + "#include <abrade/fluid/mesh/b.hpp>\n");
        CHECK(needless() == 0);
    }
    SUBCASE("heavy headers") {
        CHECK(says("abrade/core/a.hpp", once + "#include <Eigen/Dense>\n") ==
              "abrade/core/a.hpp:2: includes all of Eigen, must be the parts that it uses\n");
        CHECK(says("abrade/core/a.hpp", once + "# include <iostream>\n") ==
              "abrade/core/a.hpp:2: includes <iostream>, must be <ostream> or <iosfwd>\n");
        CHECK(says("abrade/core/a.hpp", once + "#include <boost/numeric/odeint.hpp>\n") ==
              "abrade/core/a.hpp:2: includes all of odeint\n");
        CHECK(says("abrade/core/a.hpp", once + "#include <boost/numeric/odeint/stepper/euler.hpp>\n") ==
              "abrade/core/a.hpp:2: includes odeint, which only dem/time/odeint_steppers.hpp may\n");
        fs::remove("made_up_tree/abrade/core/a.hpp");
        CHECK(
            says("abrade/dem/time/stepper.hpp",
                 once + "#include <boost/numeric/odeint/stepper/euler.hpp>\n") ==
            "abrade/dem/time/stepper.hpp:2: includes odeint, which only dem/time/odeint_steppers.hpp may\n");
        tree.add("abrade/dem/time/stepper.hpp", once);
        tree.add("abrade/dem/time/odeint_steppers.hpp", once);
        CHECK(says("abrade/sim/a.hpp", once + "#include <abrade/dem/time/odeint_steppers.hpp>\n") ==
              "abrade/sim/a.hpp:2: includes odeint's steppers, which only users may\n");
    }
    SUBCASE("wrong places") {
        CHECK(says("abrade/fluid/attic/a.hpp", once) ==
              "abrade/fluid/attic/a.hpp:1: stands in no known folder of its room\n");
        fs::remove("made_up_tree/abrade/fluid/attic/a.hpp");
        CHECK(says("abrade/attic/a.hpp", once) == "abrade/attic/a.hpp:1: stands in no known room\n");
        fs::remove("made_up_tree/abrade/attic/a.hpp");
        CHECK(says("abrade/other.hpp", once) ==
              "abrade/other.hpp:1: only abrade.hpp stands outside the rooms\n");
        fs::remove("made_up_tree/abrade/other.hpp");
        CHECK(says("abrade/core/a.h", once) == "abrade/core/a.h:1: is not a .hpp\n");
    }
    SUBCASE("wrong names") {
        CHECK(says("abrade/core/a.hpp", once + "#include \"types.hpp\"\n") ==
              "abrade/core/a.hpp:2: includes \"types.hpp\", must be <abrade/ROOM/HEADER.hpp>\n");
        CHECK(says("abrade/core/a.hpp", once + "#include <abrade/core/tpyes.hpp>\n") ==
              "abrade/core/a.hpp:2: includes abrade/core/tpyes.hpp, which does not exist\n");
    }
}
