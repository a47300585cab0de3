// Decodes messages in JSON: each number and truth value by its path.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/bags/decoded.hpp"

namespace furcula::bags {

/// `to` and `names` are overwritten; `names` may be null. null is a value that is not known (NaN). @returns why the message cannot be
/// read; empty: it was.
std::string decode_json(std::string_view data, Decoded& to, std::vector<std::string>* names);

}  // namespace furcula::bags
