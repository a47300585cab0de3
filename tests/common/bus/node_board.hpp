// A board that stands on the ground and does what a test says, a store in memory, and a node on both.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "firmware/app/node.hpp"
#include "firmware/app/node_registers.hpp"

namespace furcula::test {

struct StandingBoard {
  std::uint32_t clock_us = 0xfffff000u;  // wraps soon
  std::uint32_t period_us = 1000;
  bool answers = true;
  bool reset = false;
  control::Sample sample = standing();
  control::Command command;

  static control::Sample standing() {
    control::Sample s;
    s.home_height_m = 0.22f;
    s.leg_angle_rad = 0.747584f;  // acos(0.22 / 0.3)
    s.contact = 1;
    return s;
  }

  bool wait_for_tick() { return true; }
  std::uint32_t now_us() { return clock_us += period_us; }
  Result<control::Sample> sense() const {
    if (!answers) return Status::disconnected;
    return sample;
  }
  Status actuate(const control::Command& c) {
    command = c;
    return Status::ok;
  }
  void kick_watchdog() {}
  bool take_reset_request() { return std::exchange(reset, false); }
  void report(const firmware::Telemetry&) {}
};

struct MemoryStore {
  std::vector<std::uint8_t> image;
  Status load_status = Status::ok, save_status = Status::ok;
  int saves = 0;

  Result<std::size_t> load(std::span<std::uint8_t> into) const {
    if (load_status != Status::ok) return load_status;
    if (image.size() > into.size()) return Status::invalid;
    std::copy(image.begin(), image.end(), into.begin());
    return image.size();
  }
  Status save(std::span<const std::uint8_t> bytes) {
    ++saves;
    if (save_status == Status::ok) image.assign(bytes.begin(), bytes.end());
    return save_status;
  }
};

inline control::Config harmonic_torque() {
  control::Config config;
  config.torque = {control::ProfileShape::harmonic, 2.0f, 0.3f};
  return config;
}

inline constexpr bus::Identity kTestIdentity{.board = "test_board",
                                             .text = "1.2.3 build 0badcafe",
                                             .firmware_version = bus::version_number(1, 2, 3),
                                             .build_id = 0x0badcafe,
                                             .reset_cause = bus::ResetCause::watchdog,
                                             .unique_id = {0x11111111, 0x22222222, 0x33333333}};

struct Bench {
  StandingBoard board;
  MemoryStore store;
  firmware::FaultLog faults{};
  firmware::Node<StandingBoard, MemoryStore> node;
  firmware::NodeRegisters<firmware::Node<StandingBoard, MemoryStore>> registers{node};

  explicit Bench(const MemoryStore& kept = {}, const control::Config& config = harmonic_torque())
      : store(kept), node(board, store, config, kTestIdentity, 0x1234, faults) {
    faults.begin();
  }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  void tick(int n = 1) {
    for (int i = 0; i < n; ++i) node.tick();
  }
  /// Past the start.
  void settle() { tick(60); }
  void start() {
    settle();
    static_cast<void>(node.request(bus::Request::arm));
    static_cast<void>(node.request(bus::Request::hop));
  }
};

}  // namespace furcula::test
