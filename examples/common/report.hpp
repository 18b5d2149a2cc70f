#pragma once
// A run's report: one HTML file with everything in it, to be opened, mailed, archived. No scripts, nothing
// loaded.

#include <abrade/core/require.hpp>
#include <abrade/core/types.hpp>
#include <abrade/io/file_error.hpp>

#include "parameter.hpp"

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace abrade::examples {

/// A line of a table.
struct ReportRow {
    std::string name{};
    std::string value{};
    std::string unit{};
};

/// A picture (.png) with what it shows.
struct ReportFigure {
    std::filesystem::path picture{};
    std::string caption{};
};

/// A table of its own; the first column names the rows.
struct ReportTable {
    std::string title{};
    std::vector<std::string> columns{};
    std::vector<std::vector<std::string>> rows{};
    bool numbers = true;  ///< to the right, but for the first column
};

/// What a report says. Any text may hold any character.
struct Report {
    std::string title{};
    std::string explanation{};  ///< one paragraph: what was run, and what it shows
    std::vector<ReportRow> summary{};
    std::vector<ReportTable> tables{};
    std::vector<ReportFigure> figures{};
    std::vector<Parameter> parameters{};
    std::vector<std::string> notes{};
    std::vector<ReportRow> versions{};  ///< compiler, flags, libraries, seed
};

/// A number for a table: 4 digits, or as many as asked for.
inline std::string short_number(Real value, int digits = 4) {
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%.*g", digits, value);
    return text.data();
}

/// Text that HTML shows as it is.
inline std::string html_text(std::string_view text) {
    std::string out{};
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

/// Base64 (RFC 4648).
inline std::string base64(std::string_view bytes) {
    static constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out{};
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k)
            out += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63U];
    }
    return out;
}

/// How this program was built, for `Report::versions`.
inline std::vector<ReportRow> build_versions() {
    std::vector<ReportRow> rows{};
#if defined(__clang__)
    rows.push_back({"compiler", "clang " __clang_version__});
#elif defined(__GNUC__)
    rows.push_back({"compiler", "g++ " __VERSION__});
#endif
#if defined(NDEBUG)
    rows.push_back({"assertions", "off"});
#else
    rows.push_back({"assertions", "on"});
#endif
#if defined(__AVX512F__)
    rows.push_back({"instructions", "AVX-512"});
#elif defined(__AVX2__)
    rows.push_back({"instructions", "AVX2"});
#else
    rows.push_back({"instructions", "baseline"});
#endif
    return rows;
}

