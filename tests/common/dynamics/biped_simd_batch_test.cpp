// The biped on lanes against plain numbers, and in float against double.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/common/dynamics/biped_examples.hpp"

using namespace furcula;
using namespace furcula::test;
using dynamics::SimdBatch;
using dynamics::ValueOf;

namespace {

/// A robot's numbers, one of each name, in plain numbers.
template <class T, class Read>
std::vector<double> numbers(const biped::State<T>& s, const Read& read) {
  std::vector<double> out;
  const auto put = [&](const T& x) { out.push_back(static_cast<double>(read(x))); };
  for (const auto* v : {&s.position_m, &s.w_radps, &s.v_mps}) put(v->x), put(v->y), put(v->z);
  put(s.attitude.w), put(s.attitude.x), put(s.attitude.y), put(s.attitude.z);
  for (std::size_t i = 0; i < biped::kJoints; ++i)
    put(biped::joint<T>(s.q_rad, i)), put(biped::joint<T>(s.qd_radps, i));
  for (std::size_t side = 0; side < 2; ++side) {
    const std::size_t pass = biped::Legs<T>::pass(side);
    const auto of_leg = [&](const auto& x) { put(biped::Legs<T>::read(x, side)); };
    for (const auto& a : s.anchors_m[pass]) of_leg(a[0]), of_leg(a[1]);
    for (std::size_t c = 0; c < biped::kClutches; ++c)
      of_leg(s.rotors_rad[pass][c]), of_leg(s.rotors_radps[pass][c]);
  }
  return out;
}

/// Robot number `k` drops from 5 mm, tilted; `set` writes a number of robot k into T.
template <class T, class Set>
void begin(std::size_t k, biped::State<T>& s, const Set& set) {
  Random r(static_cast<unsigned>(100 + k));
  using V = ValueOf<T>;
  set(s.position_m.z, V(0.995));
  set(s.w_radps.x, static_cast<V>(r.within(-0.3, 0.3)));
  set(s.w_radps.z, static_cast<V>(r.within(-0.3, 0.3)));
  set(s.v_mps.x, static_cast<V>(r.within(-0.5, 0.5)));
  set(s.v_mps.y, static_cast<V>(r.within(-0.2, 0.2)));
  for (std::size_t i = 0; i < biped::kJoints; ++i) {
    T q = biped::joint<T>(s.q_rad, i), qd = biped::joint<T>(s.qd_radps, i);
    set(q, static_cast<V>(r.within(-0.05, 0.05)));
    set(qd, static_cast<V>(r.within(-0.5, 0.5)));
    biped::set_joint<T>(s.q_rad, i, q);
    biped::set_joint<T>(s.qd_radps, i, qd);
  }
}

/// 600 steps, with right knee's and left hip's clutches open in the robots `odd`; the knee's closes after half of them. Returns
/// what that impact takes.
template <class Topology, class P, class T>
T run(biped::State<T>& s, const P& p, const dynamics::MaskOf<T>& odd) {
  auto laws = biped::active_laws(p);
  biped::set_mode(p, biped::kRight, biped::kKneeClutch, biped::Mode::released, laws, s, odd);
  biped::set_mode(p, biped::kLeft, biped::kHipClutch, biped::Mode::passive, laws, s, odd);
  const biped::Commands<T> straight;
  biped::StepReport<T> report;
  T loss_j{};
  for (int n = 0; n < 600; ++n) {
    if (n == 300) loss_j = biped::engage<Topology>(p, biped::kRight, biped::kKneeClutch, laws, s, odd);
    biped::step<true, Topology>(p, laws, straight, T(static_cast<ValueOf<T>>(biped::kStep_s)), s, report);
  }
  return loss_j;
}

/// Robots 0 to N-1 together, and each by itself: the same to the bit?
template <class V, int N, class Topology = biped::DesignTopology, class P, class PAlone>
void check_lanes(const P& together, const PAlone& alone) {
  using T = SimdBatch<V, N>;
  biped::State<T> all;
  T number(V(0));
  for (std::size_t k = 0; k < static_cast<std::size_t>(N); ++k) {
    begin(k, all, [k](T& x, V value) { x.set(k, value); });
    number.set(k, static_cast<V>(k % 2));
  }
  const T losses_j = run<Topology>(all, together, number > V(0));
  for (std::size_t k = 0; k < static_cast<std::size_t>(N); ++k) {
    biped::State<V> one;
    begin(k, one, [](V& x, V value) { x = value; });
    const V loss_j = run<Topology>(one, alone, k % 2 == 1);
    CAPTURE(k);
    CHECK(losses_j[k] == loss_j);
    CHECK((loss_j > V(0)) == (k % 2 == 1));
    const auto a = numbers(all, [k](const T&x) { return x[k]; }), b = numbers(one, [](V x) { return x; });
    REQUIRE(std::isfinite(b[2]));
    CHECK(b[2] > 0.5);  // it has not fallen
    CHECK(a == b);
  }
}

}  // namespace

TEST_CASE("Sine and cosine are within rounding of the library's") {
  double worst = 0.0, worst_float = 0.0;
  for (int n = -200000; n <= 200000; ++n) {
    const double x = n * 5e-4 + 1e-7 * n;
    const auto d = dynamics::sine_cosine(x);
    worst = std::max({worst, std::abs(d.sine - std::sin(x)), std::abs(d.cosine - std::cos(x))});
    const float y = static_cast<float>(x);
    const auto f = dynamics::sine_cosine(y);
    worst_float =
        std::max({worst_float, std::abs(static_cast<double>(f.sine) - std::sin(static_cast<double>(y))),
                  std::abs(static_cast<double>(f.cosine) - std::cos(static_cast<double>(y)))});
  }
  CHECK(worst < 2.3e-16);
  CHECK(worst_float < 1.2e-7);
}

