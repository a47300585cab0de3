// The trial of conventions on a driven pendulum of this file's own: its equation, its integration and its columns.
#include "host/conventions/trial.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/host/error_message.hpp"

using namespace furcula;
using namespace furcula::conventions;

namespace {

constexpr double kInertia = 0.05, kGravity = 2.5, kDamping = 0.02, kStep_s = 2e-3;

/// inertia q'' + damping q' + gravity sin q = torque
class Pendulum final : public Family {
 public:
  explicit Pendulum(std::vector<FreeParameter> inertia = {}) : free_(std::move(inertia)) {}
  const std::vector<Joint>& joints() const override { return joints_; }
  std::vector<FreeParameter> free_parameters() const override { return free_; }
  std::vector<std::string> other_gravities() const override { return {}; }
  bool forces(const State& s, std::size_t, Forces& out) const override {
    out = {};
    out.needed = {kInertia * s.acceleration[0] + kDamping * s.velocity[0] +
                  kGravity * std::sin(s.position[0])};
    out.input_gain = {1.0};
    out.of_drive = {0.0};
    out.inertia = {kInertia};
    out.mass = {kInertia};
    out.log_det = std::log(kInertia);
    // One of the free parameter is a hundred times the inertia.
    out.by_free.assign(free_.size(), {99.0 * kInertia * s.acceleration[0]});
    out.inertia_by_free.assign(free_.size(), {99.0 * kInertia});
    return true;
  }

 private:
  std::vector<Joint> joints_{
      {"hinge", "angle_rad", "torque_nm", Quantity::angle, Quantity::torque, false, true, "bob", 0.25, 4.0}};
  std::vector<FreeParameter> free_;
};

/// What it does under a sum of two sines, with dry friction that the family does not know; noise and steps of an encoder.
std::vector<Columns> recordings(double friction_nm = 0.1) {
  std::vector<Columns> out;
  for (unsigned k = 0; k < 3; ++k) {
    Columns c{"log-" + std::to_string(k) + ".csv", {}, {{}}, {{}}};
    std::mt19937 random(k + 1);
    std::normal_distribution<double> noise(0.0, 5e-4);
    double q = 0.3, v = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double t = i * kStep_s;
      const double torque = 1.2 * std::sin(2.0 * t * (1.0 + 0.3 * k)) + 0.5 * std::sin(7.1 * t);
      c.time_s.push_back(t);
      c.position[0].push_back(q + noise(random));
      c.input[0].push_back(torque);
      constexpr int kParts = 20;
      for (int p = 0; p < kParts; ++p) {
        const double a =
            (torque - kDamping * v - kGravity * std::sin(q) - friction_nm * std::tanh(v / 0.01)) / kInertia;
        v += a * kStep_s / kParts;
        q += v * kStep_s / kParts;
      }
    }
    out.push_back(std::move(c));
  }
  return out;
}

template <class Change>
std::vector<Columns> changed(const Change& change) {
  std::vector<Columns> all = recordings();
  for (Columns& c : all) change(c);
  return all;
}
std::vector<Columns> angles(double scale, double offset = 0.0) {
  return changed([&](Columns& c) {
    for (double& q : c.position[0]) q = scale * q + offset;
  });
}
std::vector<Columns> torques(double scale) {
  return changed([&](Columns& c) {
    for (double& u : c.input[0]) u *= scale;
  });
}
std::string found(const std::vector<Columns>& columns) {
  const auto f = find_convention(Pendulum(), columns);
  return f ? f->what : "";
}

constexpr double kDegree = std::numbers::pi / 180.0;

/// mass x'' + damping x' = force, or under a drive's law force = stiffness (set point - x).
class Axle final : public Family {
 public:
  explicit Axle(double stiffness_npm = 0.0) : stiffness_(stiffness_npm) {
    joints_ = {{"", "position_m", stiffness_ > 0.0 ? "reference_m" : "force_n", Quantity::length,
                stiffness_ > 0.0 ? Quantity::length : Quantity::force, stiffness_ > 0.0, true, "", 0.25,
                4.0}};
  }
  const std::vector<Joint>& joints() const override { return joints_; }
  std::vector<FreeParameter> free_parameters() const override { return {}; }
  std::vector<std::string> other_gravities() const override { return {}; }
  bool forces(const State& s, std::size_t, Forces& out) const override {
    out = {};
    out.of_drive = {stiffness_ * s.position[0]};
    out.needed = {kMass * s.acceleration[0] + kDrag * s.velocity[0] + out.of_drive[0]};
    out.input_gain = {stiffness_ > 0.0 ? stiffness_ : 1.0};
    out.inertia = {kMass};
    out.mass = {kMass};
    out.log_det = std::log(kMass);
    return true;
  }
  /// The inputs times `scale`, positions and set points moved by `offset`.
  std::vector<Columns> recordings(double scale, double offset) const {
    Columns c{"axle.csv", {}, {{}}, {{}}};
    double x = 0.0, v = 0.0;
    for (int i = 0; i < 5000; ++i) {
      const double t = i * kStep_s;
      const double input = stiffness_ > 0.0 ? 0.2 * std::sin(3.0 * t) + 0.1 * std::sin(8.3 * t)
                                            : 9.0 * std::sin(3.0 * t) + 6.0 * std::sin(8.3 * t);
      c.time_s.push_back(t);
      c.position[0].push_back(std::round((x + offset) * 1e6) * 1e-6);
      c.input[0].push_back(scale * input + offset);
      constexpr int kParts = 20;
      for (int p = 0; p < kParts; ++p) {
        v += ((stiffness_ > 0.0 ? stiffness_ * (input - x) : input) - kDrag * v) / kMass * kStep_s / kParts;
        x += v * kStep_s / kParts;
      }
    }
    return {c};
  }

