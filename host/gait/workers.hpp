// Independent jobs in processes of their own: MUMPS, Ipopt's linear solver, keeps its state in globals and cannot run
// on two threads.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace furcula::gait {

/// A job's way to tell how it goes, on one line.
using Tell = std::function<void(std::string_view)>;

/// job(i, tell) for i below `count`, on up to `processes` processes; what they return, in order. With one process or one
/// job nothing is forked. `told(i, line)` is called here. @throws std::runtime_error: a process ended without its result,
/// with what it threw.
std::vector<std::string> in_processes(std::size_t count, unsigned processes,
                                      const std::function<std::string(std::size_t, const Tell&)>& job,
                                      const std::function<void(std::size_t, std::string_view)>& told);

}  // namespace furcula::gait
