// The log reader. The rig is that of the input's `# machine_type:` line, of a bag tree, else the hopper.
#include "host/log/machine_types.hpp"
#include "host/log/reader.hpp"
#include "host/log/writer.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  std::string rig = "hopper";
  for (const log::MachineType& r : log::kMachineTypes)
    if (input.find("# machine_type: " + std::string(r.name) + "\n") != input.npos) rig = r.name;
  if (input.starts_with("\x89MCAP")) rig = "tree";
  log::Log log;
  try {
    log = log::parse_log(input, "input", rig);
  } catch (const core::DataError&) {
    return false;
  }
  const std::string written = log::format_log(log);
  const log::Log again = log::parse_log(written, "input", rig);
  require(again.columns == log.columns, "a written log reads back with the same columns");
  require(log::format_log(again) == written, "a log that was read is written the same");
  return true;
}

}  // namespace furcula::fuzz
