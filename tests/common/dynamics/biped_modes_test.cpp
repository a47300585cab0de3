// The modes of the biped's hip pitch and knee: what their laws give, the motor behind an open clutch, and how one closes.
#include <catch2/catch.hpp>

#include "tests/common/dynamics/biped_examples.hpp"

using namespace furcula;
using namespace furcula::test;
using biped::Mode;

namespace {

/// x of a x = b, a symmetric and positive definite (by Gauss).
template <std::size_t N>
std::array<double, N> solved(std::array<std::array<double, N>, N> a, std::array<double, N> b) {
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t k = i + 1; k < N; ++k) {
      const double f = a[k][i] / a[i][i];
      for (std::size_t c = i; c < N; ++c) a[k][c] -= f * a[i][c];
      b[k] -= f * b[i];
    }
  for (std::size_t i = N; i-- > 0;) {
    for (std::size_t c = i + 1; c < N; ++c) b[i] -= a[i][c] * b[c];
    b[i] /= a[i][i];
  }
  return b;
}

struct Robot {
  biped::Description d = biped::design();
  biped::Parameters<double> p{d};
  biped::JointLaws<double> laws = biped::active_laws(p);
  biped::State<double> s;
  biped::Commands<double> c;

  double torque(std::size_t joint) const {
    biped::JointTorques<double> out;
    biped::joint_torques<true>(p, s, laws, c.target_rad, out);
    return biped::joint<double>(out.joint_nm, joint);
  }
};

constexpr std::size_t kRightHip = 6 + biped::kHipPitch, kLeftKnee = biped::kKnee;

}  // namespace

TEST_CASE("Each mode of a joint has its law, and the other leg's joint keeps its own") {
  Robot r;
  biped::set_joint<double>(r.s.q_rad, kRightHip, 0.3);
  biped::set_joint<double>(r.s.qd_radps, kRightHip, 0.02);
  biped::set_joint<double>(r.s.q_rad, biped::kHipPitch, 0.3);
  biped::set_joint<double>(r.s.qd_radps, biped::kHipPitch, 0.02);
  biped::set_joint<double>(r.c.target_rad, kRightHip, 0.32);
  biped::set_joint<double>(r.c.target_rad, biped::kHipPitch, 0.32);
  const double active = 3000 * 0.02 - 80 * 0.02 - 2 * 0.02 - 5 * 0.02 / 0.05;
  CHECK(r.torque(kRightHip) == Approx(active));
  const auto mode = [&](Mode m) { biped::set_mode(r.p, biped::kRight, biped::kHipClutch, m, r.laws, r.s); };
  mode(Mode::passive);
  CHECK(r.torque(kRightHip) == Approx(-60 * 0.3 - 0.05 * 0.02));
  CHECK(r.torque(biped::kHipPitch) == Approx(active));
  mode(Mode::released);
  CHECK(r.torque(kRightHip) == Approx(-0.05 * 0.02));
  mode(Mode::engaging);
  CHECK(r.torque(kRightHip) == Approx(-0.05 * 0.02));
  mode(Mode::braked);
  CHECK(r.torque(kRightHip) == Approx(-60 * 0.02));
  biped::set_joint<double>(r.s.q_rad, kRightHip, 0.301);
  CHECK(r.torque(kRightHip) == Approx(-2e4 * 0.001 - 60 * 0.02));
  biped::set_joint<double>(r.s.q_rad, kRightHip, 0.4);
  CHECK(r.torque(kRightHip) == Approx(-220));
  mode(Mode::active);
  CHECK(r.torque(kRightHip) ==
        Approx(-220 - 2 * 0.02 - 5 * 0.02 / 0.05));  // the motor's limit, then the gear
  CHECK(r.torque(biped::kHipPitch) == Approx(active));
  // Fast motion has Coulomb friction in full.
  biped::set_joint<double>(r.s.qd_radps, biped::kHipPitch, -0.5);
  CHECK(r.torque(biped::kHipPitch) == Approx(3000 * 0.02 + 80 * 0.5 + 2 * 0.5 + 5));
}

TEST_CASE("A target that is not a number is no torque") {
  // A clamp by comparisons alone may make the limit of it: 220 N m.
  Robot r;
  biped::set_joint<double>(r.c.target_rad, kLeftKnee, std::nan(""));
  CHECK(std::isnan(r.torque(kLeftKnee)));
  CHECK(r.torque(kRightHip) == 0.0);
}

