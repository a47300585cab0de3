// Registers over CAN (docs/bus.md, Register_Request): asks, gathers the answer's frames, and asks again where
// one of them is lost.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "furcula/bus/frame.hpp"
#include "furcula/bus/register_frames.hpp"
#include "host/modbus/link.hpp"

namespace furcula::modbus {

/// A socket on the bus, or what a test puts in its place.
class FramePort {
 public:
  virtual ~FramePort() = default;
  /// false: it was not taken.
  virtual bool send(const bus::Frame& frame) = 0;
  /// The next frame that is `wanted`; none: it did not come within the time.
  virtual std::optional<bus::Frame> receive(std::chrono::milliseconds most,
                                            const std::function<bool(const bus::Frame&)>& wanted) = 0;
};

class CanLink final : public Link {
 public:
  static constexpr int kTries = 3;
  /// From the request to the first frame of its answer, and from each to the next.
  static constexpr std::chrono::milliseconds kReadMost{100};
  /// A board that saves its parameters is silent for so long.
  static constexpr std::chrono::milliseconds kWriteMost{1000};

  /// `name` is for messages. `sequence` should differ from program to program: it tells whose answer it is.
  CanLink(std::string name, std::uint8_t node, std::uint8_t sequence, std::unique_ptr<FramePort> port);

  Answer read(Table table, std::uint16_t first, std::span<std::uint16_t> out) override;
  Answer write(std::uint16_t first, std::uint32_t bits) override;
  Answer request(std::uint16_t session, bus::Request request) override;
  std::string text(std::uint8_t object) override;

 private:
  using Values = std::vector<std::uint32_t>;
  Answer ask(bus::RegisterRequest request, const char* doing, Values& values,
             const std::function<bool(const Values&)>& complete);

  std::string name_;
  std::uint8_t node_, sequence_;
  std::unique_ptr<FramePort> port_;
};

}  // namespace furcula::modbus
