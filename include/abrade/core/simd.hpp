#pragma once
// A pack of numbers that one instruction works on, and the way of records into packs and back.
//
// Compiler vectors (g++ and clang++) behind one small type: as fast as intrinsics here, one source for every
// instruction set. Eight lanes with AVX-512, four with AVX2, two otherwise.

#include <abrade/core/pack.hpp>

#include <array>
#include <cstring>
#include <string_view>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace abrade {

#if defined(__AVX512F__) && defined(__AVX512DQ__)
#define ABRADE_AVX512
inline constexpr int pack_lanes = 8;
inline constexpr std::string_view instruction_set = "AVX-512";
#elif defined(__AVX2__) && defined(__FMA__)
#define ABRADE_AVX2
inline constexpr int pack_lanes = 4;
inline constexpr std::string_view instruction_set = "AVX2";
#else
inline constexpr int pack_lanes = 2;
inline constexpr std::string_view instruction_set = "baseline";
#endif

namespace detail {
using NativeReals [[gnu::vector_size(sizeof(Real) * pack_lanes)]] = Real;
#if defined(ABRADE_AVX512)
using NativeBits = __mmask8;  // this machine compares into registers of bits
#else
using NativeBits [[gnu::vector_size(sizeof(Real) * pack_lanes)]] = long long;
#endif
}  // namespace detail

/// Yes or no in each lane.
struct PackMask {
    detail::NativeBits bits;

#if defined(ABRADE_AVX512)
    friend PackMask operator&(PackMask a, PackMask b) noexcept { return {_kand_mask8(a.bits, b.bits)}; }
    friend PackMask operator|(PackMask a, PackMask b) noexcept { return {_kor_mask8(a.bits, b.bits)}; }
    friend PackMask operator!(PackMask a) noexcept { return {_knot_mask8(a.bits)}; }
    bool operator[](int lane) const noexcept { return (bits >> lane & 1) != 0; }
    void set(int lane) noexcept { bits = static_cast<__mmask8>(bits | 1 << lane); }
#else
    friend PackMask operator&(PackMask a, PackMask b) noexcept { return {a.bits & b.bits}; }
    friend PackMask operator|(PackMask a, PackMask b) noexcept { return {a.bits | b.bits}; }
    friend PackMask operator!(PackMask a) noexcept { return {~a.bits}; }
    bool operator[](int lane) const noexcept { return bits[lane] != 0; }
    void set(int lane) noexcept { bits[lane] = -1; }
#endif
};

/// `pack_lanes` numbers that are worked on together. Behaves like a number.
struct Pack {
    using Native = detail::NativeReals;
    Native lanes;

    Pack() = default;  // uninitialised, as Real is
    Pack(Real same) noexcept : lanes(same - Native{}) {}
    Pack(Native values) noexcept : lanes(values) {}

    Real operator[](int lane) const noexcept { return lanes[lane]; }
    void set(int lane, Real value) noexcept { lanes[lane] = value; }
    static Pack load(const Real* aligned) noexcept { return *reinterpret_cast<const Native*>(aligned); }
    static Pack load_from_anywhere(const Real* values) noexcept {
        Pack pack;
        std::memcpy(&pack.lanes, values, sizeof(Native));
        return pack;
    }
    void store(Real* aligned) const noexcept { *reinterpret_cast<Native*>(aligned) = lanes; }

