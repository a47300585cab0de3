// A SIMD batch whose first lane leads: conditions are those of that lane.
//
// In it run nearly equal robots, or one from nearly equal states: the lanes go through the same changes of their friction, each at its own
// time to first order, as a dual number does (furcula/dynamics/tree/plant.hpp). The first lane has the bits that plain numbers
// have; the others less the first are a finite difference.
#pragma once

#include "furcula/dynamics/simd_batch.hpp"

namespace furcula::trees {

/// N numbers in lanes. Its plain value is the first.
template <class V, int N>
struct LedBatch {
  dynamics::SimdBatch<V, N> lanes;

  LedBatch() : lanes(V(0)) {}
  FURCULA_INLINE LedBatch(V x) : lanes(x) {}  // NOLINT(google-explicit-constructor): as a number anywhere
  FURCULA_INLINE explicit LedBatch(const dynamics::SimdBatch<V, N>& x) : lanes(x) {}
};

#define FURCULA_LED_OPERATOR(op)                                                                  \
  template <class V, int N>                                                                       \
  FURCULA_INLINE LedBatch<V, N> operator op(const LedBatch<V, N>& a, const LedBatch<V, N>& b) {   \
    return LedBatch<V, N>(a.lanes op b.lanes);                                                    \
  }                                                                                               \
  template <class V, int N>                                                                       \
  FURCULA_INLINE LedBatch<V, N> operator op(const LedBatch<V, N>& a, std::type_identity_t<V> b) { \
    return LedBatch<V, N>(a.lanes op b);                                                          \
  }                                                                                               \
  template <class V, int N>                                                                       \
  FURCULA_INLINE LedBatch<V, N> operator op(std::type_identity_t<V> a, const LedBatch<V, N>& b) { \
    return LedBatch<V, N>(a op b.lanes);                                                          \
  }                                                                                               \
  template <class V, int N, class B>                                                              \
  FURCULA_INLINE LedBatch<V, N>& operator op##=(LedBatch<V, N>& a, const B& b) {                  \
    return a = a op b;                                                                            \
  }
FURCULA_LED_OPERATOR(+)
FURCULA_LED_OPERATOR(-)
FURCULA_LED_OPERATOR(*)
FURCULA_LED_OPERATOR(/)
#undef FURCULA_LED_OPERATOR

template <class V, int N>
FURCULA_INLINE LedBatch<V, N> operator-(const LedBatch<V, N>& a) {
  return LedBatch<V, N>(-a.lanes);
}
template <class V, int N>
FURCULA_INLINE LedBatch<V, N> sqrt(const LedBatch<V, N>& x) {
  return LedBatch<V, N>(dynamics::square_root(x.lanes));
}

/// Where the first lane hardly crosses, the others' times would be far from it: they keep to the step.
template <class V, int N>
FURCULA_INLINE LedBatch<V, N> inside_step(const LedBatch<V, N>& time, const LedBatch<V, N>& step) {
  using dynamics::larger, dynamics::smaller;
  return LedBatch<V, N>(larger(smaller(time.lanes, step.lanes), dynamics::SimdBatch<V, N>(V(0))));
}

namespace detail {

/// How far the lanes are from the first.
template <class V, int N>
FURCULA_INLINE dynamics::SimdBatch<V, N> ahead(const LedBatch<V, N>& x) {
  return x.lanes - x.lanes[0];
}
/// Whether series about the first lane have the precision of V: up to x^10, the next term is 0.1^11 / 11!.
template <class V, int N>
FURCULA_INLINE bool is_near(const dynamics::SimdBatch<V, N>& ahead) {
  return !dynamics::any(ahead * ahead > V(0.01));
}
template <class V, int N>
FURCULA_INLINE dynamics::SimdBatch<V, N> sine(const dynamics::SimdBatch<V, N>& d) {
  const auto s = d * d;
  return d +
         d * s * ((s * ((s * (s * V(1.0 / 362880.0) - V(1.0 / 5040.0))) + V(1.0 / 120.0))) - V(1.0 / 6.0));
}
template <class V, int N>
FURCULA_INLINE dynamics::SimdBatch<V, N> versed_cosine(const dynamics::SimdBatch<V, N>& d) {  // 1 - cos
  const auto s = d * d;
  return s * (V(0.5) -
              s * (V(1.0 / 24.0) - s * (V(1.0 / 720.0) - s * (V(1.0 / 40320.0) - s * V(1.0 / 3628800.0)))));
}
template <class V, int N, class F>
[[gnu::noinline]] LedBatch<V, N> each(const LedBatch<V, N>& x, const F& f) {
  LedBatch<V, N> out;
  for (std::size_t i = 0; i < static_cast<std::size_t>(N); ++i) out.lanes.set(i, f(x.lanes[i]));
  return out;
}

}  // namespace detail

template <class V, int N>
FURCULA_INLINE LedBatch<V, N> sin(const LedBatch<V, N>& x) {
  const auto d = detail::ahead(x);
  if (!detail::is_near(d)) return detail::each(x, [](V v) { return std::sin(v); });
  const V s = std::sin(x.lanes[0]), c = std::cos(x.lanes[0]);
  return LedBatch<V, N>(s + (c * detail::sine(d) - s * detail::versed_cosine(d)));
}
template <class V, int N>
FURCULA_INLINE LedBatch<V, N> cos(const LedBatch<V, N>& x) {
  const auto d = detail::ahead(x);
  if (!detail::is_near(d)) return detail::each(x, [](V v) { return std::cos(v); });
  const V s = std::sin(x.lanes[0]), c = std::cos(x.lanes[0]);
  return LedBatch<V, N>(c - (s * detail::sine(d) + c * detail::versed_cosine(d)));
}
template <class V, int N>
FURCULA_INLINE LedBatch<V, N> exp(const LedBatch<V, N>& x) {
  return detail::each(x, [](V v) { return std::exp(v); });
}

}  // namespace furcula::trees

template <class V, int N>
struct furcula::dynamics::ScalarTraits<furcula::trees::LedBatch<V, N>> {
  using Value = V;
  static constexpr V value(const furcula::trees::LedBatch<V, N>& x) { return x.lanes[0]; }
};
