// The page on the bus, see document.hpp.
#include "host/bus/document.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "furcula/bus/walker_nodes.hpp"
#include "host/bus/nodes.hpp"
#include "host/bus/numbers.hpp"
#include "host/core/message.hpp"

namespace furcula::bus {
namespace {

using core::rounded;

constexpr std::string_view kHead = R"(# CAN messages

This page is what `furcula bus docs` prints, from the table that codec, decoder and DBC file (`furcula bus dbc`) follow from,
`common/include/furcula/bus/messages.hpp`. How boards and programs use the bus: [CAN and Modbus](board_link.md).

Classical CAN, 1 Mbit/s, 11-bit ids. `n` is the node id, 1 to 31. Bits: start bit as in a DBC file, and width; little-endian unless stated.
A physical value is the raw number times the factor, from the least to the greatest value. Messages with `Protocol_Version` (now )";

constexpr std::string_view kShared = R"() share these signals:

| signal | bits | scale | meaning |
|---|---|---|---|
)";

constexpr std::string_view kMotorsHead = R"(
## Motors with the mini-cheetah's packing

| motor | position, rad | velocity, rad/s | torque, N m | kp, N m/rad | kd, N m s/rad | bytes of a reply |
|---|---|---|---|---|---|---|
)";

std::string id_rule(const Message& m) {
  char text[40];
  switch (m.rule) {
    case IdRule::fixed:
      std::snprintf(text, sizeof text, "`0x%03X`, first byte `n`", static_cast<unsigned>(m.base));
      break;
    case IdRule::plus_node:
      std::snprintf(text, sizeof text, "`0x%03X + n`", static_cast<unsigned>(m.base));
      break;
    case IdRule::odrive:
      std::snprintf(text, sizeof text, "`n << 5 | 0x%02X`", static_cast<unsigned>(m.base));
      break;
  }
  return text;
}

std::string_view sender(const Message& m) {
  switch (m.sender) {
    case Sender::host:
      return "host";
    case Sender::controller:
      return "controller";
    case Sender::node:
      return "node";
  }
  return "";
}

std::string scale(const Signal& s) {
  const std::string unit = s.unit.empty() ? "" : " " + std::string(s.unit);
  switch (s.ranged) {
    case Ranged::position:
    case Ranged::velocity:
    case Ranged::torque:
      return "± the motor's," + unit;
    case Ranged::stiffness:
    case Ranged::damping:
      return "0 to the motor's," + unit;
    case Ranged::no:
      break;
  }
  if (s.encoding == Encoding::real) return "IEEE 754" + (unit.empty() ? "" : "," + unit);
  if (s.span == s.counts && s.unit.empty()) return "";
  return decimal(factor(s)) + unit + ", " + decimal(lowest(s)) + " to " + decimal(highest(s));
}

std::string signal_row(const Signal& s) {
  return "| `" + std::string(s.name) + "` | " + std::to_string(s.start_bit) + ", " + std::to_string(s.width) +
         (s.encoding == Encoding::signed_integer ? ", signed" : "") +
         (s.order == ByteOrder::big ? ", big-endian" : "") + " | " + scale(s) + " | " +
         std::string(s.meaning) + " |\n";
}

/// What most messages of this project's protocols begin with: told once.
constexpr std::array kSharedSignals{table::version(), table::sequence(), table::age()};

bool is_shared(const Signal& s) {
  return std::any_of(kSharedSignals.begin(), kSharedSignals.end(), [&](const Signal& shared) {
    return s.name == shared.name && s.start_bit == shared.start_bit && s.meaning == shared.meaning;
  });
}

