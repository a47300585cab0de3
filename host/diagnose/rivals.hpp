// Sets with other causes in the place of one member of the chosen set, or under its other names.
#pragma once

#include <vector>

#include "host/diagnose/weighing.hpp"

namespace furcula::diagnose {

/// Sets with as many parameters that explain as much as the chosen one, with another effect (or two) in the
/// place of each member. Needs s.without.
std::vector<Selection::Rival> rivals(SearchState& s, const Weighing& w);

}  // namespace furcula::diagnose
