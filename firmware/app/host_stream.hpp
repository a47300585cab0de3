// What a host asks by its stream of command frames, for any robot's link: a stop whoever says it, all else by version, number and age.
#pragma once

#include <cstdint>

#include "firmware/app/can_sources.hpp"
#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/stream.hpp"
#include "furcula/core/status.hpp"

namespace furcula::firmware {

/// Of a person's command frame.
struct CanRequest {
  enum class Kind : std::uint8_t { none = 0, stop = 1, hop = 2, reset = 3 };
  Kind kind = Kind::none;
  float torque_amplitude_nm = 0.0f;
  float torque_period_s = 0.0f;
  bool release_in_flight = false;
  bool came = false;        ///< a frame of the stream came, be it one that asks for nothing
  bool follows = false;     ///< no frame of the stream was lost before it
  bool stop_apart = false;  ///< somebody said stop, beside the stream
  bool stop_again = false;  ///< the stream's stop came once more
  bool hop_said = false;    ///< somebody said hop, in the stream or beside it
};

class HostStream {
 public:
  explicit HostStream(const bus::StreamLimits& limits) : limits_(limits) {}

  /// A frame with the id of the node's commands. A stop is obeyed, whoever says it, in whatever order, age and version:
  /// of such a frame the request alone is looked at. Where it is not the very next one of the stream it is no part of it,
  /// so that a second host neither disturbs the first one's numbers nor is held to them. All else is judged by version,
  /// number and age.
  void hear(const bus::Frame& frame, std::uint32_t now_us, CanStatistics& statistics) {
    using bus::message::kCommand;
    using Kind = CanRequest::Kind;
    const auto raw = [&](const bus::Signal& s) { return bus::get_raw(frame, s); };
    const Result<std::uint32_t> said = raw(bus::signal(kCommand, "Request"));
    const auto kind = static_cast<Kind>(said.ok() ? said.value() : 0xffu);
    const std::uint32_t since_us = requested_.age_us(now_us);
    if (kind == Kind::hop) request_.hop_said = true;
    if (kind == Kind::stop && !is_next(frame, since_us)) {
      // The stream's last one once more is still the stream's.
      const bool again =
          says_ == Kind::stop && frame.size > 1 && stream_.begun && frame.data[1] == stream_.sequence;
      (again ? request_.stop_again : request_.stop_apart) = true;
      ++statistics.stops_apart;
      return;
    }
    if (frame.size != kCommand.size || kind > Kind::reset) {
      ++statistics.malformed;
      return;
    }
    const std::uint32_t lost_before = stream_.lost;
    if (!judge(stream_, limits_, frame, since_us, statistics).ok()) return;
    requested_.note(now_us);
    says_ = kind;
    // Nothing takes the place of a stop that waits.
    if (request_.came && request_.kind == Kind::stop) return;
    const auto value = [&](const bus::Signal& s) { return bus::get(frame, s).value(); };
    request_.came = true;
    request_.kind = kind;
    request_.follows = stream_.lost == lost_before;
    request_.torque_amplitude_nm = value(bus::signal(kCommand, "Torque_Amplitude"));
    request_.torque_period_s = value(bus::signal(kCommand, "Torque_Period"));
    request_.release_in_flight = raw(bus::signal(kCommand, "Clutch")).value() != 0;
  }

  /// The newest request that was not taken yet; `kind` none where there is none.
  CanRequest take() {
    const CanRequest taken = request_;
    request_ = {};
    return taken;
  }
  /// Whether somebody said stop since the last take().
  bool stop_waits() const {
    return request_.stop_apart || request_.stop_again || request_.kind == CanRequest::Kind::stop;
  }
  /// Since the last command frame that counts, kForgottenUs where there was none for that long. To be asked
  /// once a second at least.
  std::uint32_t age_us(std::uint32_t now_us) { return requested_.age_us(now_us); }

 private:
  /// Whether the stream's next frame is this one, with none lost between; or it begins anew with it.
  bool is_next(const bus::Frame& frame, std::uint32_t since_us) const {
    const Result<bus::Stamp> stamp = bus::get_stamp(frame);
    if (frame.size != bus::message::kCommand.size || !stamp.ok()) return false;
    bus::Stream stream = stream_;
    return bus::arrive(stream, limits_, stamp.value(), static_cast<float>(since_us) * 1e-6f) ==
           bus::Arrival::fresh;
  }

  bus::StreamLimits limits_;
  LastHeard requested_;
  bus::Stream stream_;
  CanRequest::Kind says_ = CanRequest::Kind::none;
  CanRequest request_;
};

}  // namespace furcula::firmware
