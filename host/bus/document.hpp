// Writes docs/bus.md from the table of messages.
#pragma once

#include <string>

namespace furcula::bus {

std::string to_markdown();

}  // namespace furcula::bus
