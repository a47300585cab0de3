// Lets the leg's spring go in flight and catches it before touch-down: release, make sure that it let go,
// fold and stretch the leg, bring the cable to a tooth, catch, make sure that it holds (002 chapter 5).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "furcula/control/height.hpp"
#include "furcula/control/leg_position.hpp"
#include "furcula/control/phase.hpp"
#include "furcula/core/count.hpp"

namespace furcula::control {

/// Lengths and forces of the cable are as seen along the leg.
struct ClutchConfig {
  std::uint32_t fitted = 0;             ///< 1: the robot has a clutch
  std::uint32_t release_in_flight = 0;  ///< 1; 0: the spring stays caught
  float metres_per_count = 3.5714e-5f;  ///< 2400 counts a turn of 60 mm of cable, 0.7 of cable to one of leg
  float tooth_pitch_m = 4.2857e-3f;     ///< cable travel from one tooth to the next
  float tooth_play_m = 1.4286e-3f;      ///< travel of a caught belt between the key's flanks
  float spring_npm = 605.0f;            ///< stiffness of the spring along the leg
  float spring_rest_m = 0.289f;         ///< leg's length at which the caught spring is relaxed

  float contraction_m =
      0.0f;  ///< by which the leg folds in flight; also without a release, where none is asked
  float contraction_s = 0.2f;            ///< that folding and stretching take where the flight is long enough
  float shortest_contraction_s = 0.08f;  ///< in flights that leave less there is no release
  float most_acceleration_mps2 = 250.0f;  ///< of the leg's length: a contraction that takes more is smaller
  float liftoff_confirmed_s = 0.004f;     ///< in flight with the leg on its stop for so long
  float touchdown_margin_s = 0.012f;      ///< from the verified catch to touch-down

