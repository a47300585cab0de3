// Text for the inside of XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace furcula::core {

/// Text for an element's content or a quoted attribute: & < > " ' are escaped, control characters are
/// replaced by U+FFFD.
std::string escape(std::string_view text);

}  // namespace furcula::core