TEST_CASE("Two equal hip springs put the torso on the legs' bisector") {
  // Spring torques on the pelvis, of both legs: k (qL + qR) = 0 there, for any spread of the legs.
  Robot r;
  for (const std::size_t side : {biped::kLeft, biped::kRight})
    biped::set_mode(r.p, side, biped::kHipClutch, Mode::passive, r.laws, r.s);
  for (const double spread : {0.1, 0.4, 0.8})
    for (const double lean : {-0.2, 0.0, 0.3}) {
      biped::set_joint<double>(r.s.q_rad, biped::kHipPitch, spread + lean);
      biped::set_joint<double>(r.s.q_rad, kRightHip, -spread + lean);
      CHECK(r.torque(biped::kHipPitch) + r.torque(kRightHip) == Approx(-2 * 60 * lean).margin(1e-12));
    }
}

TEST_CASE("A joint whose motor is not joined moves without its armature") {
  Random random(41);
  for (int n = 0; n < 20; ++n) {
    Robot r;
    biped::set_mode(r.p, biped::kLeft, biped::kKneeClutch, Mode::released, r.laws, r.s);
    const Coordinates c = random_coordinates(random);
    const auto torque = random_torques(random, 100.0);
    auto act = in_flight(r.d, torque);
    for (std::size_t j = 0; j < biped::kLegJoints; ++j) act.armature_kgm2[0][j] = r.laws[0][j].armature_kgm2;
    Tree18 tree = as_tree(r.d);
    tree.laws[6 + kLeftKnee].armature_kgm2 = 0.0;
    const auto a = biped::accelerations(r.p, state_of(c), act);
    const auto asked = inverse_dynamics(tree, c.q, c.qd, second_derivatives(c, a));
    for (std::size_t i = 0; i < 18; ++i) CHECK(asked[i] == Approx(i < 6 ? 0.0 : torque[i - 6]).margin(1e-7));
  }
}

TEST_CASE("A motor behind an open clutch comes to its link's angle as its equation says") {
  Robot r;
  biped::set_mode(r.p, biped::kLeft, biped::kKneeClutch, Mode::released, r.laws, r.s);
  const double off = 1e-5, h = 1e-5;
  r.s.rotors_rad[0][1] = dynamics::SimdBatch<double, 2>(off);
  // Below the creep: A y'' + (kd + b + Fc/vs) y' + kp y = 0, over-damped.
  const double a = 1.28, d = 80 + 2 + 5 / 0.05, k = 3000, root = std::sqrt(d * d - 4 * a * k);
  const double l1 = (-d + root) / (2 * a), l2 = (-d - root) / (2 * a);
  for (int n = 0; n < 10000; ++n) biped::step_motors(r.p, r.laws, r.s.q_rad, r.c.pin_nm, h, r.s);
  const double t = 0.1, expected = off * (l2 * std::exp(l1 * t) - l1 * std::exp(l2 * t)) / (l2 - l1);
  CHECK(r.s.rotors_rad[0][1][0] == Approx(expected).epsilon(1e-3));
  CHECK(r.s.rotors_rad[0][1][1] == 0.0);  // the right knee's motor is joined: where its link is
}