  float release_delay_s = 0.020f;  ///< from coil on until the belt is free, to begin with
  float catch_wait_s = 0.020f;     ///< from coil off until the belt is held, to begin with
  float longest_delay_s = 0.060f;  ///< that either can be
  float resolution_s = 0.0025f;    ///< to which the wait for the catch is learned
  float moved_m = 1.5e-4f;         ///< a cable that moved so far is not held
  float hesitation_m = 0.004f;  ///< fold beyond that of a free cable's start, and no further while it is held
  float still_mps = 0.02f;      ///< slow enough to be caught
  float homing_s = 0.012f;      ///< that the cable takes to come to rest
  /// Fold whose pull moves a cable that is not held, and also one that only the key's tips rub on.
  float test_pull_m = 0.010f;
  float test_s = 0.040f;      ///< duration of the test pull, from the stretched leg and back
  float straight_m = 0.004f;  ///< a leg that is shorter by less is on its stop
  float onset_m = 0.004f;     ///< fold at which a free cable starts to move
  float creep_s = 0.0005f;    ///< by which the release is taken to be faster until the leg has to wait for it
  std::uint32_t failed_releases_max = 3;  ///< running; then it is tried in every tenth flight
};

/// homing: the leg is back, the cable comes to rest at a tooth. aborting: the belt was not let go, the leg
/// goes back gently.
enum class ClutchStage : std::uint8_t { caught, releasing, folding, homing, catching, testing, aborting };

/// Since begin_clutch().
struct ClutchCounts {
  std::uint32_t releases = 0;         ///< that were seen to let go
  std::uint32_t failed_releases = 0;  ///< that were not
  std::uint32_t catches = 0;          ///< verified in flight
  std::uint32_t slipped = 0;          ///< catches that did not hold when pulled
  std::uint32_t retries = 0;          ///< of those: released and caught once more
  std::uint32_t missed = 0;           ///< stances that began on a free spring
};

/// State of sequence_clutch(). Made by begin_clutch().
struct ClutchState {
  ClutchStage stage = ClutchStage::caught;  ///< as of the last tick
  std::uint8_t next = 0;             ///< index of the oldest entry of `cable_counts`, which is replaced next
  bool coil = false;                 ///< wanted on
  bool tried = false;                ///< in this flight
  bool began_held = true;            ///< the release of this flight, with the cable held by the key
  bool released = false;             ///< in this flight: the cable was seen to move
  bool waited = false;               ///< in this flight: the leg, for the cable
  bool missed_here = false;          ///< this stance is counted as missed
  std::uint32_t ticks_in_stage = 0;  ///< since it was entered; stops while the leg waits for the cable
  std::uint32_t ticks_of_coil = 0;   ///< since it was switched last
  std::array<std::int32_t, 4> cable_counts{};  ///< of the last four ticks, a ring buffer
  float landed_m = 0.0f;                       ///< travel at touch-down
  float held_m = 0.0f;                         ///< where the flank was that held the cable
  std::int32_t tooth = 0;                      ///< at which the cable is to be caught
  float contraction_m = 0.0f,                  ///< by which the leg folds in this flight
      contraction_s = 1.0f;                    ///< duration of folding and stretching in this flight
  float hold_m = 0.0f;                         ///< fold that brings the tooth under the key
  float release_delay_s = 0.0f;                ///< learned time from coil on until the belt is free
  float held_after_s = 0.0f;                   ///< shortest wait after which a catch held
  float free_after_s = 0.0f;                   ///< longest wait after which one did not
  std::uint32_t flights = 0,                   ///< lift-offs since begin_clutch() or restart_clutch()
      failed_running = 0,                      ///< failed releases since the last one that succeeded
      slipped_running = 0,  ///< slips after a wait that had held before, since the last verified catch
      missed_running = 0;   ///< stances in succession that began on a free spring
  ClutchCounts counts;      ///< for telemetry
};

/// What one tick of it sees.
struct ClutchView {
  PhaseEstimate phase;           ///< of this tick
  float time_left_s = 0.0f;      ///< until touch-down
  float leg_fold_m = 0.0f;       ///< by which the leg is shorter than on its stop
  std::int32_t cable_count = 0;  ///< from home
  bool coil_ready = true;        ///< it may be switched on
};

/// What one tick of the sequence yields.
struct ClutchEstimate {
  ClutchStage stage = ClutchStage::caught;  ///< after this tick
  bool coil = false;                        ///< wanted
  bool drives_leg = false;                  ///< along `path`
  LegPath path;                             ///< target of the leg's fold; used where `drives_leg`
  float travel_m = 0.0f;                    ///< of the cable from home
};

/// Whether there is anything to do in flight.
inline bool moves_leg_in_flight(const ClutchConfig& config) {
  return config.fitted != 0 || config.contraction_m > 0.0f;
}

/// The state before the first tick: caught, with the configured delays.
inline ClutchState begin_clutch(const ClutchConfig& config) {
  ClutchState state;
  state.release_delay_s = config.release_delay_s;
  state.held_after_s = config.catch_wait_s;
  state.free_after_s = 0.5f * config.catch_wait_s;
  return state;
}

/// After a fault: what it has learned and counted stays, and there is no release before the next lift-off.
inline void restart_clutch(ClutchState& state, const ClutchConfig& config, std::int32_t cable_count) {
  state.tried = state.released = state.missed_here = false;
  state.flights = state.failed_running = state.slipped_running = state.missed_running = 0;
  state.tooth = 0;
  state.landed_m = static_cast<float>(cable_count) * config.metres_per_count;
}

/// In a fault: the coil goes off, the leg is not driven.
inline void abandon(ClutchState& state) {
  state.stage = ClutchStage::caught;
  state.coil = false;
  state.ticks_of_coil = 0;
}

/// Force of the spring along the leg, N, whose cable has moved by `travel_m`; 0 where it is slack.
inline float spring_pull_n(const ClutchConfig& config, float leg_m, float travel_m) {
  const float stretch_m = config.spring_rest_m - leg_m - travel_m;
  return stretch_m > 0.0f ? config.spring_npm * stretch_m : 0.0f;
}

/// What the caught spring would push and this one does not, because its cable has moved, N: the motor's to
/// replace, so that a leg that lands on a free spring carries the body all the same.
inline float lost_push_n(const ClutchConfig& config, float leg_m, float travel_m) {
  const float caught_n = spring_pull_n(config, leg_m, 0.0f);
  return caught_n > 0.0f ? caught_n - spring_pull_n(config, leg_m, travel_m) : 0.0f;
}

/// Until the body is down at `touchdown_m`, in free fall; 0 where it is.
inline float time_to_touchdown_s(float gravity_mps2, const HeightEstimate& height, float touchdown_m,
                                 float dt_s) {
  const float above_m = height.height_m - touchdown_m;
  if (!(above_m > 0.0f)) return 0.0f;
  // The velocity is that of half a window ago.
  const float v =
      height.velocity_mps - gravity_mps2 * (0.5f * static_cast<float>(kVelocityWindowTicks) * dt_s);
  return (v + std::sqrt(v * v + 2.0f * gravity_mps2 * above_m)) / gravity_mps2;
}

/// One tick's step through the stages. Each ends by what the cable's encoder says, or by a time.
class ClutchTick {
 public:
  /// Keeps references to `config`, `state` and `view`; `dt_s` is the time since the last tick.
  ClutchTick(const ClutchConfig& config, ClutchState& state, const ClutchView& view, float dt_s)
      : c_(config),
        s_(state),
        view_(view),
        travel_m_(static_cast<float>(view.cable_count) * config.metres_per_count),
        dt_s_(dt_s) {}