 private:
  static constexpr double kMass = 3.0, kDrag = 2.0;
  double stiffness_;
  std::vector<Joint> joints_;
};

/// mass z'' + drag z' + mass g = 0, thrown up every half second.
class Falling final : public Family {
 public:
  const std::vector<Joint>& joints() const override { return joints_; }
  std::vector<FreeParameter> free_parameters() const override { return {}; }
  std::vector<std::string> other_gravities() const override { return {}; }
  bool forces(const State& s, std::size_t, Forces& out) const override {
    out = {};
    out.needed = {kMass * (s.acceleration[0] + kG) + kDrag * s.velocity[0]};
    out.of_drive = {0.0};
    out.input_gain = {0.0};
    out.inertia = {kMass};
    out.mass = {kMass};
    out.log_det = std::log(kMass);
    return true;
  }
  std::vector<Columns> recordings(double scale) const {
    std::vector<Columns> out;
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0.0, 5e-5);
    for (int k = 0; k < 8; ++k) {
      Columns c{"throw.csv", {}, {{}}, {{}}};
      double z = 0.0, v = 2.0 + 0.1 * k;
      for (int i = 0; i < 200; ++i) {
        c.time_s.push_back(i * kStep_s);
        c.position[0].push_back(scale * (z + noise(random)));
        c.input[0].push_back(0.0);
        constexpr int kParts = 20;
        for (int p = 0; p < kParts; ++p) {
          v += (-kG - kDrag * v / kMass) * kStep_s / kParts;
          z += v * kStep_s / kParts;
        }
      }
      out.push_back(std::move(c));
    }
    return out;
  }

 private:
  static constexpr double kMass = 1.5, kDrag = 0.4, kG = 9.81;
  std::vector<Joint> joints_{
      {"", "height_m", "", Quantity::length, Quantity::force, false, true, "", 1.0, 1.0}};
};

}  // namespace

TEST_CASE("Columns that are what their names say are left alone, friction that the model lacks or not") {
  CHECK(found(recordings(0.0)).empty());
  CHECK(found(recordings(0.1)).empty());
  CHECK(found(recordings(0.3)).empty());
}

TEST_CASE("An angle in another unit is named, with the scale that makes it radians") {
  using Catch::Contains;
  CHECK(found(angles(1.0 / kDegree)) == "angle_rad is in degrees");
  CHECK(found(angles(0.5 / std::numbers::pi)) == "angle_rad is in turns");
  CHECK(found(angles(1000.0 / kDegree)) == "angle_rad is in millidegrees");
  CHECK_THAT(found(angles(9.0)), Contains("angle_rad is 9") && Contains("the motor's side of a gear?"));
  const auto degrees = find_convention(Pendulum(), angles(1.0 / kDegree));
  REQUIRE(degrees);
  CHECK_THAT(degrees->map, Contains("angle_rad = { column = \"angle_rad\", scale = 0.01745329 }"));
  CHECK(degrees->off_read < 0.2);
  CHECK(degrees->off_given > 0.5);
}

TEST_CASE("Encoder counts are whole numbers of a power of two a turn") {
  const auto counts = changed([](Columns& c) {
    for (double& q : c.position[0]) q = std::round(q * 16384.0 / (2.0 * std::numbers::pi));
  });
  CHECK_THAT(found(counts), Catch::Contains("encoder counts") && Catch::Contains("16384 a turn"));
}

TEST_CASE("A torque in another unit is named, and a current by its torque constant") {
  using Catch::Contains;
  CHECK(found(torques(1000.0)) == "torque_nm is in N mm");
  CHECK(found(torques(-1.0)) == "torque_nm has the other sign");
  const std::string current = found(torques(1.0 / 0.06));
  CHECK_THAT(current, Contains("torque_nm is about 17 times what it is in N m: a current, with 0.06"));
  const auto f = find_convention(Pendulum(), torques(1.0 / 0.06));
  REQUIRE(f);
  REQUIRE(!f->same.empty());  // a lighter machine under the torque as named moves alike
  CHECK_THAT(f->same.front(), Contains("all masses, inertias, dampings"));
}

