// A CAN bus in the simulated rig, and what may go wrong with it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "boards/sim_host/faults.hpp"
#include "furcula/bus/frame.hpp"

namespace furcula::sim_host {

/// One way over the bus. A frame takes no time, but for what is wrong with the bus.
class CanWay {
 public:
  struct Faults {
    bool lost = false, late = false, repeated = false, reordered = false;
  };

  void send(const bus::Frame& frame, std::uint32_t tick, const Faults& faults) {
    if (faults.lost) return;
    std::uint32_t due = tick + (faults.late ? kLateTicks : 0u);
    if (faults.reordered && tick % 2 == 0) ++due;
    for (int copies = faults.repeated ? 2 : 1; copies > 0; --copies)
      on_the_way_.push_back({frame, tick, due});
  }

  /// Those that have come by this tick. Of frames that come together those that were held up come last.
  std::vector<bus::Frame> receive(std::uint32_t tick) {
    std::stable_sort(on_the_way_.begin(), on_the_way_.end(),
                     [](const Transit& a, const Transit& b) { return a.sent > b.sent; });
    std::vector<bus::Frame> come;
    std::erase_if(on_the_way_, [&](const Transit& t) {
      if (t.due <= tick) come.push_back(t.frame);
      return t.due <= tick;
    });
    return come;
  }

 private:
  static constexpr std::uint32_t kLateTicks = 2;
  struct Transit {
    bus::Frame frame;
    std::uint32_t sent, due;
  };
  std::vector<Transit> on_the_way_;
};

}  // namespace furcula::sim_host
