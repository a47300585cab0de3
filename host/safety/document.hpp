// Writes docs/safety.md from the table of faults and what the simulated robot did.
#pragma once

#include <string>

namespace furcula::safety {

/// Tries every row at every moment of the stride (a few seconds) and puts the ticks into the page.
std::string to_markdown();

}  // namespace furcula::safety
