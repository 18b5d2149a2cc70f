#pragma once
// Published numbers: a comment that says where they are from, a header of column names, rows.

#include <doctest/doctest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

/// Rows of tests/verification/data/NAME by column name; what is no number is left out of its row.
inline std::vector<std::map<std::string, double>> reference_table(const std::string& name) {
    std::ifstream file(std::string(ABRADE_TEST_DATA) + "/" + name);
    REQUIRE_MESSAGE(file.good(), "cannot read ", name);
    std::vector<std::string> columns;
    std::vector<std::map<std::string, double>> rows;
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::vector<std::string> cells;
        std::istringstream text(line);
        for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
        if (columns.empty()) {
            columns = cells;
            continue;
        }
        REQUIRE(cells.size() == columns.size());
        auto& row = rows.emplace_back();
        for (std::size_t c = 0; c < cells.size(); ++c) {
            char* end = nullptr;
            const double value = std::strtod(cells[c].c_str(), &end);
            if (end != cells[c].c_str() && value == value) row[columns[c]] = value;
        }
    }
    REQUIRE(!rows.empty());
    return rows;
}
