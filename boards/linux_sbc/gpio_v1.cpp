// The lines on libgpiod's version 1 (Debian 12 has 1.6), see gpio.hpp.
#include <fcntl.h>
#include <gpiod.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "boards/linux_sbc/gpio.hpp"

namespace furcula::linux_sbc {
namespace {

constexpr const char* kConsumer = "furculad";

struct CloseChip {
  void operator()(gpiod_chip* chip) const { ::gpiod_chip_close(chip); }  // its lines are given back with it
};
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

std::string last_error() { return std::generic_category().message(errno); }

Chip open_chip(const GpioLine& wanted) {
  Chip chip(::gpiod_chip_open_lookup(wanted.chip.c_str()));
  if (!chip)
    throw GpioError("GPIO chip '" + wanted.chip + "' cannot be opened: " + last_error() +
                    "; gpiodetect lists what is there");
  return chip;
}

gpiod_line* find_line(gpiod_chip* chip, const GpioLine& wanted) {
  gpiod_line* line = ::gpiod_chip_find_line(chip, wanted.line.c_str());
  if (line == nullptr && wanted.line.find_first_not_of("0123456789") == std::string::npos &&
      wanted.line.size() < 5)
    line = ::gpiod_chip_get_line(chip, static_cast<unsigned>(std::stoul(wanted.line)));
  if (line == nullptr)
    throw GpioError("GPIO chip '" + wanted.chip + "' has no line '" + wanted.line +
                    "'; gpioinfo lists those that it has");
  return line;
}

[[noreturn]] void refused(const GpioLine& wanted, const char* as) {
  throw GpioError("GPIO line '" + wanted.line + "' of '" + wanted.chip + "' is not to be had as " + as +
                  ": " + last_error() + "; gpioinfo tells who has it");
}

}  // namespace

struct Gpio::Lines {
  Chip contact_chip, solenoid_chip;
  gpiod_line* contact = nullptr;
  gpiod_line* solenoid = nullptr;
  int events = -1;
};

Gpio::Gpio(const GpioLine& contact, const GpioLine* solenoid) : lines_(std::make_unique<Lines>()) {
  lines_->contact_chip = open_chip(contact);
  lines_->contact = find_line(lines_->contact_chip.get(), contact);
  const int contact_flags = contact.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  if (::gpiod_line_request_both_edges_events_flags(lines_->contact, kConsumer, contact_flags) != 0)
    refused(contact, "an input with edges");
  lines_->events = ::gpiod_line_event_get_fd(lines_->contact);
  ::fcntl(lines_->events, F_SETFL, ::fcntl(lines_->events, F_GETFL) | O_NONBLOCK);
  reading_.closed = ::gpiod_line_get_value(lines_->contact) == 1;
  if (solenoid == nullptr) return;
  lines_->solenoid_chip = open_chip(*solenoid);
  lines_->solenoid = find_line(lines_->solenoid_chip.get(), *solenoid);
  const int solenoid_flags = solenoid->active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  if (::gpiod_line_request_output_flags(lines_->solenoid, kConsumer, solenoid_flags, 0) != 0)
    refused(*solenoid, "an output");
}

Gpio::~Gpio() { static_cast<void>(set_solenoid(false)); }

SwitchReading Gpio::read_switch() {
  std::array<gpiod_line_event, 16> events;  // as many as the kernel keeps for a line
  const int n = ::gpiod_line_event_read_fd_multiple(lines_->events, events.data(), events.size());
  reading_.edges = n > 0 ? static_cast<std::uint32_t>(n) : 0;
  if (n > 0) {
    const timespec& last = events[static_cast<std::size_t>(n) - 1].ts;
    reading_.last_edge_ns = std::int64_t{1'000'000'000} * last.tv_sec + last.tv_nsec;
    // Asked anew, because a switch that chatters loses edges in the kernel's queue.
    const int value = ::gpiod_line_get_value(lines_->contact);
    reading_.ok = value >= 0;
    if (value >= 0) reading_.closed = value == 1;
  } else if (n < 0 && errno != EAGAIN) {
    reading_.ok = false;
  }
  return reading_;
}

bool Gpio::set_solenoid(bool on) {
  if (lines_->solenoid == nullptr || on == solenoid_on_) return true;
  if (::gpiod_line_set_value(lines_->solenoid, on ? 1 : 0) != 0) return false;
  solenoid_on_ = on;
  return true;
}

}  // namespace furcula::linux_sbc
