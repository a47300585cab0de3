// Units that are not what a column's name says.
#pragma once

#include <vector>

#include "host/identify/windows.hpp"

namespace furcula::identify {

/// @throws core::DataError where the positions of a recording do what the model as given says as degrees (of a linear axis: as
/// millimetres), to within a factor of four, and not as what they are named: more than ten times as much, or nothing alike. A linear
/// machine that nothing drives moves the same in any unit. Hoppers' heights are not looked at: their windows hang on them.
void require_named_unit(const model::Model& model, const std::vector<Recording>& recordings,
                        const std::vector<Window>& windows);

/// Of recordings whose velocity is their position's slope but for a factor: a note that says so, and the slope in its place.
void mend_velocities(std::vector<Recording>& recordings);

}  // namespace furcula::identify