std::string message_text(const Message& m) {
  std::string out = "\n### " + std::string(m.name) + "\n\n" + std::string(m.meaning) + " Id " + id_rule(m) +
                    "; from " + std::string(sender(m)) + "; " + std::to_string(m.size) + " bytes";
  if (m.least_size != m.size) out += ", or " + std::to_string(m.least_size);
  if (m.marker != 0) {
    char byte[8];
    std::snprintf(byte, sizeof byte, "%02X", static_cast<unsigned>(m.marker));
    return out + ": `FF FF FF FF FF FF FF " + byte + "`.\n";
  }
  std::string rows;
  const char* before = "; begins with ";
  for (const Signal& s : m.signals) {
    if (is_shared(s)) {
      out += before + ("`" + std::string(s.name) + "`");
      before = ", ";
    } else {
      rows += signal_row(s);
    }
  }
  return out + ".\n" +
         (rows.empty() ? "" : "\n| signal | bits | scale | meaning |\n|---|---|---|---|\n" + rows);
}

constexpr std::string_view kWalkerHead = R"(
## The biped's twelve drives

Worst load: command and reply of each drive, 135 bits a frame with stuffing (`common/include/furcula/bus/load.hpp`).

| bus | drives | rate | worst load |
|---|---|---|---|
)";

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * share);
  return text;
}

std::string walker_text() {
  std::string out(kWalkerHead);
  struct Layout {
    std::uint32_t buses, hz;
  };
  const auto drives = static_cast<std::uint32_t>(kWalkerDrives.size());
  const auto row = [&](const std::string& bus, std::uint32_t n, std::uint32_t hz, double load) {
    out += "| " + bus + " | " + std::to_string(n) + " | " + std::to_string(hz) + " Hz | " + percent(load) +
           (load > 1.0 ? ": too much" : "") + " |\n";
  };
  for (const Layout& a : {Layout{1, 1000}, Layout{2, 1000}, Layout{4, 1000}, Layout{2, 500}, Layout{1, 250}})
    row("one of " + std::to_string(a.buses), drives / a.buses, a.hz, walker_load(drives / a.buses, a.hz));
  const std::array<Traffic, 4> left{{{&message::kMotorCommand, drives / 2 * kWalkerDrive_hz},
                                     {&message::kMotorReply, drives / 2 * kWalkerDrive_hz},
                                     {&message::kCommand, 100},
                                     {&message::kHeartbeat, 10}}};
  row("left leg of `furculad`, with `Command` and `Heartbeat`", drives / 2, kWalkerDrive_hz,
      worst_load(left));
  row("body of `furculad`: protocol `walker`, host, telemetry", 0, 1000, worst_load(kWalkerBodyTraffic));
  out += "\n| joint | bus | id | motor |\n|---|---|---|---|\n";
  for (const WalkerDrive& d : kWalkerDrives)
    out += "| `" + std::string(d.joint) + "` | " + std::to_string(d.bus) + " | " + std::to_string(d.node) +
           " | `" + std::string(info(kWalkerMotor).name) + "` |\n";
  return out;
}

}  // namespace

std::string to_markdown() {
  std::string out = std::string(kHead) + std::to_string(kProtocolVersion) + std::string(kShared);
  for (const Signal& s : kSharedSignals) out += signal_row(s);
  for (const Protocol p : {Protocol::controller, Protocol::encoder, Protocol::mini_cheetah, Protocol::odrive,
                           Protocol::walker}) {
    out += "\n## Protocol `" + std::string(name_of(p)) + "`\n";
    for (const Message* m : kMessages)
      if (m->protocol == p) out += message_text(*m);
  }
  out += kMotorsHead;
  for (const MotorInfo& m : kMotors) {
    const auto text = [](float x) { return rounded(static_cast<double>(x)); };
    out += "| `" + std::string(m.name) + "` | ±" + text(m.position_max_rad) + " | ±" +
           text(m.velocity_max_radps) + " | ±" + text(m.torque_max_nm) + " | 0 to " +
           text(m.stiffness_max_nmpr) + " | 0 to " + text(m.damping_max_nmspr) + " | " +
           std::to_string(m.reply_bytes) + " |\n";
  }
  return out + walker_text();
}

}  // namespace furcula::bus
