// furculad: the application on a Linux computer as a service.
#pragma once

#include <string>

#include "boards/linux_sbc/configuration.hpp"

namespace furcula::linux_sbc {

/// Runs until SIGTERM or SIGINT, then leaves the drive off and the coil without current. Figures of the loop
/// go to stdout on SIGUSR1 and at the end, warnings to stderr. @throws CanError, GpioError, log::DataError
/// (Modbus), std::system_error before it has begun.
void run_daemon(const Configuration& configuration);

}  // namespace furcula::linux_sbc
