#include "host/gait/machine.hpp"

#include <numbers>

namespace furcula::gait {

Machine spear(LegSpring spring) {
  Machine m;
  m.leg = {6.71,
           2.43,
           0.73,
           0.06,
           0.02,
           0.320,
           0.327,
           0.092,
           0.097,
           0.31,
           0.06,
           60.67,
           61.0 * std::numbers::pi / 180.0,
           9.81};
  m.spring = spring;
  m.motors = {60.0, 20.0, 0.0414, 0.72, 0.0, 0.0};
  return m;
}

}  // namespace furcula::gait
