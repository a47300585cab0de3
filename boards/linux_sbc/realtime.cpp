// Keeping time, see realtime.hpp.
#include "boards/linux_sbc/realtime.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <system_error>

namespace furcula::linux_sbc {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

}  // namespace

std::string run_first_in_first_out(int priority) {
  sched_param wanted{};
  wanted.sched_priority = priority;
  const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &wanted);
  if (error == 0) return {};
  return "no SCHED_FIFO with priority " + std::to_string(priority) + " (" + reason(error) +
         "): the loop runs at the usual priority and will be late under load; LimitRTPRIO= of the service, or CAP_SYS_NICE, "
         "allows it";
}

std::string lock_memory() {
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return {};
  return "memory is not locked (" + reason(errno) +
         "): page faults may make ticks late; LimitMEMLOCK= of the service, or CAP_IPC_LOCK, allows it";
}

void touch_stack() {
  // Half of the stack that start_thread() gives: more than the loop ever uses.
  volatile unsigned char room[kThreadStackBytes / 2];
  for (std::size_t i = 0; i < sizeof(room); i += 1024) room[i] = 0;
}

unsigned long start_thread(void* (*body)(void*), void* argument) {
  pthread_attr_t attributes;
  ::pthread_attr_init(&attributes);
  ::pthread_attr_setstacksize(&attributes, kThreadStackBytes);
  pthread_t thread{};
  const int error = ::pthread_create(&thread, &attributes, body, argument);
  ::pthread_attr_destroy(&attributes);
  if (error != 0) throw std::system_error(error, std::generic_category(), "no thread");
  return thread;
}

}  // namespace furcula::linux_sbc
