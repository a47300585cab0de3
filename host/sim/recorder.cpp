// Recording, see recorder.hpp.
#include "host/sim/recorder.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

namespace furcula::sim {
namespace {

using sim_host::SimBoard;

constexpr std::pair<const char*, double (*)(SimBoard&)> kColumns[] = {
    {"time_s", [](SimBoard& b) { return b.time_s(); }},
    {"height_m", [](SimBoard& b) { return b.measured_height_m(); }},
    {"velocity_mps", [](SimBoard& b) { return b.measured_velocity_mps(); }},
    {"leg_angle_rad", [](SimBoard& b) { return b.measured_leg_angle_rad(); }},
    {"contact", [](SimBoard& b) { return static_cast<double>(b.sample().contact); }},
    {"torque_cmd_nm", [](SimBoard& b) { return static_cast<double>(b.command().torque_nm); }},
    {"torque_nm", [](SimBoard& b) { return b.measured_torque_nm(); }},
    {"solenoid",
     [](SimBoard& b) { return b.command().coil_duty > 0.0f || b.coil_switched_on() ? 1.0 : 0.0; }},
    {"clutch_travel_m", [](SimBoard& b) { return b.measured_cable_travel_m(); }},
    {"fault", [](SimBoard& b) { return static_cast<double>(b.telemetry().outputs.fault); }},
};

}  // namespace

HopperRecorder::HopperRecorder(double duration_s) : values_(std::size(kColumns)) {
  for (auto& v : values_) v.reserve(static_cast<std::size_t>(duration_s * 1e3) + 1);
}

void HopperRecorder::add(SimBoard& board) {
  const bool homed = std::isfinite(board.measured_height_m()) && std::isfinite(board.measured_velocity_mps());
  if (!homed) return;
  for (std::size_t i = 0; i < std::size(kColumns); ++i) values_[i].push_back(kColumns[i].second(board));
}

void HopperRecorder::finish(log::Log& log, bool clutch) {
  for (std::size_t i = 0; i < std::size(kColumns); ++i)
    log.columns[kColumns[i].first] = std::move(values_[i]);
  if (!clutch) log.columns.erase("clutch_travel_m");
}

}  // namespace furcula::sim
