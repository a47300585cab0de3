// Which signals furculad knows, and what each asks for.
#pragma once

#include <csignal>
#include <ctime>

namespace furcula::linux_sbc {

/// Each signal that would end or stop a program ends this one as SIGTERM does, with the drive off: a terminal that is
/// closed (SIGHUP), a reader of its output that went (SIGPIPE) or Ctrl-Z (SIGTSTP) would otherwise leave the motor to the
/// drive's own watchdog, and the coil as it is. These are left to the kernel: the program's own errors, after which
/// nothing of it can be trusted, and what ends nothing. SIGKILL and SIGSTOP cannot be kept from it.
inline constexpr int kOfTheKernel[] = {SIGSEGV, SIGBUS,  SIGFPE,  SIGILL, SIGTRAP, SIGABRT,
                                       SIGSYS,  SIGCHLD, SIGCONT, SIGURG, SIGWINCH};
inline constexpr int kFiguresSignal = SIGUSR1;

class Signals {
 public:
  enum class Asks { nothing, figures, end };

  /// To be called before the other threads begin, which inherit that these signals wait for wait().
  Signals() {
    ::sigfillset(&set_);
    for (const int signal : kOfTheKernel) ::sigdelset(&set_, signal);
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
