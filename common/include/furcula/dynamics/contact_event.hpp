// A touch-down or a lift-off.
#pragma once

namespace furcula::dynamics {

/// What happened inside a step, and when after its start.
template <class V>
struct ContactEvent {
  enum class Kind { touchdown, liftoff } kind;
  V offset_s;
  V velocity_before_mps;
  V velocity_after_mps;
};

}  // namespace furcula::dynamics
