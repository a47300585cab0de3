// What disturbs a virtual machine in every recording: a random force, impacts that are not all alike, ground that is not flat.
// No cause to be named. Drawn from a number, so that a machine that is run ahead meets the same.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace furcula::hidden {

/// All 0: nothing disturbs.
struct Disturbance {
  double force = 0.0;  ///< root mean square of the random force, N (N m on rotary joint and clutch bench)
  double correlation_s = 0.03;  ///< of it: an Ornstein-Uhlenbeck process
  double restitution = 0.0;     ///< standard deviation of the speed's factor at each touch-down and lift-off
  double ground_m = 0.0;  ///< standard deviation of the ground's height, from one touch-down to the next

  bool any() const { return force > 0.0 || restitution > 0.0 || ground_m > 0.0; }
};

/// One recording's.
class Disturbed {
 public:
  Disturbed() = default;
  Disturbed(const Disturbance& size, std::uint64_t draw);

  double force(double time_s) const;
  double factor(int event) const;    ///< of the speed at that touch-down or lift-off
  double ground_m(int event) const;  ///< under that touch-down

 private:
  Disturbance size_;
  std::uint64_t draw_ = 0;
  std::shared_ptr<const std::vector<double>> force_;  // each kGrid_s
};

}  // namespace furcula::hidden
