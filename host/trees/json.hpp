// What the JSON of a tree's diagnosis and that of its identification have in common.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/trees/diagnosis.hpp"

namespace furcula::trees {

using Json = nlohmann::ordered_json;

inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// Errors of each joint's channel.
inline Json held_out(const TreeModel& m, const std::vector<ChannelError>& errors) {
  Json out = Json::object();
  for (std::size_t j = 0; j < errors.size(); ++j) out["nmse_" + channel_name(m, j)] = number(errors[j].nmse);
  for (std::size_t j = 0; j < errors.size(); ++j)
    out["mae_" + channel_name(m, j) + "_" + std::string(channel_unit(m, j))] = number(errors[j].mae);
  for (std::size_t j = 0; j < errors.size(); ++j)
    out["rmse_" + channel_name(m, j) + "_" + std::string(channel_unit(m, j))] = number(errors[j].rmse);
  return out;
}

}  // namespace furcula::trees
