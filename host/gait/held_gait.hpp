// A gait that is played stride after stride from any state at the apex, with or without a feedback in stance.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "host/gait/gait.hpp"
#include "host/gait/held_law.hpp"

namespace furcula::gait {

class HeldGait {
 public:
  /// Without gains the stance has its torques over time alone. @throws core::DataError: the gait makes no stride
  explicit HeldGait(const Gait& gait, const StanceGains& gains = {});
  HeldGait(const HeldGait&) = delete;
  HeldGait& operator=(const HeldGait&) = delete;

  const Gait& gait() const { return gait_; }
  const StanceGains& gains() const { return gains_; }
  void set_gains(const StanceGains& gains) { gains_ = gains; }
  /// The gait's own.
  Apex<double> apex() const;
  /// The angles over the gait's stance, by the time since touch-down.
  const PathPieces& stance_path() const { return path_; }

  StrideEnd<double> stride(const Apex<double>& from, const StrideOptions& options) const;
  /// Of the return map at the gait's apex, largest first; empty where it has no derivatives.
  std::vector<std::complex<double>> multipliers() const;

  /// f(law) with the law of torques, feedback included; law.motors(phase, time, middle, angle, rate).
  template <class F>
  auto with_law(const F& f) const {
    if (free_) return f(HeldLaw<FreeLaw>(*free_, path_, gains_));
    return f(HeldLaw<FourierLaw<double>>(*fourier_, path_, gains_));
  }

 private:
  Gait gait_;
  StanceGains gains_;
  std::optional<FreeLaw> free_;
  std::optional<FourierLaw<double>> fourier_;
  PathPieces path_;
};

}  // namespace furcula::gait
