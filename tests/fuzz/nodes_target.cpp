// A node of the bus as the command line names it.
#include "host/bus/nodes.hpp"
#include "host/core/error.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  try {
    const bus::Node node = bus::parse_node(input);
    require(!node.name.empty() && node.id >= 1 && node.id <= 31, "a node has a name and an id");
    require(input.starts_with(node.name + "=" + std::string(bus::name_of(node.protocol)) + ":"),
            "name and protocol are what was said");
    require(!bus::messages_of({node}).empty(), "and messages of its own");
    return true;
  } catch (const core::DataError&) {
    return false;
  }
}

}  // namespace furcula::fuzz
