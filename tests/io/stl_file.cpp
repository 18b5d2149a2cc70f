// STL files: both kinds are read, what is broken is refused as a whole, with the file's name.
#include <abrade/io/stl_file.hpp>

#include <doctest/doctest.h>

#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

using namespace abrade;
namespace fs = std::filesystem;

namespace {

/// A tetrahedron with its right angle at the origin and legs of 1, 2 and 3: V = 1.
const std::array<Vec3, 4> corners{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 2, 0), Vec3(0, 0, 3)};
const std::array<Triangle, 4> faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};

SurfaceMesh tetrahedron() { return {{corners.begin(), corners.end()}, {faces.begin(), faces.end()}}; }

std::string ascii(const std::string& space = " ", const std::string& line_end = "\n") {
    std::ostringstream text;
    text << "solid a stone" << line_end;
    for (const Triangle& t : faces) {
        text << "facet" << space << "normal nan 0 0" << line_end << space << "outer loop" << line_end;
        for (const std::size_t v : t)
            text << space << space << "vertex" << space << corners[v].x() << space << corners[v].y() << "e0"
                 << space << "+" << corners[v].z() << line_end;
        text << "endloop" << line_end << "endfacet" << line_end;
    }
    text << "endsolid a stone" << line_end;
    return text.str();
}

std::string binary() {
    write_stl(tetrahedron(), "whole.stl");
    std::ostringstream text;
    text << std::ifstream{"whole.stl", std::ios::binary}.rdbuf();
    return text.str();
}

fs::path put(const std::string& bytes) {
    std::ofstream{"stone.stl", std::ios::binary} << bytes;
    return "stone.stl";
}

std::string message_of(const std::string& bytes, const StlOptions& options = {}) {
    try {
        read_stl(put(bytes), options);
    } catch (const InputError& error) {
        return std::string{"input: "} + error.what();
    } catch (const FileError& error) {
        return std::string{"file: "} + error.what();
    }
    return "nothing was thrown";
}
bool has(const std::string& text, std::string_view part) { return text.find(part) != text.npos; }

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    return text.replace(text.find(what), what.size(), by);
}

void check_tetrahedron(const SurfaceMesh& mesh) {
    CHECK(mesh.vertices().size() == 4);
    CHECK(mesh.triangles().size() == 4);
    CHECK(mesh.moments().volume == doctest::Approx(1).epsilon(1e-14));
    CHECK((mesh.moments().centroid - Vec3(0.25, 0.5, 0.75)).norm() < 1e-14);
}

}  // namespace

TEST_CASE("ASCII, with whatever spaces and line ends") {
    check_tetrahedron(read_stl(put(ascii())));
    check_tetrahedron(read_stl(put(ascii("\t \t"))));
    check_tetrahedron(read_stl(put(ascii("  ", "\r\n"))));
    check_tetrahedron(read_stl(put("\n\n  " + ascii(" ", " \n\n") + "\n \t\n")));
    std::string shouting = ascii();
    for (char& c : shouting)
        if (c >= 'a' && c <= 'z' && c != 'e') c = static_cast<char>(c - 32);
    check_tetrahedron(read_stl(put(shouting)));
}

TEST_CASE("binary, even when its head says solid") {
    check_tetrahedron(read_stl(put(binary())));
    std::string head = binary();
    std::memcpy(head.data(), "solid by some program", 21);
    check_tetrahedron(read_stl(put(head)));
}

TEST_CASE("what is written is read back, to the digits of a 32-bit number") {
    std::vector<Vec3> v(corners.begin(), corners.end());
    for (Vec3& x : v) x = 0.01 * x + Vec3(0.1, 0.2, -0.3);
    const SurfaceMesh mesh(v, {faces.begin(), faces.end()});
    write_stl(mesh, "again.stl");
    const SurfaceMesh again = read_stl("again.stl");
    for (std::size_t t = 0; t < 4; ++t)
        for (std::size_t k = 0; k < 3; ++k) CHECK((again.corner(t, k) - mesh.corner(t, k)).norm() < 1e-7);
    CHECK_THROWS_AS(write_stl(mesh, "no/such/folder/again.stl"), FileError);
}

