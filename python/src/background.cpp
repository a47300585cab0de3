#include "python/src/background.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

namespace furcula::python {
namespace {

namespace py = pybind11;

class Shared final : public Teller {
 public:
  void operator()(double fraction, std::string_view doing) override {
    if (cancelled_) throw Cancelled{};
    const std::scoped_lock lock(mutex_);
    fraction_ = fraction;
    doing_ = doing;
    news_ = true;
    changed_.notify_one();
  }
  bool cancelled() const override { return cancelled_; }

  void cancel() { cancelled_ = true; }
  void end() {
    const std::scoped_lock lock(mutex_);
    done_ = true;
    changed_.notify_one();
  }
  struct State {
    bool done, news;
    double fraction;
    std::string doing;
  };
  /// What is new, within so long.
  State wait(std::chrono::milliseconds most) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, most, [this] { return done_ || news_; });
    State out{done_, news_, fraction_, doing_};
    news_ = false;
    return out;
  }

 private:
  std::atomic<bool> cancelled_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false, news_ = false;
  double fraction_ = 0.0;
  std::string doing_;
};

}  // namespace

void in_background(const py::object& progress, const std::function<void(Teller&)>& work) {
  Shared shared;
  std::exception_ptr failure, stopped_by;
  {
    const py::gil_scoped_release release;
    std::jthread worker([&] {
      try {
        work(shared);
      } catch (...) {
        failure = std::current_exception();
      }
      shared.end();
    });
    constexpr std::chrono::milliseconds kLongest{50}, kBetweenCalls{20};
    for (Shared::State state{}; !state.done;) {
      state = shared.wait(kLongest);
      if (stopped_by) continue;
      {
        const py::gil_scoped_acquire acquire;
        try {
          if (PyErr_CheckSignals() != 0) throw py::error_already_set();
          if (state.news && !progress.is_none()) progress(state.fraction, state.doing);
        } catch (...) {
          stopped_by = std::current_exception();
          shared.cancel();
        }
      }
      if (!state.done) std::this_thread::sleep_for(kBetweenCalls);
    }
  }
  if (stopped_by) std::rethrow_exception(stopped_by);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace furcula::python
