// ESCH of NLopt (da Silva Santos, Goncalves, Hernandez-Figueroa 2010): 40 parents, 60 offspring a generation by crossover and mutation
// within the ranges, the best 40 of all go on.
//
// NLopt asks for one value after the other. Within a generation no point hangs on a value of it, so that a generation can run at once: to be
// asked for points, NLopt runs again from its beginning with the values that are known, and then through the next generation with none, which
// gives its points. What was asked before must come again to the bit, else the run ends. This takes time with the square of the walks
// (docs/biped.md).
#pragma once

#include "host/walk/method.hpp"

namespace furcula::walk {

class Esch final : public Method {
 public:
  Esch(Vector least, Vector most, std::uint64_t seed);

  const std::vector<Vector>& ask() override;
  void tell(std::span<const double> values, const Vector& best) override;
  unsigned restarts() const override { return 0; }
  std::string state() const override;
  void restore(const std::string& state) override;

 private:
  Vector least_, most_;
  std::uint64_t seed_;
  std::vector<double> values_;  ///< in the order in which NLopt asks for them
  std::uint64_t hash_ = 0;      ///< of the points that these are of
  std::vector<Vector> points_;  ///< of the next generation; empty: not asked yet
};

}  // namespace furcula::walk