    friend Pack operator+(Pack a, Pack b) noexcept { return a.lanes + b.lanes; }
    friend Pack operator-(Pack a, Pack b) noexcept { return a.lanes - b.lanes; }
    friend Pack operator*(Pack a, Pack b) noexcept { return a.lanes * b.lanes; }
    friend Pack operator/(Pack a, Pack b) noexcept { return a.lanes / b.lanes; }
    friend Pack operator-(Pack a) noexcept { return -a.lanes; }
    Pack& operator+=(Pack b) noexcept { return lanes += b.lanes, *this; }
    Pack& operator-=(Pack b) noexcept { return lanes -= b.lanes, *this; }
    Pack& operator*=(Pack b) noexcept { return lanes *= b.lanes, *this; }
    Pack& operator/=(Pack b) noexcept { return lanes /= b.lanes, *this; }
#if defined(ABRADE_AVX512)
    friend PackMask operator<(Pack a, Pack b) noexcept {
        return {_mm512_cmp_pd_mask(a.lanes, b.lanes, _CMP_LT_OQ)};
    }
    friend PackMask operator<=(Pack a, Pack b) noexcept {
        return {_mm512_cmp_pd_mask(a.lanes, b.lanes, _CMP_LE_OQ)};
    }
    friend PackMask operator==(Pack a, Pack b) noexcept {
        return {_mm512_cmp_pd_mask(a.lanes, b.lanes, _CMP_EQ_OQ)};
    }
    friend PackMask operator!=(Pack a, Pack b) noexcept {
        return {_mm512_cmp_pd_mask(a.lanes, b.lanes, _CMP_NEQ_UQ)};
    }
#else
    friend PackMask operator<(Pack a, Pack b) noexcept { return {a.lanes < b.lanes}; }
    friend PackMask operator<=(Pack a, Pack b) noexcept { return {a.lanes <= b.lanes}; }
    friend PackMask operator==(Pack a, Pack b) noexcept { return {a.lanes == b.lanes}; }
    friend PackMask operator!=(Pack a, Pack b) noexcept { return {a.lanes != b.lanes}; }
#endif
    friend PackMask operator>(Pack a, Pack b) noexcept { return b < a; }
    friend PackMask operator>=(Pack a, Pack b) noexcept { return b <= a; }
};

template <>
inline constexpr Real tiny<Pack> = tiny<Real>;

inline Pack select(PackMask condition, Pack yes, Pack no) noexcept {
#if defined(ABRADE_AVX512)
    return Pack::Native(_mm512_mask_blend_pd(condition.bits, no.lanes, yes.lanes));
#else
    return condition.bits ? yes.lanes : no.lanes;
#endif
}
#if defined(ABRADE_AVX512)
namespace detail {
/// The masked forms of intrinsics: the others make g++ 12 warn, in the user's build, of values never set.
inline constexpr __mmask8 all_lanes = 0xff;
}  // namespace detail
#endif

// As std::max and std::min: the first where neither is larger, and where one is not a number. The
// instructions return their second operand then.
inline Pack max(Pack a, Pack b) noexcept {
#if defined(ABRADE_AVX512)
    return Pack::Native(_mm512_maskz_max_pd(detail::all_lanes, b.lanes, a.lanes));
#elif defined(ABRADE_AVX2)
    return Pack::Native(_mm256_max_pd(b.lanes, a.lanes));
#else
    return a.lanes < b.lanes ? b.lanes : a.lanes;
#endif
}
inline Pack min(Pack a, Pack b) noexcept {
#if defined(ABRADE_AVX512)
    return Pack::Native(_mm512_maskz_min_pd(detail::all_lanes, b.lanes, a.lanes));
#elif defined(ABRADE_AVX2)
    return Pack::Native(_mm256_min_pd(b.lanes, a.lanes));
#else
    return b.lanes < a.lanes ? b.lanes : a.lanes;
#endif
}

inline bool any(PackMask mask) noexcept {
#if defined(ABRADE_AVX512)
    return mask.bits != 0;
#elif defined(ABRADE_AVX2)
    return _mm256_movemask_pd(reinterpret_cast<__m256d>(mask.bits)) != 0;
#elif defined(__SSE2__)
    return _mm_movemask_pd(reinterpret_cast<__m128d>(mask.bits)) != 0;
#else
    return (mask.bits[0] | mask.bits[1]) != 0;
#endif
}

/// Bit k is set where lane k holds.
inline unsigned lanes_of(PackMask mask) noexcept {
#if defined(ABRADE_AVX512)
    return mask.bits;
#elif defined(ABRADE_AVX2)
    return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(mask.bits)));
#else
    unsigned lanes = 0;
    for (int lane = 0; lane < pack_lanes; ++lane) lanes |= static_cast<unsigned>(mask[lane]) << lane;
    return lanes;
#endif
}

inline Pack sqrt(Pack x) noexcept {
#if defined(ABRADE_AVX512)
    return Pack::Native(_mm512_maskz_sqrt_pd(detail::all_lanes, x.lanes));
#elif defined(ABRADE_AVX2)
    return Pack::Native(_mm256_sqrt_pd(x.lanes));
#elif defined(__SSE2__)
    return Pack::Native(_mm_sqrt_pd(x.lanes));
#else
    return Pack::Native{std::sqrt(x.lanes[0]), std::sqrt(x.lanes[1])};
#endif
}

