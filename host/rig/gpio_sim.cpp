// gpio-sim, see gpio_sim.hpp.
#include "host/rig/gpio_sim.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "host/rig/rig.hpp"

namespace furcula::rig {
namespace {

int open_attribute(const std::string& path, int flags) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  if (fd < 0)
    throw RigError(path + ": " + std::generic_category().message(errno) +
                   "; expected a bank of gpio-sim with two lines (scripts/hil makes one)");
  return fd;
}

}  // namespace

GpioBank find_gpio_bank(const std::string& configuration) {
  const auto read = [&](const char* attribute) {
    std::string word;
    if (!(std::ifstream(configuration + attribute) >> word))
      throw RigError("no bank of gpio-sim at " + configuration +
                     "; scripts/hil sets it up, or runs what needs it in a small kernel that has it");
    return word;
  };
  const std::string chip = read("/bank0/chip_name");
  return {"/sys/devices/platform/" + read("/dev_name") + "/" + chip, "/dev/" + chip};
}

GpioSim::GpioSim(const std::string& folder)
    : contact_(open_attribute(folder + "/sim_gpio0/pull", O_WRONLY)),
      solenoid_(open_attribute(folder + "/sim_gpio1/value", O_RDONLY)) {
  closed_ = true;
  set_contact(false);
}

GpioSim::~GpioSim() {
  ::close(contact_);
  ::close(solenoid_);
}

void GpioSim::set_contact(bool closed) {
  if (closed == closed_) return;
  const char* const word = closed ? "pull-up" : "pull-down";
  const auto size = static_cast<ssize_t>(std::strlen(word));
  if (::pwrite(contact_, word, static_cast<std::size_t>(size), 0) != size)
    throw RigError("the switch's line cannot be pulled: " + std::generic_category().message(errno));
  closed_ = closed;
}

bool GpioSim::solenoid() const {
  char value = '0';
  if (::pread(solenoid_, &value, 1, 0) != 1)
    throw RigError("the solenoid's line cannot be read: " + std::generic_category().message(errno));
  return value == '1';
}

}  // namespace furcula::rig
