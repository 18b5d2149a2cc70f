#pragma once
// A Cartesian box of cells: their sizes, their places in memory, and fields over them.

#include <abrade/core/require.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace abrade {

/// A point in 2 (x, z) or 3 (x, y, z) dimensions. The last axis is the vertical one by convention.
template <int Dim>
using Point = Eigen::Matrix<Real, Dim, 1>;

/// One value for each axis, or for each end of one. Unlike std::array it is indexed by signed integers, as
/// axes are counted, and its Dim can be deduced.
template <class Value, int Dim>
struct PerAxis {
    std::array<Value, Dim> values;

    constexpr Value& operator[](std::integral auto axis) noexcept {
        return values[static_cast<std::size_t>(axis)];
    }
    constexpr const Value& operator[](std::integral auto axis) const noexcept {
        return values[static_cast<std::size_t>(axis)];
    }
    constexpr Value* begin() noexcept { return values.data(); }
    constexpr Value* end() noexcept { return values.data() + Dim; }
    constexpr const Value* begin() const noexcept { return values.data(); }
    constexpr const Value* end() const noexcept { return values.data() + Dim; }
    static constexpr int size() noexcept { return Dim; }
    constexpr void fill(const Value& value) noexcept { values.fill(value); }
    bool operator==(const PerAxis&) const = default;
};

/// Numbers of a cell along the axes; the first cell inside the box is 0, ghosts are below and above.
template <int Dim>
using CellNumber = PerAxis<int, Dim>;

/// Distance between two cells in memory.
using Offset = std::ptrdiff_t;

/// Where cells stand in memory. Planes of constant x follow each other; within a plane rows (of constant z
/// in 3-D); within a row cells along the second axis, which is y in 3-D and z in 2-D. So a long channel is
/// cut into many thin planes, several of which stay in cache at once. Around the box stand two layers of
/// ghosts: limited second-order fluxes reach two cells upstream.
///
/// Cell 0 of a row stands at a multiple of `lanes`, and so many cells before it belong to no other row but
/// for the ghosts of that before: a loop may work on whole packs, beyond the end of its row.
template <int Dim>
struct Layout {
    static_assert(Dim == 2 || Dim == 3, "fluids are two- or three-dimensional");
    static constexpr int ghosts = 2;
    static constexpr int lanes = 16;
    static constexpr int outer = 0, inner = 1;  ///< axis across planes, axis along rows

    PerAxis<int, Dim> cells{};      ///< along each axis, without ghosts
    PerAxis<Offset, Dim> stride{};  ///< from a cell to the next one along each axis
    Offset first = 0;               ///< of cell 0 along all axes
    Offset total = 0;               ///< with ghosts and padding

    Layout() = default;
    explicit Layout(const PerAxis<int, Dim>& count) : cells(count) {
        stride[inner] = 1;
        const Offset row = (count[inner] + lanes - 1) / lanes * lanes + lanes;
        if constexpr (Dim == 3) {
            stride[2] = row;
            stride[outer] = row * (count[2] + 2 * ghosts);
        } else {
            stride[outer] = row;
        }
        first = lanes + ghosts * stride[outer] + (Dim == 3 ? ghosts * row : 0);
        total = stride[outer] * (count[outer] + 2 * ghosts) + lanes;
    }

    Offset at(const CellNumber<Dim>& cell) const noexcept {
        Offset offset = first;
        for (int a = 0; a < Dim; ++a) offset += cell[a] * stride[a];
        return offset;
    }

    /// Of the cell at an offset, ghosts included.
    CellNumber<Dim> number(Offset offset) const noexcept {
        CellNumber<Dim> cell{};
        // Ghosts above a row stand where the next one's padding begins. Short numbers are faster to divide.
        auto left = static_cast<std::uint32_t>(offset - lanes / 2);
        for (int k = 0; k < Dim; ++k) {
            const int a = k == 0 ? 0 : Dim - k;  // by decreasing stride
            const auto step = static_cast<std::uint32_t>(stride[a]);
            cell[a] = static_cast<int>(left / step) - (a == inner ? lanes / 2 : ghosts);
            left %= step;
        }
        return cell;
    }

    /// First cell of the pack of `lanes` that cell i of a row stands in.
    static constexpr int pack(int i) noexcept { return i & ~(lanes - 1); }

    int planes() const noexcept { return cells[outer]; }
    int rows_per_plane() const noexcept { return Dim == 3 ? cells[Dim - 1] : 1; }
    int row_length() const noexcept { return cells[inner]; }
    /// Offset of cell 0 of a row; plane and row may be those of ghosts.
    Offset row_start(int plane, int row) const noexcept {
        Offset offset = first + plane * stride[outer];
        if constexpr (Dim == 3) offset += row * stride[2];
        return offset;
    }
    Index cell_count() const noexcept {
        Index count = 1;
        for (const int n : cells) count *= n;
        return count;
    }
};

