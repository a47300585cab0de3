// A run and others beside it, in SIMD lanes: of nearly equal trees, or from nearly equal states. Derivatives are differences between lanes.
// A shared library, built for several kinds of x86-64 (furcula_lanes in host/CMakeLists.txt): no Eigen here, whose types depend on the
// processor.
#pragma once

#include <memory>
#include <span>

#include "host/trees/run.hpp"

namespace furcula::trees {

class BatchRunner {
 public:
  static constexpr std::size_t kLanes = 8, kMostJoints = 12, kStep = 2;

  /// Whether `other` may run beside `first`: with the same laws, none of them in one alone, the same geometry and delays.
  static bool fits(const Setup& first, const Setup& other);
  /// `setups`, of one phase each, at most kLanes: the first leads. `starts`: of each, where it begins.
  BatchRunner(std::span<const Setup* const> setups, std::span<const Runner::Place> starts);
  BatchRunner(const BatchRunner&) = delete;
  BatchRunner& operator=(const BatchRunner&) = delete;
  ~BatchRunner();

  /// Puts each lane where its place is; the step of integration stays that of the starts.
  void go_to(std::span<const Runner::Place> places);
  Runner::Place place(std::size_t lane) const;
  void disturb(std::size_t lane, std::size_t joint, double torque_nm);
  /// With one input for each joint in all lanes.
  void advance(std::span<const double> input, double dt_s);
  /// With inputs for the lanes that there are: those of the first one's joints, then those of the next.
  void advance_each(std::span<const double> inputs, double dt_s);
  double measured(std::size_t lane, std::size_t joint) const;
  /// Of integration, as many of one run as would have taken as long: a step of all lanes is kStep.
  std::size_t steps() const;

 private:
  struct Lanes;
  std::unique_ptr<Lanes> lanes_;
};

}  // namespace furcula::trees
