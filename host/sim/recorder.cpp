// Recording, see recorder.hpp.
#include "host/sim/recorder.hpp"

#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::sim {
namespace {

using sim_host::SimBoard;

constexpr const char* kColumns[] = {"time_s",          "height_m",      "velocity_mps", "leg_angle_rad",
                                    "contact",         "torque_cmd_nm", "torque_nm",    "solenoid",
                                    "clutch_travel_m", "fault"};

}  // namespace

HopperRecorder::HopperRecorder(double duration_s) : values_(std::size(kColumns)) {
  for (auto& v : values_) v.reserve(static_cast<std::size_t>(duration_s * 1e3) + 1);
}

void HopperRecorder::add(SimBoard& board) {
  const double height_m = board.measured_height_m(), velocity_mps = board.measured_velocity_mps();
  if (!std::isfinite(height_m) || !std::isfinite(velocity_mps)) return;
  const double leg_rad = board.measured_leg_angle_rad();
  if (!std::isfinite(leg_rad))
    throw core::DataError(
        "at " + core::rounded(board.time_s(), 4) + " s the leg is folded flat, the body " +
        core::rounded(height_m, 3) +
        " m high: nothing holds the robot up, and its model ends there. Expected a clutch that catches before, "
        "or an auxiliary spring that carries it");
  const control::Command& command = board.command();
  const bool coil = command.coil_duty > 0.0f || board.coil_switched_on();
  const double row[] = {board.time_s(),
                        height_m,
                        velocity_mps,
                        leg_rad,
                        static_cast<double>(board.sample().contact),
                        static_cast<double>(command.torque_nm),
                        board.measured_torque_nm(),
                        coil ? 1.0 : 0.0,
                        board.measured_cable_travel_m(),
                        static_cast<double>(board.telemetry().outputs.fault)};
  static_assert(std::size(row) == std::size(kColumns));
  for (std::size_t i = 0; i < std::size(kColumns); ++i) values_[i].push_back(row[i]);
}

void HopperRecorder::finish(log::Log& log, bool clutch) {
  for (std::size_t i = 0; i < std::size(kColumns); ++i) log.columns[kColumns[i]] = std::move(values_[i]);
  if (!clutch) log.columns.erase("clutch_travel_m");
}

}  // namespace furcula::sim
