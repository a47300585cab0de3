// Simulation of a tree: Runge-Kutta steps that end where a joint comes to rest or begins to move.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "furcula/dynamics/event_time.hpp"
#include "furcula/dynamics/tree/dry_friction.hpp"
#include "furcula/dynamics/tree/energy.hpp"

namespace furcula::dynamics::tree {

/// The time of a change as it is used in a step over `step`: of a batch, whose lanes have times of their own, no lane's is outside of it.
template <class T>
constexpr const T& inside_step(const T& time, const T& step) {
  static_cast<void>(step);
  return time;
}

/// A tree with dry friction and elastic drives. The torque is constant over an advance(). Between changes of the
/// friction mode the steps are classic Runge-Kutta (error of fourth order). A joint that comes to rest, the break-away of
/// a held joint and the edges of binding spots are located inside the step; their times have derivatives
/// (docs/decisions/0005). The position of a held joint is bitwise constant. Dry friction acts between a body and its
/// parent; the rotor of an elastic drive has none. Load friction has a kink where the torque of an elastic drive's spring
/// is zero: the step over it is of second order.
template <class T, Topology P>
class Plant {
 public:
  using M = Model<T, P>;              ///< the model
  using V = typename M::V;            ///< the plain number behind the scalar T
  using Joints = typename M::Joints;  ///< one number for each joint
  static constexpr int kMostChanges =
      64;  ///< located in one advance(); then the friction mode stays to its end
  static constexpr V kShortest = V(5e-3);  ///< shortest step over the longest

  /// The complete state of a plant: from it go_to() continues the same motion.
  struct Place {
    Joints position_rad{},              ///< of joints
        velocity_radps{},               ///< of joints
        rotor_rad{},                    ///< angles of elastic drives' rotors, at the joint
        rotor_radps{};                  ///< rates of these rotors
    FrictionMode<P::kCapacity> mode{};  ///< of dry friction
  };

  /// The step is at most `longest_step_s` and at most what the springs and dampers of joints and drives allow in the posture
  /// of reset(), but at least kShortest times `longest_step_s` (for 4 ms: stable for decay times from 8 us).
  explicit Plant(const M& model, V longest_step_s = V(1e-3)) : model_(model), longest_step_(longest_step_s) {
    if constexpr (!kPlain) plain_ = Model<V, P>(model);
  }

  /// Starts at these positions and velocities. Rotors of elastic drives start with relaxed springs and the joints' velocity. A
  /// stance foot is stopped by an impact without bounce (foothold.hpp).
  void reset(const Joints& q_rad, const Joints& qd_radps) {
    Joints qd = qd_radps;
    if (model_.foothold.joint >= 0) stop_foot(model_, q_rad, qd);
    state_ = {q_rad, qd, q_rad, qd};
    mode_ = {};
    changes_ = 0;
    dry_ = false;
    for (std::size_t i = 0; i < count(); ++i) dry_ |= is_dry(model_.laws[i]);
    step_ = stable_step();
  }
  /// The present state.
  Place place() const { return {state_.position, state_.velocity, state_.rotor, state_.rotor_rate, mode_}; }
  /// Continues from a state of place(), or from one near it; the step stays that of reset().
  void go_to(const Place& p) {
    state_ = {p.position_rad, p.velocity_radps, p.rotor_rad, p.rotor_radps};
    mode_ = p.mode;
  }
  /// After reset(): sets angle and rate of the rotor of an elastic drive.
  void place_rotor(std::size_t joint, const T& angle_rad, const T& rate_radps) {
    state_.rotor[joint] = angle_rad;
    state_.rotor_rate[joint] = rate_radps;
  }

  /// Changes the rest position of the joint's spring: the set point of a position drive whose gains are the joint's stiffness
  /// and damping.
  void set_rest(std::size_t joint, const T& rest_rad) {
    model_.laws[joint].rest_rad = rest_rad;
    if constexpr (!kPlain) plain_.laws[joint].rest_rad = value_of(rest_rad);
  }

  /// Replaces damping, springs and friction of the joint; the step stays that of reset().
  void set_law(std::size_t joint, const JointLaw<T>& law) {
    model_.laws[joint] = law;
    if constexpr (!kPlain)
      plain_.laws[joint] = joint_law_of<V>(law, [&](auto coefficient) { return value_of(law.*coefficient); });
    dry_ |= is_dry(law);
  }