TEST_CASE("A motor that is joined in motion gives the link its momentum, and the loss is booked") {
  Random random(42);
  for (int n = 0; n < 20; ++n) {
    Robot r;
    const Coordinates c = random_coordinates(random, 1.0);
    r.s = state_of(c);
    const std::size_t side = n % 2 == 0 ? biped::kLeft : biped::kRight;
    const biped::LegClutch clutch = n % 4 < 2 ? biped::kHipClutch : biped::kKneeClutch;
    const std::size_t j = biped::kClutchJoints[clutch], at = 6 + side * 6 + j;
    // The other leg's other joint is released too: it counts without armature.
    const biped::LegClutch other_clutch =
        clutch == biped::kHipClutch ? biped::kKneeClutch : biped::kHipClutch;
    const std::size_t other = biped::kClutchJoints[other_clutch];
    biped::set_mode(r.p, 1 - side, other_clutch, Mode::released, r.laws, r.s);
    biped::set_mode(r.p, side, clutch, Mode::released, r.laws, r.s);
    const double motor = random.within(-3.0, 3.0), armature = 1.28;
    r.s.rotors_radps[0][clutch].set(side, motor);
    const auto energy = [&] {
      return biped::totals(r.p, r.s).kinetic_j + biped::motors_kinetic_j(r.p, r.laws, r.s);
    };
    const auto before = biped::totals(r.p, r.s);
    const double had = energy();
    // By the tree's mass matrix: all velocities change by M^-1 e_j L.
    Tree18 tree = as_tree(r.d);
    tree.laws[at].armature_kgm2 = 0.0;
    tree.laws[6 + (1 - side) * 6 + other].armature_kgm2 = 0.0;
    std::array<double, 18> unit{};
    unit[at] = 1.0;
    const auto response = solved(mass_matrix(tree, c.q), unit);
    const double impulse = (motor - c.qd[at]) / (1 / armature + response[at]);

    const double loss = biped::engage(r.p, side, clutch, r.laws, r.s);
    CHECK(loss == Approx(impulse * (motor - c.qd[at]) / 2).epsilon(1e-9));
    CHECK(had - energy() == Approx(loss).epsilon(1e-8).margin(1e-9));
    CHECK(loss > 0.0);
    for (std::size_t i = 0; i < biped::kJoints; ++i)
      CHECK(biped::joint<double>(r.s.qd_radps, i) ==
            Approx(c.qd[6 + i] + response[6 + i] * impulse).margin(1e-9));
    CHECK(r.s.rotors_radps[0][clutch][side] == biped::joint<double>(r.s.qd_radps, side * 6 + j));
    // What the motor lost is the impulse.
    CHECK(armature * (motor - r.s.rotors_radps[0][clutch][side]) == Approx(impulse).epsilon(1e-9));
    const auto after = biped::totals(r.p, r.s);
    const Vec3<double> linear = after.linear_ns - before.linear_ns,
                       spin = after.spin_nms() - before.spin_nms();
    CHECK(dot(linear, linear) < 1e-18);
    CHECK(dot(spin, spin) < 1e-18);
    CHECK(r.laws[0][j].joined[side]);
    CHECK(r.laws[0][j].armature_kgm2[side] == armature);
    CHECK_FALSE(r.laws[0][other].joined[1 - side]);
  }
}

TEST_CASE("A pin that enters takes the motor along, and gives the link what the motor loses") {
  Robot r;
  // Held in flight without gravity, at rest but for the motor.
  r.p.gravity_mps2 = {0.0, 0.0, 0.0};
  r.s.position_m.z = 5.0;
  biped::set_mode(r.p, biped::kRight, biped::kHipClutch, Mode::engaging, r.laws, r.s);
  r.s.rotors_radps[0][0].set(biped::kRight, 0.3);
  for (auto& l : r.laws[0]) l.friction_nm = l.damping_nmspr = dynamics::SimdBatch<double, 2>(0.0);
  auto& drive = r.p.drives[0][biped::kHipPitch];
  drive.kp_nmprad = drive.kd_nmsprad = drive.friction_nm = drive.damping_nmspr =
      dynamics::SimdBatch<double, 2>(0.0);
  auto pin = dynamics::biped_hip<double>();
  pin.pin_stroke_s = 1e-4;  // in before the motor has left the hole
  biped::Engaging<double> engaging(r.p, pin, biped::kRight, biped::kHipClutch, r.s);
  double impulse = 0.0, widest = 0.0;
  biped::StepReport<double> report;
  const double start = 1.28 * 0.3;
  for (int n = 0; n < 400; ++n) {
    engaging.before_step(r.s, biped::kStep_s, r.c);
    impulse += r.c.pin_nm[0][0][biped::kRight] * biped::kStep_s;
    biped::step<true>(r.p, r.laws, r.c, biped::kStep_s, r.s, report);
    engaging.after_step(r.s);
    const double apart = r.s.rotors_rad[0][0][biped::kRight] - biped::joint<double>(r.s.q_rad, kRightHip);
    widest = std::max(widest, std::abs(apart));
    CHECK(1.28 * r.s.rotors_radps[0][0][biped::kRight] + impulse == Approx(start).epsilon(1e-6));
  }
  CHECK(engaging.is_in());
  CHECK(impulse > 0.05);  // the link was taken along
  CHECK(widest > 0.006);  // through the play to the hole's wall
  // Then it presses by at most sqrt(J/k) 0.3 rad/s = 2.4 mrad: J is below the motor's 1.28 kg m^2.
  CHECK(widest < 0.006 + std::sqrt(1.28 / 2e4) * 0.3);
  CHECK(r.c.pin_nm[0][0][biped::kLeft] == 0.0);
}