/// One number per cell of a layout, ghosts included, in memory that begins at a cache line.
template <class Number>
class Field {
public:
    Field() = default;
    explicit Field(Offset size, Number value = 0) : size_(size), data_(allocate(size)) { fill(value); }
    Field(const Field& other) : Field(other.size_) { *this = other; }
    Field(Field&& other) noexcept : size_(std::exchange(other.size_, 0)), data_(std::move(other.data_)) {}
    Field& operator=(const Field& other) {
        if (size_ != other.size_) *this = Field(other.size_);
        if (size_ > 0) std::memcpy(data_.get(), other.data_.get(), bytes());
        return *this;
    }
    Field& operator=(Field&& other) noexcept {
        size_ = std::exchange(other.size_, 0);
        data_ = std::move(other.data_);
        return *this;
    }

    void fill(Number value) noexcept { std::fill_n(data_.get(), size_, value); }
    Number* data() noexcept { return data_.get(); }
    const Number* data() const noexcept { return data_.get(); }
    Number& operator[](Offset i) noexcept { return data_.get()[i]; }
    Number operator[](Offset i) const noexcept { return data_.get()[i]; }
    Offset size() const noexcept { return size_; }

private:
    struct Free {
        void operator()(Number* p) const noexcept { ::operator delete (p, std::align_val_t{64}); }
    };
    static Number* allocate(Offset size) {
        return static_cast<Number*>(
            ::operator new (static_cast<std::size_t>(size) * sizeof(Number), std::align_val_t{64}));
    }
    std::size_t bytes() const noexcept { return static_cast<std::size_t>(size_) * sizeof(Number); }

    Offset size_ = 0;
    std::unique_ptr<Number[], Free> data_;
};

/// A vector per cell, component by component. On a staggered grid component a of a cell stands on the face
/// between it and its lower neighbour along axis a.
template <int Dim, class Number = Real>
using FaceField = PerAxis<Field<Number>, Dim>;

template <int Dim, class Number = Real>
FaceField<Dim, Number> face_field(const Layout<Dim>& layout, Number value = 0) {
    FaceField<Dim, Number> field;
    for (auto& component : field) component = Field<Number>(layout.total, value);
    return field;
}

/// A Cartesian grid, uniform along x and y, on request stretched along the vertical.
template <int Dim>
class Grid {
public:
    static constexpr int vertical = Dim - 1;

    struct Params {
        PerAxis<int, Dim> cells{};                     ///< along each axis
        Point<Dim> low = Point<Dim>::Zero();           ///< lower corner [m]
        Point<Dim> spacing = Point<Dim>::Constant(0);  ///< size of a cell along each axis [m]
        std::vector<Real> levels{};  ///< [cells + 1] heights of the faces [m]; none: uniform

        void validate() const {
            for (int a = 0; a < Dim; ++a) {
                const std::string name(1, axis_name(a));
                require(cells[a] >= 1 && cells[a] < 1 << 20,
                        {"Grid.cells." + name, "from 1 to 1048575", "", "give the number of cells along it"},
                        cells[a]);
                require_finite(low[a], "Grid.low." + name, "m");
                if (a == vertical && !levels.empty()) continue;
                require_positive(spacing[a], "Grid.spacing." + name, "m");
                require(std::abs(low[a]) <= 1e12 * spacing[a],
                        {"Grid.low." + name, "within 1e12 cells of 0", "m",
                         "numbers cannot tell such cells apart: put the origin near the box"},
                        low[a]);
            }
            const auto all = static_cast<Real>(Layout<Dim>(cells).total);  // cells are told by an Index
            require(
                all < 2e9,
                {"Grid.cells", "below 2e9 in all, ghosts and padding included", "", "take a larger spacing"},
                all);
            if (levels.empty()) return;
            require(static_cast<int>(levels.size()) == cells[vertical] + 1,
                    {"Grid.levels.size()", "the number of cells along z and one more", "",
                     "give the height of each face, floor and ceiling included"},
                    static_cast<Real>(levels.size()));
            for (std::size_t k = 0; k < levels.size(); ++k) {
                const std::string name = "Grid.levels[" + std::to_string(k) + "]";
                require_finite(levels[k], name, "m");
                require(k == 0 || levels[k] > levels[k - 1],
                        {name, "above the level before it (" + to_text(levels[k > 0 ? k - 1 : 0]) + " m)",
                         "m", "sort the levels upwards"},
                        levels[k]);
            }
        }
    };

    /// Throws InputError when cells, spacing or levels make no grid.
    explicit Grid(Params params) : params_((params.validate(), std::move(params))), layout_(params_.cells) {
        for (int a = 0; a < Dim; ++a) {
            const int n = params_.cells[a], g = Layout<Dim>::ghosts;
            std::vector<Real>& face = faces_[a];
            const bool stretched = a == vertical && !params_.levels.empty();
            for (int i = -g; i <= n + g; ++i)
                face.push_back(stretched ? level(i) : params_.low[a] + i * params_.spacing[a]);
            for (int i = 0; i < n + 2 * g; ++i) {
                const auto k = static_cast<std::size_t>(i);
                size_[a].push_back(stretched ? face[k + 1] - face[k] : params_.spacing[a]);
                centre_[a].push_back(0.5 * (face[k] + face[k + 1]));
            }
            gap_[a].push_back(size_[a][0]);
            for (std::size_t k = 1; k < size_[a].size(); ++k)
                gap_[a].push_back(stretched ? centre_[a][k] - centre_[a][k - 1] : params_.spacing[a]);
        }
    }

