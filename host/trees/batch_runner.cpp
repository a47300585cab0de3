// Runs in lanes, see batch_runner.hpp.
#include "host/trees/batch_runner.hpp"

#include "host/trees/led_batch.hpp"

namespace furcula::trees {
namespace {

using T = LedBatch<double, static_cast<int>(BatchRunner::kLanes)>;
using Shape = dynamics::tree::DynamicTopology<BatchRunner::kMostJoints>;
using BatchSetup = SetupOf<T, Shape>;
using Law = dynamics::tree::JointLaw<double>;

/// number(0), number(1), ... in the lanes; those that there are not, as the first.
template <class F>
T in_lanes(std::size_t count, const F& number) {
  T out(number(std::size_t{0}));
  for (std::size_t lane = 1; lane < count; ++lane) out.lanes.set(lane, number(lane));
  return out;
}

BatchSetup setup_of(std::span<const Setup* const> setups) {
  const Setup& first = *setups.front();
  BatchSetup out;
  out.model = dynamics::tree::Model<T, Shape>(first.model);
  out.longest_step_s = first.longest_step_s;
  out.joints.resize(first.joints.size());
  const auto lanes = [&](const auto& number) {
    return in_lanes(setups.size(), [&](std::size_t lane) { return number(*setups[lane]); });
  };
  const auto vector = [&](const auto& of) {
    return dynamics::tree::Vec3<T>{lanes([&](const Setup& s) { return of(s).x; }),
                                   lanes([&](const Setup& s) { return of(s).y; }),
                                   lanes([&](const Setup& s) { return of(s).z; })};
  };
  out.model.gravity_mps2 = vector([](const Setup& s) { return s.model.gravity_mps2; });
  for (std::size_t i = 0; i < out.joints.size(); ++i) {
    out.model.laws[i] = dynamics::tree::joint_law_of<T>(first.model.laws[i], [&](auto coefficient) {
      return lanes([&](const Setup& s) { return s.model.laws[i].*coefficient; });
    });
    const auto body = [i](const Setup& s) -> const auto& { return s.model.aligned_inertia(i); };
    const auto moment = [&](auto part) {
      return lanes([&](const Setup& s) { return body(s).inertia_kgm2.*part; });
    };
    using Moments = dynamics::tree::Sym3<double>;
    out.model.set_aligned_inertia(i, {lanes([&](const Setup& s) { return body(s).mass_kg; }),
                                      vector([&](const Setup& s) { return body(s).moment_kgm; }),
                                      {moment(&Moments::xx), moment(&Moments::xy), moment(&Moments::xz),
                                       moment(&Moments::yy), moment(&Moments::yz), moment(&Moments::zz)}});
    const Setup::Joint& j = first.joints[i];
    const auto drive = [&](auto number) {
      return lanes([&](const Setup& s) { return s.joints[i].*number; });
    };
    BatchSetup::Joint& d = out.joints[i];
    d.law = j.law;
    d.kp_nmprad = drive(&Setup::Joint::kp_nmprad);
    d.kd_nmsprad = drive(&Setup::Joint::kd_nmsprad);
    d.gain = drive(&Setup::Joint::gain);
    d.lag_s = drive(&Setup::Joint::lag_s);
    d.limit_nm = drive(&Setup::Joint::limit_nm);
    d.ripple_nm = drive(&Setup::Joint::ripple_nm);
    d.ripple_cycles = drive(&Setup::Joint::ripple_cycles);
    d.ripple_phase_rad = drive(&Setup::Joint::ripple_phase_rad);
    d.offset_nm = drive(&Setup::Joint::offset_nm);
    d.encoder_offset_rad = drive(&Setup::Joint::encoder_offset_rad);
    d.held_torque = j.held_torque;
    d.stepwise = j.stepwise;
  }
  return out;
}

}  // namespace

struct BatchRunner::Lanes {
  std::size_t count, joints;
  BatchSetup setup;
  RunnerOf<T, Shape> runner;
  std::vector<T> disturbance;

  explicit Lanes(std::span<const Setup* const> setups)
      : count(setups.size()),
        joints(setups.front()->joints.size()),
        setup(setup_of(setups)),
        runner(setup),
        disturbance(joints) {}

