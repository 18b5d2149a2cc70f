#pragma once
// Surfaces from STL files, binary or ASCII, and into binary ones.

#include <abrade/core/require.hpp>
#include <abrade/geometry/surface_mesh.hpp>
#include <abrade/io/file_error.hpp>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace abrade {

/// How to read an STL file.
struct StlOptions {
    Real unit = 1;            ///< length of the file's unit [m]: 1e-3 when it is in millimetres
    Real merge_distance = 0;  ///< vertices within this of one another are one [m]; 0: equal ones only

    void validate() const {
        require_positive(unit, "StlOptions.unit", "m", "1e-3 for a file in millimetres");
        require_not_negative(merge_distance, "StlOptions.merge_distance", "m",
                             "0 merges equal vertices only");
    }
};

namespace detail {

using LooseTriangles = std::vector<std::array<Vec3, 3>>;

/// A binary STL file: 80 bytes of anything, the number n of triangles, then 50 bytes for each: its normal,
/// which is not used, three vertices, and two bytes that have no meaning. Numbers are little-endian.
class BinaryStl {
public:
    static constexpr std::size_t head = 84, record = 50;

    static std::uint64_t length(std::string_view bytes) {
        return head + std::uint64_t{record} * unsigned_at(bytes, 80);
    }
    static LooseTriangles triangles(std::string_view bytes) {
        LooseTriangles result(unsigned_at(bytes, 80));
        for (std::size_t t = 0; t < result.size(); ++t)
            for (std::size_t v = 0; v < 3; ++v)
                for (std::size_t axis = 0; axis < 3; ++axis)
                    result[t][v][static_cast<Eigen::Index>(axis)] =
                        std::bit_cast<float>(unsigned_at(bytes, head + t * record + 12 + 12 * v + 4 * axis));
        return result;
    }

private:
    static std::uint32_t unsigned_at(std::string_view bytes, std::size_t at) {
        std::uint32_t value = 0;
        for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
        return value;
    }
};

/// The words of an ASCII STL file, without regard to case, lines or spaces between them.
class AsciiStl {
public:
    AsciiStl(std::string_view text, std::string_view name) : rest_{text}, name_{name} {}

    LooseTriangles triangles() {
        LooseTriangles result;
        do {
            expect("solid");
            skip_line();  // a name of any words
            for (std::string_view word = next(); word != "endsolid"; word = next()) {
                if (!same(word, "facet")) wrong("'facet' or 'endsolid'", word);
                expect("normal");
                for (int axis = 0; axis < 3; ++axis) next();  // not used: "nan" is common
                expect("outer");
                expect("loop");
                std::array<Vec3, 3> triangle;
                for (Vec3& vertex : triangle) {
                    expect("vertex");
                    for (Eigen::Index axis = 0; axis < 3; ++axis) vertex[axis] = number();
                }
                expect("endloop");
                expect("endfacet");
                result.push_back(triangle);
            }
            skip_line();
        } while (more());
        return result;
    }

private:
    [[noreturn]] void wrong(std::string_view wanted, std::string_view found) const {
        throw FileError("cannot read '" + std::string{name_} + "' as ASCII STL: line " +
                        std::to_string(line_) + " should have " + std::string{wanted} + ", has " +
                        (found.empty() ? "ended" : "'" + std::string{found.substr(0, 40)} + "'"));
    }
    static constexpr std::string_view spaces_ = " \t\r\n\v\f";
    static bool same(std::string_view word, std::string_view keyword) {
        if (word.size() != keyword.size()) return false;
        for (std::size_t n = 0; n < word.size(); ++n)
            if ((word[n] | 0x20) != keyword[n]) return false;
        return true;
    }
    bool more() {
        while (!rest_.empty() && spaces_.find(rest_.front()) != spaces_.npos) {
            line_ += rest_.front() == '\n';
            rest_.remove_prefix(1);
        }
        return !rest_.empty();
    }
    std::string_view next() {
        if (!more()) wrong("more", "");
        const std::string_view word = rest_.substr(0, rest_.find_first_of(spaces_));
        rest_.remove_prefix(word.size());
        return same(word, "endsolid") ? "endsolid" : word;
    }
    void expect(std::string_view keyword) {
        const std::string_view word = more() ? next() : "";
        if (!same(word, keyword)) wrong("'" + std::string{keyword} + "'", word);
    }
    Real number() {
        const std::string_view word = more() ? next() : "";
        Real value = 0;
        const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc{} || end != digits.data() + digits.size()) wrong("a number", word);
        return value;
    }
    void skip_line() {
        const std::size_t end = rest_.find('\n');
        rest_.remove_prefix(end == rest_.npos ? rest_.size() : end);
    }