    const Params& params() const noexcept { return params_; }
    const Layout<Dim>& layout() const noexcept { return layout_; }
    int cells(int axis) const noexcept { return layout_.cells[axis]; }
    bool uniform() const noexcept { return params_.levels.empty(); }

    /// Of cell i along an axis, ghosts included [m].
    Real size(int axis, int i) const noexcept { return size_[axis][index(i)]; }
    Real centre(int axis, int i) const noexcept { return centre_[axis][index(i)]; }
    Real face(int axis, int i) const noexcept { return faces_[axis][index(i)]; }  ///< its lower face
    /// From the centre of cell i - 1 to that of cell i [m].
    Real gap(int axis, int i) const noexcept { return gap_[axis][index(i)]; }
    Real volume(const CellNumber<Dim>& cell) const noexcept {
        Real product = 1;
        for (int a = 0; a < Dim; ++a) product *= size(a, cell[a]);
        return product;
    }
    /// Whether a cell stands inside the box; ghosts do not.
    bool has(const CellNumber<Dim>& cell) const noexcept {
        for (int a = 0; a < Dim; ++a)
            if (cell[a] < 0 || cell[a] >= cells(a)) return false;
        return true;
    }
    Point<Dim> centre(const CellNumber<Dim>& cell) const noexcept {
        Point<Dim> x;
        for (int a = 0; a < Dim; ++a) x[a] = centre(a, cell[a]);
        return x;
    }
    /// Centre of the lower face along `axis`.
    Point<Dim> face_centre(int axis, const CellNumber<Dim>& cell) const noexcept {
        Point<Dim> x = centre(cell);
        x[axis] = face(axis, cell[axis]);
        return x;
    }
    /// Of all cells along an axis [m]; ghosts are as large as those beside them.
    Real smallest(int axis) const noexcept {
        return *std::min_element(size_[axis].begin(), size_[axis].end());
    }
    Real smallest() const noexcept {
        Real least = smallest(0);
        for (int a = 1; a < Dim; ++a) least = std::min(least, smallest(a));
        return least;
    }
    Real largest(int axis) const noexcept {
        return *std::max_element(size_[axis].begin(), size_[axis].end());
    }
    Real low(int axis) const noexcept { return face(axis, 0); }
    Real high(int axis) const noexcept { return face(axis, cells(axis)); }

    /// Calls body(cell, offset) for each cell, those of `beyond` layers of ghosts included.
    void for_each(auto&& body, int beyond = 0) const {
        CellNumber<Dim> cell;
        walk<0>(cell, beyond, body);
    }

    /// Calls body(cell, offset) for the cells beside a side of the box.
    void for_each_beside(int axis, bool high, auto&& body) const {
        CellNumber<Dim> cell;
        walk<0>(cell, axis, high, body);
    }

    static char axis_name(int axis) noexcept { return Dim == 3 ? "xyz"[axis] : "xz"[axis]; }

private:
    static std::size_t index(int i) noexcept { return static_cast<std::size_t>(i + Layout<Dim>::ghosts); }
    /// Ghost cells are as high as those at the end.
    Real level(int i) const noexcept {
        const std::vector<Real>& z = params_.levels;
        const int n = params_.cells[vertical];
        if (i < 0) return z[0] + i * (z[1] - z[0]);
        const auto last = static_cast<std::size_t>(n);
        if (i > n) return z[last] + (i - n) * (z[last] - z[last - 1]);
        return z[static_cast<std::size_t>(i)];
    }
    template <int Axis>
    void walk(CellNumber<Dim>& cell, int beyond, auto& body) const {
        if constexpr (Axis == Dim) {
            body(std::as_const(cell), layout_.at(cell));
        } else {
            for (int i = -beyond; i < cells(Axis) + beyond; ++i) {
                cell[Axis] = i;
                walk<Axis + 1>(cell, beyond, body);
            }
        }
    }

    template <int Axis>
    void walk(CellNumber<Dim>& cell, int axis, bool high, auto& body) const {
        if constexpr (Axis == Dim) {
            body(std::as_const(cell), layout_.at(cell));
        } else {
            const int first = Axis == axis && high ? cells(Axis) - 1 : 0;
            const int end = Axis == axis ? first + 1 : cells(Axis);
            for (int i = first; i < end; ++i) {
                cell[Axis] = i;
                walk<Axis + 1>(cell, axis, high, body);
            }
        }
    }

    Params params_;
    Layout<Dim> layout_;
    PerAxis<std::vector<Real>, Dim> faces_, size_, centre_, gap_;
};

/// "x = 0.1 m, z = 0.2 m", for errors.
template <int Dim>
std::string place_text(const Point<Dim>& x) {
    std::string text;
    for (int a = 0; a < Dim; ++a)
        text += std::string(a > 0 ? ", " : "") + Grid<Dim>::axis_name(a) + " = " + short_text(x[a]) + " m";
    return text;
}

}  // namespace abrade
