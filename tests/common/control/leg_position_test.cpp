// The leg's path and what follows it.
#include "furcula/control/leg_position.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace furcula::control;

TEST_CASE("a raised cosine starts and ends at rest, and its derivatives are its own") {
  const float height = 0.05f, time = 0.2f;
  for (const bool back : {true, false}) {
    CHECK(raised_cosine(height, time, 0.0f, back).fold_m == Approx(0.0f).margin(1e-7));
    CHECK(raised_cosine(height, time, 1.0f, back).fold_m == Approx(back ? 0.0f : height).margin(1e-7));
    CHECK(raised_cosine(height, time, back ? 0.5f : 1.0f, back).fold_m == Approx(height));
    CHECK(raised_cosine(height, time, 1.0f, back).rate_mps == Approx(0.0f).margin(1e-5));
    for (const float share : {0.1f, 0.3f, 0.6f, 0.9f}) {
      const float h = 1e-2f;
      const auto before = raised_cosine(height, time, share - h, back),
                 after = raised_cosine(height, time, share + h, back),
                 at = raised_cosine(height, time, share, back);
      CHECK(at.rate_mps ==
            Approx((after.fold_m - before.fold_m) / (2 * h * time)).epsilon(5e-3).margin(1e-3));
      CHECK(at.acceleration_mps2 ==
            Approx((after.rate_mps - before.rate_mps) / (2 * h * time)).epsilon(5e-3).margin(0.05));
    }
  }
}

TEST_CASE("a leg of the expected inertia and geometry follows its path closely") {
  // I theta'' = torque - lever * pull, along l = 2 L cos theta.
  const LegPositionConfig config;
  LegPositionState state{0.349f, 0.349f};
  const double length = 0.15, straight = 2 * length * std::cos(0.349), pull_npm = 50.0;
  double angle = 0.349, rate = 0.0, worst = 0.0;
  for (int n = 0; n < 200; ++n) {
    const LegPath path = raised_cosine(0.05f, 0.2f, static_cast<float>(n) / 200, true);
    const double fold = straight - 2 * length * std::cos(angle);
    worst = std::max(worst, std::abs(fold - path.fold_m));
    const float lever = leg_lever_m(0.15f, static_cast<float>(angle));
    CHECK(lever == Approx(2 * length * std::sin(angle)).epsilon(1e-5));
    const double torque =
        follow_path(config, state, path, static_cast<float>(fold), static_cast<float>(angle), lever,
                    static_cast<float>(pull_npm * fold), 0.001f);
    note_angle(state, static_cast<float>(angle));
    for (int k = 0; k < 100; ++k) {
      const double l = 2 * length * std::cos(angle);
      rate += 1e-5 * (torque - 2 * length * std::sin(angle) * pull_npm * (straight - l)) / 0.003;
      angle += 1e-5 * rate;
    }
  }
  CHECK(worst < 0.004);
}
