// Text for a page: escaping, and numbers as a person reads them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/core/markup.hpp"

namespace furcula::report {

using core::escape;

/// JSON text for the inside of a <script> element: no '<', '>' or '&' remains, so it cannot end the element.
std::string inside_script(std::string_view json);

/// "coulomb_friction" as "Coulomb friction".
std::string in_words(std::string_view identifier);

/// With this many significant digits: "1.61", "605", "4.1×10⁻⁵"; a dash if it is not finite.
std::string number(double value, int significant_digits = 3);

/// A share as "94 %", "0.4 %", "< 0.1 %", "> 99 %".
std::string percent(double share);

/// A unit that suits these magnitudes: metres below 0.1 as mm, rad below 0.1 as mrad, m/s below 0.1 as mm/s.
struct Scale {
  double factor;  ///< shown = value * factor
  std::string unit;
};
Scale scale_for(const std::vector<double>& values, std::string_view unit);

}  // namespace furcula::report
