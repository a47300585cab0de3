// What the JSON of all results has in common.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/result/diagnosis.hpp"

namespace furcula::result {

using Json = nlohmann::ordered_json;

/// null where it is not finite.
inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// null where it is empty.
inline Json or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }
template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// "mae_angle" and "rad/s" as "mae_angle_radps": '/' is written p, spaces are left out. Without a unit the key as it is.
std::string key_with_unit(std::string key, std::string_view unit);

/// `nmse_CHANNEL`, then `mae_CHANNEL_UNIT`, then `rmse_CHANNEL_UNIT` of each. Of instants (unit "s") there is no NMSE.
Json errors_json(const std::vector<ChannelError>& errors);

/// Adds `rejected_samples` (the first hundred), `rejected_sample_count`, `excluded_logs` and `notes` to an object.
void add_data_quality(Json& data, const log::DataQuality& data_quality);

/// `excluded_windows` of `data`.
Json excluded_windows_json(const std::vector<ExcludedWindows>& windows);

}  // namespace furcula::result
