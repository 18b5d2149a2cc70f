// Series for ParaView: the XDMF is whole after each write and names data that are there, of the size that it
// says.
#include <abrade/io/series.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

using namespace abrade;

namespace {

std::string text_of(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream{path}.rdbuf();
    return text.str();
}

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
    return count;
}

/// Every element that opens closes, and nothing follows the last.
void check_whole(const std::string& xdmf) {
    for (const std::string name :
         {"Xdmf", "Domain", "Grid", "Geometry", "Attribute", "DataItem", "Topology"}) {
        const std::size_t opened = count_of(xdmf, "<" + name + " ") + count_of(xdmf, "<" + name + ">");
        CHECK(opened == count_of(xdmf, "</" + name + ">"));
    }
    CHECK(xdmf.ends_with("</Xdmf>\n"));
}

/// Every DataItem is in its file (looked for in `folder`), with as many numbers as its Dimensions say.
std::size_t check_data(const std::string& xdmf, const std::filesystem::path& folder = {}) {
    const auto between = [&](std::size_t from, std::string_view left, std::string_view right) {
        const std::size_t begin = xdmf.find(left, from) + left.size();
        return xdmf.substr(begin, xdmf.find(right, begin) - begin);
    };
    std::size_t items = 0;
    for (std::size_t at = xdmf.find("<DataItem"); at != xdmf.npos;
         at = xdmf.find("<DataItem", at + 1), ++items) {
        const std::string place = between(at, ">", "</DataItem>");
        const Column column = Hdf5File::open(folder / place.substr(0, place.find(":/")))
                                  .read(place.substr(place.find(":/") + 2));
        std::string shape = std::to_string(column.view().count());
        if (column.components > 1) shape += " " + std::to_string(column.components);
        CHECK(between(at, "Dimensions=\"", "\"") == shape);
    }
    return items;
}

}  // namespace

TEST_CASE("after each write the series is whole, also for a reader beside the writer") {
    SeriesWriter series{"run"};
    for (int step = 0; step < 4; ++step) {
        const std::size_t stones = step == 0 ? 0 : static_cast<std::size_t>(4 - step);  // none, 3, 2, 1
        const std::vector<Real> positions(3 * stones, 0.5 * step), speeds(stones, 2.0),
            spins(4 * stones, 1.0);
        const FieldView fields[] = {
            {"speed", "m/s", 1, speeds}, {"orientation", "-", 4, spins}, {"velocity", "m/s", 3, positions}};
        series.write("stones", 0.1 * step, {"position", "m", 3, positions}, fields);

        // What a killed run leaves is what is on disk now: read copies while the writer still has its files
        // open.
        std::filesystem::create_directories("copy");
        std::filesystem::copy_file("run.h5", "copy/run.h5",
                                   std::filesystem::copy_options::overwrite_existing);
        const std::string xdmf = text_of("run_stones.xdmf");
        check_whole(xdmf);
        CHECK(count_of(xdmf, "<Time Value=") == static_cast<std::size_t>(step) + 1);
        CHECK(check_data(xdmf, "copy") == 5 * (static_cast<std::size_t>(step) + 1));
    }
    const std::string xdmf = text_of(series.xdmf_path("stones"));
    CHECK(count_of(xdmf, "AttributeType=\"Vector\"") == 4);
    CHECK(count_of(xdmf, "AttributeType=\"Scalar\"") == 4);
    CHECK(count_of(xdmf, "NumberOfElements=\"3\"") == 1);
    CHECK(count_of(xdmf, "<Information Name=\"unit\" Value=\"m/s\"/>") == 8);
}

TEST_CASE("what is constant is stored once and named at each time") {
    const std::vector<Real> positions(3000, 0.25), radii(1000, 0.01);
    const FieldView radius{"radius", "m", 1, radii};
    SeriesWriter series{"constant"};
    series.set_constant("concrete", {"position", "m", 3, positions}, {&radius, 1});
    for (const Real time : {0.0, 1.0, 2.0}) {
        const std::vector<Real> rates(1000, time);
        const FieldView rate{"fracture_rate", "-", 1, rates};
        series.write("concrete", time, {&rate, 1});
    }
    series.close();
    const std::string xdmf = text_of("constant_concrete.xdmf");
    check_whole(xdmf);
    CHECK(check_data(xdmf) == 12);  // vertices, positions, rate, radius, three times
    CHECK(count_of(xdmf, "constant.h5:/concrete/constant_0/radius<") == 3);
    const Hdf5File data = Hdf5File::open("constant.h5");
    CHECK(data.names("concrete") == std::vector<std::string>{"constant_0", "time_0", "time_1", "time_2"});
    CHECK(data.names("concrete/time_1") == std::vector<std::string>{"fracture_rate"});
    CHECK(data.read("concrete/time_2/fracture_rate").values.front() == 2.0);
}

TEST_CASE("a series refuses what would not open") {
    const std::vector<Real> positions(6, 0.0), three(3, 0.0);
    const FieldView at{"position", "m", 3, positions}, wrong{"speed", "m/s", 1, three};
    SeriesWriter series{"refused"};
    series.write("stones", 1.0, at);
    CHECK_THROWS_WITH_AS(series.write("stones", 1.0, at),
                         "SeriesWriter.stones time must be later than the one before (1), got 1 s; write "
                         "each time once, in order",
                         InputError);
    CHECK_THROWS_AS(series.write("stones", std::nan(""), at), InputError);
    CHECK_THROWS_WITH_AS(series.write("stones", 2.0, at, {&wrong, 1}),
                         "SeriesWriter.stones.speed must be one row per point (2 x 1), got 3 values; does it "
                         "belong to another cloud?",
                         InputError);
    CHECK_THROWS_AS(series.write("stones", 2.0, {&wrong, 1}), InputError);  // no constant positions
    CHECK_THROWS_AS(series.write("a b", 2.0, at), InputError);
    CHECK_THROWS_AS(series.write("stones", 2.0, wrong), InputError);  // not 3 components
    CHECK_THROWS_AS((SeriesWriter{"whole_numbers", {.number = StoredNumber::int32}}), InputError);
    CHECK_THROWS_AS(SeriesWriter{"missing/run"}, InputError);
    check_whole(text_of("refused_stones.xdmf"));
}
