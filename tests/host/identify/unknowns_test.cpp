// What a fit moves, and how that becomes a model: the links' inertias, which are fitted in other coordinates.
#include "host/identify/unknowns.hpp"

#include <catch2/catch.hpp>
#include <random>

#include "host/identify/simulation_fit.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using dynamics::Effect;

namespace {

constexpr double kLength_m = 0.15;

/// Point masses on the links: upper ones at `x` from the hip's side, lower ones at `x` from the knee
/// (docs/physics.md).
std::array<double, 3> inertias_of(const std::vector<std::array<double, 2>>& upper,
                                  const std::vector<std::array<double, 2>>& lower) {
  std::array<double, 3> abe{};
  for (const auto& [mass, x] : upper) {
    abe[0] += mass * x * x;
    abe[2] += mass * x;
  }
  for (const auto& [mass, x] : lower) {
    abe[0] += mass * (x * x + kLength_m * kLength_m);
    abe[1] += mass * x;
    abe[2] += mass * (x + kLength_m);
  }
  return abe;
}

}  // namespace

TEST_CASE("Whatever the links are made of, the coordinates of their inertias are not negative") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> mass(0.0, 0.3), place(0.0, kLength_m);
  for (int i = 0; i < 1000; ++i) {
    const auto law = inertias_of({{mass(random), place(random)}, {mass(random), place(random)}},
                                 {{mass(random), place(random)}, {mass(random), place(random)}});
    std::array<double, 3> fitted = law;
    identify::links_from_law(fitted, kLength_m);
    for (double v : fitted) CHECK(v >= -1e-12);
    std::array<double, 3> back = fitted;
    identify::links_to_law(back, kLength_m);
    for (std::size_t k = 0; k < 3; ++k) CHECK(back[k] == Approx(law[k]).margin(1e-12));
  }
}

TEST_CASE("The inertias of the published rig are such that links can have") {
  std::array<double, 3> abe{42e-4, 75e-4, 38e-3};  // 002, table 3.1
  identify::links_from_law(abe, kLength_m);
  CHECK(abe[0] == Approx(0.010));
  CHECK(abe[1] == Approx(0.013));
  CHECK(abe[2] == Approx(0.0075));
}

TEST_CASE("A model keeps the inertias of its links through the vector of unknowns") {
  model::Model model = test::hopper_model();
  model.parameters[*dynamics::parameter_index(model.kind, "link_length_m")] = kLength_m;
  model.effects[Effect::leg_inertia] = {42e-4, 75e-4, 38e-3};
  const auto unknowns = identify::effect_unknowns(Effect::leg_inertia, model.kind);
  const auto values = identify::values_in(model, unknowns);
  const auto back = identify::with_values(model, unknowns, values);
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(back.effects.at(Effect::leg_inertia)[k] == Approx(model.effects.at(Effect::leg_inertia)[k]));
  const identify::PlantSetup<double> setup(model, unknowns, values.data());
  const dynamics::EffectsOf<double, dynamics::Stage::mechanism> effects(setup.effects);
  CHECK(effects.value(Effect::leg_inertia, 0) == Approx(42e-4));
  CHECK(effects.value(Effect::leg_inertia, 1) == Approx(75e-4));
  CHECK(effects.value(Effect::leg_inertia, 2) == Approx(38e-3));
}

TEST_CASE("A fit's values, covariance and information are told of the law's parameters") {
  model::Model model = test::hopper_model();
  model.parameters[*dynamics::parameter_index(model.kind, "link_length_m")] = kLength_m;
  const auto unknowns = identify::effect_unknowns(Effect::leg_inertia, model.kind);
  // Many windows that say the same: the scatter of their gradients is their information.
  identify::Fit fit;
  fit.values = {0.010, 0.013, 0.0};
  fit.at_bound = {false, false, true};
  constexpr double kInformation[] = {1e6, 2.5e5, 1e6 / 9.0};
  constexpr int kWindows = 3000;
  for (int i = 0; i < kWindows; ++i) {
    identify::WindowShare share;
    share.gradient = Eigen::Vector3d::Zero();
    share.gradient(i % 3) = (i / 3 % 2 == 0 ? 1.0 : -1.0) * std::sqrt(3.0 * kInformation[i % 3] / kWindows);
    share.information = Eigen::Vector3d(kInformation[0], kInformation[1], kInformation[2]).asDiagonal();
    share.information /= kWindows;
    fit.shares.push_back(share);
  }
  const identify::Fit law = identify::in_law_parameters(fit, unknowns, model);
  CHECK(law.values[0] == Approx(kLength_m * 0.013));
  CHECK(law.values[1] == 0.0);
  CHECK(law.values[2] == Approx(0.023));
  // Variances 1e-6, 4e-6, 9e-6; that a coordinate lies on its bound makes it no surer. a = L (q + 2 r): L^2
  // (4 + 4 * 9) 1e-6; b = r; e = p + q + 2 r: (1 + 4 + 36) 1e-6.
  CHECK(law.covariance(0, 0) == Approx(kLength_m * kLength_m * 40e-6).epsilon(2e-3));
  CHECK(law.covariance(1, 1) == Approx(9e-6).epsilon(2e-3));
  CHECK(law.covariance(2, 2) == Approx(41e-6).epsilon(2e-3));
  CHECK((kWindows * law.shares[0].information * law.covariance).isApprox(Eigen::Matrix3d::Identity(), 2e-3));
}

TEST_CASE("A parameter of an effect means one of the model's only where it is its true value") {
  const auto meant = [](dynamics::Kind kind, Effect effect, std::size_t i = 0) {
    const auto index = identify::parameter_meant(kind, dynamics::info(effect).parameter_table[i]);
    return index ? std::string(dynamics::info(kind).parameters[*index].name) : std::string();
  };
  using dynamics::Kind;
  CHECK(meant(Kind::hopper_linear, Effect::stiffness_error) == "stiffness_npm");
  // The ground's is not the spring's: with that free, a ground that gives is still asked for.
  CHECK(meant(Kind::hopper_linear, Effect::ground_compliance).empty());
  CHECK(meant(Kind::hopper_linear, Effect::ground_compliance, 1).empty());
  CHECK(meant(Kind::rotary_joint, Effect::damping_error) == "damping_nmspr");
  CHECK(meant(Kind::hopper_linear, Effect::damping_error).empty());
  const auto& damping = dynamics::info(Effect::damping_error).parameter_table[0];
  CHECK(identify::neutral_value(test::hopper_model(), damping) == 0.0);
}
