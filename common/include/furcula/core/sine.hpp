// A sine whose every bit is the same on the target and on the host. (sinf of newlib and of glibc are two
// functions that differ in the last bit.)
#pragma once

#include <cstdint>

namespace furcula {

/// sin(2 pi turns), within 2e-7 of the true value for |turns| <= 64, exactly 0 from 2^23 turns on, NaN for
/// a number that is not finite. The argument counts whole turns, so that taking them off is exact; what is
/// left is folded to a quarter turn (exact as well) and goes into an odd polynomial of degree 9, Chebyshev
/// interpolation of sin(2 pi x)/x in x^2 over [0, 1/16], itself within 7e-9.
constexpr float sine_of_turns(float turns) {
  const float magnitude = turns < 0.0f ? -turns : turns;
  if (!(magnitude < 8388608.0f)) return turns - turns;
  const float nearest = static_cast<float>(static_cast<std::int32_t>(turns + (turns < 0.0f ? -0.5f : 0.5f)));
  float x = turns - nearest;
  if (x > 0.25f) x = 0.5f - x;
  if (x < -0.25f) x = -0.5f - x;
  const float y = x * x;
  return x *
         (6.283185280f + y * (-41.34168061f + y * (81.60247637f + y * (-76.58117264f + y * 39.75982709f))));
}

/// Whether a number is neither infinite nor NaN.
constexpr bool is_finite(float x) { return x - x == 0.0f; }

}  // namespace furcula
