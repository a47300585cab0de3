// Which elements and attributes MJCF has, where the dynamics depend on them: another name is a mistake in the file, and MuJoCo refuses it, too.
#pragma once

#include "host/model/mjcf_document.hpp"

namespace furcula::model {

/// @throws core::DataError with file, line, element and the nearest name: an element or attribute that no version of MuJoCo has.
void check_mjcf_names(const MjcfElement& root);

}  // namespace furcula::model
