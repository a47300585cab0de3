#include "host/modbus/monitor.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <span>

#include "furcula/bus/node_words.hpp"
#include "furcula/control/fault.hpp"
#include "host/core/message.hpp"
#include "host/core/own_build.hpp"

namespace furcula::modbus {
namespace {

constexpr std::array<std::string_view, 7> kStages{"caught",   "releasing", "folding", "homing",
                                                  "catching", "testing",   "aborting"};

/// The word of a number that came over a bus.
std::string name_of(std::span<const bus::Word> words, std::uint16_t number) {
  return number < words.size() ? std::string(words[number].name) : std::to_string(number);
}
std::string meaning_of(std::span<const bus::Word> words, std::uint16_t number) {
  return number < words.size() ? std::string(words[number].meaning)
                               : "number " + std::to_string(number) + ", which this program does not know";
}
std::string fault_name(std::uint16_t number) {
  return number < control::kFaults.size() ? std::string(control::kFaults[number].name)
                                          : std::to_string(number);
}

std::string fixed(float value, int decimals) {
  if (!std::isfinite(value)) return "unknown";
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", decimals, static_cast<double>(value));
  return text;
}

/// 24 digits, the most significant first.
std::string unique_id(const bus::Snapshot& s) {
  return core::hexadecimal(s.unique_id_2) + core::hexadecimal(s.unique_id_1) +
         core::hexadecimal(s.unique_id_0);
}

std::string when(const bus::LoggedFault& f) {
  return f.tick == bus::kNoTick ? "at an unknown time"
                                : "at " + fixed(static_cast<float>(f.tick) * 0.001f, 3) + " s";
}

}  // namespace

std::string reason_text(const bus::Snapshot& s) {
  if (s.reason != static_cast<int>(bus::Reason::fault) || s.fault >= control::kFaults.size())
    return meaning_of(bus::kReasons, s.reason);
  const control::FaultInfo& fault = control::kFaults[s.fault];
  return "Fault " + std::string(fault.name) + ". " + std::string(fault.meaning) + " " +
         std::string(fault.remedy);
}

std::string to_text(const View& view) {
  const bus::Snapshot& s = view.snapshot;
  const bool moves = s.state == static_cast<int>(bus::NodeState::running) &&
                     s.reason != static_cast<int>(bus::Reason::no_torque) &&
                     s.reason != static_cast<int>(bus::Reason::standing_still);
  const auto count = [](std::uint32_t n) { return std::to_string(n); };
  std::string out;
  const auto line = [&out](const char* head, const std::string& rest) {
    char text[16];
    std::snprintf(text, sizeof text, "%-11s", head);
    out += text + rest + "\n";
  };
  line("robot", core::printable(view.names.board) + ", " + core::printable(view.names.revision) + ", up " +
                    fixed(static_cast<float>(s.uptime_ms) * 0.001f, 1) + " s");
  line("state", name_of(bus::kNodeStates, s.state) + ", fault " + fault_name(s.fault));
  line(moves ? "moves" : "why not", reason_text(s));
  line("body", std::string(s.phase == 0 ? "flight" : "stance") + ", height " + fixed(s.height_m, 4) +
                   " m, velocity " + fixed(s.velocity_mps, 2) + " m/s, last apex " +
                   fixed(s.apex_height_m, 4) + " m");
  line("leg", "angle " + fixed(s.leg_angle_rad, 3) + " rad, torque " + fixed(s.torque_nm, 2) +
                  " N m, switch " + (s.contact == 0 ? "open" : "closed"));
  line("clutch", (s.clutch_stage < kStages.size() ? std::string(kStages[s.clutch_stage]) : "?") + ", cable " +
                     fixed(s.cable_travel_m * 1000.0f, 1) + " mm, coil " + fixed(s.coil_duty * 100.0f, 0) +
                     " %; releases " + count(s.releases) + ", catches " + count(s.catches) + ", missed " +
                     count(s.missed_catches));
  line("ticks", "last " + count(s.last_interval_us) + " us, longest " + count(s.longest_interval_us) +
                    " us; samples missed " + count(s.missed_samples) + ", commands refused by the drive " +
                    count(s.refused_by_drive));
  line("requests", "taken " + count(s.requests_taken) + ", refused " + count(s.requests_refused) +
                       (s.last_refusal == 0 ? "" : "; last: " + meaning_of(bus::kRefusals, s.last_refusal)));
  line("parameters", meaning_of(bus::kParameterOrigins, s.parameter_origin));
  line("bus", "requests " + count(s.bus_requests) + ", exceptions " + count(s.bus_exceptions) +
                  ", frames dropped " + count(s.bus_bad_frames));
  line("start", "number " + count(s.starts) + ", by " + name_of(bus::kResetCauses, s.reset_cause) +
                    ", chip " + unique_id(s));
  for (const bus::LoggedFault& f : view.faults)
    line("fault log", fault_name(f.fault) + " in start " + count(f.starts) + " " + when(f));
  return out;
}

std::string to_json(const View& view) {
  const bus::Snapshot& s = view.snapshot;
  nlohmann::ordered_json out;
  out["board"] = view.names.board;
  out["revision"] = view.names.revision;
  out["state_name"] = name_of(bus::kNodeStates, s.state);
  out["reason_text"] = reason_text(s);
  out["fault_name"] = fault_name(s.fault);
  out["reset_cause_name"] = name_of(bus::kResetCauses, s.reset_cause);
  out["unique_id"] = unique_id(s);
  out["faults"] = nlohmann::ordered_json::array();
  for (const bus::LoggedFault& f : view.faults) {
    nlohmann::ordered_json entry{{"fault_name", fault_name(f.fault)}};
    for (const bus::LogRegister& r : bus::kLogRegisters) entry[std::string(r.name)] = r.get(f);
    out["faults"].push_back(entry);
  }
  for (const bus::InputRegister& r : bus::kInputRegisters) {
    const std::string name(r.name);
    if (r.type != bus::RegisterType::real) {
      out[name] = r.get(s);
      continue;
    }
    const auto value = static_cast<double>(std::bit_cast<float>(r.get(s)));
    if (std::isfinite(value))
      out[name] = value;
    else
      out[name] = nullptr;
  }
  return out.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

}  // namespace furcula::modbus
