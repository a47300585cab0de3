// Whether a text is an XML document that nests no deeper than a robot's does, before a parser sees it: TinyXML,
// which urdfdom reads with, recurses once a level and says little of what it does not like.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace furcula::model {

/// Elements within each other. URDF needs 5.
inline constexpr std::size_t kXmlDepthMax = 32;

/// @throws log::DataError naming file, line, element and what was expected: tags that do not match, attributes
/// without quotes, more or less than one root element, nested deeper than kXmlDepthMax, a document type
/// (entities of its own).
void check_xml(std::string_view text, const std::string& name);

}  // namespace furcula::model