  /// Advances the state by one tick; to be called once.
  ClutchEstimate run() {
    if (s_.ticks_in_stage != 0xffffffffu) ++s_.ticks_in_stage;
    if (s_.ticks_of_coil != 0xffffffffu) ++s_.ticks_of_coil;
    ClutchEstimate out;
    if (view_.phase.phase == Phase::stance)
      stand();
    else
      out.path = fly();
    s_.cable_counts[s_.next] = view_.cable_count;
    s_.next = static_cast<std::uint8_t>((s_.next + 1u) % s_.cable_counts.size());
    out.stage = s_.stage;
    out.coil = s_.coil;
    out.drives_leg = s_.stage != ClutchStage::caught;
    out.travel_m = travel_m_;
    return out;
  }

 private:
  float in_stage_s() const { return static_cast<float>(s_.ticks_in_stage) * dt_s_; }
  float coil_s() const { return static_cast<float>(s_.ticks_of_coil) * dt_s_; }
  float tooth_m() const { return static_cast<float>(s_.tooth) * c_.tooth_pitch_m; }
  /// Of a belt whose key stands against its flank there.
  bool within_play(float flank_m) const {
    return travel_m_ <= flank_m + c_.moved_m && travel_m_ >= flank_m - c_.tooth_play_m - c_.moved_m;
  }
  bool at_tooth() const { return within_play(tooth_m()); }
  bool still() const {
    const float moved_m =
        static_cast<float>(count_difference(static_cast<std::uint32_t>(view_.cable_count),
                                            static_cast<std::uint32_t>(s_.cable_counts[s_.next]))) *
        c_.metres_per_count;
    const float most_m = c_.still_mps * dt_s_ * static_cast<float>(s_.cable_counts.size());
    return moved_m <= most_m && moved_m >= -most_m;
  }
  /// Halfway between a wait after which the catch held and one after which it did not.
  float wait_s() const {
    return s_.counts.catches > 0 && s_.held_after_s - s_.free_after_s > c_.resolution_s
               ? 0.5f * (s_.held_after_s + s_.free_after_s)
               : s_.held_after_s;
  }
  float until_caught_s() const { return c_.homing_s + wait_s() + c_.test_s + c_.touchdown_margin_s; }

  void enter(ClutchStage stage) {
    s_.stage = stage;
    s_.ticks_in_stage = 0;
  }
  void switch_coil(bool on) {
    s_.coil = on;
    s_.ticks_of_coil = 0;
  }

  /// The coil is off; a cable that moves with the leg was not caught.
  void stand() {
    if (s_.coil) switch_coil(false);
    if (s_.stage != ClutchStage::caught) enter(ClutchStage::caught);
    if (view_.phase.touchdown) {
      s_.missed_here = false;
      s_.landed_m = travel_m_;
    }
    if (!s_.missed_here && travel_m_ > s_.landed_m + 0.5f * c_.tooth_pitch_m) {
      s_.missed_here = true;
      ++s_.counts.missed;
      ++s_.missed_running;
    }
    s_.tried = false;
  }

  LegPath fly() {
    if (view_.phase.liftoff) {
      ++s_.flights;
      if (!s_.missed_here) s_.missed_running = 0;
    }
    LegPath path;
    switch (s_.stage) {
      case ClutchStage::caught:
        consider_release();
        break;
      case ClutchStage::releasing:
        if (s_.contraction_m > 0.0f && coil_s() >= s_.release_delay_s - onset_s())
          enter(ClutchStage::folding);
        if (s_.contraction_m == 0.0f && coil_s() >= s_.release_delay_s) enter(ClutchStage::homing);
        break;
      case ClutchStage::folding:
        return contract();
      case ClutchStage::homing:
        return come_home();
      case ClutchStage::catching:
        path.fold_m = s_.hold_m;
        if (coil_s() < wait_s()) break;
        if (view_.time_left_s > c_.test_s)
          enter(ClutchStage::testing);
        else
          enter(ClutchStage::caught);  // no time to make sure
        break;
      case ClutchStage::testing:
        return test_catch();
      case ClutchStage::aborting:
        return go_back();
    }
    return path;
  }

