// A touch-down or a lift-off.
#pragma once

namespace furcula::dynamics {

/// A touch-down or a lift-off inside a step.
template <class V>
struct ContactEvent {
  /// What happened.
  enum class Kind { touchdown, liftoff } kind;  ///< what happened
  V offset_s;                                   ///< time since the start of the advance()
  V velocity_before_mps;                        ///< of the body just before, positive upwards
  V velocity_after_mps;  ///< of the body just after the impact or the loss, positive upwards
};

}  // namespace furcula::dynamics