/// 1 / sqrt(x) to within 2 units in the last place, for normal x > 0: an estimate of 14 bits and one
/// step of fourth order where the machine has one.
inline Pack rsqrt(Pack x) noexcept {
#if defined(ABRADE_AVX512)
    const Pack y = Pack::Native(_mm512_maskz_rsqrt14_pd(detail::all_lanes, x.lanes));
    const Pack h = Pack(1) - x * y * y;
    return y + (y * h) * (Pack(0.5) + h * (Pack(0.375) + Pack(0.3125) * h));
#else
    return Pack(1) / sqrt(x);
#endif
}

/// 1 / x, likewise.
inline Pack reciprocal(Pack x) noexcept {
#if defined(ABRADE_AVX512)
    Pack y = Pack::Native(_mm512_maskz_rcp14_pd(detail::all_lanes, x.lanes));
    y *= Pack(2) - x * y;
    y *= Pack(2) - x * y;
    return y;
#else
    return Pack(1) / x;
#endif
}

inline Pack rough_reciprocal(Pack x) noexcept {
#if defined(ABRADE_AVX512)
    return Pack::Native(_mm512_maskz_rcp14_pd(detail::all_lanes, x.lanes));
#else
    return Pack(1) / x;
#endif
}

/// Over all lanes, in a fixed order.
inline Real sum(Pack x) noexcept {
    Real total = 0;
    for (int lane = 0; lane < pack_lanes; ++lane) total += x[lane];
    return total;
}
inline Real largest(Pack x) noexcept {
    Real most = x[0];
    for (int lane = 1; lane < pack_lanes; ++lane) most = std::max(most, x[lane]);
    return most;
}

/// Four numbers side by side in memory: a record, or a part of one.
struct [[gnu::may_alias]] alignas(4 * sizeof(Real)) Quad {  // lines are read as their members, too
    using Native [[gnu::vector_size(4 * sizeof(Real))]] = Real;
    Native value;

    friend Quad operator+(const Quad& a, const Quad& b) noexcept { return {a.value + b.value}; }
    friend Quad operator-(const Quad& a, const Quad& b) noexcept { return {a.value - b.value}; }
    friend Quad operator*(const Quad& a, const Quad& b) noexcept { return {a.value * b.value}; }
    friend Quad least(const Quad& a, const Quad& b) noexcept {
        return {b.value < a.value ? b.value : a.value};
    }
    friend Quad most(const Quad& a, const Quad& b) noexcept {
        return {a.value < b.value ? b.value : a.value};
    }
};

inline Quad with_fourth(const Quad& q, Real fourth) noexcept {
    return {Quad::Native{q.value[0], q.value[1], q.value[2], fourth}};
}
/// a x b of the first three numbers; the fourth means nothing.
inline Quad cross(const Quad& a, const Quad& b) noexcept {
    const auto yzx = [](const Quad& q) {
        return Quad{__builtin_shufflevector(q.value, q.value, 1, 2, 0, 3)};
    };
    return yzx(a * yzx(b) - yzx(a) * b);
}

/// One quad of each lane, and its four components as packs.
using QuadRows = std::array<Quad, pack_lanes>;
using QuadColumns = std::array<Pack, 4>;

/// From rows to columns: column[c][lane] = row[lane][c].
inline QuadColumns columns(const QuadRows& row) noexcept {
    using N = Pack::Native;
    const auto value = [&](std::size_t i) -> const Quad::Native& { return row[i].value; };
#if defined(ABRADE_AVX512)
    const auto both = [&](std::size_t i) {  // lanes i and i + 4 side by side
        return N(
            _mm512_maskz_insertf64x4(detail::all_lanes, _mm512_castpd256_pd512(value(i)), value(i + 4), 1));
    };
    const N a = both(0), b = both(1), c = both(2), d = both(3);
    const N ab_even = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    const N ab_odd = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const N cd_even = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
    const N cd_odd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    return {N(__builtin_shufflevector(ab_even, cd_even, 0, 1, 8, 9, 4, 5, 12, 13)),
            N(__builtin_shufflevector(ab_odd, cd_odd, 0, 1, 8, 9, 4, 5, 12, 13)),
            N(__builtin_shufflevector(ab_even, cd_even, 2, 3, 10, 11, 6, 7, 14, 15)),
            N(__builtin_shufflevector(ab_odd, cd_odd, 2, 3, 10, 11, 6, 7, 14, 15))};
#elif defined(ABRADE_AVX2)
    const N ab_even = __builtin_shufflevector(value(0), value(1), 0, 4, 2, 6);
    const N ab_odd = __builtin_shufflevector(value(0), value(1), 1, 5, 3, 7);
    const N cd_even = __builtin_shufflevector(value(2), value(3), 0, 4, 2, 6);
    const N cd_odd = __builtin_shufflevector(value(2), value(3), 1, 5, 3, 7);
    return {N(__builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5)),
            N(__builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5)),
            N(__builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7)),
            N(__builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7))};
