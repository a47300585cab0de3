// Motion with changes of mode: Runge-Kutta steps that end where a mode ends.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "furcula/dynamics/event_time.hpp"
#include "furcula/dynamics/members.hpp"
#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// Moves a machine on in its modes. A machine has
///   State                   its members each of the scalar T
///   Look look()             the state of now (its member `state`) and what rates and margins of it share
///   take(look)              goes there
///   in_motion(f)            f(motion) with a type for the way in which it moves now; a step is compiled for each.
///                           Of the type: kMembers, pointers to the members of State that move, and kIntegrals, to
///                           those on which no rate depends
///   rates(motion, look)     of these members
///   rates(motion, state, near)  the same of a state that is a part of a step from one that was looked at
///   arrive(motion, from, t, end)  completes the look `end`, whose state is there, `t` after the look `from`: puts
///                           it on the mode's constraint, with what has a closed form
///   longest_step()          that is accurate enough in the mode of now, s
///   each_change(f)          f(change) of what can end the mode
///   margin(change, look)    positive while that does not happen
///   tolerance(change)       for a margin that starts at zero: it counts as crossed where it ends below minus
///                           that
///   follows(change)         whether a change happens at once where its margin starts at or below zero
///   make(change)            takes the machine through it, into the mode that follows
/// One classic Runge-Kutta step from change to change; each is located inside it (by further steps of the
/// same kind, so that location adds no error of its own) and carries its derivative by the implicit function
/// theorem. After kMostChanges in one advance() the rest passes in the mode of then.
template <class Machine, class T>
class Hybrid {
 public:
  /// The value type of T: float or double.
  using V = ValueOf<T>;
  /// All that is integrated.
  using State = typename Machine::State;
  /// What can end a mode.
  using Change = typename Machine::Change;
  /// A state with what its rates and margins share.
  using Look = typename Machine::Look;
  static constexpr int kMostChanges = 64;  ///< changes of mode in one advance()

  /// Moves the machine on by `dt_s` seconds, in steps of equal length while longest_step() is constant. `elapsed` is the
  /// time since the start of the call, s, for the machine to read.
  static void advance(Machine& machine, V dt_s, V& elapsed) {
    elapsed = V(0);
    int made = 0;
    Look looks[2] = {machine.look(), {}};
    Look *here = &looks[0], *end = &looks[1];
    for (T left = T(dt_s); value_of(left) > V(0);) {
      const V parts = value_of(left) / machine.longest_step();
      T until = left;
      if (parts > V(1.001)) until = T(value_of(left) / static_cast<V>(static_cast<int>(parts + V(0.999))));
      after(machine, *here, until, *end);
      bool changes = false;
      const auto look_at = [&](Change c) __attribute__((always_inline)) {
        changes |= is_past(machine, c, *end);
      };
      if (made < kMostChanges) machine.each_change(look_at);
      Change change{};
      if (changes) change = first_change(machine, *here, until, *end);
      left = left - until;  // where the change's time has a derivative, so has the rest's
      elapsed = dt_s - value_of(left);
      std::swap(here, end);
      if (!changes) continue;
      machine.take(*here);
      machine.make(change);
      ++made;
      *here = machine.look();
    }
    machine.take(*here);
  }

 private:
  static void after(const Machine& machine, const Look& here, const T& t, Look& out) {
    machine.in_motion([&](auto motion) { after(machine, motion, here, t, out); });
  }
  template <class Motion>
  static void after(const Machine& machine, Motion motion, const Look& here, const T& t, Look& out) {
    const State& s = here.state;
    const T half = V(0.5) * t, sixth = t / V(6);
    const auto along = [&](const State& rate, const T& by) {  // without its integrals
      State part = s;
      for_each<Motion::kMembers>([&](auto m) { part.*m = s.*m + by * (rate.*m); });
      return part;
    };
    const State a = machine.rates(motion, here);
    const State b = machine.rates(motion, along(a, half), here);
    const State c = machine.rates(motion, along(b, half), here);
    const State d = machine.rates(motion, along(c, t), here);
    out.state = s;
    const auto sum = [&](auto m) { out.state.*m = s.*m + sixth * (a.*m + V(2) * (b.*m + c.*m) + d.*m); };
    for_each<Motion::kMembers>(sum);
    for_each<Motion::kIntegrals>(sum);
    machine.arrive(motion, here, t, out);
  }

  [[gnu::always_inline]] static bool is_past(const Machine& machine, Change c, const Look& end) {
    return value_of(machine.margin(c, end)) < -machine.tolerance(c);
  }
  /// Of those that come to pass within `until`, which becomes its time, and `end` that time's look.
  static Change first_change(const Machine& machine, const Look& here, T& until, Look& end) {
    Change first{};
    machine.each_change([&](Change c) { take_earlier(machine, here, c, first, until, end); });
    return first;
  }
  static void take_earlier(const Machine& machine, const Look& here, Change c, Change& first, T& until,
                           Look& end) {
    if (!is_past(machine, c, end)) return;
    until = crossing(machine, here, c, until);
    after(machine, here, until, end);
    first = c;
  }

  static T crossing(const Machine& machine, const Look& here, Change change, const T& to) {
    if (machine.follows(change) && !(value_of(machine.margin(change, here)) > V(0))) return T(V(0));
    if (!(value_of(to) > V(0))) return T(V(0));
    const auto margin = [&](const T& t) {
      Look end;
      after(machine, here, t, end);
      return machine.margin(change, end);
    };
    const auto value = [&](V t) { return value_of(margin(T(t))); };
    const V end = value_of(to), time = event_time<V>(V(0), end, value);
    if constexpr (std::is_same_v<T, V>) {
      return time;
    } else {
      const V probe = V(1e-2) * end;
      const V rate = (value(time + probe) - value(time - probe)) / (V(2) * probe);
      if (rate == V(0)) return T(time);
      return T(time) - (margin(T(time)) - value(time)) / rate;
    }
  }
};

}  // namespace furcula::dynamics
