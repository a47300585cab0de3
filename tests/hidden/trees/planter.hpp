// Where a cause sits and how large it is, from what the robot does without it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/hidden/trees/stage.hpp"

namespace furcula::hidden::trees {

/// Of a joint's rms torque: least and most that a tier's causes take.
std::pair<double, double> shares(Tier tier);

class Planter {
 public:
  Planter(const Stage& stage, Random& random) : stage_(stage), c_(stage.c), base_(stage.base), r_(random) {}

  /// An effect at a seat that is free of `others`, of a share of the rms torque. Nothing where it cannot be.
  std::optional<Cause> propose(const std::string& effect, double share, bool tied,
                               const std::vector<Cause>& others);

 private:
  double mean(const std::vector<std::size_t>& joints, const Values& of) const;
  bool taken(const std::string& effect, const std::string& at, const std::vector<Cause>& others) const;
  bool at_joints(Cause& cause, const std::vector<std::size_t>& joints, double share);
  Values dampings() const;
  /// The largest share of a joint's rms torque that a change of masses, of gravity or of an encoder makes.
  double share_of(const Cause& cause) const;
  /// The cause of size x <= most whose share is the one asked for.
  std::optional<Cause> scaled(double share, double most, const std::function<Cause(double)>& make) const;
  std::optional<Cause> on_a_link(Cause cause, double share, const std::vector<Cause>& others);

  // Of a leg, in leg_planter.cpp.
  std::optional<Cause> in_a_leg(const std::string& effect, double share, const std::vector<Cause>& others);
  /// Sized by its effect, not by a torque.
  Cause sized(Cause cause, double share);
  std::optional<Cause> law_of_a_leg(Cause cause, double share);
  std::optional<Cause> on_a_legs_link(Cause cause, double share, const std::vector<Cause>& others);
  double share_in_a_leg(const Machine& changed, const Machine& plain) const;
  /// Delay or time constant that changes a leg's command by this torque, rms.
  double leg_timing_s(std::size_t joint, bool lag, double torque_nm) const;

  const Stage& stage_;
  const Case& c_;
  const Baseline& base_;
  Random& r_;
};

}  // namespace furcula::hidden::trees
