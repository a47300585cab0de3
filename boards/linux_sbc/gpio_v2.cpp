// The lines on libgpiod's version 2, see gpio.hpp.
#include <fcntl.h>
#include <gpiod.h>

#include <cerrno>
#include <system_error>

#include "boards/linux_sbc/gpio.hpp"

namespace furcula::linux_sbc {
namespace {

constexpr const char* kConsumer = "furculad";
constexpr std::size_t kEvents = 16;  // as many as the kernel keeps for a line

template <auto close>
struct Close {
  template <class T>
  void operator()(T* object) const {
    close(object);
  }
};
using Chip = std::unique_ptr<gpiod_chip, Close<gpiod_chip_close>>;
using Settings = std::unique_ptr<gpiod_line_settings, Close<gpiod_line_settings_free>>;
using LineConfig = std::unique_ptr<gpiod_line_config, Close<gpiod_line_config_free>>;
using RequestConfig = std::unique_ptr<gpiod_request_config, Close<gpiod_request_config_free>>;
using Request = std::unique_ptr<gpiod_line_request, Close<gpiod_line_request_release>>;
using Events = std::unique_ptr<gpiod_edge_event_buffer, Close<gpiod_edge_event_buffer_free>>;

std::string last_error() { return std::generic_category().message(errno); }

/// Version 2 opens paths alone: a name or a number stands for /dev/NAME or /dev/gpiochipNUMBER.
Chip open_chip(const GpioLine& wanted) {
  std::string path = wanted.chip;
  if (path.find_first_not_of("0123456789") == std::string::npos) path = "gpiochip" + path;
  if (path.find('/') == std::string::npos) path = "/dev/" + path;
  Chip chip(::gpiod_chip_open(path.c_str()));
  if (!chip)
    throw GpioError("GPIO chip '" + wanted.chip + "' cannot be opened: " + last_error() +
                    "; gpiodetect lists what is there");
  return chip;
}

unsigned find_line(gpiod_chip* chip, const GpioLine& wanted) {
  int offset = ::gpiod_chip_get_line_offset_from_name(chip, wanted.line.c_str());
  if (offset < 0 && wanted.line.find_first_not_of("0123456789") == std::string::npos &&
      wanted.line.size() < 5)
    offset = std::stoi(wanted.line);
  if (offset < 0)
    throw GpioError("GPIO chip '" + wanted.chip + "' has no line '" + wanted.line +
                    "'; gpioinfo lists those that it has");
  return static_cast<unsigned>(offset);
}

Request request(const GpioLine& wanted, unsigned& offset, bool output) {
  const Chip chip = open_chip(wanted);
  offset = find_line(chip.get(), wanted);
  const Settings settings(::gpiod_line_settings_new());
  ::gpiod_line_settings_set_active_low(settings.get(), wanted.active_low);
  ::gpiod_line_settings_set_direction(settings.get(),
                                      output ? GPIOD_LINE_DIRECTION_OUTPUT : GPIOD_LINE_DIRECTION_INPUT);
  if (output)
    ::gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE);
  else
    ::gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
  const LineConfig lines(::gpiod_line_config_new());
  ::gpiod_line_config_add_line_settings(lines.get(), &offset, 1, settings.get());
  const RequestConfig config(::gpiod_request_config_new());
  ::gpiod_request_config_set_consumer(config.get(), kConsumer);
  Request made(::gpiod_chip_request_lines(chip.get(), config.get(), lines.get()));
  if (!made)
    throw GpioError("GPIO line '" + wanted.line + "' of '" + wanted.chip + "' is not to be had as " +
                    (output ? "an output" : "an input with edges") + ": " + last_error() +
                    "; gpioinfo tells who has it");
  return made;
}

}  // namespace

struct Gpio::Lines {
  Request contact, solenoid;
  unsigned contact_offset = 0, solenoid_offset = 0;
  Events events{::gpiod_edge_event_buffer_new(kEvents)};
};

Gpio::Gpio(const GpioLine& contact, const GpioLine* solenoid) : lines_(std::make_unique<Lines>()) {
  lines_->contact = request(contact, lines_->contact_offset, false);
  const int fd = ::gpiod_line_request_get_fd(lines_->contact.get());
  ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
  reading_.closed = ::gpiod_line_request_get_value(lines_->contact.get(), lines_->contact_offset) ==
                    GPIOD_LINE_VALUE_ACTIVE;
  if (solenoid != nullptr) lines_->solenoid = request(*solenoid, lines_->solenoid_offset, true);
}

Gpio::~Gpio() { static_cast<void>(set_solenoid(false)); }

SwitchReading Gpio::read_switch() {
  const int n = ::gpiod_line_request_read_edge_events(lines_->contact.get(), lines_->events.get(), kEvents);
  reading_.edges = n > 0 ? static_cast<std::uint32_t>(n) : 0;
  if (n > 0) {
    gpiod_edge_event* const last =
        ::gpiod_edge_event_buffer_get_event(lines_->events.get(), static_cast<unsigned long>(n) - 1);
    reading_.last_edge_ns = static_cast<std::int64_t>(::gpiod_edge_event_get_timestamp_ns(last));
    // Asked anew, because a switch that chatters loses edges in the kernel's queue.
    const auto value = ::gpiod_line_request_get_value(lines_->contact.get(), lines_->contact_offset);
    reading_.ok = value != GPIOD_LINE_VALUE_ERROR;
    if (reading_.ok) reading_.closed = value == GPIOD_LINE_VALUE_ACTIVE;
  } else if (n < 0 && errno != EAGAIN) {
    reading_.ok = false;
  }
  return reading_;
}

bool Gpio::set_solenoid(bool on) {
  if (!lines_->solenoid || on == solenoid_on_) return true;
  const auto value = on ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  if (::gpiod_line_request_set_value(lines_->solenoid.get(), lines_->solenoid_offset, value) != 0)
    return false;
  solenoid_on_ = on;
  return true;
}

}  // namespace furcula::linux_sbc
