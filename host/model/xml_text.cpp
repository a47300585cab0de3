// Words and numbers in the attributes of robot files, see xml_text.hpp.
#include "host/model/xml_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "host/core/message.hpp"

namespace furcula::model {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
}
std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> out;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const std::size_t end = std::min(text.find_first_of(kBlank), text.size());
    out.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return out;
}

std::optional<double> any_number(std::string_view text) {
  text = trimmed(text);
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || end != text.data() + text.size()) return std::nullopt;
  // Too large, or less than a double holds.
  if (error == std::errc::result_out_of_range) {
    const std::size_t e = text.find_first_of("eE");
    return e != text.npos && text.find('-', e) != text.npos ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return value;
}
std::optional<double> number(std::string_view text) {
  const auto value = any_number(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}
std::string no_number(std::string_view text) {
  std::string out = core::quoted(text) + " is no finite number, expected one as 0.25 or 2.5e-1";
  const std::string_view digits = trimmed(text);
  if (digits.find(',') != digits.npos)
    out += " (with a decimal point)";
  else if (digits.starts_with("0x") || digits.starts_with("0X"))
    out += " (decimal)";
  else if (!digits.empty() && std::string_view("0123456789").find(digits.front()) != digits.npos)
    out += " (without unit or formula)";
  return out;
}

}  // namespace furcula::model
