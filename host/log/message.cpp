// Error messages' pieces, see message.hpp.
#include "host/log/message.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <numeric>

namespace furcula::log {

std::string quoted(std::string_view value) {
  constexpr std::size_t kMost = 40;
  std::string out = "'";
  for (const char c : value.substr(0, kMost)) {
    if (c >= 0x20 && c < 0x7f) {
      out += c;
    } else {
      char hex[8];
      std::snprintf(hex, sizeof hex, "\\x%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
      out += hex;
    }
  }
  return out + (value.size() > kMost ? "...'" : "'");
}

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string rounded(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

namespace {

// Levenshtein's distance; both names are short.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string did_you_mean(std::string_view name, std::span<const std::string_view> names) {
  if (name.size() > 100) return {};
  std::string_view best;
  std::size_t least = 1 + std::max<std::size_t>(2, name.size() / 3);
  for (const std::string_view candidate : names) {
    // A part of a name is as good as a slip of the pen, a name with more to it nearly as good.
    const bool part = name.size() >= 3 && candidate.find(name) != candidate.npos;
    const bool more = candidate.size() >= 4 && name.find(candidate) != name.npos;
    const std::size_t distance =
        part ? 1 : std::min<std::size_t>(edit_distance(name, candidate), more ? 2 : 100);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best.empty() ? std::string{} : " (did you mean '" + std::string(best) + "'?)";
}

std::string listed(std::span<const std::string_view> names) {
  std::string out;
  for (const std::string_view name : names) {
    if (!out.empty()) out += ", ";
    out += name;
  }
  return out;
}

}  // namespace furcula::log
