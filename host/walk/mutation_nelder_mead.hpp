// Mutation and Nelder-Mead in turns, as document 000's section III names them; how they are joined, and every number, is chosen here.
//
// Mutation: 32 walks a generation about the best, each with some coordinates changed. Where it gains nothing more a simplex is laid about
// the best and descends by the method of Nelder and Mead (1965), in the parallel form of Lee and Wiswall (2007): the worst
// third of its corners moves at once, each against the centre of the others. Where that gains nothing more mutation goes on from the best.
#pragma once

#include "host/walk/method.hpp"

namespace furcula::walk {

class MutationNelderMead final : public Method {
 public:
  MutationNelderMead(Vector least, Vector most, std::uint64_t seed);

  const std::vector<Vector>& ask() override { return points_; }
  void tell(std::span<const double> values, const Vector& best) override;
  /// How often mutation began again.
  unsigned restarts() const override { return restarts_; }
  std::string state() const override;
  void restore(const std::string& state) override;

 private:
  struct Corner {
    Vector x;
    double value;
  };
  enum class Phase : std::uint8_t { mutation, lay, reflection, second, shrinking };
  /// What a reflected corner asks for.
  enum class Next : std::uint8_t { expansion, nothing, contraction };

  void mutate();
  void told_of_mutation(std::span<const double> values);
  void lay();
  void reflect();
  void told_of_reflection(std::span<const double> values);
  void told_of_second(std::span<const double> values);
  void shrink();
  /// A move of the simplex is done.
  void moved();

  Next next_of(std::size_t corner) const;
  std::size_t moving() const { return simplex_.size() / 3; }
  std::size_t first_moving() const { return simplex_.size() - reflected_.size(); }
  Vector centre() const;
  bool gains();

  Vector least_, most_;
  std::uint64_t seed_, drawn_ = 0;
  Phase phase_ = Phase::mutation;
  std::vector<Vector> points_;
  Corner best_;
  double scale_, last_better_;
  unsigned waited_ = 0, restarts_ = 0;
  std::vector<Corner> simplex_;    ///< the best first
  std::vector<Corner> reflected_;  ///< of its last corners
};

}  // namespace furcula::walk
