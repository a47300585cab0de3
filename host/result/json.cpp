// See json.hpp.
#include "host/result/json.hpp"

#include <algorithm>

namespace furcula::result {

std::string key_with_unit(std::string key, std::string_view unit) {
  if (unit.empty()) return key;
  key += '_';
  for (const char c : unit)
    if (c != ' ') key += c == '/' ? 'p' : static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return key;
}

Json errors_json(const std::vector<ChannelError>& errors) {
  Json out = Json::object();
  for (const ChannelError& e : errors)
    if (e.unit != "s") out["nmse_" + e.channel] = number(e.nmse);
  for (const ChannelError& e : errors) out[key_with_unit("mae_" + e.channel, e.unit)] = number(e.mae);
  for (const ChannelError& e : errors) out[key_with_unit("rmse_" + e.channel, e.unit)] = number(e.rmse);
  return out;
}

void add_data_quality(Json& data, const log::DataQuality& data_quality) {
  constexpr std::size_t kMost = 100;
  Json rows = Json::array(), logs = Json::array();
  for (std::size_t i = 0; i < std::min(kMost, data_quality.refused.size()); ++i) {
    const log::RejectedRow& r = data_quality.refused[i];
    rows.push_back({{"log", r.log},
                    {"row", r.row},
                    {"line", r.line == 0 ? Json(nullptr) : Json(r.line)},
                    {"column", or_null(r.column)},
                    {"value", std::isfinite(r.value) ? Json(r.value) : or_null(r.text)},
                    {"reason", r.why}});
  }
  for (const log::DataQuality::Excluded& l : data_quality.excluded)
    logs.push_back({{"log", l.log}, {"reason", l.log + " " + l.why}});
  data["rejected_samples"] = rows;
  data["rejected_sample_count"] = data_quality.refused.size();
  data["excluded_logs"] = logs;
  data["notes"] = data_quality.notes;
}

Json excluded_windows_json(const std::vector<ExcludedWindows>& windows) {
  Json out = Json::array();
  for (const ExcludedWindows& w : windows)
    out.push_back({{"reason", w.reason},
                   {"windows", w.windows},
                   {"share", number(w.share)},
                   {"duration_s", number(w.duration_s)},
                   {"logs", w.logs}});
  return out;
}

}  // namespace furcula::result
