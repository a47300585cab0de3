// Long work beside Python: other threads of the interpreter go on, progress is told on the caller's thread, and Ctrl-C ends the work.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <string_view>

namespace furcula::python {

/// What the work tells, from any thread.
class Teller {
 public:
  virtual ~Teller() = default;
  /// @throws Cancelled where the caller wants no more of it.
  virtual void operator()(double fraction, std::string_view doing) = 0;
  virtual bool cancelled() const = 0;
};

/// Ends the work from within; the caller never sees it.
struct Cancelled {};

/// Runs the work on a thread of its own. This thread calls `progress(fraction, doing)` (None: nothing) and Python's signal handlers; an
/// exception of theirs cancels the work and is thrown. With the GIL held.
void in_background(const pybind11::object& progress, const std::function<void(Teller&)>& work);

}  // namespace furcula::python