#else
    QuadColumns column;
    for (std::size_t c = 0; c < 4; ++c) column[c] = N{value(0)[c], value(1)[c]};
    return column;
#endif
}

/// And back: row[lane][c] = column[c][lane].
inline QuadRows rows(const QuadColumns& column) noexcept {
    QuadRows row;
#if defined(ABRADE_AVX512)
    using N = Pack::Native;
    const N &a = column[0].lanes, &b = column[1].lanes, &c = column[2].lanes, &d = column[3].lanes;
    const N ab_even = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    const N ab_odd = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const N cd_even = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
    const N cd_odd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    const std::array<N, 4> both{N(__builtin_shufflevector(ab_even, cd_even, 0, 1, 8, 9, 4, 5, 12, 13)),
                                N(__builtin_shufflevector(ab_odd, cd_odd, 0, 1, 8, 9, 4, 5, 12, 13)),
                                N(__builtin_shufflevector(ab_even, cd_even, 2, 3, 10, 11, 6, 7, 14, 15)),
                                N(__builtin_shufflevector(ab_odd, cd_odd, 2, 3, 10, 11, 6, 7, 14, 15))};
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 4; ++i) {
        row[i].value = __builtin_shufflevector(both[i], both[i], 0, 1, 2, 3);
        row[i + 4].value = __builtin_shufflevector(both[i], both[i], 4, 5, 6, 7);
    }
#elif defined(ABRADE_AVX2)
    QuadRows as_rows;
    for (std::size_t i = 0; i < 4; ++i) as_rows[i].value = column[i].lanes;
    const QuadColumns turned = columns(as_rows);
    for (std::size_t i = 0; i < 4; ++i) row[i].value = turned[i].lanes;
#else
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t c = 0; c < 4; ++c) row[i].value[c] = column[c].lanes[i];
#endif
    return row;
}

}  // namespace abrade

/// A vector of packs: three packs by name, where an array of them would be kept in memory.
template <>
class Eigen::Matrix<abrade::Pack, 3, 1, 0, 3, 1> {
public:
    using Pack = abrade::Pack;
    using Scalar = Pack;
    Matrix() = default;
    Matrix(Pack x, Pack y, Pack z) noexcept : x_(x), y_(y), z_(z) {}
    static Matrix Constant(Pack same) noexcept { return {same, same, same}; }
    static Matrix Zero() noexcept { return Constant(Pack(0)); }

    Pack x() const noexcept { return x_; }
    Pack y() const noexcept { return y_; }
    Pack z() const noexcept { return z_; }
    Pack& operator[](int axis) noexcept { return axis == 0 ? x_ : axis == 1 ? y_ : z_; }
    const Pack& operator[](int axis) const noexcept { return axis == 0 ? x_ : axis == 1 ? y_ : z_; }

    Pack dot(const Matrix& o) const noexcept { return x_ * o.x_ + y_ * o.y_ + z_ * o.z_; }
    Matrix cross(const Matrix& o) const noexcept {
        return {y_ * o.z_ - z_ * o.y_, z_ * o.x_ - x_ * o.z_, x_ * o.y_ - y_ * o.x_};
    }
    friend Matrix operator+(const Matrix& a, const Matrix& b) noexcept {
        return {a.x_ + b.x_, a.y_ + b.y_, a.z_ + b.z_};
    }
    friend Matrix operator-(const Matrix& a, const Matrix& b) noexcept {
        return {a.x_ - b.x_, a.y_ - b.y_, a.z_ - b.z_};
    }
    friend Matrix operator-(const Matrix& a) noexcept { return {-a.x_, -a.y_, -a.z_}; }
    friend Matrix operator*(Pack s, const Matrix& a) noexcept { return {s * a.x_, s * a.y_, s * a.z_}; }
    Matrix& operator+=(const Matrix& o) noexcept { return *this = *this + o; }
    Matrix& operator-=(const Matrix& o) noexcept { return *this = *this - o; }

private:
    Pack x_, y_, z_;
};
