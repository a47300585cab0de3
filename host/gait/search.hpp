// Looks for the cheapest gait of a task: many starts, each its own optimum, checked by an independent integrator; and
// says what stands against it where there is none.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/gait/gait.hpp"

namespace furcula::gait {

struct Query {
  Machine machine;
  Task task;
  bool fourier = false;  ///< else free torques
  unsigned starts = 3;
  std::uint64_t seed = 1;
  unsigned processes = 1;        ///< changes nothing but the time
  bool explains = true;          ///< where none is found, the nearest task that has one is sought
  std::optional<FreeGait> from;  ///< a gait of a similar task, taken as the only start
  std::function<void(double fraction, std::string_view doing)> progress;
};

/// A local optimum: its cost (J in place, else of transport) and how many starts ended there.
struct Optimum {
  double cost = 0.0;
  unsigned starts = 0;
};

struct Search {
  std::optional<Gait> gait;
  Evaluation evaluation;
  FreeGait free;  ///< of the gait, or what it was fitted to
  std::vector<Optimum> optima;
  unsigned without = 0;  ///< starts that found none
  std::string refusal;   ///< where none was found: why, and the nearest task that has one
  double seconds = 0.0;
};

/// The same for any number of processes, but for the time.
Search find_gait(const Query& query);

}  // namespace furcula::gait
