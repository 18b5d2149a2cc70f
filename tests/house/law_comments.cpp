// A law's comment says its formula, symbols, validity, what it throws and where it is from.

#include "law_comments.hpp"

#include <doctest/doctest.h>

TEST_CASE("the comments of laws have all parts, in order") {
    for (const std::string& law : house::incomplete_laws_below(ABRADE_INCLUDE_DIR)) FAIL_CHECK(law);
}

TEST_CASE("a part that is missing or out of order is named") {
    const auto said = [](const std::string& comment) {
        const std::filesystem::path file = "made_up_law.hpp";
        std::ofstream(file) << comment +
                                   "template <class L>\nclass Law {\n"
                                   "    static constexpr std::string_view name = \"Law\";\n};\n";
        const auto found = house::incomplete_laws(file);
        std::filesystem::remove(file);
        return found.empty() ? std::string("whole") : found.front();
    };
    const std::string title = "/// A law.\n", formula = "///   f = k x\n/// x way [m]\n",
                      validity = "/// Validity: small x.\n", throws = "/// Throws InputError.\n",
                      source = "/// Source: doi:10.0/0.\n";
    CHECK(said(title + formula + validity + throws + source) == "whole");
    CHECK(said(title + validity + throws + source) == "Law misses a formula");
    CHECK(said(title + formula + throws + source) == "Law misses Validity:");
    CHECK(said(title + formula + throws + validity + source) == "Law misses Throws ");
    CHECK(said(title + formula + validity + throws) == "Law misses Source:");
    CHECK(said("") == "Law misses a formula");
}
