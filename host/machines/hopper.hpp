// The hoppers' common measure.
#pragma once

#include "host/model/model.hpp"

namespace furcula::machines {

/// 2 L cos(touch-down angle), m.
double touchdown_height_m(const model::Model& model);

}  // namespace furcula::machines
