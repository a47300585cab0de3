// A drive at a joint with weight, damping and dry friction, as its bus carries it: set points and estimates of an ODrive. The torque
// holds from the reception of a set point to the next one; the joint is integrated in steps that are small against both.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "host/bus/candump.hpp"

namespace furcula::test {

struct PolledDrive {
  double inertia_kgm2 = 0.05, gravity_torque_nm = 1.5, damping_nmspr = 0.1, friction_nm = 0.12;
  double counts_per_turn = 0.0;  ///< of the encoder; 0: it has no steps
  std::int64_t command_period_ns = 5'000'000, state_period_ns = 5'000'000;
  std::int64_t command_ns = 0;      ///< of the first set point
  std::int64_t state_ns = 300'000;  ///< of the first estimate
  std::int64_t measured_ns = 0;     ///< estimates tell of so long before
  std::int64_t asked_ns = -1;       ///< a remote frame asks so long before each estimate; negative: none
  std::function<bool(std::size_t)> command_comes = [](std::size_t) {
    return true;
  };  ///< it is in the recording

  struct Truth {
    std::vector<bus::LogFrame> frames;
    std::vector<std::int64_t> measured_ns;       ///< of each estimate
    std::vector<double> angle_rad, impulse_nms;  ///< at each of them; of the torque since the start
  };

  Truth run(double seconds) const {
    using namespace bus;
    constexpr std::int64_t kStepNs = 20'000;
    Truth truth;
    double q = 0.1, v = 0.0, u = 0.0, impulse = 0.0;
    std::size_t command = 0;
    std::int64_t next_command_ns = command_ns, next_measured_ns = state_ns - measured_ns;
    for (std::int64_t t = 0; t < std::llround(seconds * 1e9); t += kStepNs) {
      const auto send = [&](std::int64_t at_ns, const Frame& frame) {
        const LogFrame f{1'000'000'000 + at_ns, "can0", frame};
        auto place = truth.frames.end();
        while (place != truth.frames.begin() && std::prev(place)->time_ns > f.time_ns) --place;
        truth.frames.insert(place, f);
      };
      if (t >= next_command_ns) {
        const double s = static_cast<double>(t) * 1e-9, a = 2 * std::numbers::pi * 0.55 * s,
                     b = 2 * std::numbers::pi * 1.3 * s;
        const double wanted = 0.7 * std::sin(a) + 0.25 * std::sin(b);
        u = static_cast<double>(static_cast<float>(6.0 * (wanted - q) - 0.5 * v + 1.5 * std::sin(wanted)));
        Frame frame = empty_frame(message::kOdriveInputTorque, 2);
        static_cast<void>(put(frame, table::kOdriveInputTorque[0], static_cast<float>(u)));
        if (command_comes(command++)) send(t, frame);
        next_command_ns += command_period_ns;
      }
      if (t >= next_measured_ns) {
        Frame frame = empty_frame(message::kOdriveEncoderEstimates, 2);
        double turns = q / (2 * std::numbers::pi);
        if (counts_per_turn > 0.0) turns = std::round(turns * counts_per_turn) / counts_per_turn;
        static_cast<void>(put(frame, table::kOdriveEncoderEstimates[0], static_cast<float>(turns)));
        static_cast<void>(
            put(frame, table::kOdriveEncoderEstimates[1], static_cast<float>(v / (2 * std::numbers::pi))));
        if (asked_ns >= 0) {
          Frame ask = empty_frame(message::kOdriveEncoderEstimates, 2);
          ask.remote = true;
          send(t + measured_ns - asked_ns, ask);
        }
        send(t + measured_ns, frame);
        truth.measured_ns.push_back(1'000'000'000 + t);
        truth.angle_rad.push_back(q);
        truth.impulse_nms.push_back(impulse);
        next_measured_ns += state_period_ns;
      }
      const double h = static_cast<double>(kStepNs) * 1e-9;
      const double moves = u - gravity_torque_nm * std::sin(q) - damping_nmspr * v;
      // Dry friction takes speed until there is none.
      const double free = v + h * moves / inertia_kgm2, loss = h * friction_nm / inertia_kgm2;
      v = std::abs(free) <= loss ? 0.0 : free - std::copysign(loss, free);
      q += h * v;
      impulse += h * u;
    }
    return truth;
  }
};

}  // namespace furcula::test
