// The laws that the virtual machines can hide, by name: those of the catalogue's contract (docs/contracts.md,
// section 3) under its names, whether or not the catalogue of the build knows them yet, and causes that no
// catalogue holds.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "furcula/dynamics/machines.hpp"

namespace furcula::hidden {

using dynamics::Kind;

/// Kinds by name, so that one which the build does not know yet can be spoken of. True for those that the
/// virtual machine can be.
constexpr bool is_kind(Kind kind, std::string_view name) { return dynamics::info(kind).name == name; }
constexpr bool machine_has(Kind kind) {
  return is_kind(kind, "hopper_linear") || is_kind(kind, "motor_axis") || is_kind(kind, "rotary_joint") ||
         is_kind(kind, "rail_carriage") || is_kind(kind, "clutch_bench");
}

inline constexpr std::size_t kMostValues = 3;
using Values = std::array<double, kMostValues>;

/// A law with its parameters in the order of the table in laws.cpp, which is the contract's.
struct Planted {
  std::string law;
  Values values{};
};

/// What a law needs to show, and so what a machine without the sensors' errors can say about it.
enum class Acts : std::uint8_t {
  on_the_body,       ///< the body moves otherwise for the same commands
  on_the_sensors,    ///< the body moves the same, the log says something else
  outside_catalogue  ///< no effect of the catalogue is it
};

struct LawInfo {
  std::string_view name;
  Acts acts;
  bool hopper, motor_axis, rotary_joint, rail_carriage;    ///< the kinds on which the machine can have it
  std::array<std::string_view, kMostValues> parameters{};  ///< names on a linear axis; empty: none
  bool clutch_bench = false;                               ///< and on the bench (belt.hpp)
  constexpr bool on(Kind kind) const {
    const std::string_view kind_name = dynamics::info(kind).name;
    return kind_name == "hopper_linear"  ? hopper
           : kind_name == "motor_axis"   ? motor_axis
           : kind_name == "rotary_joint" ? rotary_joint
           : kind_name == "clutch_bench" ? clutch_bench
                                         : kind_name == "rail_carriage" && rail_carriage;
  }
};

/// In the order of the contract's table; those outside the catalogue last.
std::span<const LawInfo> laws();
/// Null if there is none of this name.
const LawInfo* law_named(std::string_view name);
/// The parameter's name on an axis of this kind (rotary axes have rotary units in their names); empty: none.
std::string parameter_name(const LawInfo& law, std::size_t index, Kind kind);
/// Whether the catalogue of this build knows the law on this kind, so that a diagnosis could name it.
bool can_be_named(std::string_view law, Kind kind);
/// True for the names that can_be_named() gives, and for causes outside of the catalogue where the machine
/// has them.
bool can_be_planted(std::string_view law, Kind kind);

/// The values of a law in a set of planted ones; null if it is not there.
const Values* find(const std::vector<Planted>& planted, std::string_view law);

}  // namespace furcula::hidden
