// The filter against the closed forms of its linearisation: with e the tilt, e' = -kP e - b, b' = -kI e... and against a turn that is known.
#include "furcula/control/walk/attitude_filter.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace furcula;
using namespace furcula::control;
using dynamics::biped::rotation;

namespace {

Quaternion<double> turned(double roll, double pitch) {
  const double cr = std::cos(roll / 2), sr = std::sin(roll / 2), cp = std::cos(pitch / 2),
               sp = std::sin(pitch / 2);
  return {cp * cr, cp * sr, sp * cr, -sp * sr};
}
/// What an accelerometer at rest measures.
Vec3<double> at_rest(const Quaternion<double>& a) { return up_of(a) * 9.81; }

/// Between the verticals, rad.
double tilt(const Quaternion<double>& a, const Quaternion<double>& b) {
  const Vec3<double> c = cross(up_of(a), up_of(b));
  return std::asin(std::sqrt(dot(c, c)));
}

}  // namespace

TEST_CASE("at rest the accelerometer gives roll and pitch, and yaw is zero") {
  for (const double roll : {-3.0, -1.2, 0.0, 0.4, 2.5})
    for (const double pitch : {-1.5, -0.3, 0.0, 0.7, 1.5}) {
      const Quaternion<double> truth = turned(roll, pitch);
      const AttitudeFilter<double> f = attitude_at_rest(at_rest(truth));
      const auto r = rotation(f.attitude), t = rotation(truth);
      for (const auto& [a, b] : {std::pair{r.x, t.x}, std::pair{r.y, t.y}, std::pair{r.z, t.z}}) {
        CHECK(a.x == Approx(b.x).margin(1e-9));
        CHECK(a.y == Approx(b.y).margin(1e-9));
        CHECK(a.z == Approx(b.z).margin(1e-9));
      }
      CHECK(r.y.x == Approx(0.0).margin(1e-9));  // yaw
    }
}

TEST_CASE("a wrong attitude comes back to the vertical with the filter's rate") {
  const AttitudeGains<double> gains{0.5, 0.0};
  const Quaternion<double> truth = turned(0.3, -0.2);
  AttitudeFilter<double> f{turned(0.32, -0.2), {0.0, 0.0, 0.0}};
  const double before = tilt(f.attitude, truth);
  for (int i = 0; i < 3000; ++i) step_attitude(gains, {{0.0, 0.0, 0.0}, at_rest(truth)}, 1e-3, f);
  CHECK(before == Approx(0.02 * std::cos(0.2)).epsilon(1e-3));  // roll turns about x, which is pitched
  CHECK(tilt(f.attitude, truth) == Approx(before * std::exp(-0.5 * 3.0)).epsilon(2e-3));
}

TEST_CASE("the gyro's bias across the vertical is found, as the linear law says") {
  // e'' + kP e' + kI e = 0 about a level attitude: with kP 2, kI 1 both roots are -1, and b - b_true = -b_true (1 + t) exp(-t).
  const AttitudeGains<double> gains{2.0, 1.0};
  const Vec3<double> bias{0.01, -0.02, 0.0};
  AttitudeFilter<double> f{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  const Vec3<double> acc{0.0, 0.0, 9.81};
  for (int i = 0; i < 2000; ++i) step_attitude(gains, {bias, acc}, 1e-3, f);
  const double left = (1.0 + 2.0) * std::exp(-2.0);
  CHECK(f.bias_radps.x == Approx(bias.x * (1.0 - left)).epsilon(5e-3));
  CHECK(f.bias_radps.y == Approx(bias.y * (1.0 - left)).epsilon(5e-3));
  CHECK(f.bias_radps.z == Approx(0.0).margin(1e-12));
  for (int i = 0; i < 20000; ++i) step_attitude(gains, {bias, acc}, 1e-3, f);
  CHECK(f.bias_radps.x == Approx(bias.x).epsilon(1e-4));
  CHECK(tilt(f.attitude, {1.0, 0.0, 0.0, 0.0}) < 1e-5);
}

TEST_CASE("a turn about a tilted axis is followed, and the attitude stays a rotation") {
  const AttitudeGains<double> gains;
  const Vec3<double> w{0.6, -1.1,
                       0.8};  // in the IMU's axes, constant: so the axis stands still in the level too
  const double rate = std::sqrt(dot(w, w));
  AttitudeFilter<double> f{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  Quaternion<double> truth{1.0, 0.0, 0.0, 0.0};
  for (int i = 1; i <= 5000; ++i) {
    step_attitude(gains, {w, at_rest(truth)}, 1e-3, f);  // a sample of the step's beginning
    const double half = 0.5 * rate * 1e-3 * i, s = std::sin(half) / rate;
    truth = {std::cos(half), w.x * s, w.y * s, w.z * s};
  }
  const auto& q = f.attitude;
  CHECK(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z == Approx(1.0).margin(1e-9));
  const double along = q.w * truth.w + q.x * truth.x + q.y * truth.y + q.z * truth.z;
  CHECK(2.0 * std::acos(std::min(1.0, std::abs(along))) < 2e-5);
}

TEST_CASE("in free fall the accelerometer says nothing, and the gyro alone turns the attitude") {
  AttitudeFilter<double> f{turned(0.2, 0.1), {0.0, 0.0, 0.0}};
  const Quaternion<double> before = f.attitude;
  for (int i = 0; i < 1000; ++i)
    step_attitude(AttitudeGains<double>{}, {{0.0, 0.0, 0.0}, {0.1, -0.2, 0.3}}, 1e-3, f);
  CHECK(f.attitude.x == Approx(before.x).margin(1e-12));
  CHECK(f.attitude.y == Approx(before.y).margin(1e-12));
  CHECK(f.bias_radps.x == 0.0);
}

TEST_CASE("an attitude in lanes has the bits that it has by itself") {
  using Lane = dynamics::SimdBatch<float, 8>;
  AttitudeFilter<float> one{{1.0f, 0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}};
  AttitudeFilter<Lane> all{{Lane(1.0f), Lane(0.0f), Lane(0.0f), Lane(0.0f)},
                           {Lane(0.0f), Lane(0.0f), Lane(0.0f)}};
  for (int i = 0; i < 300; ++i) {
    const float x = 0.01f * static_cast<float>(i % 37), y = 0.3f - x;
    step_attitude(AttitudeGains<float>{}, {{x, y, -x}, {y, x, 9.7f}}, 1e-3f, one);
    Imu<Lane> imu{{Lane(1.0f), Lane(1.0f), Lane(1.0f)}, {Lane(2.0f), Lane(0.0f), Lane(9.0f)}};
    imu.gyro_radps.x.set(3, x), imu.gyro_radps.y.set(3, y), imu.gyro_radps.z.set(3, -x);
    imu.acc_mps2.x.set(3, y), imu.acc_mps2.y.set(3, x), imu.acc_mps2.z.set(3, 9.7f);
    step_attitude(AttitudeGains<Lane>{}, imu, Lane(1e-3f), all);
  }
  CHECK(all.attitude.w[3] == one.attitude.w);
  CHECK(all.attitude.x[3] == one.attitude.x);
  CHECK(all.attitude.y[3] == one.attitude.y);
  CHECK(all.attitude.z[3] == one.attitude.z);
  CHECK(all.bias_radps.x[3] == one.bias_radps.x);
  CHECK(all.attitude.x[2] != one.attitude.x);
}
