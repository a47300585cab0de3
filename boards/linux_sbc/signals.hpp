// Which signals furculad knows, and what each asks for.
#pragma once

#include <csignal>
#include <ctime>

namespace furcula::linux_sbc {

/// Each of them ends it as SIGTERM does, with the drive off: a terminal that is closed (SIGHUP) and a reader
/// of its output that went (SIGPIPE) would otherwise kill it, and leave the motor to the drive's own watchdog.
inline constexpr int kEndingSignals[] = {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGPIPE};
inline constexpr int kFiguresSignal = SIGUSR1;

class Signals {
 public:
  enum class Asks { nothing, figures, end };

  /// To be called before the other threads begin, which inherit that these signals wait for wait().
  Signals() {
    ::sigemptyset(&set_);
    for (const int signal : kEndingSignals) ::sigaddset(&set_, signal);
    ::sigaddset(&set_, kFiguresSignal);
    ::pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }

  Asks wait(const timespec& at_most) const {
    const int signal = ::sigtimedwait(&set_, nullptr, &at_most);
    if (signal < 0) return Asks::nothing;
    return signal == kFiguresSignal ? Asks::figures : Asks::end;
  }

 private:
  sigset_t set_{};
};

}  // namespace furcula::linux_sbc
