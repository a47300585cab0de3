// A pass over tags, comments and attributes; what the elements mean is urdfdom's.
#include "host/model/xml_check.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <utility>
#include <vector>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/model/xml_text.hpp"

namespace furcula::model {
namespace {

class Scanner {
 public:
  Scanner(std::string_view text, const std::string& name, std::size_t depth_max)
      : text_(text), name_(name), depth_max_(depth_max) {}

  std::vector<XmlElement> run() {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
    if (text_.starts_with("\xff\xfe") || text_.starts_with("\xfe\xff"))
      fail(0, "the text is UTF-16, expected UTF-8 (iconv -f UTF-16 -t UTF-8 FILE > robot.urdf makes it)");
    while (at_ < text_.size()) {
      const std::size_t open = text_.find('<', at_);
      const std::string_view between = text_.substr(at_, std::min(open, text_.size()) - at_);
      if (open_.empty() && between.find_first_not_of(" \t\r\n") != between.npos)
        fail(at_ + between.find_first_not_of(" \t\r\n"),
             (elements_.empty() ? "not XML" : "text after the root element") + std::string(": ") +
                 core::quoted(between) + ", expected an XML document");
      // What an element holds, once it has begun and before an element within it has.
      if (!open_.empty() && elements_.back().depth + 1 == open_.size() && elements_.back().text.empty())
        elements_.back().text = trimmed(between);
      if (open == text_.npos) break;
      at_ = open;
      markup();
    }
    if (!open_.empty()) fail(text_.size(), "<" + core::printable(open_.back()) + "> is not closed");
    if (elements_.empty()) fail(text_.size(), "no element, expected a robot");
    return std::move(elements_);
  }

 private:
  [[noreturn]] void fail(std::size_t at, const std::string& message) const {
    throw core::DataError(name_ + ":" + std::to_string(line(at)) + ": " + message);
  }
  /// Of a place, counted on from the last one asked for that was before it.
  std::size_t line(std::size_t at) const {
    if (at < counted_to_) counted_to_ = 0, line_ = 1;
    line_ += static_cast<std::size_t>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(counted_to_),
                                                 text_.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
    counted_to_ = at;
    return line_;
  }
  bool here(std::string_view what) const { return text_.substr(at_, what.size()) == what; }
  void skip_past(std::string_view end, const char* what) {
    const std::size_t found = text_.find(end, at_);
    if (found == text_.npos)
      fail(at_, std::string(what) + " has no end, expected '" + std::string(end) + "'");
    at_ = found + end.size();
  }
  void skip_space() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }
  std::string_view word() {
    const std::size_t from = at_;
    const auto belongs = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':' || c == '-' || c == '.';
    };
    while (at_ < text_.size() && belongs(text_[at_])) ++at_;
    if (at_ == from || std::isdigit(static_cast<unsigned char>(text_[from])) != 0 || text_[from] == '-' ||
        text_[from] == '.')
      fail(from, "not XML: " + core::quoted(text_.substr(from, 20)) + ", expected a name");
    return text_.substr(from, at_ - from);
  }

