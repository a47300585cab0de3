// Motion with changes of mode: Runge-Kutta steps that end where a mode ends.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "furcula/dynamics/event_time.hpp"
#include "furcula/dynamics/members.hpp"
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
///   State                   with kMembers, pointers to its members, each of the scalar T, and kIntegrals, to
///                           those on which no rate depends
///   state()                 where it is, to read and to set
///   Look look(state)        a state (its member `state`) and what rates and margins of it share
///   rates(look)             of every member, in the mode of now
///   rates(state, near)      the same of a state that is a part of a step from one that was looked at
///   arrive(from, state, t)  looks at the state, `t` after the look `from`, put on the mode's constraint and
///                           with what has a closed form
///   longest_step()          that is accurate enough in the mode of now, s
///   changes()               what can end the mode: a range of Change
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
  using V = ValueOf<T>;
  using State = typename Machine::State;
  using Change = typename Machine::Change;
  using Look = typename Machine::Look;
  static constexpr int kMostChanges = 64;

  /// By `dt_s` seconds, in steps that are equal while the longest one stays; `elapsed` goes from 0 to dt_s.
  static void advance(Machine& machine, V dt_s, V& elapsed) {
    elapsed = V(0);
    int made = 0;
    Look here = machine.look(machine.state());
    for (T left = T(dt_s); value_of(left) > V(0);) {
      const V parts = value_of(left) / machine.longest_step();
      T until = left;
      if (parts > V(1.001)) until = T(value_of(left) / static_cast<V>(static_cast<int>(parts + V(0.999))));
      Look end = after(machine, here, until);
      bool changes = false;
      Change change{};
      if (made < kMostChanges) {
        for (const Change c : machine.changes()) {
          if (!(value_of(machine.margin(c, end)) < -machine.tolerance(c))) continue;
          until = crossing(machine, here, c, until);
          end = after(machine, here, until);
          change = c;
          changes = true;
        }
      }
      machine.state() = end.state;
      left = left - until;  // where the change's time has a derivative, so has the rest's
      elapsed = dt_s - value_of(left);
      if (changes) {
        machine.make(change);
        ++made;
        here = machine.look(machine.state());
      } else {
        here = end;
      }
    }
  }

 private:
  /// Without its integrals.
  static State along(const State& s, const State& rate, const T& t) {
    State out;
    for_each(State::kMembers, [&](auto m) { out.*m = s.*m + t * (rate.*m); });
    return out;
  }

  static Look after(const Machine& machine, const Look& here, const T& t) {
    const State& s = here.state;
    const T half = V(0.5) * t, sixth = t / V(6);
    const State a = machine.rates(here);
    const State b = machine.rates(along(s, a, half), here);
    const State c = machine.rates(along(s, b, half), here);
    const State d = machine.rates(along(s, c, t), here);
    State out;
    const auto sum = [&](auto m) { out.*m = s.*m + sixth * (a.*m + V(2) * (b.*m + c.*m) + d.*m); };
    for_each(State::kMembers, sum);
    for_each(State::kIntegrals, sum);
    return machine.arrive(here, out, t);
  }

  static T crossing(const Machine& machine, const Look& here, Change change, const T& to) {
    if (machine.follows(change) && !(value_of(machine.margin(change, here)) > V(0))) return T(V(0));
    if (!(value_of(to) > V(0))) return T(V(0));
    const auto margin = [&](const T& t) { return machine.margin(change, after(machine, here, t)); };
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
