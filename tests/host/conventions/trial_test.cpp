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

/// inertia q'' + damping q' + gravity sin q = torque, or = stiffness (set point - q) where the model's drive leads it so.
struct Model {
  double inertia = kInertia, gravity = kGravity, stiffness = 0.0;
  std::vector<FreeParameter> free{};  ///< one of each is a hundred times the inertia
};
class Pendulum final : public Family {
 public:
  explicit Pendulum(Model model = {}) : m_(std::move(model)) {
    const bool led = m_.stiffness > 0.0;
    joints_ = {{"hinge", "angle_rad", led ? "angle_cmd_rad" : "torque_nm", Quantity::angle,
                led ? Quantity::angle : Quantity::torque, led, true, "bob", 0.25, 4.0}};
  }
  const std::vector<Joint>& joints() const override { return joints_; }
  std::vector<FreeParameter> free_parameters() const override { return m_.free; }
  std::vector<std::string> other_gravities() const override { return {}; }
  bool forces(const State& s, std::size_t, Forces& out) const override {
    out = {};
    out.of_drive = {m_.stiffness * s.position[0]};
    out.needed = {m_.inertia * s.acceleration[0] + kDamping * s.velocity[0] +
                  m_.gravity * std::sin(s.position[0]) + out.of_drive[0]};
    out.input_gain = {m_.stiffness > 0.0 ? m_.stiffness : 1.0};
    out.inertia = {m_.inertia};
    out.mass = {m_.inertia};
    out.log_det = std::log(m_.inertia);
    out.by_free.assign(m_.free.size(), {99.0 * m_.inertia * s.acceleration[0]});
    out.inertia_by_free.assign(m_.free.size(), {99.0 * m_.inertia});
    return true;
  }

 private:
  Model m_;
  std::vector<Joint> joints_;
};

/// What the machine has, and the model does not.
struct Beside {
  double friction_nm = 0.1, damping_nmspr = 0.0, spring_nmprad = 0.0, gravity = kGravity, stiffness = 0.0;
};