TEST_CASE("the unit of the file") {
    CHECK(read_stl(put(ascii()), {.unit = 1e-3}).moments().volume == doctest::Approx(1e-9).epsilon(1e-12));
    CHECK(message_of(ascii(), {.unit = 0}) ==
          "input: StlOptions.unit must be finite and > 0, got 0 m; 1e-3 for a file in millimetres");
}

TEST_CASE("a file that is cut off is refused wherever it is cut") {
    const std::string whole = binary(), text = ascii();
    for (std::size_t bytes = 0; bytes < whole.size(); bytes += 7)
        CHECK(has(message_of(whole.substr(0, bytes)), "file: cannot read 'stone.stl' as "));
    // Up to where the word endsolid is whole; the name behind it does not matter.
    for (std::size_t bytes = 0; bytes < text.find("endsolid") + 8; bytes += 5)
        CHECK(has(message_of(text.substr(0, bytes)), "file: cannot read 'stone.stl' as "));
    CHECK(has(message_of(""), "as STL: it is empty; is it cut off"));
    CHECK(has(message_of(whole.substr(0, 60)), "it has 60 bytes, and a binary one has at least 84"));
    CHECK(has(message_of(text.substr(0, text.find("endsolid"))), "line 30 should have more, has ended"));
}

TEST_CASE("a wrong number of triangles") {
    std::string more = binary();
    more[80] = 5;
    CHECK(has(message_of(more), "its number of triangles asks for 334 bytes, it has 284"));
    more[83] = '\x7f';  // two thousand million of them: refused before any room is made for them
    CHECK(has(message_of(more), "it has 284"));
    CHECK(has(message_of(binary() + "x"), "asks for 284 bytes, it has 285"));
}

TEST_CASE("broken text, with its line") {
    CHECK(has(message_of(replaced(ascii(), "vertex 1", "vertex one")),
              "line 6 should have a number, has 'one'"));
    CHECK(has(message_of(replaced(ascii(), "vertex 1", "vertex 1x")), "has '1x'"));
    CHECK(has(message_of(replaced(ascii(), "endloop", "vertex")),
              "line 7 should have 'endloop', has 'vertex'"));
    CHECK(has(message_of(replaced(ascii(), "outer", "inner")), "line 3 should have 'outer', has 'inner'"));
    CHECK(has(message_of("a stone"), "as STL: it has 7 bytes"));
}

TEST_CASE("numbers that are none, and surfaces that are not closed") {
    CHECK(has(message_of(replaced(ascii(), "vertex 1", "vertex nan")),
              "input: 'stone.stl': SurfaceMesh.triangles[0].corners[2].x must be finite, got nan m; mend"));
    CHECK(has(message_of(replaced(ascii(), "vertex 1", "vertex inf")), "must be finite, got inf m"));
    std::string nan = binary();
    const float bad = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(nan.data() + 84 + 12, &bad, 4);
    CHECK(has(message_of(nan), "SurfaceMesh.triangles[0].corners[0].x must be finite, got nan m"));
    CHECK(has(message_of(replaced(ascii(), "vertex 1", "vertex 1.001")),
              "SurfaceMesh must be closed and manifold"));
    CHECK(read_stl(put(replaced(ascii(), "vertex 1", "vertex 1.001")), {.merge_distance = 0.01})
              .triangles()
              .size() == 4);
    CHECK(has(message_of("solid nothing\nendsolid nothing\n"),
              "SurfaceMesh.triangles must be at least 4, got 0"));
}

TEST_CASE("no file, and a folder") {
    CHECK_THROWS_WITH_AS(read_stl("none.stl"), "cannot read 'none.stl': is it there, and a file?", FileError);
    fs::create_directories("folder.stl");
    CHECK_THROWS_AS(read_stl("folder.stl"), FileError);
}
