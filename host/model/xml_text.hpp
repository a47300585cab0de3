// Words and numbers in the attributes of robot files.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace furcula::model {

/// Without the blanks around it.
std::string_view trimmed(std::string_view text);

/// The parts between blanks.
std::vector<std::string_view> words(std::string_view text);

/// The number, infinity and NaN among them; nothing where it is none. Decimal, with a point, whatever the locale is.
std::optional<double> any_number(std::string_view text);

/// The finite number.
std::optional<double> number(std::string_view text);

/// What is wrong with a text that is no number, and how it is written.
std::string no_number(std::string_view text);

}  // namespace furcula::model
