// Motion with changes of mode: Runge-Kutta steps that end where a mode ends.
#pragma once

#include <array>
#include <cstddef>

#include "furcula/dynamics/event_time.hpp"
#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// What can end a mode.
template <class Change, std::size_t kMost>
class Changes {
 public:
  void add(const Change& c) { all_[count_++] = c; }
  const Change* begin() const { return all_.data(); }
  const Change* end() const { return all_.data() + count_; }

 private:
  std::array<Change, kMost> all_{};
  std::size_t count_ = 0;
};

/// Moves a machine on in its modes. A machine has
///   State                     with kMembers, pointers to its members, each of the scalar T
///   state()                   where it is, to read and to set
///   rates(state)              of every member, in the mode of now
///   kept(state)               the state on the mode's constraint
///   longest_step()            that is accurate enough in the mode of now, s
///   changes()                 what can end the mode: a range of Change
///   margin(change, state)     positive while that does not happen, with its tolerance(change) for a margin
///                             that starts at zero: it counts as crossed where it ends below minus that
///   follows(change)           whether a change happens at once where its margin starts at or below zero
///   make(change)              takes the machine through it, into the mode that follows
/// One classic Runge-Kutta step from change to change; each is located inside it (by further steps of the
/// same kind, so that location adds no error of its own) and carries its derivative by the implicit function
/// theorem. After kMostChanges the rest passes in the mode of then.
template <class Machine, class T>
class Hybrid {
 public:
  using V = ValueOf<T>;
  using State = typename Machine::State;
  using Change = typename Machine::Change;
  static constexpr int kMostChanges = 16;

  /// By `dt_s` seconds, in equal steps while the longest one stays; `elapsed` goes from 0 to dt_s.
  static void advance(Machine& machine, V dt_s, V& elapsed) {
    elapsed = V(0);
    while (elapsed < dt_s) {
      const V start = elapsed, left = dt_s - start;
      const V parts = left / machine.longest_step();
      const V h = parts <= V(1.001) ? left : left / static_cast<V>(static_cast<int>(parts + V(0.999)));
      pass(machine, T(h), elapsed);
      elapsed = h < left ? start + h : dt_s;
    }
  }

 private:
  static void pass(Machine& machine, T left, V& elapsed) {
    for (int round = 0; round < kMostChanges; ++round) {
      if (!(value_of(left) > V(0))) return;
      State end = after(machine, left);
      bool changes = false;
      Change change{};
      T until = left;
      for (const Change c : machine.changes()) {
        if (!(value_of(machine.margin(c, end)) < -machine.tolerance(c))) continue;
        until = crossing(machine, c, until);
        end = after(machine, until);
        change = c;
        changes = true;
      }
      machine.state() = end;
      elapsed += value_of(until);
      left = left - until;
      if (!changes) return;
      machine.make(change);
    }
    machine.state() = after(machine, left);
    elapsed += value_of(left);
  }

  static State along(const State& s, const State& rate, const T& t) {
    State out = s;
    for (const auto member : State::kMembers) out.*member += t * (rate.*member);
    return out;
  }

  static State after(const Machine& machine, const T& t) {
    const State& s = machine.state();
    const T half = V(0.5) * t, sixth = t / V(6);
    const State a = machine.rates(s);
    const State b = machine.rates(along(s, a, half));
    const State c = machine.rates(along(s, b, half));
    const State d = machine.rates(along(s, c, t));
    State out = s;
    for (const auto m : State::kMembers) out.*m += sixth * (a.*m + V(2) * (b.*m + c.*m) + d.*m);
    return machine.kept(out);
  }

  static T crossing(const Machine& machine, Change change, const T& to) {
    if (machine.follows(change) && !(value_of(machine.margin(change, machine.state())) > V(0)))
      return T(V(0));
    if (!(value_of(to) > V(0))) return T(V(0));
    const V end = value_of(to), probe = V(1e-2) * end;
    const auto value = [&](V t) { return value_of(machine.margin(change, after(machine, T(t)))); };
    const auto slope = [&](V t) { return (value(t + probe) - value(t - probe)) / (V(2) * probe); };
    const V time = event_time<V>(V(0), end, value, slope);
    const V rate = slope(time);
    if (rate == V(0)) return T(time);
    return T(time) - (machine.margin(change, after(machine, T(time))) - value(time)) / rate;
  }
};

}  // namespace furcula::dynamics
