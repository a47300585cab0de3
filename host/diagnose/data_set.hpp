// The recordings that a diagnosis is made of, and the windows that they are predicted over.
#pragma once

#include <cstddef>
#include <vector>

#include "host/identify/recording.hpp"
#include "host/identify/windows.hpp"
#include "host/log/clean.hpp"
#include "host/log/log.hpp"
#include "host/model/model.hpp"

namespace furcula::diagnose {

class DataSet {
 public:
  /// Recordings of both lists of logs, without the rows that their neighbours refute, or runs of the re-fitted model. Inputs are held from
  /// row to row. `window_s`: length of a prediction on axes without strides. Model and logs must outlive it.
  /// @throws core::DataError where the logs hold no window to predict over, or nothing plausible.
  DataSet(const model::Model& model, const std::vector<log::Log>& training,
          const std::vector<log::Log>& held_out, double window_s, unsigned threads);

  /// The same logs, without the same rows, with inputs that act by so much of a row earlier than they stand there (identify::take_earlier()).
  DataSet with_inputs(double early_rows) const;
  double early_rows() const { return early_rows_; }

  const std::vector<identify::Recording>& training() const { return training_; }
  const std::vector<identify::Recording>& held_out() const { return held_out_; }
  /// On which fits are made: of long recordings the windows that tell most.
  const identify::TrainingWindows& training_windows() const { return training_windows_; }
  const std::vector<identify::Window>& held_out_windows() const { return held_out_windows_; }
  /// Of the training recordings, before those are chosen that tell most.
  std::size_t all_training_windows() const { return all_training_windows_; }

  /// Training windows that do not overlap.
  std::size_t independent_windows() const {
    return training_windows_.windows.size() / training_windows_.layers;
  }
  /// Too few of these to say how an estimate scatters.
  bool has_few_windows() const;

  /// From now on a training window that leaves more squares than `most` counts as one that leaves as many.
  void bound_squares(double most) { training_windows_.most_squares = most; }

 private:
  using Refuted = std::vector<std::vector<log::Refuted>>;  // rows of each log

  void read();
  std::vector<identify::Recording> recordings_of(const std::vector<log::Log>& logs,
                                                 const Refuted& refuted) const;
  void refuse_by_residuals(unsigned threads);
  void require(const std::vector<identify::Window>& windows,
               const std::vector<identify::Recording>& recordings, const char* what) const;

  const model::Model* model_;
  const std::vector<log::Log>*training_logs_, *held_out_logs_;
  double window_s_;
  double early_rows_ = 0.0;  ///< inputs; 0: held from their rows on
  Refuted refuted_in_training_, refuted_in_held_out_;
  std::vector<identify::Recording> training_, held_out_;
  identify::TrainingWindows training_windows_;
  std::vector<identify::Window> held_out_windows_;
  std::size_t all_training_windows_ = 0;
};

/// Of long recordings' windows as many as a fit is made on.
std::vector<identify::Window> evenly(const std::vector<identify::Window>& all);

/// Whether the machine is a belt, whose falls end on one tooth or another: runs jump with what is fitted.
bool ends_on_teeth(dynamics::Kind kind);

}  // namespace furcula::diagnose
