// Whether a text is an XML document that nests no deeper than a robot's does, before a parser sees it: TinyXML,
// which urdfdom reads with, recurses once a level and says little of what it does not like.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace furcula::model {

/// Elements within each other. URDF needs 5; the bodies of MJCF are within each other.
inline constexpr std::size_t kXmlDepthMax = 32, kMjcfDepthMax = 256;

/// An element as it stands in the text, its entities (&amp;) as they are.
struct XmlElement {
  std::size_t line = 1;
  std::size_t depth = 0;  ///< 0: the root
  std::string_view tag;
  std::vector<std::pair<std::string_view, std::string_view>> attributes;
  std::string_view text = {};  ///< from its start tag to the next tag, without the blanks around it

  /// Empty if it has none of that name.
  std::string_view attribute(std::string_view name) const {
    for (const auto& [n, value] : attributes)
      if (n == name) return value;
    return {};
  }
};

/// The elements in their order. @throws core::DataError naming file, line, element and what was expected: tags
/// that do not match, attributes without quotes, more or less than one root element, nested deeper than
/// `depth_max`, a document type with entities of its own.
std::vector<XmlElement> check_xml(std::string_view text, const std::string& name,
                                  std::size_t depth_max = kXmlDepthMax);

/// An attribute's value with its entities resolved, as an XML reader hands it out.
std::string resolved(std::string_view raw);

}  // namespace furcula::model
