// The linear test of all candidates at once: what each would gain, and whether windows and recordings agree on it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "host/trees/candidates.hpp"

namespace furcula::trees {

/// Of the residuals that there are, what is less is not worth a name.
inline constexpr double kWorth = 0.004;

/// How well the recordings must agree on a cause (steadiness) by the number of its parameters: each is another way to suit a few of them.
/// Quarters of a single recording say less than recordings do.
double agreement(std::size_t parameters, const Problem& problem);

/// The linear problem at a hypothesis: a column for each unknown that is fitted already, and for each candidate's probes.
class ScoreTest {
 public:
  using Columns = std::vector<Eigen::Index>;

  /// `added` are hypotheses that residuals can be seen from (seen_from).
  ScoreTest(const Problem& problem, const Hypothesis& h, const std::vector<Unknown>& unknowns,
            std::vector<Candidate> candidates, const std::vector<Hypothesis>& added = {});

  /// The same problem with the residuals that there are where one of the added hypotheses is true of the model.
  ScoreTest seen_from(std::size_t added) const;

  struct Score {
    std::size_t candidate = 0;
    double gain = 0.0;   ///< of the loss
    double worth = 0.0;  ///< gain less what a cause without effect would gain
    Eigen::VectorXd coefficients;
  };
  /// What each candidate would gain on top of the columns `base`, best first.
  std::vector<Score> gains(const Columns& base) const;
  /// Of these, `most` that hold on windows and recordings, by their worth.
  /// `alike`: what the best of those gains that the windows are sure of, whether or not the recordings agree on it, of the loss.
  std::vector<Score> scores(const Columns& base, std::size_t most, double* alike = nullptr) const;

  /// Candidates that change the motion as the cause does that an added hypothesis leaves out: by a share of more than `least` of the
  /// squares of what that changes, `base` fitted beside both. Best first, the share as their gain.
  std::vector<Score> in_place_of(std::size_t added, const Columns& base, double least) const;

  const std::vector<Candidate>& candidates() const { return candidates_; }
  double loss() const { return products_.all(0, 0); }
  Columns columns_of(std::size_t candidate) const;
  const Columns& fitted() const { return fitted_; }  ///< of the unknowns, 1 and their number, that are free

 private:
  struct OnFolds {
    double kept;    ///< of the gain
    double worse;   ///< share of the folds that lose
    double steady;  ///< how well they agree on its size (steadiness)
  };
  double loss_of(const Columns& base) const;  ///< once these are fitted
  double sureness(const Columns& base, const Score& s) const;
  double worse_of_one_size(Eigen::Index column) const;
  OnFolds on_folds(const Columns& base, const Score& s) const;
  OnFolds on_folds(const std::vector<Eigen::MatrixXd>& parts, const Columns& base, const Score& s) const;
  /// Products of a recording's windows, by quarters.
  std::vector<Eigen::MatrixXd> quarters_of(std::size_t recording) const;
  void one_size(const Eigen::MatrixXd& fold, const Columns& base, const Score& s, std::vector<double>& size,
                std::vector<double>& information) const;

  const Problem& problem_;
  std::vector<Candidate> candidates_;
  bool first_;                        ///< the hypothesis has no cause yet
  std::vector<Eigen::Index> column_;  ///< first column of each candidate
  Eigen::Index added_ = 0;
  Columns fitted_;
  Products products_;
};

}  // namespace furcula::trees
