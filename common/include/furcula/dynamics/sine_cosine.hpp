// Sine and cosine of an angle in radians, without a branch: the same bits in every lane, on every processor and in every
// library.
//
// The nearest multiple of pi/2 is taken off in two or three parts (Cody and Waite), what is left goes into the polynomials
// of fdlibm's __kernel_sin and __kernel_cos in double (within 1 ulp for |x| <= pi/4), of Cephes' sinf and cosf in float, and the
// quadrant exchanges them and sets signs. For |x| up to 1e5 rad in double, 1e3 in float.
#pragma once

#include <bit>

#include "furcula/dynamics/simd_batch.hpp"

namespace furcula::dynamics {

/// Sine and cosine of one angle.
template <class T>
struct SineCosine {
  T sine,      ///< -1 to 1
      cosine;  ///< -1 to 1
};

namespace detail {

template <class V, int N>
FURCULA_INLINE auto bits_of(const SimdBatch<V, N>& x) {
  return std::bit_cast<typename SimdBatch<V, N>::Bits>(x.v);
}
template <class V>
FURCULA_INLINE SignedOf<sizeof(V)> bits_of(V x) {
  return std::bit_cast<SignedOf<sizeof(V)>>(x);
}
template <class T, class Bits>
FURCULA_INLINE T from_bits(const Bits& bits) {
  if constexpr (std::is_arithmetic_v<T>)
    return std::bit_cast<T>(bits);
  else
    return T::of(std::bit_cast<typename T::Vector>(bits));
}

template <class T>
FURCULA_INLINE SineCosine<T> sine_cosine(const T& x) {
  using V = ValueOf<T>;
  constexpr bool kDouble = sizeof(V) == 8;
  constexpr int kTop = kDouble ? 62 : 30;
  // Added, it leaves the nearest whole number in the last bits.
  constexpr V kShift = kDouble ? V(6755399441055744.0) : V(12582912.0);
  const T shifted = x * V(0.63661977236758134308) + kShift;
  const auto quadrant = bits_of(shifted);
  const T k = shifted - kShift;
  T r;
  if constexpr (kDouble)
    r = (x - k * V(1.57079632673412561417)) - k * V(6.07710050650619224932e-11);
  else
    r = ((x - k * V(1.5703125)) - k * V(4.837512969970703125e-4)) - k * V(7.54978995489188216e-8);
  const T z = r * r;
  T sine, cosine;
  if constexpr (kDouble) {
    const T s = V(8.33333333332248946124e-03) +
                z * (V(-1.98412698298579493134e-04) +
                     z * (V(2.75573137070700676789e-06) +
                          z * (V(-2.50507602534068634195e-08) + z * V(1.58969099521155010221e-10))));
    sine = r + z * r * (V(-1.66666666666666324348e-01) + z * s);
    const T c =
        z * (V(4.16666666666666019037e-02) +
             z * (V(-1.38888888888741095749e-03) +
                  z * (V(2.48015872894767294178e-05) +
                       z * (V(-2.75573143513906633035e-07) +
                            z * (V(2.08757232129817482790e-09) + z * V(-1.13596475577881948265e-11))))));
    const T half = z * V(0.5), w = V(1) - half;
    cosine = w + (((V(1) - w) - half) + z * c);
  } else {
    sine = r + z * r * (V(-1.6666654611e-1) + z * (V(8.3321608736e-3) + z * V(-1.9515295891e-4)));
    cosine = V(1) - z * V(0.5) +
             z * z * (V(4.166664568298827e-2) + z * (V(-1.388731625493765e-3) + z * V(2.443315711809948e-5)));
  }
  const auto odd = -(quadrant & 1);
  const auto s = bits_of(sine), c = bits_of(cosine);
  return {from_bits<T>(((s & ~odd) | (c & odd)) ^ ((quadrant & 2) << (kTop))),
          from_bits<T>(((c & ~odd) | (s & odd)) ^ (((quadrant + 1) & 2) << (kTop)))};
}

}  // namespace detail

/// Sine and cosine of an angle in rad, of each lane of a batch; dual numbers use their own sin and cos.
template <class T>
FURCULA_INLINE SineCosine<T> sine_cosine(const T& x) {
  if constexpr (std::is_same_v<T, ValueOf<T>> || requires { T::kLanes; })
    return detail::sine_cosine(x);
  else
    return {sin(x), cos(x)};
}

}  // namespace furcula::dynamics