  void markup() {
    if (here("<!--")) {
      at_ += 4;
      return skip_past("-->", "a comment");
    }
    if (here("<?")) return skip_past("?>", "a processing instruction");
    if (here("<![CDATA[") && !open_.empty()) return skip_past("]]>", "a CDATA section");
    // Without entities of its own.
    if (const std::size_t end = text_.find('>', at_); here("<!DOCTYPE") && elements_.empty() &&
                                                      end != text_.npos &&
                                                      text_.substr(at_, end - at_).find('[') == text_.npos) {
      at_ = end + 1;
      return;
    }
    if (here("<!")) fail(at_, "a document type or CDATA section, expected elements and comments alone");
    if (here("</")) return close();
    ++at_;
    const std::size_t from = at_;
    const std::string_view tag = word();
    if (open_.empty() && !elements_.empty())
      fail(from, "a second root element <" + core::printable(tag) + ">, expected one");
    elements_.push_back({line(from), open_.size(), tag, {}, {}});
    for (;;) {
      const std::size_t before = at_;
      skip_space();
      if (here("/>")) {
        at_ += 2;
        return;
      }
      if (here(">")) {
        ++at_;
        break;
      }
      if (at_ == text_.size()) fail(from, "<" + core::printable(tag) + "> has no end, expected '>'");
      if (at_ == before)
        fail(at_, "in <" + core::printable(tag) + ">: " + core::quoted(text_.substr(at_, 20)) +
                      ", expected a blank");
      attribute(tag);
    }
    open_.push_back(tag);
    if (open_.size() > depth_max_)
      fail(from,
           "elements nest deeper than " + std::to_string(depth_max_) + ", expected a robot (a URDF: 5)");
  }
  void attribute(std::string_view tag) {
    const std::string_view name = word();
    const std::string in = "in <" + core::printable(tag) + ">: attribute '" + core::printable(name) + "'";
    skip_space();
    if (!here("=")) fail(at_, in + " has no value, expected =\"...\"");
    ++at_;
    skip_space();
    if (!here("\"") && !here("'")) fail(at_, in + " has no quotes, expected =\"...\"");
    const char quote = text_[at_++];
    const std::size_t end = text_.find(quote, at_);
    if (end == text_.npos) fail(at_, in + " has no closing quote");
    if (text_.substr(at_, end - at_).find('<') != text_.npos) fail(at_, in + " has '<' in it, expected &lt;");
    elements_.back().attributes.emplace_back(name, text_.substr(at_, end - at_));
    at_ = end + 1;
  }
  void close() {
    const std::size_t from = at_;
    at_ += 2;
    const std::string_view tag = word();
    skip_space();
    if (!here(">")) fail(from, "</" + core::printable(tag) + " has no end, expected '>'");
    ++at_;
    if (open_.empty() || open_.back() != tag)
      fail(from, "</" + core::printable(tag) + ">, expected " +
                     (open_.empty() ? "nothing to be closed" : "</" + core::printable(open_.back()) + ">"));
    open_.pop_back();
  }

  std::string_view text_;
  const std::string& name_;
  const std::size_t depth_max_;
  std::size_t at_ = 0;
  mutable std::size_t counted_to_ = 0, line_ = 1;
  std::vector<XmlElement> elements_;
  std::vector<std::string_view> open_;
};

std::string utf8(unsigned code) {
  const auto byte = [](unsigned value) { return static_cast<char>(static_cast<unsigned char>(value)); };
  const auto more = [&](unsigned shift) { return byte(0x80U | ((code >> shift) & 0x3FU)); };
  if (code < 0x80U) return {byte(code)};
  if (code < 0x800U) return {byte(0xC0U | (code >> 6U)), more(0)};
  if (code < 0x10000U) return {byte(0xE0U | (code >> 12U)), more(6), more(0)};
  return {byte(0xF0U | (code >> 18U)), more(12), more(6), more(0)};
}

}  // namespace

std::vector<XmlElement> check_xml(std::string_view text, const std::string& name, std::size_t depth_max) {
  return Scanner(text, name, depth_max).run();
}

std::string resolved(std::string_view raw) {
  constexpr std::pair<std::string_view, char> kNamed[] = {
      {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  std::string out;
  while (!raw.empty()) {
    const auto* const found = std::find_if(std::begin(kNamed), std::end(kNamed),
                                           [&](const auto& entity) { return raw.starts_with(entity.first); });
    std::size_t length = found != std::end(kNamed) ? found->first.size() : 1;
    std::string character(1, found != std::end(kNamed) ? found->second : raw.front());
    if (raw.starts_with("&#")) {
      const bool hex = raw.substr(2).starts_with("x");
      const std::string_view digits = raw.substr(hex ? 3 : 2);
      unsigned code = 0;
      const auto [end, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), code, hex ? 16 : 10);
      constexpr unsigned kMostUnicode = 0x10FFFF;
      if (error == std::errc{} && end < digits.data() + digits.size() && *end == ';' && code > 0 &&
          code <= kMostUnicode) {
        length = static_cast<std::size_t>(end + 1 - raw.data());
        character = utf8(code);
      }
    }
    out += character;
    raw.remove_prefix(length);
  }
  return out;
}

}  // namespace furcula::model
