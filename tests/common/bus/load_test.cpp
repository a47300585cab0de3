// What frames take of a bus: against bits that are stuffed one by one, and the biped's drives.
#include "furcula/bus/load.hpp"

#include <catch2/catch.hpp>
#include <set>
#include <string>
#include <vector>

#include "furcula/bus/walker_nodes.hpp"
#include "furcula/control/walk/walker_sample.hpp"

using namespace furcula;
using namespace furcula::bus;

namespace {

/// Stuffed as ISO 11898-1 has it: after five equal bits one of the other kind, which counts from then on.
std::size_t stuffed(const std::vector<int>& bits) {
  std::size_t count = 0, run = 0;
  int last = -1;
  for (const int bit : bits) {
    run = bit == last ? run + 1 : 1;
    last = bit;
    ++count;
    if (run == 5) {
      last = 1 - bit;
      run = 1;
      ++count;
    }
  }
  return count;
}

}  // namespace

TEST_CASE("a frame has no more bits than with the stuffing of the worst one, which has as many") {
  for (std::uint8_t bytes = 0; bytes <= 8; ++bytes) {
    const std::size_t open = 34u + 8u * bytes;
    // Five equal bits, then four of the stuffed kind, then four of the other: the stuffed bit is the first of the next five.
    std::vector<int> worst(open);
    for (std::size_t i = 0; i < open; ++i) worst[i] = i < 5 ? 0 : 1 - static_cast<int>((i - 5) / 4 % 2);
    CHECK(stuffed(worst) + 13 == worst_bits(bytes));
    std::uint32_t draw = 12345;
    for (int trial = 0; trial < 200; ++trial) {
      std::vector<int> some(open);
      for (int& bit : some) bit = static_cast<int>((draw = 1664525u * draw + 1013904223u) >> 31);
      CHECK(stuffed(some) + 13 <= worst_bits(bytes));
    }
  }
  // As the literature has it for a full frame.
  CHECK(worst_bits(8) == 135);
}

TEST_CASE("twelve drives at 1 kHz are too many for one bus and for two, a bus a leg holds them at 500 Hz") {
  // 135 bits, twice a drive and tick: by hand.
  CHECK(walker_load(12, 1000) == Approx(3.24));
  CHECK(walker_load(6, 1000) == Approx(1.62));
  CHECK(walker_load(6, 500) == Approx(0.81));
  CHECK(walker_load(3, 1000) == Approx(0.81));
  CHECK(walker_load(12, 250) == Approx(0.81));
  // The body's bus: two frames of 135 bits and two of 125 each ms, 125 + 135 + 135 each 10 ms, 125 and 135 each 100 ms. A leg's bus has no
  // room for the IMU beside its drives.
  CHECK(worst_load(kWalkerBodyTraffic) == Approx(0.520 + 0.0395 + 0.0026));
  CHECK(walker_load(6, 500) + 2 * 0.135 > 1.0);

  // The table, with what a host and the board say on the first bus: a command each 10 ms, a heartbeat each 100 ms.
  for (std::uint8_t wire = 0; wire < kWalkerBuses; ++wire) {
    std::vector<Traffic> all;
    for (const WalkerDrive& d : kWalkerDrives) {
      if (d.bus != wire) continue;
      all.push_back({&message::kMotorCommand, kWalkerDrive_hz});
      all.push_back({&message::kMotorReply, kWalkerDrive_hz});
    }
    if (wire == 0) all.push_back({&message::kCommand, 100}), all.push_back({&message::kHeartbeat, 10});
    INFO(int(wire));
    CHECK(worst_load(all) > 0.8);
    CHECK(worst_load(all) < 0.85);
  }
}

TEST_CASE(
    "each joint of the biped has an id of its own, and its drive's frames hold its gains and its torque") {
  CHECK(kWalkerDrives.size() == control::kWalkerJoints);
  std::set<std::uint32_t> ids;
  std::set<std::string_view> names;
  std::array<int, kWalkerBuses> in_even{}, in_odd{};
  for (std::size_t i = 0; i < kWalkerDrives.size(); ++i) {
    const WalkerDrive& d = kWalkerDrives[i];
    CHECK(d.node >= kFirstNode);
    CHECK(d.node <= kLastNode);
    CHECK(ids.insert(id_of(message::kMotorCommand, d.node)).second);
    CHECK(names.insert(d.joint).second);
    CHECK(d.bus == i / dynamics::biped::kLegJoints);
    CHECK(d.joint == (d.bus == 0 ? "left_" : "right_") +
                         std::string(dynamics::biped::kLegJointNames[i % dynamics::biped::kLegJoints]));
    ++(has_turn(i, 0) ? in_even : in_odd)[d.bus];
    CHECK(has_turn(i, 0) != has_turn(i, 1));
  }
  for (std::size_t wire = 0; wire < kWalkerBuses; ++wire) {
    CHECK(in_even[wire] == 3);
    CHECK(in_odd[wire] == 3);
  }
  const MotorInfo& m = info(kWalkerMotor);
  CHECK(m.stiffness_max_nmpr >= 3000.0f);
  CHECK(m.damping_max_nmspr >= 80.0f);
  CHECK(m.torque_max_nm >= 220.0f);
  CHECK(m.position_max_rad >= 1.57f);
}
