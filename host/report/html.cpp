// Escaping, and numbers as text.
#include "host/report/html.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace furcula::report {

std::string inside_script(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) switch (c) {
      case '<':
        out += "\\u003c";
        break;
      case '>':
        out += "\\u003e";
        break;
      case '&':
        out += "\\u0026";
        break;
      default:
        out += c;
    }
  return out;
}

std::string in_words(std::string_view identifier) {
  std::string out(identifier);
  std::replace(out.begin(), out.end(), '_', ' ');
  if (!out.empty()) out[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(out[0])));
  return out;
}

namespace {

std::string superscript(int value) {
  constexpr const char* kDigits[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                     "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string out;
  for (const char c : std::to_string(value)) out += c == '-' ? "\u207b" : kDigits[c - '0'];
  return out;
}

}  // namespace

std::string number(double value, int significant_digits) {
  if (!std::isfinite(value)) return "\xE2\x80\x93";
  if (value == 0.0) return "0";
  char text[64];
  const double magnitude = std::abs(value);
  if (magnitude < 1e-4 || magnitude >= 1e7) {
    std::snprintf(text, sizeof text, "%.*e", significant_digits - 1, value);
    const std::string_view written(text);
    const std::size_t e = written.find('e');
    return std::string(written.substr(0, e)) +
           "\xC3\x97"
           "10" +
           superscript(std::atoi(text + e + 1));
  }
  const int decimals = significant_digits - 1 - static_cast<int>(std::floor(std::log10(magnitude)));
  std::snprintf(text, sizeof text, "%.*f", std::max(0, decimals), value);
  return text;
}

std::string percent(double share) {
  if (!std::isfinite(share)) return "\xE2\x80\x93";
  const double p = 100.0 * share;
  if (p != 0.0 && std::abs(p) < 0.1) return p > 0.0 ? "< 0.1 %" : "> -0.1 %";
  if (p >= 99.5 && p < 100.0) return "> 99 %";
  char text[32];
  std::snprintf(text, sizeof text, "%.*f %%", p != 0.0 && std::abs(p) < 10.0 ? 1 : 0, p);
  return text;
}

Scale scale_for(const std::vector<double>& values, std::string_view unit) {
  double largest = 0.0;
  for (const double v : values)
    if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
  if (largest < 0.1 && (unit == "m" || unit == "m/s" || unit == "rad" || unit == "rad/s"))
    return {1e3, "m" + std::string(unit)};
  return {1.0, std::string(unit)};
}

}  // namespace furcula::report