  bool releases() const { return c_.fitted != 0 && c_.release_in_flight != 0; }

  /// Once in a flight: where the spring is wanted away, or caught at a wrong tooth, and the flight is long
  /// enough.
  void consider_release() {
    if (travel_m_ <= c_.moved_m) s_.tooth = 0;  // on its stop
    const bool astray = releases() && !at_tooth();
    if (s_.flights == 0 || s_.tried || view_.leg_fold_m > c_.straight_m ||
        view_.phase.since_liftoff_s < c_.liftoff_confirmed_s)
      return;
    if (releases() ? !view_.coil_ready || rests() : c_.contraction_m == 0.0f) return;
    const float before_s = releases() ? s_.release_delay_s + until_caught_s() : c_.touchdown_margin_s;
    const float room_s = view_.time_left_s - before_s;
    if (room_s < (astray ? 0.0f : c_.shortest_contraction_s)) return;
    s_.contraction_s = room_s < c_.contraction_s ? room_s : c_.contraction_s;
    // The wave's acceleration is half its height times (2 pi / time)^2.
    const float most_m = c_.most_acceleration_mps2 * s_.contraction_s * s_.contraction_s * 0.050660592f;
    const float wanted_m =
        releases() && c_.contraction_m < c_.test_pull_m ? c_.test_pull_m : c_.contraction_m;
    s_.contraction_m = astray ? 0.0f : wanted_m < most_m ? wanted_m : most_m;
    s_.tried = true;
    if (releases())
      release(true);
    else
      enter(ClutchStage::folding);
  }
  /// A coil that failed and failed is left alone for a while.
  bool rests() const { return s_.failed_running >= c_.failed_releases_max && s_.flights % 10 != 0; }
  /// `held`: by the key, so that the first motion of the cable is the release.
  void release(bool held) {
    s_.began_held = held;
    s_.hold_m = 0.0f;
    s_.released = s_.waited = false;
    const auto teeth_below = static_cast<std::int32_t>((travel_m_ - c_.moved_m) / c_.tooth_pitch_m);
    s_.held_m = travel_m_ <= c_.moved_m ? 0.0f : static_cast<float>(teeth_below + 1) * c_.tooth_pitch_m;
    switch_coil(true);
    enter(ClutchStage::releasing);
  }

  void note_release() {
    if (s_.released) return;
    if (!s_.began_held) {
      s_.released = coil_s() >= s_.release_delay_s;
      return;
    }
    if (within_play(s_.held_m)) return;
    s_.released = true;
    s_.failed_running = 0;
    ++s_.counts.releases;
    // Where the leg had to wait for it, the instant is the belt's. Else it may have been free for long.
    s_.release_delay_s += s_.waited ? 0.5f * (coil_s() - s_.release_delay_s) : -c_.creep_s;
    const float least_s = s_.contraction_m > 0.0f ? onset_s() : 0.0f;
    if (s_.release_delay_s < least_s) s_.release_delay_s = least_s;
  }
  /// From the beginning of the contraction until the fold at which a free cable starts; for a sine that is
  /// small its angle stands.
  float onset_s() const { return s_.contraction_s * 0.318309886f * std::sqrt(c_.onset_m / s_.contraction_m); }
  void note_failure() {
    ++s_.counts.failed_releases;
    ++s_.failed_running;
    // Perhaps the coil only takes longer than thought.
    const float longer_s = s_.release_delay_s + 0.005f;
    s_.release_delay_s = longer_s < c_.longest_delay_s ? longer_s : c_.longest_delay_s;
  }

