// The table of Modbus registers. Firmware, the servers of the Linux board and of the simulation, the host's
// programs and docs/modbus.md follow from it.
//
// A number of 32 bits takes two registers, the more significant word first; a real number is IEEE 754.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "furcula/bus/logged_fault.hpp"
#include "furcula/bus/node_words.hpp"
#include "furcula/bus/parameters.hpp"

namespace furcula::bus {

/// Version of this table; a master refuses a node that shows another.
inline constexpr std::uint16_t kRegistersVersion = 2;

/// Exception codes of MODBUS Application Protocol V1.1b3, section 7.
enum class ModbusException : std::uint8_t {
  none = 0,
  illegal_function = 1,
  illegal_address = 2,
  illegal_value = 3,
  device_failure = 4,  ///< here: refused; the input register last_refusal says why
  acknowledge = 5,     ///< taken, and it takes a while: here a save; parameter_origin says when it is done
};

/// Of what came over Modbus, and as requests for registers over CAN.
struct BusCounts {
  std::uint32_t requests = 0;    ///< answered, or broadcast and done
  std::uint32_t exceptions = 0;  ///< of these, answered by an exception
  std::uint32_t bad_frames = 0;  ///< of the serial line, dropped: checksum, length or gap
};

/// All that a node shows, as of its last tick.
struct Snapshot {
  std::uint16_t registers_version = kRegistersVersion;  ///< of the table of registers
  std::uint16_t state = 0,                              ///< number of the NodeState
      reason = 0,                                       ///< number of the Reason why the robot does not move
      fault = 0,             ///< number in the table of faults (control/fault.hpp); 0: none
      last_refusal = 0,      ///< number of the Refusal of the last write or request that was refused
      session = 0,           ///< to be sent with the next request
      parameter_origin = 0;  ///< number of the ParameterOrigin
  std::uint16_t phase = 0,   ///< 0: flight, 1: stance
      contact = 0,           ///< raw contact switch; 1: closed
      clutch_stage = 0;      ///< number of the control::ClutchStage
  std::uint32_t firmware_version = 0,  ///< as version_number() makes it
      build_id = 0,                    ///< of the image, as the board's build gives it
      board_id = 0;                    ///< board_id() of the board's name
  std::uint32_t uptime_ms = 0;         ///< ticks since the start
  float height_m = 0.0f,               ///< of the body's centre of mass; not a number: not homed
      velocity_mps = 0.0f,             ///< of the body, positive upwards
      apex_height_m = 0.0f,            ///< of the last whole flight
      leg_angle_rad = 0.0f,            ///< from the vertical, on the motor's side
      torque_nm = 0.0f;                ///< commanded
  float cable_travel_m = 0.0f,         ///< of the clutch's cable, as seen along the leg
      coil_duty = 0.0f;                ///< share of the supply across the coil, 0 to 1
  std::uint32_t missed_samples = 0,    ///< ticks without an answer of the sensors
      refused_by_drive = 0,            ///< commands that the drive did not take
      last_interval_us = 0,            ///< between the last two ticks
      longest_interval_us = 0;         ///< greatest between two ticks since the node was first idle
  std::uint32_t releases = 0,          ///< of the spring, seen to let go
      catches = 0,                     ///< of the spring, verified in flight
      missed_catches = 0;              ///< stances that began on a free spring
  std::uint32_t requests_taken = 0,    ///< requests and parameter writes that were done
      requests_refused = 0,            ///< requests and parameter writes that were refused
      stale_stops = 0;                 ///< stops because a stream of commands, or the host, fell silent
  std::uint32_t bus_requests = 0,      ///< as BusCounts::requests
      bus_exceptions = 0,              ///< as BusCounts::exceptions
      bus_bad_frames = 0;              ///< as BusCounts::bad_frames
  std::uint16_t reset_cause = 0,       ///< number of the ResetCause
      logged_faults = 0;               ///< entries of the fault log
  std::uint32_t starts = 0,            ///< since the fault log was cleared, this one included
      unique_id_0 = 0,                 ///< of the chip, bits 0 to 31; 0: it has none
      unique_id_1 = 0,                 ///< of the chip, bits 32 to 63
      unique_id_2 = 0;                 ///< of the chip, bits 64 to 95
  std::uint16_t observed_contact = 0;  ///< by the contact observer, without the switch; 1: on the ground
  float ground_force_n = 0.0f;         ///< on the toe, along the leg, by the contact observer
};

/// Type of a number in the table: u16 has one register, u32 and real (IEEE 754, 32 bits) have two.
enum class RegisterType : std::uint8_t { u16, u32, real };
/// Number of registers of that type.
constexpr std::uint16_t words(RegisterType type) { return type == RegisterType::u16 ? 1 : 2; }

/// A number in a block of registers that `Owner` is.
template <class Owner>
struct RegisterOf {
  std::uint16_t address;               ///< from the block's begin
  std::string_view name;               ///< that of the member of `Owner`, but "start" for LoggedFault::starts
  RegisterType type;                   ///< gives the number of registers, words(type)
  std::string_view unit;               ///< empty: a number without unit, or a code
  std::string_view meaning;            ///< description for the documentation
  std::uint32_t (*get)(const Owner&);  ///< its bits
  void (*put)(Owner&, std::uint32_t);  ///< sets the number from its bits
};
/// An input register or pair of them, of the block that a Snapshot makes.
using InputRegister = RegisterOf<Snapshot>;
/// A register or pair of them, of an entry of the fault log.
using LogRegister = RegisterOf<LoggedFault>;

namespace table {

template <class Owner, class Value>
constexpr Owner owner_of(Value Owner::*);

template <auto Member, class Owner = decltype(owner_of(Member))>
constexpr RegisterOf<Owner> input(std::uint16_t address, std::string_view name, std::string_view unit,
                                  std::string_view meaning) {
  using Value = std::remove_cvref_t<decltype(Owner{}.*Member)>;
  constexpr bool is_real = std::is_same_v<Value, float>;
  return {address,
          name,
          is_real              ? RegisterType::real
          : sizeof(Value) == 2 ? RegisterType::u16
                               : RegisterType::u32,
          unit,
          meaning,
          [](const Owner& s) -> std::uint32_t {
            if constexpr (is_real)
              return std::bit_cast<std::uint32_t>(s.*Member);
            else
              return s.*Member;
          },
          [](Owner& s, std::uint32_t bits) {
            if constexpr (is_real)
              s.*Member = std::bit_cast<float>(bits);
            else
              s.*Member = static_cast<Value>(bits);
          }};
}

}  // namespace table

/// The table of input registers, in the order of their addresses.
inline constexpr std::array kInputRegisters{
    table::input<&Snapshot::registers_version>(0, "registers_version", "", "Of this table."),
    table::input<&Snapshot::state>(1, "state", "", "Of the node; see States."),
    table::input<&Snapshot::reason>(2, "reason", "", "Why it does not move; see Reasons."),
    table::input<&Snapshot::fault>(3, "fault", "", "Number in the table of faults (safety.md); 0: none."),
    table::input<&Snapshot::last_refusal>(4, "last_refusal", "",
                                          "Why the last write or request was refused; see Refusals."),
    table::input<&Snapshot::session>(5, "session", "", "To be sent with the next request."),
    table::input<&Snapshot::parameter_origin>(6, "parameter_origin", "",
                                              "Where the parameters come from; see Parameters."),
    table::input<&Snapshot::phase>(7, "phase", "", "0: flight, 1: stance."),
    table::input<&Snapshot::contact>(8, "contact", "", "The raw switch; 1: closed."),
    table::input<&Snapshot::clutch_stage>(
        9, "clutch_stage", "",
        "0: caught, 1: releasing, 2: folding, 3: homing, 4: catching, 5: testing, 6: aborting."),
    table::input<&Snapshot::firmware_version>(10, "firmware_version", "",
                                              "65536 x major + 256 x minor + patch."),
    table::input<&Snapshot::build_id>(12, "build_id", "", "Of the image, as the board's build gives it."),
    table::input<&Snapshot::board_id>(14, "board_id", "", "FNV-1a, 32 bits, of the name of the board."),
    table::input<&Snapshot::uptime_ms>(16, "uptime_ms", "ms", "Ticks since the start."),
    table::input<&Snapshot::height_m>(18, "height_m", "m",
                                      "Of the body's centre of mass; not a number: not homed."),
    table::input<&Snapshot::velocity_mps>(20, "velocity_mps", "m/s", "Upwards."),
    table::input<&Snapshot::apex_height_m>(22, "apex_height_m", "m", "Of the last whole flight."),
    table::input<&Snapshot::leg_angle_rad>(24, "leg_angle_rad", "rad",
                                           "From the vertical, on the motor's side."),
    table::input<&Snapshot::torque_nm>(26, "torque_nm", "N m", "Commanded."),
    table::input<&Snapshot::cable_travel_m>(28, "cable_travel_m", "m",
                                            "Of the clutch's cable, as seen along the leg."),
    table::input<&Snapshot::coil_duty>(30, "coil_duty", "", "Share of the supply across the coil."),
    table::input<&Snapshot::missed_samples>(32, "missed_samples", "",
                                            "Ticks without an answer of the sensors."),
    table::input<&Snapshot::refused_by_drive>(34, "refused_by_drive", "",
                                              "Commands that the drive did not take."),
    table::input<&Snapshot::last_interval_us>(36, "last_interval_us", "us", "Between the last two ticks."),
    table::input<&Snapshot::longest_interval_us>(38, "longest_interval_us", "us",
                                                 "Between two ticks, since it was idle first."),
    table::input<&Snapshot::releases>(40, "releases", "", "Of the spring, seen to let go."),
    table::input<&Snapshot::catches>(42, "catches", "", "Of the spring, verified in flight."),
    table::input<&Snapshot::missed_catches>(44, "missed_catches", "",
                                            "Stances that began on a loose spring."),
    table::input<&Snapshot::requests_taken>(46, "requests_taken", "", "Requests and parameter writes done."),
    table::input<&Snapshot::requests_refused>(48, "requests_refused", "",
                                              "Requests and parameter writes refused."),
    table::input<&Snapshot::stale_stops>(50, "stale_stops", "",
                                         "Stops because a stream of commands, or the host, fell silent."),
    table::input<&Snapshot::bus_requests>(52, "bus_requests", "",
                                          "Requests answered: of Modbus, and for registers over CAN."),
    table::input<&Snapshot::bus_exceptions>(54, "bus_exceptions", "", "Of these, answered by an exception."),
    table::input<&Snapshot::bus_bad_frames>(56, "bus_bad_frames", "",
                                            "Frames of the serial line dropped: checksum, length or gap."),
    table::input<&Snapshot::reset_cause>(58, "reset_cause", "", "Why it started; see Reset causes."),
    table::input<&Snapshot::logged_faults>(59, "logged_faults", "",
                                           "Entries of the log of faults; see below."),
    table::input<&Snapshot::starts>(60, "starts", "", "Since the log of faults was cleared, this one too."),
    table::input<&Snapshot::unique_id_0>(62, "unique_id_0", "", "Of the chip, bits 0 to 31; 0: it has none."),
    table::input<&Snapshot::unique_id_1>(64, "unique_id_1", "", "Bits 32 to 63."),
    table::input<&Snapshot::unique_id_2>(66, "unique_id_2", "", "Bits 64 to 95."),
    table::input<&Snapshot::observed_contact>(68, "observed_contact", "",
                                              "Told from the leg, without the switch; 1: on the ground."),
    table::input<&Snapshot::ground_force_n>(69, "ground_force_n", "N", "On the toe, told from the leg."),
};

/// Number of input registers: the table has addresses 0 to kInputWords - 1, without a gap.
inline constexpr std::uint16_t kInputWords =
    kInputRegisters.back().address + words(kInputRegisters.back().type);

static_assert(
    [] {
      std::uint16_t next = 0;
      for (const InputRegister& r : kInputRegisters) {
        if (r.address != next) return false;
        next = static_cast<std::uint16_t>(next + words(r.type));
      }
      return next <= 125;
    }(),
    "without a gap, and read by one request");

/// The log of faults: input registers from here on, the same few for each entry, the newest fault first. An
/// entry that is not there reads as 0.
inline constexpr std::uint16_t kLogBase = 512;
/// The registers of one entry of the fault log.
inline constexpr std::array kLogRegisters{
    table::input<&LoggedFault::fault>(0, "fault", "", "Number in the table of faults (safety.md)."),
    table::input<&LoggedFault::starts>(1, "start", "", "The run: 1 is the first since the log was cleared."),
    table::input<&LoggedFault::tick>(2, "tick", "ms", "Of that run; 4294967295: not known."),
};
/// Registers of one entry of the fault log.
inline constexpr std::uint16_t kLogEntryWords =
    kLogRegisters.back().address + words(kLogRegisters.back().type);
/// Registers of the whole fault log.
inline constexpr std::uint16_t kLogWords = kLoggedFaults * kLogEntryWords;

/// The last trial on the clutch's bench, input registers too: its number since the start, how many rows it
/// has, and of each row what the cable's encoder had moved since the first one (counts, signed) and the
/// coil's duty from then on (percent). A row is a millisecond. Rows that the trial does not have are old or
/// 0.
inline constexpr std::uint16_t kTrialNumberAddress = 1024;
inline constexpr std::uint16_t kTrialRowsAddress = 1025;  ///< of the number of rows
/// First register of the encoder's counts, one register a row.
inline constexpr std::uint16_t kTrialCountBase = 2048;
/// First register of the coil's duties, one register a row.
inline constexpr std::uint16_t kTrialCoilBase = 4096;
/// Greatest number of rows that are kept.
inline constexpr std::uint16_t kTrialRowsMost = 1024;

/// The request: three holding registers that are written at once. `stop` may be written alone.
inline constexpr std::uint16_t kRequestKeyAddress = 0;
inline constexpr std::uint16_t kRequestSessionAddress = 1;  ///< of the session that the node gave
inline constexpr std::uint16_t kRequestAddress = 2;         ///< of the request's number
/// Registers of a request: key, session and request.
inline constexpr std::uint16_t kRequestWords = 3;
inline constexpr std::uint16_t kRequestKey = 0x4655;  ///< "FU"

/// Address of the first parameter; each parameter has two holding registers.
inline constexpr std::uint16_t kParameterBase = 256;
/// Address of the first of the parameter's two holding registers.
constexpr std::uint16_t address_of(const Parameter& p) {
  return static_cast<std::uint16_t>(kParameterBase + 2 * (p.number - 1));
}
/// Registers of all parameters.
inline constexpr std::uint16_t kParameterWords = 2 * kParameters.size();
static_assert(kParameterWords <= 123, "all of them are written by one request");

/// The more significant 16 bits: the first register of a number of 32 bits.
constexpr std::uint16_t high_word(std::uint32_t bits) { return static_cast<std::uint16_t>(bits >> 16); }
/// The less significant 16 bits: the second register of a number of 32 bits.
constexpr std::uint16_t low_word(std::uint32_t bits) { return static_cast<std::uint16_t>(bits & 0xffffu); }
/// The number of 32 bits from its two registers.
constexpr std::uint32_t bits_of(std::uint16_t high, std::uint16_t low) {
  return static_cast<std::uint32_t>(high) << 16 | low;
}

namespace table {

constexpr void put_words(std::span<std::uint16_t> block, std::uint16_t address, RegisterType type,
                         std::uint32_t bits) {
  if (words(type) == 2) block[address] = high_word(bits);
  block[address + words(type) - 1u] = low_word(bits);
}
constexpr std::uint32_t bits_at(std::span<const std::uint16_t> block, std::uint16_t address,
                                RegisterType type) {
  return words(type) == 2 ? bits_of(block[address], block[address + 1u]) : std::uint32_t{block[address]};
}

template <std::size_t... I>
constexpr void put_words(const Snapshot& snapshot, std::array<std::uint16_t, kInputWords>& out,
                         std::index_sequence<I...>) {
  (put_words(out, kInputRegisters[I].address, kInputRegisters[I].type, kInputRegisters[I].get(snapshot)),
   ...);
}

template <std::size_t... I>
inline void put_words(const control::Config& config, std::array<std::uint16_t, kParameterWords>& out,
                      std::index_sequence<I...>) {
  const auto put = [&out](std::size_t i, std::uint32_t bits) {
    out[2 * i] = high_word(bits);
    out[2 * i + 1] = low_word(bits);
  };
  (put(I, std::bit_cast<std::uint32_t>(kParameters[I].get(config))), ...);
}

}  // namespace table

// Without loops over the tables, which would be slower: a robot answers between two ticks.

/// The input registers' words.
constexpr std::array<std::uint16_t, kInputWords> to_words(const Snapshot& snapshot) {
  std::array<std::uint16_t, kInputWords> out{};
  table::put_words(snapshot, out, std::make_index_sequence<kInputRegisters.size()>());
  return out;
}
/// The parameters' words, from kParameterBase on.
inline std::array<std::uint16_t, kParameterWords> to_words(const control::Config& config) {
  std::array<std::uint16_t, kParameterWords> out;
  table::put_words(config, out, std::make_index_sequence<kParameters.size()>());
  return out;
}
/// Inverse of to_words().
constexpr Snapshot from_words(const std::array<std::uint16_t, kInputWords>& in) {
  Snapshot snapshot;
  for (const InputRegister& r : kInputRegisters) r.put(snapshot, table::bits_at(in, r.address, r.type));
  return snapshot;
}

/// Entries of the log of faults, the newest first: their words, one entry after the other.
constexpr std::array<std::uint16_t, kLogWords> to_words(std::span<const LoggedFault> entries) {
  std::array<std::uint16_t, kLogWords> out{};
  for (std::size_t i = 0; i < entries.size() && i < kLoggedFaults; ++i)
    for (const LogRegister& r : kLogRegisters)
      table::put_words(std::span(out).subspan(i * kLogEntryWords), r.address, r.type, r.get(entries[i]));
  return out;
}
/// Of one entry. `in` has its kLogEntryWords words.
constexpr LoggedFault logged_fault(std::span<const std::uint16_t> in) {
  LoggedFault entry;
  for (const LogRegister& r : kLogRegisters) r.put(entry, table::bits_at(in, r.address, r.type));
  return entry;
}

/// FNV-1a of a board's name (the name of its folder).
constexpr std::uint32_t board_id(std::string_view name) {
  std::uint32_t hash = 0x811c9dc5u;
  for (const char c : name) hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x01000193u;
  return hash;
}
/// 65536 x major + 256 x minor + patch. `minor` and `patch` are below 256.
constexpr std::uint32_t version_number(std::uint32_t major, std::uint32_t minor, std::uint32_t patch) {
  return major << 16 | minor << 8 | patch;
}

/// Who a node is. The texts outlive it.
struct Identity {
  std::string_view board;                        ///< the name of its folder
  std::string_view text;                         ///< version and build in words
  std::uint32_t firmware_version = 0;            ///< as version_number() makes it
  std::uint32_t build_id = 0;                    ///< of the image, as the board's build gives it
  ResetCause reset_cause = ResetCause::unknown;  ///< why it started
  std::array<std::uint32_t, 3> unique_id{};      ///< least significant word first; 0: it has none
};

}  // namespace furcula::bus