  /// Of numbers of the places, the joint's.
  template <class F>
  T at(std::span<const Runner::Place> places, const F& number) const {
    return in_lanes(count, [&](std::size_t lane) { return number(places[lane]); });
  }
};

bool BatchRunner::fits(const Setup& first, const Setup& other) {
  const std::size_t n = first.joints.size();
  if (n > kMostJoints || first.extension_m != other.extension_m ||
      first.longest_step_s != other.longest_step_s ||
      first.model.foothold.joint != other.model.foothold.joint)
    return false;
  const auto alike = [](double a, double b) { return (a != 0.0) == (b != 0.0); };
  for (std::size_t i = 0; i < n; ++i) {
    const Setup::Joint &j = first.joints[i], &k = other.joints[i];
    if (j.law != k.law || j.delay_s != k.delay_s || j.held_torque != k.held_torque ||
        j.stepwise != k.stepwise || !alike(j.lag_s, k.lag_s) || !alike(j.limit_nm, k.limit_nm) ||
        !alike(j.ripple_nm, k.ripple_nm))
      return false;
    const Law &a = first.model.laws[i], &b = other.model.laws[i];
    if (a.two_sided != b.two_sided || a.elastic != b.elastic || a.asymmetric != b.asymmetric) return false;
    for (const auto law : {&Law::one_way_nmprad, &Law::friction_nm, &Law::static_friction_nm,
                           &Law::friction_back_nm, &Law::stribeck_velocity_radps, &Law::load_friction_ratio,
                           &Law::binding_friction_nm, &Law::drag_nms2prad2})
      if (!alike(a.*law, b.*law)) return false;
  }
  return true;
}

BatchRunner::BatchRunner(std::span<const Setup* const> setups, std::span<const Runner::Place> starts)
    : lanes_(std::make_unique<Lanes>(setups)) {
  RunnerOf<T, Shape>::Plant::Joints q{}, v{};
  for (std::size_t i = 0; i < lanes_->joints; ++i) {
    q[i] = lanes_->at(starts, [i](const Runner::Place& p) { return p.plant.position_rad[i]; });
    v[i] = lanes_->at(starts, [i](const Runner::Place& p) { return p.plant.velocity_radps[i]; });
  }
  lanes_->runner.start(q, v);
  go_to(starts);
}

BatchRunner::~BatchRunner() = default;

void BatchRunner::go_to(std::span<const Runner::Place> places) {
  RunnerOf<T, Shape>::Place to;
  const Runner::Place& first = places.front();
  to.lagged_nm.resize(lanes_->joints);
  to.acceleration_radps2.resize(lanes_->joints);
  for (std::size_t i = 0; i < lanes_->joints; ++i) {
    using P = Runner::Plant::Place;
    const auto of_plant = [&](auto numbers) {
      return lanes_->at(places, [&](const Runner::Place& p) { return (p.plant.*numbers)[i]; });
    };
    to.plant.position_rad[i] = of_plant(&P::position_rad);
    to.plant.velocity_radps[i] = of_plant(&P::velocity_radps);
    to.plant.rotor_rad[i] = of_plant(&P::rotor_rad);
    to.plant.rotor_radps[i] = of_plant(&P::rotor_radps);
    to.plant.mode.held[i] = first.plant.mode.held[i];
    to.plant.mode.direction[i] = first.plant.mode.direction[i];
    to.plant.mode.spot[i] = first.plant.mode.spot[i];
    to.lagged_nm[i] = lanes_->at(places, [i](const Runner::Place& p) { return p.lagged_nm[i]; });
    to.acceleration_radps2[i] =
        lanes_->at(places, [i](const Runner::Place& p) { return p.acceleration_radps2[i]; });
  }
  lanes_->runner.go_to(to);
}

Runner::Place BatchRunner::place(std::size_t lane) const {
  const auto from = lanes_->runner.place();
  Runner::Place out;
  for (std::size_t i = 0; i < lanes_->joints; ++i) {
    out.plant.position_rad[i] = from.plant.position_rad[i].lanes[lane];
    out.plant.velocity_radps[i] = from.plant.velocity_radps[i].lanes[lane];
    out.plant.rotor_rad[i] = from.plant.rotor_rad[i].lanes[lane];
    out.plant.rotor_radps[i] = from.plant.rotor_radps[i].lanes[lane];
    out.plant.mode.held[i] = from.plant.mode.held[i];
    out.plant.mode.direction[i] = from.plant.mode.direction[i];
    out.plant.mode.spot[i] = from.plant.mode.spot[i];
    out.lagged_nm.push_back(from.lagged_nm[i].lanes[lane]);
    out.acceleration_radps2.push_back(from.acceleration_radps2[i].lanes[lane]);
  }
  return out;
}

void BatchRunner::disturb(std::size_t lane, std::size_t joint, double torque_nm) {
  lanes_->disturbance[joint].lanes.set(lane, torque_nm);
  lanes_->runner.disturb(joint, lanes_->disturbance[joint]);
}

void BatchRunner::advance(std::span<const double> input, double dt_s) { lanes_->runner.advance(input, dt_s); }

void BatchRunner::advance_each(std::span<const double> inputs, double dt_s) {
  const std::size_t n = lanes_->joints;
  std::vector<T> of_joints;
  for (std::size_t i = 0; i < n; ++i)
    of_joints.push_back(in_lanes(lanes_->count, [&](std::size_t lane) { return inputs[lane * n + i]; }));
  lanes_->runner.advance(of_joints, dt_s);
}

double BatchRunner::measured(std::size_t lane, std::size_t joint) const {
  return lanes_->runner.measured(joint).lanes[lane];
}

std::size_t BatchRunner::steps() const { return kStep * lanes_->runner.steps(); }

}  // namespace furcula::trees
