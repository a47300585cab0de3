// Parameters within their bounds that once made the robot unsafe, or describe another robot.
#include <catch2/catch.hpp>
#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

#include "host/safety/trial.hpp"

using namespace furcula;
using namespace furcula::safety;
using control::Fault;

namespace {

using Values = std::initializer_list<std::pair<std::string_view, float>>;

Trial hop_with(Values values, double duration_s = 20.0) {
  std::vector<DrawnParameter> parameters;
  for (const auto& [name, value] : values) parameters.push_back({bus::parameter_named(name), value});
  return run_trial(robot(), hopping(duration_s), 3, Rig::on_bus, parameters);
}

constexpr float kConstant = 2.0f, kHarmonic = 1.0f;

}  // namespace

TEST_CASE("a constant torque of 6 N m or more is refused, with its limit or shape it may be written") {
  for (const float nm : {6.0f, 8.0f, 20.0f, -6.0f, -20.0f}) {
    CAPTURE(nm);
    CHECK(hop_with({{"torque_shape", kConstant}, {"torque_amplitude_nm", nm}}).refused);
  }
  CHECK(hop_with({{"torque_shape", kHarmonic}, {"torque_amplitude_nm", 10.0f}}).refused);
  CHECK_FALSE(hop_with({{"torque_shape", 0.0f}, {"torque_amplitude_nm", 20.0f}}, 0.1).refused);
}

TEST_CASE("the most torque that is taken hops below the limits of rail and leg, and goes on hopping") {
  // Without the envelope 5.8 N m came to 0.65 m and 3.2 m/s; the torque is held back at 0.63 m and 2.6 m/s.
  for (const float nm : {5.8f, -5.8f, 4.0f}) {
    CAPTURE(nm);
    const Trial trial = hop_with({{"torque_shape", kConstant}, {"torque_amplitude_nm", nm}});
    CHECK(trial.unsafe == 0);
    CHECK(trial.highest_m < 0.63);
    CHECK(trial.hardest_mps < 2.6);
  }
  for (const float nm : {9.1f, 6.0f, -9.1f}) {
    CAPTURE(nm);
    const Trial trial = hop_with({{"torque_amplitude_nm", nm}});
    CHECK(trial.unsafe == 0);
    CHECK(trial.fault == Fault::none);
    CHECK(trial.hops > 30);
    CHECK(trial.highest_m < 0.63);
    CHECK(trial.hardest_mps < 2.6);
  }
  // 20 N m cut off by the limit of the torque are nearly constant.
  const Trial trial = hop_with({{"torque_amplitude_nm", 20.0f}, {"torque_limit_nm", 9.1f}});
  CHECK(trial.unsafe == 0);
}

TEST_CASE("a spring rate that is far too large makes no runaway of a folding leg, or is refused") {
  // Computed from where the leg was, the pull of 2,100 N/m drove the toe to 4.0 m/s and more; of 8,000 N/m to 4.8 m/s.
  for (const float npm : {900.0f, 1500.0f, 2100.0f, 2900.0f})
    for (const float fitted : {0.0f, 1.0f}) {
      CAPTURE(npm, fitted);
      const Trial trial =
          hop_with({{"spring_npm", npm}, {"clutch_fitted", fitted}, {"contraction_m", 0.08f}}, 5.0);
      CHECK(trial.unsafe == 0);
      CHECK(trial.fastest_toe_mps < 3.0);
    }
  for (const float npm : {3000.0f, 8000.0f, 20000.0f}) CHECK(hop_with({{"spring_npm", npm}}).refused);
}

TEST_CASE("the supervisor's limits, as wide as they may be, do not let the robot higher") {
  const Trial trial = hop_with({{"torque_shape", kConstant},
                                {"torque_amplitude_nm", 5.8f},
                                {"torque_limit_nm", 40.0f},
                                {"torque_rate_limit_nmps", 20000.0f},
                                {"height_min_m", 0.0f},
                                {"height_max_m", 5.0f},
                                {"leg_angle_min_rad", 0.0f},
                                {"leg_angle_max_rad", 1.57f},
                                {"height_mismatch_m", 0.06f},
                                {"contact_margin_m", 0.06f},
                                {"missed_catches_max", 20.0f}});
  CHECK(trial.unsafe == 0);
  CHECK(trial.highest_m < 0.63);
  CHECK(trial.hardest_mps < 2.6);
  CHECK(trial.lowest_m > 0.10);
}

TEST_CASE("parameters of another robot are found within the first hops") {
  const auto found = [](Values values) {
    const Trial trial = hop_with(values, 2.0);  // four hops
    CHECK(trial.unsafe == 0);
    return trial.refused ? Fault::bad_configuration : trial.fault;
  };
  // Heights of half and of twice the size.
  CHECK(found({{"height_metres_per_count", 4.5e-5f}}) != Fault::none);
  CHECK(found({{"height_metres_per_count", 1.8e-4f}}) != Fault::none);
  // All lengths by 0.6, which leaves encoder and leg in agreement: gravity tells.
  CHECK(found({{"height_metres_per_count", 5.4e-5f},
               {"link_length_m", 0.09f},
               {"touchdown_height_m", 0.16914f},
               {"spring_rest_m", 0.1734f}}) != Fault::none);
  CHECK(found({{"link_length_m", 0.12f}}) != Fault::none);
  CHECK(found({{"link_length_m", 0.18f}}) == Fault::parameters_implausible);
  CHECK(found({{"touchdown_height_m", 0.26f}}) == Fault::parameters_implausible);
  CHECK(found({{"touchdown_height_m", 0.35f}}) == Fault::bad_configuration);
  CHECK(found({{"spring_npm", 200.0f}}) == Fault::parameters_implausible);
  CHECK(found({{"spring_npm", 2000.0f}}) == Fault::parameters_implausible);
  // A spring that is not nearly relaxed on a straight leg is refused with the configuration.
  CHECK(found({{"spring_rest_m", 0.36f}}) == Fault::bad_configuration);
  CHECK(found({{"touchdown_height_m", 0.24f}}) == Fault::bad_configuration);
  CHECK(found({{"on_bench", 1.0f}}) == Fault::parameters_implausible);
}

TEST_CASE("parameters that are a little off are borne") {
  for (const float factor : {0.93f, 1.07f}) {
    CAPTURE(factor);
    CHECK(hop_with({{"spring_npm", 600.0f * factor}}).fault == Fault::none);
    CHECK(hop_with({{"leg_inertia_kgm2", 0.003f * factor}}).fault == Fault::none);
  }
  CHECK(hop_with({{"touchdown_height_m", 0.276f}}).fault == Fault::none);
}
