#pragma once
// The planes that stand for the liquid's surface, and what cells they may be told from.

#include <abrade/core/fields.hpp>
#include <abrade/core/simd.hpp>
#include <abrade/fluid/mesh/grid.hpp>
#include <abrade/fluid/vof/plic.hpp>

#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace abrade {

/// What is known of a cell before anything flows.
namespace cell_mark {
inline constexpr std::uint8_t whole = 1;   ///< not cut: its fraction tells of a plane in the full cell
inline constexpr std::uint8_t open = 2;    ///< fluid may be in it
inline constexpr std::uint8_t inside = 4;  ///< no ghost
inline constexpr std::uint8_t ringed = 8;  ///< all cells around it are whole
/// All cells within 3 of it along an axis are whole, and those beside them.
constexpr std::uint8_t deep(int axis) noexcept { return static_cast<std::uint8_t>(16 << axis); }
}  // namespace cell_mark

/// Planes of the cells that are neither full nor dry, in order of the cells in memory.
template <int Dim>
struct SurfacePlanes {
    std::vector<Index> cell{};                    ///< offset in memory
    std::vector<Index> level{};                   ///< number along the vertical axis
    std::array<std::vector<Real>, Dim> normal{};  ///< in units of the cell, from liquid to air
    std::vector<Real> distance{};                 ///< of the plane that holds the cell's volume
    std::vector<Real> position{};                 ///< of the surface; another one in cells cut by walls
    std::vector<std::uint8_t> has_normal{};       ///< whether the normal stands already
    /// Whether, in a cell that a wall cuts, the position tells where the liquid is, not its fraction.
    std::vector<std::uint8_t> reconstructed{};

    static void fields(auto&& field) {
        field("cell", &SurfacePlanes::cell), field("level", &SurfacePlanes::level),
            field("normal", &SurfacePlanes::normal), field("distance", &SurfacePlanes::distance),
            field("position", &SurfacePlanes::position), field("has_normal", &SurfacePlanes::has_normal),
            field("reconstructed", &SurfacePlanes::reconstructed);
    }

    Index count() const noexcept { return static_cast<Index>(cell.size()); }
    void resize(std::size_t planes) {
        cell.resize(planes);
        level.resize(planes);
        for (auto& component : normal) component.resize(planes);
        distance.resize(planes);
        position.resize(planes);
        has_normal.resize(planes);
        reconstructed.resize(planes);
    }
    CellPlane<Dim> plane(Index i) const noexcept {
        const auto k = static_cast<std::size_t>(i);
        CellPlane<Dim> result{{}, distance[k]};
        for (std::size_t a = 0; a < Dim; ++a) result.normal[a] = normal[a][k];
        return result;
    }
};

namespace detail {

using PackCells = std::array<Index, pack_lanes>;

/// Values of the cells that stand `step` from those of a pack.
template <class Number>
Pack values_at(const Number* values, const PackCells& cells, Offset step = 0) noexcept {
    return [&]<std::size_t... L>(std::index_sequence<L...>) {
        return Pack(Pack::Native{static_cast<Real>(values[cells[L] + step])...});
    }
    (std::make_index_sequence<pack_lanes>{});
}

/// Which of a pack's cells are flagged: a byte each, 0 or 1.
inline PackMask flags_at(const std::uint8_t* flags) noexcept {
#if defined(ABRADE_AVX512)
    std::uint64_t bytes;
    std::memcpy(&bytes, flags, sizeof bytes);
    return {static_cast<NativeBits>(bytes * 0x0102040810204080u >> 56)};  // byte k to bit 56 + k
#else
    using Bytes [[gnu::vector_size(pack_lanes)]] = std::uint8_t;
    Bytes bytes;
    std::memcpy(&bytes, flags, sizeof bytes);
    return {__builtin_convertvector(bytes, NativeBits) != 0};
#endif
}

/// Four neighbours along a row, from the one `step` away: result[n] stands n cells further.
inline QuadColumns gather_row(const Real* values, const PackCells& cells, Offset step) noexcept {
    QuadRows rows;
    for (std::size_t lane = 0; lane < rows.size(); ++lane)
        std::memcpy(&rows[lane], values + cells[lane] + step, sizeof(Quad));
    return columns(rows);
}

/// The 3^Dim cells around one: steps in memory and along the axes; the cell itself is number `own`.
template <int Dim>
struct Stencil {
    static constexpr int size = Dim == 3 ? 27 : 9, own = size / 2;
    std::array<Offset, size> step{};

    Stencil() = default;
    explicit Stencil(const Layout<Dim>& layout) {
        for (int k = 0; k < size; ++k)
            for (int a = 0; a < Dim; ++a) step[static_cast<std::size_t>(k)] += along(a, k) * layout.stride[a];
    }
    /// -1, 0 or 1.
    static constexpr int along(int axis, int k) noexcept {
        constexpr std::array<int, 3> power{1, 3, 9};
        return k / power[static_cast<std::size_t>(axis)] % 3 - 1;
    }
};

}  // namespace detail
}  // namespace abrade