/// What it does under a sum of two sines, with dry friction that the family does not know; noise and steps of an encoder. The input is a
/// torque, or set points.
std::vector<Columns> recordings(const Beside& beside = {}) {
  std::vector<Columns> out;
  for (unsigned k = 0; k < 3; ++k) {
    Columns c{"log-" + std::to_string(k) + ".csv", {}, {{}}, {{}}};
    std::mt19937 random(k + 1);
    std::normal_distribution<double> noise(0.0, 5e-4);
    double q = 0.3, v = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double t = i * kStep_s;
      const double input = 1.2 * std::sin(2.0 * t * (1.0 + 0.3 * k)) + 0.5 * std::sin(7.1 * t);
      c.time_s.push_back(t);
      c.position[0].push_back(q + noise(random));
      c.input[0].push_back(input);
      constexpr int kParts = 20;
      for (int p = 0; p < kParts; ++p) {
        const double torque = beside.stiffness > 0.0 ? beside.stiffness * (input - q) : input;
        const double a = (torque - (kDamping + beside.damping_nmspr) * v - beside.gravity * std::sin(q) -
                          beside.spring_nmprad * q - beside.friction_nm * std::tanh(v / 0.01)) /
                         kInertia;
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

/// mass x'' + damping x' = force
class Axle final : public Family {
 public:
  const std::vector<Joint>& joints() const override { return joints_; }
  /// The mass may be up to 30 % less.
  std::vector<FreeParameter> free_parameters() const override { return {{-1.0, 0.0}}; }
  std::vector<std::string> other_gravities() const override { return {}; }
  bool forces(const State& s, std::size_t, Forces& out) const override {
    out = {};
    out.by_free = {{0.3 * kMass * s.acceleration[0]}};
    out.inertia_by_free = {{0.3 * kMass}};
    out.of_drive = {0.0};
    out.needed = {kMass * s.acceleration[0] + kDrag * s.velocity[0]};
    out.input_gain = {1.0};
    out.inertia = {kMass};
    out.mass = {kMass};
    out.log_det = std::log(kMass);
    return true;
  }
  /// The forces times `scale`.
  static std::vector<Columns> recordings(double scale) {
    Columns c{"axle.csv", {}, {{}}, {{}}};
    double x = 0.0, v = 0.0;
    for (int i = 0; i < 5000; ++i) {
      const double t = i * kStep_s;
      const double force = 9.0 * std::sin(3.0 * t) + 6.0 * std::sin(8.3 * t);
      c.time_s.push_back(t);
      c.position[0].push_back(std::round(x * 1e6) * 1e-6);
      c.input[0].push_back(scale * force);
      constexpr int kParts = 20;
      for (int p = 0; p < kParts; ++p) {
        v += (force - kDrag * v) / kMass * kStep_s / kParts;
        x += v * kStep_s / kParts;
      }
    }
    return {c};
  }

 private:
  static constexpr double kMass = 3.0, kDrag = 2.0;
  std::vector<Joint> joints_{
      {"", "position_m", "force_n", Quantity::length, Quantity::force, false, true, "", 0.25, 4.0}};
};

/// Two carriages under forces: mass x'' + weight = force. So read that gravity is another one, springs take the weights' places.
class Carriages final : public Family {
 public:
  const std::vector<Joint>& joints() const override { return joints_; }
  std::vector<FreeParameter> free_parameters() const override { return {}; }
  std::vector<std::string> other_gravities() const override { return {"gravity is another one"}; }
  bool forces(const State& s, std::size_t gravity, Forces& out) const override {
    out = {};
    const bool named = gravity == 0;
    for (std::size_t j = 0; j < 2; ++j) {
      const double passive = named ? kWeight : kSpring * s.position[j];
      out.needed.push_back(kMass * s.acceleration[j] + passive);
      out.of_drive.push_back(0.0);
      out.input_gain.push_back(1.0);
      out.inertia.push_back(kMass);
    }
    out.mass = {kMass, 0.0, 0.0, kMass};
    out.log_det = 2.0 * std::log(kMass);
    return true;
  }
  /// With another gravity each, or as named; on b a force that the model lacks besides, of this amplitude.
  static std::vector<Columns> recordings(bool other_a, bool other_b, double beside_b) {
    Columns c{"carriages.csv", {}, {{}, {}}, {{}, {}}};
    double x[2]{}, v[2]{};
    for (int i = 0; i < 4000; ++i) {
      const double t = i * kStep_s;
      c.time_s.push_back(t);
      for (std::size_t j = 0; j < 2; ++j) {
        const auto passive = [&] { return (j == 0 ? other_a : other_b) ? kSpring * x[j] : kWeight; };
        // It is held in the middle.
        const double force = passive() - 40.0 * x[j] - 4.0 * v[j] +
                             6.0 * std::sin(3.0 * t + static_cast<double>(j)) + 4.0 * std::sin(7.7 * t);
        c.position[j].push_back(std::round(x[j] * 1e5) * 1e-5);
        c.input[j].push_back(force);
        constexpr int kParts = 20;
        for (int p = 0; p < kParts; ++p) {
          const double beside = j == 0 ? 0.0 : beside_b * std::sin(13.0 * (t + p * kStep_s / kParts));
          v[j] += (force - passive() + beside) / kMass * kStep_s / kParts;
          x[j] += v[j] * kStep_s / kParts;
        }
      }
    }
    return {c};
  }

 private:
  static constexpr double kMass = 2.0, kWeight = 20.0, kSpring = 90.0;
  std::vector<Joint> joints_{
      {"a", "position_a_m", "force_a_n", Quantity::length, Quantity::force, false, true, "", 0.25, 4.0},
      {"b", "position_b_m", "force_b_n", Quantity::length, Quantity::force, false, true, "", 0.25, 4.0}};
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
      {"", "height_m", "", Quantity::length, Quantity::force, false, true, "", 1.0, 4.0}};
};

}  // namespace

TEST_CASE("Columns that are what their names say are left alone, friction that the model lacks or not") {
  CHECK(found(recordings({0.0})).empty());
  CHECK(found(recordings({0.1})).empty());
  CHECK(found(recordings({0.3})).empty());
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
  CHECK(find_convention(Pendulum({.free = {{0.0, 1.0}}}), angles(1.0 / kDegree)).has_value());
  CHECK(!find_convention(Pendulum({.free = {{0.0, 1.0}}}), recordings()).has_value());
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
    const auto f = find_convention(family, Axle::recordings(scale));
    REQUIRE(f);
    CHECK(f->what == "force_n is in " + std::string(unit));
  }
  CHECK(!find_convention(family, Axle::recordings(1.0)));
}

