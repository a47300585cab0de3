// Numbers in lanes: N numbers that are added, multiplied and compared at once, one robot (or one leg) a lane.
//
// Each lane has the bits that the same operations on plain numbers have: every one is rounded as IEEE 754 says, nothing is contracted
// (-ffp-contract=off; GCC 12 also needs -mno-fma where it may use FMA: it makes vfmaddsub of plain numbers in spite of the former),
// and no lane sees another. Vectors of GCC, which clang has too; what the processor lacks in width the compiler splits.
// The functions of the second half exist for plain numbers and for numbers with derivatives as well, so that an algorithm
// without branches is written once: a condition is a mask, and `select` chooses by it.
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
// Of vectors wider than the processor's registers as arguments: here every function is inlined.
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

#define FURCULA_INLINE [[gnu::always_inline]] inline

namespace furcula::dynamics {

/// By the number of its bytes.
template <std::size_t kBytes>
using SignedOf = std::conditional_t<kBytes == 8, std::int64_t, std::int32_t>;

/// Which lanes; all bits of a lane are set, or none.
template <class V, int N>
struct LaneMask {
  using Bits [[gnu::vector_size(N * sizeof(V))]] = SignedOf<sizeof(V)>;
  Bits bits;

  bool operator[](std::size_t lane) const { return bits[lane] != 0; }
};

template <class V, int N>
struct Lanes {
  static_assert(N > 1 && std::is_floating_point_v<V>);
  using Vector [[gnu::vector_size(N * sizeof(V))]] = V;
  using Bits = typename LaneMask<V, N>::Bits;
  static constexpr std::size_t kLanes = N;
  Vector v;

  Lanes() = default;
  FURCULA_INLINE Lanes(V x) : v(x - Vector{}) {}  // NOLINT(google-explicit-constructor): as a number anywhere
  FURCULA_INLINE static Lanes of(const Vector& x) {
    Lanes out;
    out.v = x;
    return out;
  }
  FURCULA_INLINE V operator[](std::size_t lane) const { return v[lane]; }
  FURCULA_INLINE void set(std::size_t lane, V x) { v[lane] = x; }
};

template <class V, int N>
struct ScalarTraits<Lanes<V, N>> {
  using Value = V;
};

#define FURCULA_LANES_OPERATOR(op)                                                          \
  template <class V, int N>                                                                 \
  FURCULA_INLINE Lanes<V, N> operator op(const Lanes<V, N>& a, const Lanes<V, N>& b) {      \
    return Lanes<V, N>::of(a.v op b.v);                                                     \
  }                                                                                         \
  template <class V, int N>                                                                 \
  FURCULA_INLINE Lanes<V, N> operator op(const Lanes<V, N>& a, std::type_identity_t<V> b) { \
    return Lanes<V, N>::of(a.v op Lanes<V, N>(b).v);                                        \
  }                                                                                         \
  template <class V, int N>                                                                 \
  FURCULA_INLINE Lanes<V, N> operator op(std::type_identity_t<V> a, const Lanes<V, N>& b) { \
    return Lanes<V, N>::of(Lanes<V, N>(a).v op b.v);                                        \
  }                                                                                         \
  template <class V, int N, class B>                                                        \
  FURCULA_INLINE Lanes<V, N>& operator op##=(Lanes<V, N>& a, const B& b) {                  \
    return a = a op b;                                                                      \
  }
FURCULA_LANES_OPERATOR(+)
FURCULA_LANES_OPERATOR(-)
FURCULA_LANES_OPERATOR(*)
FURCULA_LANES_OPERATOR(/)
#undef FURCULA_LANES_OPERATOR

template <class V, int N>
FURCULA_INLINE Lanes<V, N> operator-(const Lanes<V, N>& a) {
  return Lanes<V, N>::of(-a.v);
}

#define FURCULA_LANES_COMPARE(op)                                                              \
  template <class V, int N>                                                                    \
  FURCULA_INLINE LaneMask<V, N> operator op(const Lanes<V, N>& a, const Lanes<V, N>& b) {      \
    return {a.v op b.v};                                                                       \
  }                                                                                            \
  template <class V, int N>                                                                    \
  FURCULA_INLINE LaneMask<V, N> operator op(const Lanes<V, N>& a, std::type_identity_t<V> b) { \
    return {a.v op Lanes<V, N>(b).v};                                                          \
  }
FURCULA_LANES_COMPARE(<)
FURCULA_LANES_COMPARE(>)
#undef FURCULA_LANES_COMPARE

template <class V, int N>
FURCULA_INLINE Lanes<V, N> select(const LaneMask<V, N>& which, const Lanes<V, N>& yes,
                                  const Lanes<V, N>& no) {
  return Lanes<V, N>::of(which.bits ? yes.v : no.v);
}
template <class V, int N>
FURCULA_INLINE bool any(const LaneMask<V, N>& which) {
  bool out = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(N); ++i) out = out || which[i];
  return out;
}
template <class T>
FURCULA_INLINE T select(bool which, const T& yes, const T& no) {
  return which ? yes : no;
}
FURCULA_INLINE bool any(bool which) { return which; }

/// Lanes of a number; a plain one is one lane.
template <class T>
constexpr std::size_t lanes_in() {
  if constexpr (requires { T::kLanes; })
    return T::kLanes;
  else
    return 1;
}
template <class T>
FURCULA_INLINE ValueOf<T> lane_of(const T& x, std::size_t lane) {
  if constexpr (requires { T::kLanes; })
    return x[lane];
  else
    return x;
}
template <class T>
FURCULA_INLINE void set_lane(T& x, std::size_t lane, ValueOf<T> value) {
  if constexpr (requires { T::kLanes; })
    x.set(lane, value);
  else
    x = value;
}

/// What comparing two of them gives: bool, or a mask.
template <class T>
using MaskOf = decltype(std::declval<T>() < std::declval<T>());

template <class T>
FURCULA_INLINE MaskOf<T> all_of() {
  return T(ValueOf<T>(0)) < T(ValueOf<T>(1));
}

/// The smaller and the larger; `b` where one is not a number, as processors have it.
template <class T>
FURCULA_INLINE T smaller(const T& a, const T& b) {
  return select(a < b, a, b);
}
template <class T>
FURCULA_INLINE T larger(const T& a, const T& b) {
  return select(a > b, a, b);
}
/// To +-most; what is not a number stays so.
template <class T>
FURCULA_INLINE T clamped(const T& x, const T& most) {
  return larger(T(-most), smaller(most, x));
}

/// By ADL where there is one (numbers with derivatives), else the processor's: rounded correctly on both.
template <class T>
FURCULA_INLINE T square_root(const T& x) {
  using std::sqrt;
  return sqrt(x);
}
template <class V, int N>
FURCULA_INLINE Lanes<V, N> square_root(const Lanes<V, N>& x) {
  Lanes<V, N> out;
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
