// What makes a thread of a Linux process keep its time: priority, memory that stays, a stack that is there.
#pragma once

#include <cstddef>
#include <string>

namespace furcula::linux_sbc {

/// SCHED_FIFO for the calling thread. @returns empty, or why it stays as it was, for a warning.
std::string run_first_in_first_out(int priority);

/// Locks the process's memory, that which comes later too. @returns empty, or why not, for a warning.
std::string lock_memory();

/// Touches the calling thread's stack, so that using it causes no page fault.
void touch_stack();

inline constexpr std::size_t kThreadStackBytes = 256 * 1024;

/// Starts a thread with a small stack; locked memory would make the usual 8 MiB resident. Blocks no signal:
/// threads inherit the mask. @throws std::system_error. Join with pthread_join.
unsigned long start_thread(void* (*body)(void*), void* argument);

}  // namespace furcula::linux_sbc
