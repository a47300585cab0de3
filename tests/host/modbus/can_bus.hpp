// A node's end of a CAN bus in this process, whose time goes on while the host waits: a millisecond a look.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "firmware/app/can_registers.hpp"
#include "host/modbus/can_link.hpp"
#include "host/modbus/client.hpp"

namespace furcula::test {

struct CanBus {
  std::function<void()> tick;
  std::function<bus::Response(std::span<const std::uint8_t>)> answer;
  /// Of the frame with this number, counted from 1 over both directions.
  std::function<bool(int)> loses = [](int) { return false; };
  bool takes = true;  ///< what is sent
  int frames = 0, requests = 0;
  firmware::CanRegisters registers{1};

  modbus::Client connect();
};

class CanHost final : public modbus::FramePort {
 public:
  explicit CanHost(CanBus& bus) : bus_(bus) {}

  bool send(const bus::Frame& frame) override {
    if (!bus_.takes) return false;
    ++bus_.requests;
    if (!bus_.loses(++bus_.frames)) static_cast<void>(bus_.registers.receive(frame));
    return true;
  }
  std::optional<bus::Frame> receive(std::chrono::milliseconds most,
                                    const std::function<bool(const bus::Frame&)>& wanted) override {
    firmware::CanRegisters& registers = bus_.registers;
    for (int i = 0; i < most.count(); ++i) {
      std::optional<bus::Frame> frame;
      if (registers.answering()) {
        frame = registers.next();
        registers.advance();
        if (bus_.loses(++bus_.frames)) frame.reset();
      }
      bus_.tick();
      registers.serve([this](std::span<const std::uint8_t> request, bus::Response& response) {
        response = bus_.answer(request);
      });
      if (frame && wanted(*frame)) return frame;
    }
    return std::nullopt;
  }

 private:
  CanBus& bus_;
};

inline modbus::Client CanBus::connect() {
  return {"can:test", std::make_unique<modbus::CanLink>("can:test", std::uint8_t{1}, std::uint8_t{250},
                                                        std::make_unique<CanHost>(*this))};
}

}  // namespace furcula::test
