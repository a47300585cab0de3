// The torsion pendulum against its closed forms.
#include "furcula/dynamics/machines/torsion_pendulum.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "furcula/dynamics/plants.hpp"

using furcula::dynamics::Effect;
using furcula::dynamics::Effects;
using Plant = furcula::dynamics::machines::TorsionPendulum::Plant<double>;

namespace {

constexpr double kInertia = 0.02, kStiffness = 3.0, kDamping = 0.05;

Plant plant(const Effects<double>& effects = {}, double damping = kDamping) {
  return {{.inertia_kgm2 = kInertia, .stiffness_nmprad = kStiffness, .damping_nmspr = damping}, effects};
}

}  // namespace

TEST_CASE("A torsion pendulum swings as a damped oscillator does, whatever the step") {
  const double sigma = kDamping / (2.0 * kInertia), w = std::sqrt(kStiffness / kInertia - sigma * sigma);
  for (const double step : {1e-3, 0.0173, 0.11}) {
    Plant p = plant();
    p.reset(0.8, -2.0);
    for (int n = 1; n <= 10; ++n) {
      p.advance(0.0, step);
      const double t = n * step, decay = std::exp(-sigma * t);
      const double sine = (-2.0 + sigma * 0.8) / w;
      CAPTURE(step, n);
      CHECK(p.position() == Approx(decay * (0.8 * std::cos(w * t) + sine * std::sin(w * t))).margin(1e-11));
    }
  }
}

TEST_CASE("A held torque moves its rest to torque over stiffness") {
  Plant p = plant();
  p.reset(0.0, 0.0);
  for (int n = 0; n < 40000; ++n) p.advance(1.2, 1e-3);
  CHECK(p.position() == Approx(1.2 / kStiffness).epsilon(1e-12));
  CHECK(std::abs(p.velocity()) < 1e-12);
}

TEST_CASE("Dry friction takes 2 Fc / k from each half swing, and holds where the spring is weaker") {
  constexpr double kFriction = 0.09;  // 2 Fc / k = 0.06 rad
  Effects<double> effects;
  effects.set(Effect::coulomb_friction, 0, kFriction);
  Plant p = plant(effects, 0.0);
  p.reset(0.5, 0.0);
  const double half_s = std::numbers::pi * std::sqrt(kInertia / kStiffness);
  for (int half = 1; half <= 8; ++half) {
    for (int n = 0; n < 100; ++n) p.advance(0.0, half_s / 100);
    CAPTURE(half);
    CHECK(std::abs(p.position()) == Approx(0.5 - 0.06 * half).epsilon(2e-3));
  }
  const double rest = p.position();  // 0.02: the spring pulls with 0.06 N m
  p.advance(0.0, 1.0);
  CHECK(p.position() == Approx(rest).margin(1e-6));
}
