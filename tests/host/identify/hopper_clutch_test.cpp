// Hops in which the spring is released and caught in stance: the model with a clutch follows them.
#include <catch2/catch.hpp>

#include "host/identify/identification.hpp"
#include "host/identify/prediction.hpp"
#include "tests/host/identify/clutched_hops.hpp"

using namespace furcula;

TEST_CASE("Mass and damping are identified from hops that release the spring in stance") {
  model::Model truth = test::clutched_model();
  truth.parameters[*dynamics::parameter_index(truth.kind, "mass_kg")] = 1.554;
  truth.parameters[*dynamics::parameter_index(truth.kind, "damping_stance_nspm")] = 6.42;
  const auto found = identify::identify(test::clutched_model(), test::clutched_hops(truth, 6, 1),
                                        test::clutched_hops(truth, 2, 9));
  const auto& e = found.estimations.front();
  for (const auto& p : e.parameters) {
    if (p.name == "mass_kg") CHECK(p.value == Approx(1.554).epsilon(0.01));
    if (p.name == "damping_stance_nspm") CHECK(p.value == Approx(6.42).epsilon(0.03));
  }
  REQUIRE(e.held_out);
  CHECK(e.held_out->at("height").rmse < 1e-3);
}

TEST_CASE("A window finds the travel that its cable was caught with in the recording's past") {
  const model::Model truth = test::clutched_model();
  const auto recordings = identify::make_recordings(test::clutched_hops(truth, 4, 3), truth.kind);
  const auto windows = identify::prediction_windows(recordings, truth, 0.5);
  REQUIRE(windows.size() >= 6);
  const auto starts = identify::start_states(recordings, windows, truth);
  CHECK(identify::prediction_errors(truth, recordings, windows, starts).at("height").rmse < 2e-3);
}