  /// Integrates over `dt_s` >= 0 under constant torques of the drives (N m; of a prismatic joint N).
  void advance(const Joints& torque_nm, V dt_s) {
    changes_ = 0;
    const Of<V> plain_torque = plain(torque_nm);
    if (dry_) place_in_spots(model_, state_.position, mode_);
    settle(plain_torque);
    for (T left = T(dt_s); value_of(left) > V(0);) {
      const V parts = value_of(left) / step_;
      T until = left;
      if (parts > V(1.001)) until = T(value_of(left) / std::ceil(parts - V(0.001)));
      State<T> end = after(model_, state_, torque_nm, until);
      std::size_t change = count();
      if (dry_ && changes_ < kMostChanges) {
        Of<V> at_end = margins(plain_model(), plain(end), plain_torque);
        for (std::size_t i = 0; i < count(); ++i) {
          if (!(at_end[i] < V(0))) continue;
          until = crossing(i, torque_nm, plain_torque, until);
          end = after(model_, state_, torque_nm, until);
          at_end = margins(plain_model(), plain(end), plain_torque);
          change = i;
        }
      }
      left = left - until;  // where the change's time has a derivative, so has the rest's
      state_ = end;
      if (change == count()) {
        if (dry_) set_out();
        continue;
      }
      if (at_edge(change))
        cross_edge(change);
      else if (!mode_.held[change])
        state_.velocity[change] = T(V(0));
      ++changes_;
      settle(plain_torque);
    }
  }

  /// Number of joints.
  std::size_t count() const { return model_.count(); }
  /// The model, with the changes of set_rest() and set_law().
  const M& model() const { return model_; }
  /// Of the joints, rad or m.
  const Joints& positions() const { return state_.position; }
  /// Of the joints, rad/s or m/s.
  const Joints& velocities() const { return state_.velocity; }
  /// Angle of an elastic drive's rotor at the joint, rad; of no meaning for other drives.
  const T& rotor_angle(std::size_t joint) const { return state_.rotor[joint]; }
  /// Rate of an elastic drive's rotor, rad/s; of no meaning for other drives.
  const T& rotor_rate(std::size_t joint) const { return state_.rotor_rate[joint]; }
  /// Whether dry friction holds the joint, as of the last change of the friction mode.
  bool held(std::size_t joint) const { return mode_.held[joint]; }
  /// Events inside the last advance(): joints that came to rest, broke away or crossed an edge of a binding spot.
  int changes() const { return changes_; }
  /// Integration steps since construction, including those of the event search.
  std::uint32_t steps() const { return steps_; }

  /// Mechanical energy of bodies and springs, and of rotors and springs of elastic drives, J; without the unilateral springs.
  T energy_j() const {
    T out = kinetic_energy_j(model_, state_.position, state_.velocity) +
            potential_energy_j(model_, state_.position);
    for (std::size_t i = 0; i < count(); ++i) {
      const JointLaw<T>& law = model_.laws[i];
      if (!law.elastic) continue;
      const T stretch = state_.rotor[i] - state_.position[i], rate = state_.rotor_rate[i];
      out += (law.armature_kgm2 * rate * rate + law.drive_stiffness_nmprad * stretch * stretch) * V(0.5);
    }
    return out;
  }

 private:
  static constexpr bool kPlain = std::is_same_v<T, V>;
  // How far beyond its bound a joint is let go: enough that it then moves, whatever the rounding.
  static constexpr V kBeyond = sizeof(V) == 4 ? V(1e-5) : V(1e-9);

  template <class S>
  using Of = std::array<S, P::kCapacity>;
  template <class S>
  struct State {
    Of<S> position{}, velocity{}, rotor{}, rotor_rate{};
  };

  const Model<V, P>& plain_model() const {
    if constexpr (kPlain)
      return model_;
    else
      return plain_;
  }
  Of<V> plain(const Of<T>& x) const {
    Of<V> out{};
    for (std::size_t i = 0; i < count(); ++i) out[i] = value_of(x[i]);
    return out;
  }
  State<V> plain(const State<T>& s) const {
    if constexpr (kPlain)
      return s;
    else
      return {plain(s.position), plain(s.velocity), plain(s.rotor), plain(s.rotor_rate)};
  }

