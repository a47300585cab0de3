// Writes docs/modbus.md from the tables of registers, parameters and words.
#pragma once

#include <string>

namespace furcula::bus {

std::string modbus_to_markdown();

}  // namespace furcula::bus