    std::string_view rest_, name_;
    int line_ = 1;
};

/// A binary file has exactly the length that its number of triangles asks for; its head may well begin with
/// "solid", as an ASCII file does. Whatever has no zero bytes and begins with "solid" is ASCII.
inline LooseTriangles parse_stl(std::string_view bytes, std::string_view name) {
    const bool has_head = bytes.size() >= BinaryStl::head;
    if (has_head && BinaryStl::length(bytes) == bytes.size()) return BinaryStl::triangles(bytes);
    const std::size_t word = bytes.find_first_not_of(" \t\r\n");
    const bool solid = word != bytes.npos && bytes.size() >= word + 5 && (bytes[word] | 0x20) == 's' &&
                       (bytes[word + 4] | 0x20) == 'd';
    if (solid && bytes.find('\0') == bytes.npos) return AsciiStl(bytes, name).triangles();
    const std::string why =
        bytes.empty() ? "it is empty"
        : !has_head   ? "it has " + std::to_string(bytes.size()) + " bytes, and a binary one has at least 84"
                      : "its number of triangles asks for " + std::to_string(BinaryStl::length(bytes)) +
                          " bytes, it has " + std::to_string(bytes.size());
    throw FileError("cannot read '" + std::string{name} + "' as STL: " + why +
                    "; is it cut off, or of another format?");
}

}  // namespace detail

/// Reads a binary or ASCII STL file. All of the file is read and checked before there is a mesh.
/// Throws FileError when the file cannot be read, is cut off or is no STL file, and InputError when its
/// triangles are not the surface of a solid, as the constructor of SurfaceMesh does.
inline SurfaceMesh read_stl(const std::filesystem::path& path, const StlOptions& options = {}) {
    options.validate();
    std::ifstream file(path, std::ios::binary);
    if (std::filesystem::is_directory(path) || !file)
        throw FileError("cannot read '" + path.string() + "': is it there, and a file?");
    const std::string bytes{std::istreambuf_iterator<char>{file}, {}};
    if (file.bad()) throw FileError("cannot read '" + path.string() + "' to its end");
    detail::LooseTriangles triangles = detail::parse_stl(bytes, path.string());
    for (auto& triangle : triangles)
        for (Vec3& vertex : triangle) vertex *= options.unit;
    try {
        return mesh_of_triangles(triangles, options.merge_distance);
    } catch (const InputError& error) {
        throw InputError("'" + path.string() + "': " + error.what());
    }
}

/// Writes a binary STL file, with vertices as 32-bit numbers in metres.
/// Throws FileError when it cannot be written to its end.
inline void write_stl(const SurfaceMesh& mesh, const std::filesystem::path& path) {
    std::string bytes(80, ' ');
    const auto put = [&](std::uint32_t value, int count) {
        for (int k = 0; k < count; ++k) bytes += static_cast<char>(value >> 8 * k & 0xff);
    };
    const auto put_vector = [&](const Vec3& v) {
        for (Eigen::Index axis = 0; axis < 3; ++axis)
            put(std::bit_cast<std::uint32_t>(static_cast<float>(v[axis])), 4);
    };
    put(static_cast<std::uint32_t>(mesh.triangles().size()), 4);
    for (std::size_t t = 0; t < mesh.triangles().size(); ++t) {
        put_vector(mesh.normal(t));
        for (std::size_t k = 0; k < 3; ++k) put_vector(mesh.corner(t, k));
        put(0, 2);
    }
    std::ofstream file(path, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) throw FileError("cannot write '" + path.string() + "': is the disk full or the folder gone?");
}

}  // namespace abrade
