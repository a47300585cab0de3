// A row's time as the file writes it, exactly: epoch seconds with nanoseconds do not fit a double.
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

namespace furcula::log {

/// From here on doubles are more than a nanosecond apart: 2^53 ns, 104 days. Times since the epoch are beyond it, those since a start are not.
inline constexpr double kLargeTime_s = 9007199.254740992;

/// Whether a time needs a Stamp. What is beyond an int64 of seconds is no clock's.
inline bool is_large_time(double time_s) {
  return std::abs(time_s) >= kLargeTime_s && std::abs(time_s) < 9e18;
}

/// whole + part seconds, 0 <= part < 1.
struct Stamp {
  std::int64_t whole = 0;
  double part = 0.0;

  void add(const Stamp& other) {
    whole += other.whole;
    part += other.part;
    if (part >= 1.0) {
      part -= 1.0;
      ++whole;
    }
  }
  double since(const Stamp& start) const {
    return static_cast<double>(whole - start.whole) + (part - start.part);
  }
};

/// Seconds of a plain decimal number ("1732672000.123456789", or "1732672000123456789" with the scale 1e-9), without a rounding of the whole.
/// `value` is the same as a double, which serves where the number or its scale (1, 1e-3, 1e-6, 1e-9) is not of that kind.
inline Stamp stamp_of(std::string_view digits, double scale, double value, char decimal = '.') {
  const auto of_double = [&] {
    const double s = value * scale, whole = std::floor(s);
    // Beyond any clock.
    if (!(std::abs(whole) < 9e18)) return Stamp{};
    return Stamp{static_cast<std::int64_t>(whole), s - whole};
  };
  const std::int64_t divisor = scale == 1.0    ? 1
                               : scale == 1e-3 ? 1000
                               : scale == 1e-6 ? 1000000
                               : scale == 1e-9 ? 1000000000
                                               : 0;
  if (divisor == 0) return of_double();
  constexpr std::size_t kDigits = 18;  // of an int64, any
  std::int64_t whole = 0;
  std::size_t i = 0;
  for (; i < digits.size() && digits[i] >= '0' && digits[i] <= '9'; ++i) {
    if (i == kDigits + 1 || whole > (INT64_MAX - 9) / 10) return of_double();
    whole = 10 * whole + (digits[i] - '0');
  }
  if (i == 0) return of_double();
  double part = 0.0;
  if (i < digits.size() && (digits[i] == decimal || digits[i] == '.')) {
    std::int64_t fraction = 0, power = 1;
    for (++i; i < digits.size() && digits[i] >= '0' && digits[i] <= '9'; ++i)
      if (power < 100000000000000000) {
        fraction = 10 * fraction + (digits[i] - '0');
        power *= 10;
      }
    part = static_cast<double>(fraction) / static_cast<double>(power);
  }
  if (i != digits.size()) return of_double();
  return {whole / divisor, (static_cast<double>(whole % divisor) + part) / static_cast<double>(divisor)};
}

}  // namespace furcula::log