namespace report {

inline constexpr std::string_view style = R"(
body{margin:0;background:#f4f5f6;color:#22282d;font:16px/1.5 system-ui,"Segoe UI","DejaVu Sans",sans-serif}
main{max-width:1080px;margin:0 auto;padding:32px 24px 64px}
h1{font-size:30px;line-height:1.2;margin:0 0 12px}
h2{font-size:20px;margin:40px 0 12px;padding-bottom:6px;border-bottom:2px solid #d5dade}
p.lead{font-size:17px;max-width:75ch;margin:0}
table{border-collapse:collapse;width:100%;background:#fff;border:1px solid #dde1e5;font-size:15px}
th{text-align:left;background:#eaedf0;font-weight:600}
th,td{padding:6px 12px;border-bottom:1px solid #e8ebee;vertical-align:top}
td.key{font-family:ui-monospace,"DejaVu Sans Mono",monospace;font-size:13.5px;overflow-wrap:anywhere}
td.value{text-align:right;font-variant-numeric:tabular-nums;overflow-wrap:anywhere}
td.unit,td.origin{color:#5a646d;white-space:nowrap}
th.value{text-align:right}
figure{margin:0 0 24px;background:#fff;border:1px solid #dde1e5;padding:12px}
figure img{display:block;max-width:100%;height:auto;margin:0 auto}
figcaption{padding:10px 8px 2px;color:#434c54;font-size:15px}
.badge{display:inline-block;background:#fdebd3;color:#7c3f00;border:1px solid #e9b778;border-radius:3px;padding:0 7px;font-size:12.5px;font-weight:600;margin-right:8px}
ul{max-width:80ch;padding-left:22px}
footer{margin-top:40px;color:#5a646d;font-size:14px}
@media print{body{background:#fff}figure,tr{break-inside:avoid}}
)";

inline std::string cell(std::string_view kind, std::string_view text) {
    return "<td class=\"" + std::string{kind} + "\">" + html_text(text) + "</td>";
}

inline std::string table(const std::vector<ReportRow>& rows) {
    std::string html =
        "<table><thead><tr><th>Quantity</th><th "
        "class=\"value\">Value</th><th>Unit</th></tr></thead><tbody>\n";
    for (const ReportRow& row : rows)
        html +=
            "<tr>" + cell("key", row.name) + cell("value", row.value) + cell("unit", row.unit) + "</tr>\n";
    return html + "</tbody></table>\n";
}

inline std::string table(const ReportTable& t) {
    const std::string kind = t.numbers ? "value" : "text";
    std::string html = "<h2>" + html_text(t.title) + "</h2>\n<table><thead><tr>";
    for (const std::string& name : t.columns)
        html += (&name == &t.columns.front() ? "<th>" : "<th class=\"" + kind + "\">") + html_text(name) +
                "</th>";
    html += "</tr></thead><tbody>\n";
    for (const auto& row : t.rows) {
        html += "<tr>";
        for (const std::string& text : row) html += cell(&text == &row.front() ? "key" : kind, text);
        html += "</tr>\n";
    }
    return html + "</tbody></table>\n";
}

inline std::string parameter_table(const std::vector<Parameter>& parameters) {
    std::string html =
        "<table><thead><tr><th>Parameter</th><th "
        "class=\"value\">Value</th><th>Unit</th><th>From</th><th>What it is</th></tr>"
        "</thead><tbody>\n";
    for (const Parameter& p : parameters) {
        html += "<tr>" + cell("key", p.key) + cell("value", p.value) + cell("unit", p.unit) +
                cell("origin", p.origin) + "<td>" + html_text(p.help);
        if (!p.assumption.empty())
            html += (p.help.empty() ? "" : "<br>") + std::string{"<span class=\"badge\">assumption</span>"} +
                    html_text(p.assumption);
        html += "</td></tr>\n";
    }
    return html + "</tbody></table>\n";
}

inline std::string picture(const ReportFigure& figure) {
    std::ifstream file{figure.picture, std::ios::binary};
    const std::string bytes{std::istreambuf_iterator<char>{file}, {}};
    if (!file || bytes.empty())
        throw FileError("cannot read the picture '" + figure.picture.string() + "' for the report");
    return "<figure><img alt=\"" + html_text(figure.caption) + "\" src=\"data:image/png;base64," +
           base64(bytes) + "\"><figcaption>" + html_text(figure.caption) + "</figcaption></figure>\n";
}

}  // namespace report

/// The whole report as HTML. FileError where a picture cannot be read.
inline std::string to_html(const Report& r) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>" +
        html_text(r.title) + "</title><style>" + std::string{report::style} +
        "</style></head>\n<body><main>\n<h1>" + html_text(r.title) + "</h1>\n<p class=\"lead\">" +
        html_text(r.explanation) + "</p>\n";
    if (!r.notes.empty()) {
        html += "<h2>Notes</h2>\n<ul>\n";
        for (const std::string& note : r.notes) html += "<li>" + html_text(note) + "</li>\n";
        html += "</ul>\n";
    }
    if (!r.summary.empty()) html += "<h2>Summary</h2>\n" + report::table(r.summary);
    for (const ReportTable& one : r.tables) html += report::table(one);
    if (!r.figures.empty()) html += "<h2>Pictures</h2>\n";
    for (const ReportFigure& figure : r.figures) html += report::picture(figure);
    if (!r.parameters.empty()) html += "<h2>Parameters</h2>\n" + report::parameter_table(r.parameters);
    if (!r.versions.empty()) {
        html += "<footer>";
        for (const ReportRow& row : r.versions)
            html += (&row == &r.versions.front() ? "" : " &middot; ") + html_text(row.name) + " " +
                    html_text(row.value) + (row.unit.empty() ? "" : " " + html_text(row.unit));
        html += "</footer>\n";
    }
    return html + "</main></body></html>\n";
}

/// Writes the report to a file.
inline void write_report(const Report& r, const std::filesystem::path& path) {
    const std::string html = to_html(r);
    std::ofstream file{path, std::ios::binary};
    file << html;
    file.close();
    if (!file) throw FileError("cannot write '" + path.string() + "'");
}

}  // namespace abrade::examples
