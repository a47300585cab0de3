// Which other set is likelier than the chosen one, and takes its place.
#pragma once

#include "host/diagnose/search_state.hpp"

namespace furcula::diagnose {

/// What each member is worth (s.without), and which sets do as well in its place (s.equals); one that is likelier takes its place.
void exchange(SearchState& s);

}  // namespace furcula::diagnose
