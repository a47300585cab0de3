// Laws that hold others, or that undo others in part: said in the words that a reader expects.
#pragma once

#include "host/diagnose/search_state.hpp"

namespace furcula::diagnose {

/// A friction of two sizes of which one is below zero would push. It is friction and a constant force: named
/// so (docs/contracts.md, section 3).
void put_friction_that_pushes_otherwise(SearchState& s);

/// Friction and a constant force are one law with a friction of two sizes, which is added to the equals: up = size - force, down = size + force.
void add_friction_of_two_sizes(SearchState& s);

/// A log's rows may hold the state after their input has acted: then they are early by one, and a position that is early by less is
/// late, as by a lag of the drive (of which neither a contact switch nor the drive's report tells). That is added to the equals.
void add_drive_behind_early_rows(SearchState& s);

}  // namespace furcula::diagnose
