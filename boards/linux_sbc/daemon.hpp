// furculad: the application on a Linux computer as a service.
#pragma once

#include <string>

#include "boards/linux_sbc/configuration.hpp"
#include "furcula/bus/registers.hpp"

namespace furcula::linux_sbc {

/// What this program says of itself on both buses: version and build. `text` keeps the words that it shows.
bus::Identity own_identity(std::string& text);

/// Runs until SIGTERM or SIGINT, then leaves the drive off and the coil without current. Figures of the loop
/// go to stdout on SIGUSR1 and at the end, warnings to stderr. @throws CanError, GpioError, core::DataError
/// (Modbus), std::system_error before it has begun.
void run_daemon(const Configuration& configuration);

}  // namespace furcula::linux_sbc