  /// The drives' torques as they reach the joints.
  template <class S>
  static Of<S> at_joints(const Model<S, P>& m, const State<S>& s, const Of<S>& torque) {
    Of<S> out = torque;
    for (std::size_t i = 0; i < m.count(); ++i)
      if (m.laws[i].elastic)
        out[i] = m.laws[i].drive_stiffness_nmprad * (s.rotor[i] - s.position[i]) +
                 m.laws[i].drive_damping_nmspr * (s.rotor_rate[i] - s.velocity[i]);
    return out;
  }

  /// One Runge-Kutta step over t.
  template <class S>
  State<S> after(const Model<S, P>& m, const State<S>& s, const Of<S>& torque, const S& t) const {
    ++steps_;
    State<S> sum = s, stage = s;
    Accelerations<Model<S, P>> joints;
    const V weight[4] = {V(1) / V(6), V(1) / V(3), V(1) / V(3), V(1) / V(6)};
    const V ahead[4] = {V(0.5), V(0.5), V(1), V(0)};
    for (std::size_t k = 0; k < 4; ++k) {
      const Of<S> tau = at_joints(m, stage, torque);
      forward_in_mode(m, stage.position, stage.velocity, tau, mode_, joints);
      const S share = t * weight[k], on = t * ahead[k];
      for (std::size_t i = 0; i < m.count(); ++i) {
        const JointLaw<S>& law = m.laws[i];
        const S velocity = stage.velocity[i];
        sum.position[i] += share * velocity;
        sum.velocity[i] += share * joints.joint_radps2[i];
        stage.position[i] = s.position[i] + on * velocity;
        stage.velocity[i] = s.velocity[i] + on * joints.joint_radps2[i];
        if (!law.elastic) continue;
        const S rate = stage.rotor_rate[i];
        const S acceleration = (torque[i] - law.rotor_damping_nmspr * rate - tau[i]) / law.armature_kgm2;
        sum.rotor[i] += share * rate;
        sum.rotor_rate[i] += share * acceleration;
        stage.rotor[i] = s.rotor[i] + on * rate;
        stage.rotor_rate[i] = s.rotor_rate[i] + on * acceleration;
      }
    }
    return sum;
  }

  /// Margin of each joint, positive while its mode lasts: its velocity in its direction or its distance to the binding spot's
  /// next edge, whichever is less; of a held joint, break-away torque less holding torque. Zero without dry friction.
  template <class S>
  Of<S> margins(const Model<S, P>& m, const State<S>& s, const Of<S>& torque) const {
    Of<S> out{};
    Accelerations<Model<S, P>> joints;
    bool any_held = false;
    for (std::size_t i = 0; i < m.count(); ++i) any_held |= mode_.held[i];
    Of<S> tau;
    if (any_held) {
      tau = at_joints(m, s, torque);
      forward_in_mode(m, s.position, s.velocity, tau, mode_, joints);
    }
    for (std::size_t i = 0; i < m.count(); ++i) {
      if (!mode_.held[i]) {
        out[i] = s.velocity[i] * static_cast<V>(mode_.direction[i]);
        if (mode_.spot[i] == Spot::none) continue;
        const S way = way_to_edge(m.laws[i], s.position[i], mode_.spot[i]);
        if (mode_.direction[i] == 0 || value_of(way) < value_of(out[i])) out[i] = way;
        continue;
      }
      const S& holding = joints.holding_nm[i];
      const bool forth = value_of(holding) < V(0);
      const S bound = break_away_torque(m.laws[i], tau[i], forth ? 1 : -1, mode_.spot[i]) * (V(1) + kBeyond);
      out[i] = forth ? S(bound + holding) : S(bound - holding);
    }
    return out;
  }

  /// When joint i's mode ends, before `to`, at which it has ended.
  T crossing(std::size_t i, const Of<T>& torque, const Of<V>& plain_torque, const T& to) const {
    const State<V> here = plain(state_);
    const auto value = [&](V t) {
      return margins(plain_model(), after(plain_model(), here, plain_torque, t), plain_torque)[i];
    };
    const V end = value_of(to);
    // The margin of a joint that has just begun to move starts at zero: its mode ends after the margin was positive.
    V from = V(0);
    if (!(value(V(0)) > V(0))) {
      from = end;
      for (int halvings = 0; halvings < 20 && !(value(from) > V(0)); ++halvings) from *= V(0.5);
      if (!(value(from) > V(0))) return T(V(0));
    }
    const V time = event_time<V>(from, end, value);
    if constexpr (kPlain) {
      return time;
    } else {
      const V probe = V(1e-2) * end;
      const V rate = (value(time + probe) - value(time - probe)) / (V(2) * probe);
      if (rate == V(0)) return T(time);
      const T there = margins(model_, after(model_, state_, torque, T(time)), torque)[i];
      return inside_step(T(T(time) - (there - value_of(there)) / rate), to);
    }
  }