  LegPath contract() {
    const float share = in_stage_s() / s_.contraction_s;
    if (share >= 1.0f) {
      enter(releases() ? ClutchStage::homing : ClutchStage::caught);
      return {};
    }
    const LegPath path = raised_cosine(s_.contraction_m, s_.contraction_s, share, true);
    if (!releases()) return path;
    note_release();
    if (s_.released || path.fold_m < c_.onset_m + c_.hesitation_m) return path;
    s_.waited = true;
    if (coil_s() < c_.longest_delay_s) {
      --s_.ticks_in_stage;  // no further into a spring that is still caught
      return {path.fold_m, 0.0f, 0.0f};
    }
    note_failure();
    switch_coil(false);
    s_.contraction_m = path.fold_m;
    enter(ClutchStage::aborting);
    return path;
  }

  /// From where the leg waited, at rest, stretched gently.
  LegPath go_back() {
    const float share = 0.5f + 0.5f * in_stage_s() / c_.shortest_contraction_s;
    if (share < 1.0f) return raised_cosine(s_.contraction_m, 2.0f * c_.shortest_contraction_s, share, true);
    enter(ClutchStage::caught);
    return {};
  }

  /// The leg is stretched. A cable that rests between two teeth is brought to the next one by the leg.
  LegPath come_home() {
    note_release();
    LegPath path;
    path.fold_m = s_.hold_m;
    if (in_stage_s() < 0.5f * c_.homing_s) return path;
    const bool late = view_.time_left_s < wait_s() + c_.touchdown_margin_s;
    // A cable that is to come home by itself was let go when it moves.
    const bool waits = !s_.released && coil_s() < c_.longest_delay_s;
    s_.waited = s_.waited || waits;
    if (!late && (waits || !still())) return path;
    if (s_.released && view_.coil_ready) s_.tooth = nearest_tooth();  // not where a key fell in too early
    if (!late && !at_tooth() && s_.hold_m == 0.0f) {
      if (in_stage_s() < 2.0f * c_.homing_s) return path;  // it may be creeping home
      const float middle_m = tooth_m() - 0.5f * c_.tooth_play_m;
      s_.hold_m = middle_m + (middle_m < travel_m_ ? c_.tooth_pitch_m : 0.0f) - travel_m_;
      enter(ClutchStage::homing);
      return path;
    }
    if (!s_.released) note_failure();
    switch_coil(false);
    enter(ClutchStage::catching);
    return path;
  }
  std::int32_t nearest_tooth() const {
    const float teeth = travel_m_ / c_.tooth_pitch_m + 0.5f;
    return teeth > 0.0f ? static_cast<std::int32_t>(teeth) : 0;
  }

  LegPath test_catch() {
    if (travel_m_ > tooth_m() + 3.0f * c_.moved_m) return miss();
    const float share = in_stage_s() / c_.test_s;
    if (share < 1.0f) {
      LegPath path = raised_cosine(c_.test_pull_m, c_.test_s, share, true);
      path.fold_m += s_.hold_m;
      return path;
    }
    enter(ClutchStage::caught);
    if (!s_.released) return {};  // it was caught all along
    const float waited_s = wait_s();
    ++s_.counts.catches;
    s_.held_after_s = waited_s;
    s_.slipped_running = 0;
    s_.free_after_s *= 0.998f;  // what was too short once may be long enough by now
    return {};
  }
  LegPath miss() {
    ++s_.counts.slipped;
    const float waited_s = wait_s();
    // Of a wait that has held before it takes two running to say that it is too short.
    const bool stands = waited_s >= s_.held_after_s && s_.counts.catches > 0;
    if (!stands || ++s_.slipped_running > 1) {
      s_.free_after_s = waited_s;
      const float longer_s = waited_s + 0.005f;
      if (s_.held_after_s <= waited_s)
        s_.held_after_s = longer_s < c_.longest_delay_s ? longer_s : c_.longest_delay_s;
    }
    s_.contraction_m = 0.0f;  // the cable comes home by itself
    if (view_.time_left_s < s_.release_delay_s + until_caught_s() || !view_.coil_ready || rests()) {
      enter(ClutchStage::caught);
    } else {
      ++s_.counts.retries;
      release(false);
    }
    return {};
  }

  const ClutchConfig& c_;
  ClutchState& s_;
  const ClutchView& view_;
  float travel_m_;
  float dt_s_;
};

/// One tick.
inline ClutchEstimate sequence_clutch(const ClutchConfig& config, ClutchState& state, const ClutchView& view,
                                      float dt_s) {
  return ClutchTick(config, state, view, dt_s).run();
}

}  // namespace furcula::control
