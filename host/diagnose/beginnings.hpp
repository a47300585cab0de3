// What growing cause by cause may have missed: it can only begin with the cause that removes most alone.
#pragma once

#include "host/diagnose/search_state.hpp"

namespace furcula::diagnose {

/// One cause that explains as much as several is the better explanation, even where no step towards it
/// promised so; a law that has one of them as a special case is always asked.
void one_for_several(SearchState& s);

/// The effect that alone removes most may be a compromise between two causes, and one cause alone may
/// remove nothing while another twists the rest: where one or none does not explain the recordings, pairs
/// that begin with others. True if one of them took the place of the chosen set.
bool begin_with_others(SearchState& s);

}  // namespace furcula::diagnose
