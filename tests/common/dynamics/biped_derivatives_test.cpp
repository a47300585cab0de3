// Derivatives of the biped's step by numbers that carry them, against differences.
#include <catch2/catch.hpp>

#include "furcula/dynamics/biped/design.hpp"
#include "furcula/dynamics/biped/step.hpp"
#include "host/identify/dual.hpp"

using namespace furcula;
namespace biped = furcula::dynamics::biped;

TEST_CASE("Derivatives of a step in contact are those of central differences") {
  using Dual = identify::Dual<2>;
  constexpr int kUnknowns = 8;
  const biped::Description d = biped::design();
  // After one step: by height, a velocity, the tilt's rate, two joints, two targets, and a foot's mass.
  const auto stepped = [&](const auto& shift) {
    using T = std::decay_t<decltype(shift(0))>;
    biped::Parameters<T> p(d);
    auto foot = p.link(biped::kLeft, biped::kAnkleRoll);
    foot.mass_kg += shift(7);
    p.set_link(biped::kLeft, biped::kAnkleRoll, foot);
    biped::State<T> s;
    s.position_m.z = T(0.9885) + shift(0);
    s.v_mps = {T(0.1) + shift(1), T(-0.05), T(-0.02)};
    s.w_radps = {T(0.02), T(0.03) + shift(2), T(-0.01)};
    for (std::size_t i = 0; i < biped::kJoints; ++i) {
      biped::set_joint<T>(s.q_rad, i, T(0.003 * std::sin(1.0 + static_cast<double>(i))));
      biped::set_joint<T>(s.qd_radps, i, T(0.03 * std::cos(2.0 * static_cast<double>(i))));
    }
    biped::set_joint<T>(s.q_rad, 3, biped::joint<T>(s.q_rad, 3) + shift(3));
    biped::set_joint<T>(s.qd_radps, 10, biped::joint<T>(s.qd_radps, 10) + shift(4));
    biped::Commands<T> c;
    biped::set_joint<T>(c.target_rad, 2, T(0.01) + shift(5));
    biped::set_joint<T>(c.target_rad, 11, T(-0.01) + shift(6));
    biped::StepReport<T> report;
    biped::step(p, biped::active_laws(p), c, T(biped::kStep_s), s, report);
    std::vector<T> out{s.v_mps.x,   s.v_mps.y,   s.v_mps.z,     s.w_radps.x,
                       s.w_radps.y, s.w_radps.z, s.position_m.z};
    for (std::size_t i = 0; i < biped::kJoints; ++i) out.push_back(biped::joint<T>(s.qd_radps, i));
    return out;
  };
  for (int k = 0; k < kUnknowns; ++k) {
    const auto dual = stepped([k](int i) { return i == k ? Dual(0.0, 0) : Dual(0.0); });
    const double h = 1e-6;
    const auto up = stepped([&](int i) { return i == k ? h : 0.0; });
    const auto down = stepped([&](int i) { return i == k ? -h : 0.0; });
    double scale = 0.0;
    for (const Dual& x : dual) scale = std::max(scale, std::abs(x.derivative(0)));
    CHECK(scale > 1e-6);
    for (std::size_t i = 0; i < dual.size(); ++i) {
      CAPTURE(k, i);
      CHECK(std::abs(dual[i].derivative(0) - (up[i] - down[i]) / (2 * h)) < 1e-6 * scale + 1e-9);
    }
  }
}