TEST_CASE("A free parameter of the model hides no unit of an angle, and is no unit itself") {
  CHECK(find_convention(Pendulum({{0.0, 1.0}}), angles(1.0 / kDegree)).has_value());
  CHECK(!find_convention(Pendulum({{0.0, 1.0}}), recordings()).has_value());
}

TEST_CASE("A zero that is off by a quarter or half turn is named, and what of the body would look the same") {
  using Catch::Contains;
  for (const double offset : {0.5, -0.5, 1.0}) {
    const auto f = find_convention(Pendulum(), angles(1.0, -offset * std::numbers::pi));
    REQUIRE(f);
    CHECK_THAT(f->what, Contains("the zero of angle_rad is off by " +
                                 std::string(offset == 1.0 ? "half a turn" : "a quarter turn")));
    REQUIRE(!f->same.empty());
    CHECK_THAT(f->same.front(), Contains("link bob, turned by"));
  }
}

TEST_CASE("Milliseconds that are called seconds, and columns that are exchanged, are named") {
  const auto milliseconds = find_convention(Pendulum(), changed([](Columns& c) {
                                              for (double& t : c.time_s) t *= 1000.0;
                                            }));
  REQUIRE(milliseconds);
  CHECK(milliseconds->what == "time_s is in milliseconds");
  // So read it is the log that it was before.
  const auto degrees = find_convention(Pendulum(), angles(1.0 / kDegree));
  REQUIRE(degrees);
  CHECK(milliseconds->off_read == Approx(degrees->off_read).epsilon(1e-3));
  CHECK(found(changed([](Columns& c) { std::swap(c.position, c.input); })) ==
        "angle_rad and torque_nm are exchanged");
}

TEST_CASE("A signed torque that was read as unsigned is named") {
  using Catch::Contains;
  const auto read_as_unsigned = [](bool complement) {
    return changed([&](Columns& c) {
      for (double& u : c.input[0]) {
        const double steps = std::round(u / 0.002);
        u = 0.002 * (steps >= 0.0 ? steps : complement ? 4096.0 + steps : 2048.0 - steps);
      }
    });
  };
  CHECK_THAT(found(read_as_unsigned(false)), Contains("it is sign and magnitude"));
  CHECK_THAT(found(read_as_unsigned(true)), Contains("two's complement"));
}

TEST_CASE(
    "Where only the ratio of input and mass is known, the mass stays as it is, and the input's unit is named") {
  const Axle family;
  for (const auto& [scale, unit] : {std::pair{1.0 / 9.80665, "kgf"}, {1.0 / 1000.0, "kN"}}) {
    const auto f = find_convention(family, family.recordings(scale, 0.0));
    REQUIRE(f);
    CHECK(f->what == "force_n is in " + std::string(unit));
  }
  CHECK(!find_convention(family, family.recordings(1.0, 0.0)));
}

TEST_CASE("A drive's set points are counted from the same zero as its positions") {
  const Axle family(30.0);
  CHECK(!find_convention(family, family.recordings(1.0, 0.0)));
  // Both moved alike: nothing can be seen of it on an axis without gravity, and nothing is said.
  CHECK(!find_convention(family, family.recordings(1.0, 1.0)));
}

TEST_CASE("What falls, falls with g: a position that falls six times as fast is in another unit") {
  const Falling family;
  const auto f = find_convention(family, family.recordings(6.0));
  REQUIRE(f);
  CHECK_THAT(f->what, Catch::Contains("height_m is 6"));
  CHECK(!find_convention(family, family.recordings(1.0)));
}

TEST_CASE("The message says what to write, and how to go on where the columns are right") {
  using Catch::Contains;
  const std::string said = test::error_message([] { require_convention(Pendulum(), torques(1000.0)); });
  CHECK_THAT(said, Contains("log-0.csv and 2 more: it seems that torque_nm is in N mm."));
  CHECK_THAT(said, Contains("torque_nm = { column = \"torque_nm\", scale = 0.001 }"));
  CHECK_THAT(said, Contains("--trust-columns"));
  CHECK(test::error_message([] { require_convention(Pendulum(), recordings()); }).empty());
}

TEST_CASE("Recordings of a joint that stands still, or of too few rows, say nothing of units") {
  CHECK(found(changed([](Columns& c) {
          for (double& q : c.position[0]) q = 0.1;
        })).empty());
  CHECK(found(changed([](Columns& c) {
          for (auto* column : {&c.time_s, &c.position[0], &c.input[0]}) column->resize(20);
        })).empty());
}