TEST_CASE("A drive's set points are counted from the same zero as its positions") {
  using Catch::Contains;
  const Pendulum led({.stiffness = 8.0});
  std::vector<Columns> all = recordings({.stiffness = 8.0});
  CHECK(!find_convention(led, all));
  for (Columns& c : all)
    for (auto* column : {&c.position[0], &c.input[0]})
      for (double& q : *column) q -= 0.5 * std::numbers::pi;
  const auto f = find_convention(led, all);
  REQUIRE(f);
  CHECK_THAT(f->what, Contains("the zero of angle_rad is off by a quarter turn") &&
                          Contains("and that of angle_cmd_rad likewise"));
  CHECK_THAT(f->map, Contains("angle_rad = { column = \"angle_rad\", offset = 1.570796 }") &&
                         Contains("angle_cmd_rad = { column = \"angle_cmd_rad\", offset = 1.570796 }"));
}

TEST_CASE("A number of the model in another unit is named as the model's") {
  const auto said = [](const Model& model) {
    const auto f = find_convention(Pendulum(model), recordings());
    return f ? f->what : "";
  };
  CHECK(said({.inertia = 1e4 * kInertia}) == "the model's inertia is in kg cm^2 (times 1e-04)");
  CHECK(said({.inertia = 1e3 * kInertia}) == "the model's inertia is in g m^2 (times 0.001)");
  CHECK(said({.gravity = 1e3 * kGravity}) == "the model's gravity or stiffness is in N mm (times 0.001)");
}

TEST_CASE("A reading explains each joint, or leaves it as it was") {
  const Carriages family;
  CHECK(!find_convention(family, Carriages::recordings(false, false, 6.0)));
  const auto f = find_convention(family, Carriages::recordings(true, true, 6.0));
  REQUIRE(f);
  CHECK(f->what == "gravity is another one");
  // Right for a, of which nothing else is missing, and wrong for b: more by a than is lost by b, and no reading all the same.
  CHECK(!find_convention(family, Carriages::recordings(true, false, 6.0)));
  // What b lacks in any reading does not hide a's unit.
  std::vector<Columns> all = Carriages::recordings(false, false, 400.0);
  for (Columns& c : all)
    for (double& x : c.position[0]) x *= 1000.0;
  const auto unit = find_convention(family, all);
  REQUIRE(unit);
  CHECK(unit->what == "position_a_m is in millimetres");
}

TEST_CASE("What the model lacks is no other unit or sign, however large it is") {
  CHECK(found(recordings({.damping_nmspr = 1.0})).empty());
  CHECK(found(recordings({.friction_nm = 0.8})).empty());
  CHECK(found(recordings({.spring_nmprad = 6.0})).empty());
  CHECK(found(recordings({.gravity = 3.0 * kGravity})).empty());
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

TEST_CASE(
    "Where time alone is asked about, another unit of another column is not told, and that of time is") {
  const auto said = [](const std::vector<Columns>& columns) {
    return test::error_message([&] { require_convention(Pendulum(), columns, Asked::time_alone); });
  };
  CHECK(said(torques(1000.0)).empty());
  CHECK_THAT(said(changed([](Columns& c) {
               for (double& t : c.time_s) t *= 1000.0;
             })),
             Catch::Contains("time_s is in milliseconds"));
}

TEST_CASE("Recordings of a joint that stands still, or of too few rows, say nothing of units") {
  CHECK(found(changed([](Columns& c) {
          for (double& q : c.position[0]) q = 0.1;
        })).empty());
  CHECK(found(changed([](Columns& c) {
          for (auto* column : {&c.time_s, &c.position[0], &c.input[0]}) column->resize(20);
        })).empty());
}
