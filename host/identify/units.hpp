// Units that are not what a column's name says.
#pragma once

#include <vector>

#include "host/identify/windows.hpp"

namespace furcula::identify {

/// @throws core::DataError where what a recording's position does, beyond going on as each window began, follows the model as given (but
/// for a factor of up to four) far better as degrees (of a linear axis: as millimetres) than as what it is named, or with the other sign of
/// what drives it: what is left is less than 0.15 of it. What nothing drives, and swings by less than a turn, is not looked at; nor
/// are hoppers' heights, on which their windows hang.
void require_named_unit(const model::Model& model, const std::vector<Recording>& recordings,
                        const std::vector<Window>& windows);

/// Of recordings whose velocity is their position's slope but for a factor: a note that says so, and the slope in its place.
void mend_velocities(std::vector<Recording>& recordings);

}  // namespace furcula::identify
