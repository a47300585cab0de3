// Tells the service manager how the process is, as systemd's sd_notify(3) does: a datagram to $NOTIFY_SOCKET.
#pragma once

#include <chrono>
#include <string_view>

namespace furcula::linux_sbc {

class ServiceManager {
 public:
  /// Opens what $NOTIFY_SOCKET names; without it all is quiet.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// "READY=1", "WATCHDOG=1", "STOPPING=1", "STATUS=..."; never blocks. false: not sent.
  bool tell(std::string_view state) const;

  /// Half of what $WATCHDOG_USEC allows between two "WATCHDOG=1" (sd_watchdog_enabled(3)); 0: nobody watches.
  std::chrono::microseconds watchdog_period() const { return watchdog_period_; }

 private:
  int fd_ = -1;
  std::chrono::microseconds watchdog_period_{0};
};

}  // namespace furcula::linux_sbc
