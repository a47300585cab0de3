// The reader of a planar leg's model files.
#include "host/core/error.hpp"
#include "host/gait/machine_file.hpp"
#include "tests/fuzz/message.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  gait::Machine machine;
  try {
    machine = gait::parse_machine(input, "input");
  } catch (const core::DataError& e) {
    require_printable(e);
    return false;
  }
  require(gait::is_planar_leg(input), "a planar leg is told as one");
  const std::string written = gait::format_machine(machine);
  const gait::Machine again = gait::parse_machine(written, "input");
  for (const auto keys : {gait::parameter_keys(), gait::motor_keys(), gait::range_keys()})
    for (const gait::MachineKey& k : keys)
      require(k.value(again) == k.value(machine), "a written model reads back the same");
  require(again.spring == machine.spring && gait::format_machine(again) == written,
          "a model that was read is written the same");
  return true;
}

}  // namespace furcula::fuzz
