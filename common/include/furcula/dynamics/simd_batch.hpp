// SIMD batches: N numbers that are added, multiplied and compared at once, one robot (or one leg) in each lane.
//
// Each lane has the bits that the same operations on plain numbers have: each operation is rounded as IEEE 754 says, nothing is
// contracted (-ffp-contract=off; GCC 12 also needs -mno-fma where it may use FMA, with AVX-512 -fno-tree-slp-vectorize, too, since it makes vfmaddsub of plain numbers in spite
// of the former), and the lanes are independent. These are GCC's vector extensions, which clang has too; the compiler splits a
// vector that is wider than the processor's registers. The functions of the second half exist for plain numbers and for dual numbers
// as well, so that an algorithm without branches is written once: a condition is a mask, and `select` chooses by it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "furcula/dynamics/scalar.hpp"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#if defined(__GNUC__) && !defined(__clang__)
// It warns of arguments that are wider than the processor's registers; here every function is inlined.
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

#define FURCULA_INLINE [[gnu::always_inline]] inline

namespace furcula::dynamics {

/// The signed integer of so many bytes: 8 or 4.
template <std::size_t kBytes>
using SignedOf = std::conditional_t<kBytes == 8, std::int64_t, std::int32_t>;

/// A condition in each lane: all bits of the lane are set, or none.
template <class V, int N>
struct LaneMask {
  /// Vector of N integers of the size of V.
  using Bits [[gnu::vector_size(N * sizeof(V))]] = SignedOf<sizeof(V)>;
  Bits bits;  ///< of a lane: -1 true, 0 false

  /// Whether the condition holds in a lane.
  bool operator[](std::size_t lane) const { return bits[lane] != 0; }
};

/// A SIMD batch of N numbers, N > 1; V is float or double. Operators + - * / += -= *= /= < > act on each lane, with another batch or a number.
template <class V, int N>
struct SimdBatch {
  static_assert(N > 1 && std::is_floating_point_v<V>);
  /// The compiler's vector of N numbers.
  using Vector [[gnu::vector_size(N * sizeof(V))]] = V;
  /// Vector of N integers of the size of V.
  using Bits = typename LaneMask<V, N>::Bits;
  static constexpr std::size_t kLanes = N;  ///< numbers in the batch
  Vector v;                                 ///< one number in each lane

  SimdBatch() = default;  ///< its numbers are not initialised
  /// The same number in each lane; converts from a plain number so that one can stand in any expression.
  FURCULA_INLINE SimdBatch(V x)
      : v(x - Vector{}) {}  // NOLINT(google-explicit-constructor): as a number anywhere
  /// The batch with the numbers of a vector.
  FURCULA_INLINE static SimdBatch of(const Vector& x) {
    SimdBatch out;
    out.v = x;
    return out;
  }
  /// The number in a lane, 0 to N - 1.
  FURCULA_INLINE V operator[](std::size_t lane) const { return v[lane]; }
  /// Sets the number in a lane, 0 to N - 1.
  FURCULA_INLINE void set(std::size_t lane, V x) { v[lane] = x; }
};

/// The value type of a batch is that of its lanes; a batch has no single plain value.
template <class V, int N>
struct ScalarTraits<SimdBatch<V, N>> {
  /// The number type of a lane.
  using Value = V;
};

/// \cond told at SimdBatch
#define FURCULA_LANES_OPERATOR(op)                                                                  \
  template <class V, int N>                                                                         \
  FURCULA_INLINE SimdBatch<V, N> operator op(const SimdBatch<V, N>& a, const SimdBatch<V, N>& b) {  \
    return SimdBatch<V, N>::of(a.v op b.v);                                                         \
  }                                                                                                 \
  template <class V, int N>                                                                         \
  FURCULA_INLINE SimdBatch<V, N> operator op(const SimdBatch<V, N>& a, std::type_identity_t<V> b) { \
    return SimdBatch<V, N>::of(a.v op SimdBatch<V, N>(b).v);                                        \
  }                                                                                                 \
  template <class V, int N>                                                                         \
  FURCULA_INLINE SimdBatch<V, N> operator op(std::type_identity_t<V> a, const SimdBatch<V, N>& b) { \
    return SimdBatch<V, N>::of(SimdBatch<V, N>(a).v op b.v);                                        \
  }                                                                                                 \
  template <class V, int N, class B>                                                                \
  FURCULA_INLINE SimdBatch<V, N>& operator op##=(SimdBatch<V, N>& a, const B& b) {                  \
    return a = a op b;                                                                              \
  }
FURCULA_LANES_OPERATOR(+)
FURCULA_LANES_OPERATOR(-)
FURCULA_LANES_OPERATOR(*)
FURCULA_LANES_OPERATOR(/)
#undef FURCULA_LANES_OPERATOR
/// \endcond

/// The negative of each lane.
template <class V, int N>
FURCULA_INLINE SimdBatch<V, N> operator-(const SimdBatch<V, N>& a) {
  return SimdBatch<V, N>::of(-a.v);
}

