// The other end of a simulated GPIO chip's lines (the kernel's gpio-sim): its sysfs attributes.
#pragma once

#include <string>

namespace furcula::rig {

struct GpioBank {
  std::string folder;  ///< in sysfs
  std::string chip;    ///< the same in /dev
};
/// The bank that tests/hil/run makes: `configuration` is its folder in configfs. @throws RigError: there is
/// none.
GpioBank find_gpio_bank(const std::string& configuration = "/sys/kernel/config/gpio-sim/furcula");

/// Line 0 is the contact switch, line 1 the solenoid.
class GpioSim {
 public:
  /// `folder`: that of the bank, with sim_gpio0 and sim_gpio1 in it. @throws RigError.
  explicit GpioSim(const std::string& folder);
  ~GpioSim();
  GpioSim(const GpioSim&) = delete;
  GpioSim& operator=(const GpioSim&) = delete;

  /// @throws RigError.
  void set_contact(bool closed);
  bool solenoid() const;

 private:
  int contact_ = -1, solenoid_ = -1;
  bool closed_ = false;
};

}  // namespace furcula::rig
