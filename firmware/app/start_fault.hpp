// A fault that the start found, as lost parameters: reported for a while and never again, however long the board runs.
#pragma once

#include <cstdint>

#include "furcula/control/fault.hpp"

namespace furcula::firmware {

/// Long enough for the node to show it and wait for a reset, and then over, so that the reset clears it.
inline constexpr std::uint32_t kStartFaultTicks = 1500;

class StartFault {
 public:
  void report(control::Fault fault) {
    fault_ = fault;
    ticks_left_ = kStartFaultTicks;
  }
  /// To be called once a tick: the fault, or none.
  control::Fault tick() {
    if (ticks_left_ == 0) return control::Fault::none;
    --ticks_left_;
    return fault_;
  }

 private:
  control::Fault fault_ = control::Fault::none;
  std::uint32_t ticks_left_ = 0;
};

}  // namespace furcula::firmware
