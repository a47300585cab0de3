// The reader of furculad's configuration file.
#include "boards/linux_sbc/configuration.hpp"
#include "furcula/bus/parameters.hpp"
#include "host/core/error.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  try {
    const linux_sbc::Configuration c = linux_sbc::parse_configuration(input, "input");
    require(c.priority >= 0 && c.priority < 100, "a priority");
    if (c.walker) {
      require(firmware::check(c.walker->link) == Status::ok, "a walker's link that makes sense");
      require(!c.walker->walk_file.empty(), "a walk's file");
      require(c.walker->can_interfaces[0] != c.walker->can_interfaces[1], "a bus a leg");
      return true;
    }
    require(firmware::check(c.link) == Status::ok, "a link that makes sense");
    require(control::check(c.controller) == Status::ok, "a controller that makes sense");
    for (const bus::Parameter& p : bus::kParameters)
      require(bus::allows(p, p.get(c.controller)), "parameters within their bounds");
    require(c.modbus_port > 0 && c.modbus_port < 65536, "a port");
    require(!c.contact.chip.empty() && !c.contact.line.empty(), "the switch's line");
    return true;
  } catch (const core::DataError&) {
    return false;
  }
}

}  // namespace furcula::fuzz
