// Document 002, "Design and experimental verification of a clutched parallel elastic actuation mechanism for
// legged locomotion": every number that can be computed, beside what is printed.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "host/bench/release_catch.hpp"
#include "host/energy/study.hpp"
#include "host/reproduce/comparison.hpp"
#include "host/reproduce/examples.hpp"
#include "host/reproduce/identification_rows.hpp"
#include "host/reproduce/omissions.hpp"

namespace furcula::reproduce {

struct Options {
  std::uint64_t seed = 1;  ///< of the rig that is identified
  unsigned threads = 1;
  std::function<void(double fraction, std::string_view doing)> progress;
};

struct Reproduction {
  Options options;
  Trajectory example, example_with_losses, linear_stride, nonlinear_stride;  ///< Fig. 3.4, 3.5, 3.7
  IdentificationStudy study;                                                 ///< Fig. 4.9 to 4.20
  double switched_s = 0.0;                           ///< wall time of the switched studies
  bench::ReleaseCatch release_catch;                 ///< Fig. 5.6
  std::vector<double> contraction_m, spring_work_j;  ///< Fig. 5.10a
  energy::Study energy;                              ///< Fig. 5.10b, 5.11
  double energy_s = 0.0;                             ///< wall time of `energy`
  std::vector<Row> rows;
  std::vector<Omission> omissions;
};

/// Table 3.1 and the strides that it gives, which are written to `linear` and `nonlinear`.
std::vector<Row> table_3_1_rows(const dynamics::HopperNonlinearParameters<double>& table, Trajectory& linear,
                                Trajectory& nonlinear);

/// The same for any number of threads, but for the times.
Reproduction reproduce_002(const Options& options);

}  // namespace furcula::reproduce
