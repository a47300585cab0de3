// A hopper's log as its bus would have carried it: the frames that encoder, drive and board send in each tick of 1 ms.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/motors.hpp"
#include "furcula/bus/stream.hpp"
#include "host/bus/candump.hpp"
#include "host/log/log.hpp"

namespace furcula::test {

struct HopperBus {
  double metres_per_count = 0.00009;
  double count_0_m = 0.1;  ///< height where the encoder reads 0
  double leg_zero_rad = 0.0, ratio = 1.0;
  std::int64_t start_ns = 1'732'672'000'000'000'000;
  std::uint32_t telemetry_ticks = 10;  ///< of Body_State and Leg_State
  /// false: the frame is lost. Of the tick, and the message's name.
  std::function<bool(std::size_t tick, std::string_view message)> comes = [](std::size_t, std::string_view) {
    return true;
  };

  /// The recording, in the order of its stamps: 20 ticks with the drive off, the log's rows, 20 ticks with it off again.
  template <typename Take>
  void play(const log::Log& log, Take take) const {
    using namespace bus;
    using namespace bus::message;
    constexpr std::size_t kAround = 20;
    const std::size_t rows = log.rows();
    std::uint8_t sample_number = 0, body_number = 0, leg_number = 0;
    for (std::size_t tick = 0; tick < rows + 2 * kAround; ++tick) {
      const std::size_t row = std::min(tick < kAround ? 0 : tick - kAround, rows - 1);
      const bool on = tick >= kAround && tick < kAround + rows;
      const auto at = [&](const char* column) { return value(log, column, row); };
      // Before and behind the log time goes on by 1 ms.
      const double outside = static_cast<double>(tick) - static_cast<double>(kAround + row);
      const std::int64_t tick_ns = start_ns + std::llround((at("time_s") + 0.001 * outside) * 1e9);
      const auto send = [&](const Frame& frame, std::string_view name, std::int64_t after_ns) {
        if (comes(tick, name)) take(LogFrame{tick_ns + after_ns, "can0", frame});
      };

      const double count = std::round((at("height_m") - count_0_m) / metres_per_count);
      // What else is on the bus delays the frame by up to 0.3 ms.
      const std::int64_t late_ns = 10'000 * static_cast<std::int64_t>(tick * 7919 % 31);
      Frame sample = stamped(kEncoderSample, sample_number++, static_cast<double>(late_ns) * 1e-9);
      static_cast<void>(put_raw(sample, signal(kEncoderSample, "Count"),
                                static_cast<std::uint32_t>(static_cast<std::int32_t>(count))));
      send(sample, "Sample", late_ns);

      Frame command = empty_frame(on ? kMotorCommand : kMotorExit, 1);
      if (on) {
        set(command, kMotorCommand, "Position", 0.0);
        set(command, kMotorCommand, "Velocity", 0.0);
        set(command, kMotorCommand, "Torque", at("torque_cmd_nm") / ratio);
      }
      send(command, on ? "Command" : "Exit", 400'000);

      const double turned_rad = row == 0 ? 0.0 : at("leg_angle_rad") - value(log, "leg_angle_rad", row - 1);
      Frame reply = empty_frame(kMotorReply, 1);
      set(reply, kMotorReply, "Position", (at("leg_angle_rad") - leg_zero_rad) * ratio);
      set(reply, kMotorReply, "Velocity", 1e3 * ratio * turned_rad);
      set(reply, kMotorReply, "Torque", at("torque_nm") / ratio);
      send(reply, "Reply", 550'000);

      if (tick % telemetry_ticks == 0) {
        Frame body = stamped(kBodyState, body_number++, 0.0005);
        // Before its first sample a board has no height, and says 0.
        set(body, kBodyState, "Height", tick == 0 ? 0.0 : count_0_m + count * metres_per_count);
        set(body, kBodyState, "Velocity", at("velocity_mps"));
        send(body, "Body_State", 700'000);
      }
      if (tick % telemetry_ticks == telemetry_ticks / 3) {
        Frame leg = stamped(kLegState, leg_number++, 0.0005);
        set(leg, kLegState, "Contact", at("contact"));
        set(leg, kLegState, "Solenoid", at("solenoid"));
        set(leg, kLegState, "Leg_Angle", at("leg_angle_rad"));
        set(leg, kLegState, "Torque", at("torque_cmd_nm"));
        send(leg, "Leg_State", 700'000);
      }
    }
  }

  std::string candump(const log::Log& log) const {
    std::string text;
    play(log, [&](const bus::LogFrame& f) { text += bus::format_candump(f); });
    return text;
  }

 private:
  static double value(const log::Log& log, const char* column, std::size_t row) {
    const auto found = log.columns.find(column);
    return found == log.columns.end() ? 0.0 : found->second[row];
  }
  static bus::Frame stamped(const bus::Message& message, std::uint8_t number, double age_s) {
    bus::Frame frame = bus::empty_frame(message, 1);
    static_cast<void>(bus::put_stamp(frame, {bus::kProtocolVersion, number, static_cast<float>(age_s)}));
    return frame;
  }
  static void set(bus::Frame& frame, const bus::Message& message, std::string_view name, double value) {
    for (const bus::Signal& s : message.signals)
      if (s.name == name)
        static_cast<void>(
            bus::put(frame, bus::with_range(s, bus::info(bus::Motor::ak80_9)), static_cast<float>(value)));
  }
};

}  // namespace furcula::test
