#pragma once
// Published numbers: a comment that says where they are from, a header of column names, rows.

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

/// One row by column name: what is a number, and every cell as it stands.
struct ReferenceRow {
    std::map<std::string, double> numbers;
    std::map<std::string, std::string> texts;

    double at(const std::string& column) const { return numbers.at(column); }
    bool contains(const std::string& column) const { return numbers.contains(column); }
    bool is(const std::string& column, const std::string& text) const { return texts.at(column) == text; }
};

/// Rows of tests/verification/data/NAME. Throws where it is not such a table.
inline std::vector<ReferenceRow> reference_table(const std::string& name) {
    std::ifstream file(std::string(ABRADE_TEST_DATA) + "/" + name);
    if (!file) throw std::runtime_error("cannot read " + name);
    std::vector<std::string> columns;
    std::vector<ReferenceRow> rows;
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::vector<std::string> cells;
        std::istringstream text(line);
        for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
        if (columns.empty()) {
            columns = cells;
            continue;
        }
        if (cells.size() != columns.size()) throw std::runtime_error(name + ": a short row: " + line);
        auto& row = rows.emplace_back();
        for (std::size_t c = 0; c < cells.size(); ++c) {
            row.texts[columns[c]] = cells[c];
            char* end = nullptr;
            const double value = std::strtod(cells[c].c_str(), &end);
            if (end != cells[c].c_str() && value == value) row.numbers[columns[c]] = value;
        }
    }
    if (rows.empty()) throw std::runtime_error(name + " has no rows");
    return rows;
}