  void settle(const Of<V>& torque) {
    if (!dry_) return;
    const State<V> s = plain(state_);
    if (mode_of_motion(plain_model(), s.velocity, mode_) == 0) return;
    Accelerations<Model<V, P>> joints;
    settle_in_spots(plain_model(), s.position, s.velocity, at_joints(plain_model(), s, torque), mode_,
                    joints);
  }
  /// Joints at rest that nothing held nor moved have a direction once they move.
  void set_out() {
    for (std::size_t i = 0; i < count(); ++i)
      if (mode_.direction[i] == 0 && !mode_.held[i] && is_dry(model_.laws[i]))
        mode_.direction[i] = sign_of(value_of(state_.velocity[i]));
  }

  /// Whether it is the binding spot's edge at which joint i's mode has ended.
  bool at_edge(std::size_t i) const {
    if (mode_.held[i] || mode_.spot[i] == Spot::none) return false;
    const V way = value_of(way_to_edge(model_.laws[i], state_.position[i], mode_.spot[i]));
    return mode_.direction[i] == 0 || way < value_of(state_.velocity[i]) * static_cast<V>(mode_.direction[i]);
  }
  void cross_edge(std::size_t i) {
    if (mode_.spot[i] != Spot::within)
      mode_.spot[i] = Spot::within;
    else
      mode_.spot[i] = value_of(state_.position[i]) < value_of(model_.laws[i].binding_centre_rad)
                          ? Spot::before
                          : Spot::beyond;
  }

  /// The step, joint by joint: a quarter of a radian of the fastest oscillation (a period then loses 1e-4 of its energy), a
  /// quarter of the time constant of the fastest non-linear damping (drag at the start velocity, the Stribeck curve where it
  /// is steepest), and half of the time constant of viscous damping (the error of a step is then 4e-4 of it).
  V stable_step() const {
    const Model<V, P>& m = plain_model();
    const State<V> s = plain(state_);
    const auto larger = [](V a, V b) { return a > b ? a : b; };
    V step = longest_step_;
    Of<V> still{}, torque{};
    const Of<V> without = accelerations(m, s.position, still, torque);
    for (std::size_t i = 0; i < count(); ++i) {
      const JointLaw<V>& law = m.laws[i];
      V stiffness = law.stiffness_nmprad + law.one_way_nmprad, damping = law.damping_nmspr, mobility = V(0),
        decay = V(0);
      if (law.elastic) {
        mobility = V(1) / law.armature_kgm2;
        decay = law.rotor_damping_nmspr * mobility;
        stiffness += law.drive_stiffness_nmprad;
        damping += law.drive_damping_nmspr;
      }
      const V speed = s.velocity[i] < V(0) ? -s.velocity[i] : s.velocity[i];
      V bent = V(2) * law.drag_nms2prad2 * speed;
      if (law.stribeck_velocity_radps > V(0)) {
        // The slope of exp(-x^2) is at most sqrt(2 / e) = 0.86.
        const V less = larger(law.static_friction_nm - law.friction_nm,
                              law.asymmetric ? V(law.static_friction_nm - law.friction_back_nm) : V(0));
        bent = larger(bent, V(0.86) * less / law.stribeck_velocity_radps);
      }
      torque[i] = V(1);
      mobility += accelerations(m, s.position, still, torque)[i] - without[i];
      torque[i] = V(0);
      decay = V(0.5) * (decay + damping * mobility) + bent * mobility;
      const V rate = larger(decay, std::sqrt(larger(stiffness * mobility, V(0))));
      if (rate * step > V(0.25)) step = V(0.25) / rate;
    }
    return larger(step, kShortest * longest_step_);
  }

  struct None {};
  M model_;
  [[no_unique_address]] std::conditional_t<kPlain, None, Model<V, P>> plain_{};
  V longest_step_;
  V step_ = longest_step_;
  State<T> state_{};
  FrictionMode<P::kCapacity> mode_;
  bool dry_ = false;  ///< any joint
  int changes_ = 0;
  mutable std::uint32_t steps_ = 0;
};

}  // namespace furcula::dynamics::tree
