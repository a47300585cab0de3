// A pass over tags, comments and attributes; what the elements mean is urdfdom's.
#include "host/model/xml_check.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::model {
namespace {

class Scanner {
 public:
  Scanner(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  std::vector<XmlElement> run() {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
    while (at_ < text_.size()) {
      const std::size_t open = text_.find('<', at_);
      const std::string_view between = text_.substr(at_, std::min(open, text_.size()) - at_);
      if (open_.empty() && between.find_first_not_of(" \t\r\n") != between.npos)
        fail(at_ + between.find_first_not_of(" \t\r\n"),
             (elements_.empty() ? "not XML" : "text after the root element") + std::string(": ") +
                 core::quoted(between) + ", expected an XML document (URDF)");
      if (open == text_.npos) break;
      at_ = open;
      markup();
    }
    if (!open_.empty()) fail(text_.size(), "<" + core::printable(open_.back()) + "> is not closed");
    if (elements_.empty()) fail(text_.size(), "no element, expected <robot>");
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
    if (here("<!")) fail(at_, "a document type or CDATA section, expected elements and comments alone");
    if (here("</")) return close();
    ++at_;
    const std::size_t from = at_;
    const std::string_view tag = word();
    if (open_.empty() && !elements_.empty())
      fail(from, "a second root element <" + core::printable(tag) + ">, expected one");
    elements_.push_back({line(from), open_.size(), tag, {}});
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
    if (open_.size() > kXmlDepthMax)
      fail(from, "elements nest deeper than " + std::to_string(kXmlDepthMax) + ", expected a URDF (5)");
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
  std::size_t at_ = 0;
  mutable std::size_t counted_to_ = 0, line_ = 1;
  std::vector<XmlElement> elements_;
  std::vector<std::string_view> open_;
};

}  // namespace

std::vector<XmlElement> check_xml(std::string_view text, const std::string& name) {
  return Scanner(text, name).run();
}

}  // namespace furcula::model
