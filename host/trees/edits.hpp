// Edits of an XML text in place: all other bytes stay as they are.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "host/model/xml_check.hpp"

namespace furcula::trees {

/// A text with pieces replaced; places are those of the text as it was.
class Edits {
 public:
  explicit Edits(std::string_view text) : text_(text) {}
  void replace(std::string_view piece, const std::string& by) {
    list_.push_back({place(piece), piece.size(), by});
  }
  void insert(std::size_t at, const std::string& what) { list_.push_back({at, 0, what}); }
  std::size_t place(std::string_view piece) const {
    return static_cast<std::size_t>(piece.data() - text_.data());
  }

  /// Sets an attribute, which is added after the tag's name where there is none.
  void set(const model::XmlElement& e, std::string_view attribute, const std::string& value) {
    for (const auto& [name, old] : e.attributes)
      if (name == attribute) return replace(old, value);
    insert(place(e.tag) + e.tag.size(), " " + std::string(attribute) + "=\"" + value + "\"");
  }
  /// A new element before another, on a line of its own where that one is.
  void add_before(const model::XmlElement& next, const std::string& element) {
    const std::size_t at = place(next.tag) - 1, line = text_.rfind('\n', at);
    const std::string_view indent = line == text_.npos ? "" : text_.substr(line + 1, at - line - 1);
    const bool alone = line != text_.npos && indent.find_first_not_of(" \t") == indent.npos;
    const bool carriage = alone && line > 0 && text_[line - 1] == '\r';
    insert(at, element + (alone ? (carriage ? "\r\n" : "\n") + std::string(indent) : ""));
  }
  /// At the beginning, but behind an XML declaration.
  void insert_on_top(const std::string& what) {
    std::size_t at = text_.starts_with("\xef\xbb\xbf") ? 3 : 0;
    if (text_.compare(at, 5, "<?xml") == 0) {
      at = text_.find("?>", at) + 2;
      at = std::min(text_.find_first_not_of(" \t\r", at), text_.size());
      if (text_[at] == '\n') ++at;
    }
    insert(at, what);
  }
  std::string text() {
    std::stable_sort(list_.begin(), list_.end(), [](const Edit& a, const Edit& b) { return a.at < b.at; });
    std::string out;
    std::size_t from = 0;
    for (const Edit& e : list_) {
      out.append(text_.substr(from, e.at - from)).append(e.by);
      from = e.at + e.length;
    }
    return out.append(text_.substr(from));
  }

 private:
  struct Edit {
    std::size_t at, length;
    std::string by;
  };
  std::string_view text_;
  std::vector<Edit> list_;
};

}  // namespace furcula::trees