TEST_CASE("Sine and cosine hold over their range, and what is not a number stays so") {
  Random r(32);
  double worst = 0.0, worst_float = 0.0;
  for (int n = 0; n < 100000; ++n) {
    const double x = r.within(-1e5, 1e5);
    const auto d = dynamics::sine_cosine(x);
    worst = std::max({worst, std::abs(d.sine - std::sin(x)), std::abs(d.cosine - std::cos(x))});
    const float y = static_cast<float>(r.within(-1e3, 1e3));
    const auto f = dynamics::sine_cosine(y);
    worst_float =
        std::max({worst_float, std::abs(static_cast<double>(f.sine) - std::sin(static_cast<double>(y))),
                  std::abs(static_cast<double>(f.cosine) - std::cos(static_cast<double>(y)))});
  }
  CHECK(worst < 2.3e-16);
  CHECK(worst_float < 1.2e-7);
  CHECK(std::isnan(dynamics::sine_cosine(std::nan("")).sine));
  CHECK(std::isnan(dynamics::sine_cosine(std::nanf("")).cosine));
}

TEST_CASE("Four bipeds in lanes of double are each by itself to the bit, in contact and with clutches open") {
  const biped::Description d = biped::design();
  check_lanes<double, 4>(biped::Parameters<SimdBatch<double, 4>>(d), biped::Parameters<double>(d));
}
TEST_CASE("Eight bipeds in lanes of float are each by itself to the bit") {
  const biped::Description d = biped::design();
  check_lanes<float, 8>(biped::Parameters<SimdBatch<float, 8>>(d), biped::Parameters<float>(d));
}
TEST_CASE("Bipeds of turned joints in lanes are each by itself to the bit") {
  // Hips that are canted outwards by 0.2 rad, knees turned back by as much.
  biped::JointFrames frames = straight_frames();
  for (const std::size_t side : {biped::kLeft, biped::kRight})
    for (const std::size_t j : {biped::kHipRoll, biped::kKnee}) {
      const double a = (side == biped::kLeft ? 0.2 : -0.2) * (j == biped::kKnee ? -1.0 : 1.0);
      frames[side][j] = {{1, 0, 0}, {0, std::cos(a), std::sin(a)}, {0, -std::sin(a), std::cos(a)}};
    }
  const biped::Description d = biped::design();
  check_lanes<double, 4, biped::AnywhereTopology>(biped::TurnedParameters<SimdBatch<double, 4>>(d, frames),
                                                  biped::TurnedParameters<double>(d, frames));
  check_lanes<float, 8, biped::AnywhereTopology>(biped::TurnedParameters<SimdBatch<float, 8>>(d, frames),
                                                 biped::TurnedParameters<float>(d, frames));
}

TEST_CASE("In float the biped accelerates as in double to six digits") {
  Random r(31);
  const biped::Description d = biped::design();
  const biped::Parameters<double> p(d);
  const biped::Parameters<float> pf(d);
  double worst = 0.0;
  for (int n = 0; n < 200; ++n) {
    const auto s = state_of(random_coordinates(r, 1.5));
    const auto torque = random_torques(r, 80.0);
    const auto act = in_flight(d, torque);
    const auto a = biped::accelerations(p, s, act);
    biped::State<float> sf;
    biped::Actions<float> actf{};
    const auto narrow = [](double x) { return static_cast<float>(x); };
    const auto vec = [&](const Vec3<double>& v) {
      return Vec3<float>{narrow(v.x), narrow(v.y), narrow(v.z)};
    };
    sf.attitude = {narrow(s.attitude.w), narrow(s.attitude.x), narrow(s.attitude.y), narrow(s.attitude.z)};
    sf.w_radps = vec(s.w_radps), sf.v_mps = vec(s.v_mps);
    actf.gravity_mps2 = pf.gravity_mps2;
    for (std::size_t i = 0; i < biped::kJoints; ++i) {
      biped::set_joint<float>(sf.q_rad, i, narrow(biped::joint<double>(s.q_rad, i)));
      biped::set_joint<float>(sf.qd_radps, i, narrow(biped::joint<double>(s.qd_radps, i)));
      biped::set_joint<float>(actf.torque_nm, i, narrow(torque[i]));
      biped::set_joint<float>(actf.armature_kgm2, i, narrow(biped::joint<double>(act.armature_kgm2, i)));
    }
    const auto af = biped::accelerations(pf, sf, actf);
    double scale = 0.0, apart = 0.0;
    for (std::size_t i = 0; i < biped::kJoints; ++i) {
      const double own = biped::joint<double>(a.qdd_radps2, i);
      scale = std::max(scale, std::abs(own));
      apart = std::max(apart, std::abs(own - static_cast<double>(biped::joint<float>(af.qdd_radps2, i))));
    }
    worst = std::max(worst, apart / scale);
  }
  CHECK(worst < 2e-5);
  CHECK(worst > 1e-9);  // it is float
  if (std::getenv("FURCULA_FIGURES") != nullptr)
    std::printf("float: largest relative difference %.2e\n", worst);
}
