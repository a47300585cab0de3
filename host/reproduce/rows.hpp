// Rows of a reproduction, as each document's JSON and page have them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/reproduce/comparison.hpp"

namespace furcula::reproduce {

/// Without its counterfactuals. A number that is not finite becomes null.
nlohmann::ordered_json json_of(const Row& row);

/// A table, rows that differ set off; nothing of none.
std::string rows_html(const std::vector<Row>& rows);

}  // namespace furcula::reproduce
