// HDF5 files: columns and attributes come back as they went; errors name file and object, and HDF5 stays
// silent.
#include <abrade/io/hdf5_file.hpp>

#include "../message_of.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

using namespace abrade;

namespace {

bool has(const std::string& text, std::string_view part) { return text.find(part) != text.npos; }

}  // namespace

TEST_CASE("columns come back with name, unit, shape and values") {
    const std::vector<Real> positions{0.1, -0.0, 3.0, 1e300, 5e-324, -6.0};
    const std::vector<Real> radii{0.5, 0.25};
    {
        Hdf5File file = Hdf5File::create("columns.h5");
        file.write("bodies/moving", {"position", "m", 3, positions});
        file.write("bodies/moving", {"radius", "m", 1, radii}, {.gzip = 1});
        file.write("", {"at_the_root", "-", 1, radii});
        file.write("bodies/moving", {"empty", "Pa", 3, {}}, {.gzip = 1});
        file.close();
    }
    const Hdf5File file = Hdf5File::open("columns.h5");
    const Column position = file.read("bodies/moving/position");
    CHECK(position.name == "position");
    CHECK(position.unit == "m");
    CHECK(position.components == 3);
    CHECK(position.values == positions);
    CHECK(std::signbit(position.values[1]));
    CHECK(position.view().count() == 2);
    CHECK(file.read("bodies/moving/radius").components == 1);
    CHECK(file.read("bodies/moving/radius").values == radii);
    CHECK(file.read("at_the_root").values == radii);
    CHECK(file.read("bodies/moving/empty").values.empty());
    CHECK(file.read("bodies/moving/empty").components == 3);
    CHECK(file.names("bodies/moving") == std::vector<std::string>{"position", "radius", "empty"});
    CHECK(file.contains("bodies/moving/radius"));
    CHECK(!file.contains("bodies/resting/radius"));
}

TEST_CASE("a column can be stored as 32-bit floats or whole numbers") {
    const std::vector<Real> values{0.1, 7.0};
    Hdf5File file = Hdf5File::create("small.h5");
    file.write("", {"real32", "m", 1, values}, {.number = StoredNumber::real32});
    file.write("", {"int32", "-", 1, values}, {.number = StoredNumber::int32});
    CHECK(file.read("real32").values[0] == static_cast<Real>(0.1F));
    CHECK(file.read("int32").values == std::vector<Real>{0, 7});
}

TEST_CASE("compression makes a large constant column small") {
    const std::vector<Real> values(100000, 0.02);
    for (const int gzip : {0, 1}) {
        Hdf5File file = Hdf5File::create("gzip.h5");
        file.write("", {"radius", "m", 1, values}, {.gzip = gzip});
        file.close();
        CHECK((std::filesystem::file_size("gzip.h5") < 100000) == (gzip == 1));  // 800 kB plain
        CHECK(Hdf5File::open("gzip.h5").read("radius").values == values);
    }
}

TEST_CASE("attributes of three kinds come back") {
    {
        Hdf5File file = Hdf5File::create("attributes.h5");
        file.make_group("run");
        file.write_attribute("", "time", 0.1);
        file.write_attribute("run", "step", 9007199254740993);  // not a double
        file.write_attribute("run", "law", std::string{"Mohr-Coulomb, µ"});
        file.write_attribute("run", "none", std::string{});
    }
    const Hdf5File file = Hdf5File::open("attributes.h5");
    CHECK(file.attribute("", "time") == AttributeValue{0.1});
    const Attributes all = file.attributes("run");
    CHECK(all.size() == 3);
    CHECK(all.at("step") == AttributeValue{9007199254740993});
    CHECK(all.at("law") == AttributeValue{"Mohr-Coulomb, µ"});
    CHECK(all.at("none") == AttributeValue{""});
}

TEST_CASE("errors name file and object") {
    CHECK(has(message_of<InputError>([] { Hdf5File::open("missing.h5"); }), "cannot open 'missing.h5'"));
    CHECK(has(message_of<InputError>([] { Hdf5File::create("missing/x.h5"); }),
              "cannot create 'missing/x.h5'"));
    std::ofstream{"text.h5"} << "not HDF5";
    CHECK(has(message_of<InputError>([] { Hdf5File::open("text.h5"); }), "cannot open 'text.h5'"));

    Hdf5File file = Hdf5File::create("errors.h5");
    const std::vector<Real> values{1, 2, 3};
    file.write("a", {"x", "m", 1, values});
    CHECK(message_of<InputError>([&] { file.read("a/y"); }) ==
          "cannot read 'errors.h5', a/y: no such dataset");
    CHECK(message_of<InputError>([&] { file.read("a"); }) == "cannot read 'errors.h5', a: no such dataset");
    CHECK(message_of<InputError>([&] { file.attribute("a", "t"); }) ==
          "cannot read 'errors.h5', a/t: no such attribute");
    CHECK(has(message_of<FileError>([&] {
                  file.write("a", {"x", "m", 1, values});
              }),
              "cannot write 'errors.h5', a/x: name already exists"));
    CHECK(has(message_of<InputError>([&] { file.write("a", {"z", "m", 2, values}); }), "whole rows of 2"));
    CHECK(has(message_of<InputError>([&] { file.write("a", {"", "m", 1, values}); }), "must be named"));
    CHECK(has(message_of<InputError>([&] { file.write("a", {"b/c", "m", 1, values}); }), "without '/'"));
}

TEST_CASE("the caller's own handler of HDF5 errors is back after a call") {
    int marker = 0;
    const auto handler = [](hid_t, void*) -> herr_t { return 0; };
    H5E_auto2_t before = nullptr;
    void* before_data = nullptr;
    H5Eget_auto2(H5E_DEFAULT, &before, &before_data);
    H5Eset_auto2(H5E_DEFAULT, handler, &marker);
    CHECK_THROWS_AS(Hdf5File::open("missing.h5"), InputError);
    H5E_auto2_t now = nullptr;
    void* now_data = nullptr;
    H5Eget_auto2(H5E_DEFAULT, &now, &now_data);
    CHECK(now_data == &marker);
    H5Eset_auto2(H5E_DEFAULT, before, before_data);
}

TEST_CASE("rows as they lie in memory come back, at the root and in groups, as many as there are") {
    const std::vector<float> rows{1, 2, 3, 4, 5, 6};
    const auto of = abrade::detail::column_of<float>(3);
    {
        Hdf5File file = Hdf5File::create("rows.h5");
        for (const char* name : {"plain", "in/groups/below"})
            file.write_rows(name, "m", of, std::as_bytes(std::span(rows)));
        file.close();
    }
    const Hdf5File file = Hdf5File::open("rows.h5");
    for (const char* name : {"plain", "in/groups/below"}) {
        CAPTURE(name);
        REQUIRE(file.count_rows(name, of) == 2);
        std::vector<float> read(6);
        file.read_rows(name, of, std::as_writable_bytes(std::span(read)));
        CHECK(read == rows);
        read.resize(3);
        CHECK(message_of<InputError>([&] {
                  file.read_rows(name, of, std::as_writable_bytes(std::span(read)));
              }).find("2 rows and not the 1") != std::string::npos);
    }
}