/// \cond told at SimdBatch
#define FURCULA_LANES_COMPARE(op)                                                                  \
  template <class V, int N>                                                                        \
  FURCULA_INLINE LaneMask<V, N> operator op(const SimdBatch<V, N>& a, const SimdBatch<V, N>& b) {  \
    return {a.v op b.v};                                                                           \
  }                                                                                                \
  template <class V, int N>                                                                        \
  FURCULA_INLINE LaneMask<V, N> operator op(const SimdBatch<V, N>& a, std::type_identity_t<V> b) { \
    return {a.v op SimdBatch<V, N>(b).v};                                                          \
  }
FURCULA_LANES_COMPARE(<)
FURCULA_LANES_COMPARE(>)
#undef FURCULA_LANES_COMPARE
/// \endcond

/// In each lane `yes` where the condition holds, else `no`.
template <class V, int N>
FURCULA_INLINE SimdBatch<V, N> select(const LaneMask<V, N>& which, const SimdBatch<V, N>& yes,
                                      const SimdBatch<V, N>& no) {
  return SimdBatch<V, N>::of(which.bits ? yes.v : no.v);
}
/// Whether the condition holds in any lane.
template <class V, int N>
FURCULA_INLINE bool any(const LaneMask<V, N>& which) {
  bool out = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(N); ++i) out = out || which[i];
  return out;
}
/// The same for a plain or dual number.
template <class T>
FURCULA_INLINE T select(bool which, const T& yes, const T& no) {
  return which ? yes : no;
}
/// The same for the condition of a plain or dual number.
FURCULA_INLINE bool any(bool which) { return which; }

/// Number of lanes of a scalar type; 1 for plain and dual numbers.
template <class T>
constexpr std::size_t lanes_in() {
  if constexpr (requires { T::kLanes; })
    return T::kLanes;
  else
    return 1;
}
/// The number in a lane of a batch; `x` itself where it is plain.
template <class T>
FURCULA_INLINE ValueOf<T> lane_of(const T& x, std::size_t lane) {
  if constexpr (requires { T::kLanes; })
    return x[lane];
  else
    return x;
}
/// Sets the number in a lane of a batch, or `x` itself where it is not a batch.
template <class T>
FURCULA_INLINE void set_lane(T& x, std::size_t lane, ValueOf<T> value) {
  if constexpr (requires { T::kLanes; })
    x.set(lane, value);
  else
    x = value;
}

/// Type of a comparison of two scalars: bool, or a mask.
template <class T>
using MaskOf = decltype(std::declval<T>() < std::declval<T>());

/// True in each lane.
template <class T>
FURCULA_INLINE MaskOf<T> all_of() {
  return T(ValueOf<T>(0)) < T(ValueOf<T>(1));
}

/// The smaller of two; `b` where one is not a number, as processors do.
template <class T>
FURCULA_INLINE T smaller(const T& a, const T& b) {
  return select(a < b, a, b);
}
/// The larger of two; `b` where one is not a number.
template <class T>
FURCULA_INLINE T larger(const T& a, const T& b) {
  return select(a > b, a, b);
}
/// `x` limited to the range from -most to most; NaN stays NaN.
template <class T>
FURCULA_INLINE T clamped(const T& x, const T& most) {
  return larger(T(-most), smaller(most, x));
}

/// Square root: found by ADL for dual numbers, else the processor's, which is correctly rounded.
template <class T>
FURCULA_INLINE T square_root(const T& x) {
  using std::sqrt;
  return sqrt(x);
}
/// Square root of each lane, correctly rounded.
template <class V, int N>
FURCULA_INLINE SimdBatch<V, N> square_root(const SimdBatch<V, N>& x) {
  SimdBatch<V, N> out;
  constexpr std::size_t kBytes = N * sizeof(V);
#if defined(__AVX__)
  if constexpr (kBytes % 32 == 0) {
    for (std::size_t i = 0; i < N; i += 32 / sizeof(V)) {
      if constexpr (std::is_same_v<V, double>) {
        __m256d part;
        std::memcpy(&part, reinterpret_cast<const char*>(&x.v) + i * sizeof(V), 32);
        part = _mm256_sqrt_pd(part);
        std::memcpy(reinterpret_cast<char*>(&out.v) + i * sizeof(V), &part, 32);
      } else {
        __m256 part;
        std::memcpy(&part, reinterpret_cast<const char*>(&x.v) + i * sizeof(V), 32);
        part = _mm256_sqrt_ps(part);
        std::memcpy(reinterpret_cast<char*>(&out.v) + i * sizeof(V), &part, 32);
      }
    }
    return out;
  }
#endif
#if defined(__SSE2__)
  if constexpr (kBytes % 16 == 0) {
    for (std::size_t i = 0; i < N; i += 16 / sizeof(V)) {
      if constexpr (std::is_same_v<V, double>) {
        __m128d part;
        std::memcpy(&part, reinterpret_cast<const char*>(&x.v) + i * sizeof(V), 16);
        part = _mm_sqrt_pd(part);
        std::memcpy(reinterpret_cast<char*>(&out.v) + i * sizeof(V), &part, 16);
      } else {
        __m128 part;
        std::memcpy(&part, reinterpret_cast<const char*>(&x.v) + i * sizeof(V), 16);
        part = _mm_sqrt_ps(part);
        std::memcpy(reinterpret_cast<char*>(&out.v) + i * sizeof(V), &part, 16);
      }
    }
    return out;
  }
#endif
  for (std::size_t i = 0; i < N; ++i) out.v[i] = std::sqrt(x.v[i]);
  return out;
}

}  // namespace furcula::dynamics
