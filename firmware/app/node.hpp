// A robot that people talk to: the application, idle until it is armed and told to hop, with parameters,
// requests and all that it shows. It knows no bus: node_registers.hpp has the Modbus side.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/app/app.hpp"
#include "firmware/app/store.hpp"
#include "firmware/app/stream_rules.hpp"
#include "firmware/app/trial_record.hpp"
#include "firmware/store/fault_log.hpp"
#include "firmware/store/save_limit.hpp"
#include "furcula/bus/node_words.hpp"
#include "furcula/bus/parameter_image.hpp"
#include "furcula/bus/registers.hpp"

namespace furcula::firmware {

// In ticks, that is, ms.
inline constexpr std::uint32_t kArmedTicks = 2000;  ///< that an armed robot waits for hop

template <Board B, ParameterStore S>
class Node {
 public:
  /// Keeps references to `board`, `store` and `faults`, which must outlive it. `session_seed` should differ
  /// from start to start, so that a request recorded before a restart is an old one after it. `faults` is
  /// begun by whoever has it. `first_tick`: the number of the first one; they wrap after 49.7 days.
  Node(B& board, S& store, const control::Config& defaults, const bus::Identity& identity,
       std::uint16_t session_seed, FaultLog& faults, std::uint32_t first_tick = 0)
      : store_(store),
        faults_(faults),
        defaults_(defaults),
        identity_(identity),
        app_(board, defaults, first_tick) {
    session_ = session_seed == 0 ? std::uint16_t{1} : session_seed;
    load();
    app_.set_run(false);
  }

  /// One tick, right after the board's wait_for_tick().
  void tick() {
    follow_save();
    if (ticks_in_state_ != 0xffffffffu) ++ticks_in_state_;
    rules_.tick();
    if (state_ == bus::NodeState::running && by_stream_ && rules_.silent()) {
      ++stale_stops_;
      enter(bus::NodeState::idle, bus::Reason::stream_silent);
    }
    if (host_age_ticks_ != 0xffffffffu) ++host_age_ticks_;
    if constexpr (WearingStore<S>) save_limit_.tick();
    if (state_ == bus::NodeState::running && !by_stream_ && host_is_silent()) {
      ++stale_stops_;
      enter(bus::NodeState::idle, bus::Reason::host_silent);
    }
    if (state_ == bus::NodeState::armed && ticks_in_state_ > kArmedTicks)
      enter(bus::NodeState::idle, bus::Reason::arming_expired);
    if (state_ == bus::NodeState::starting) app_.request_reset();
    app_.set_run(state_ == bus::NodeState::running);
    app_.tick();
    keep_trial();
    const control::Fault fault = app_.telemetry().outputs.fault;
    const std::uint32_t tick = app_.telemetry().tick;
    faults_.note(tick == bus::kNoTick ? tick - 1 : tick, static_cast<std::uint8_t>(fault));
    follow(fault);
  }

  /// A person's request, whose key and session were right (node_registers.hpp). What it starts runs for as
  /// long as hear_host() is called. The answer is also what the snapshot shows as last refusal.
  bus::Refusal request(bus::Request wanted) { return note(carry_out(wanted)); }

  /// Somebody reads or writes its registers, and so is there.
  void hear_host() { host_age_ticks_ = 0; }

  /// A stop that is not the next one of a stream, whoever said it. What streams hop must let go and say it anew.
  /// Nothing starts in the same tick; `holds`: nor for kStopHoldsTicks.
  void stop_from_anyone(bool holds) {
    rules_.hold(holds);
    stop();
  }
  /// Somebody said hop, in a command that counts or in one that does not.
  void note_hop_said() { rules_.note_hop_said(); }

  /// One command of a stream, fresh as bus/stream.hpp judges it. Its request counts where it changes; `hop`
  /// starts the robot without arming, if nobody has said hop for kLetGoTicks and the command before it, of which
  /// none is missing, said something else: two streams that are mixed start nothing. As long as they come, and
  /// say hop, it runs; amplitude, period and clutch are taken at the start.
  bus::Refusal stream(const StreamCommand& command) {
    const StreamRules::Edge edge = rules_.hear(command.request, command.follows);
    switch (command.request) {
      case bus::Request::hop:
        if (state_ == bus::NodeState::running && by_stream_) return bus::Refusal::none;
        // Not counted: it comes a hundred times a second.
        if (!edge.starts) return bus::Refusal::no_edge;
        return note(start_by_stream(command));
      case bus::Request::stop:
        stop();
        return bus::Refusal::none;
      case bus::Request::none:
        if (by_stream_) stop();
        return bus::Refusal::none;
      case bus::Request::reset:
        return edge.changed ? request(bus::Request::reset) : bus::Refusal::none;
      default:
        return note(bus::Refusal::unknown_request);
    }
  }

  const control::Config& config() const { return app_.config(); }

  /// Not while armed or running.
  bool may_configure() const { return state_ != bus::NodeState::armed && state_ != bus::NodeState::running; }
  /// Another configuration, as a whole, with parameters that the table allows: each value is looked at where
  /// it comes in (bus::allows()). Refused while armed or running, and where the configuration makes no sense.
  bus::Refusal configure(const control::Config& config) {
    if (!may_configure()) return note(bus::Refusal::not_in_this_state);
    if (!control::fits(config.envelope, config.torque, config.limits.torque_nm))
      return note(bus::Refusal::beyond_envelope);
    if (control::check(config) != Status::ok) return note(bus::Refusal::makes_no_sense);
    app_.configure(config);
    note_change();
    return note(bus::Refusal::none);
  }

  /// Whether a save goes on beside the ticks: its request was taken, and parameter_origin will say what came
  /// of it, last_refusal too where it failed.
  constexpr bool is_saving() const {
    if constexpr (SavesAside<S>) return saving_;
    return false;
  }

  bus::NodeState state() const { return state_; }
  std::uint16_t session() const { return session_; }
  /// The session changes with each request that brought the right one.
  void next_session() {
    // Marsaglia's xorshift with 7, 9, 8: runs through all numbers but 0.
    session_ = static_cast<std::uint16_t>(session_ ^ session_ << 7);
    session_ = static_cast<std::uint16_t>(session_ ^ session_ >> 9);
    session_ = static_cast<std::uint16_t>(session_ ^ session_ << 8);
  }
  bus::Refusal refuse(bus::Refusal why) { return note(why); }

  const TrialRecord& trial() const { return trial_; }
  const App<B>& app() const { return app_; }
  const bus::Identity& identity() const { return identity_; }
  const FaultLog& faults() const { return faults_; }
  /// For the server of the serial line to count in.
  bus::BusCounts& bus_counts() { return bus_counts_; }

  /// Why it does not move.
  bus::Reason reason() const {
    if (state_ != bus::NodeState::running) return reason_;
    if (config().bench.on_bench != 0) return bus::Reason::trial;
    if (app_.telemetry().outputs.landing) return bus::Reason::landing;
    const control::TorqueProfileConfig& torque = config().torque;
    if (torque.shape == control::ProfileShape::zero || torque.amplitude_nm == 0.0f)
      return bus::Reason::no_torque;
    const control::Outputs& out = app_.telemetry().outputs;
    if (out.phase.phase == control::Phase::flight)
      return out.clutch.drives_leg ? bus::Reason::none : bus::Reason::flight;
    // Longer than a stance of a robot that hops.
    constexpr float kLongest_s = 1.0f;
    return torque.shape == control::ProfileShape::constant && out.height.velocity_mps == 0.0f &&
                   out.phase.since_touchdown_s > kLongest_s
               ? bus::Reason::standing_still
               : bus::Reason::none;
  }

  bus::Snapshot snapshot() const {
    const control::Outputs& out = app_.telemetry().outputs;
    const control::Sample& sample = app_.state().last_sample;
    const control::ClutchCounts& clutch = app_.state().clutch.counts;
    const TickStatistics& ticks = app_.statistics();
    bus::Snapshot s;
    s.state = static_cast<std::uint16_t>(state_);
    s.reason = static_cast<std::uint16_t>(reason());
    s.fault = static_cast<std::uint16_t>(out.fault);
    s.last_refusal = static_cast<std::uint16_t>(last_refusal_);
    s.session = session_;
    s.parameter_origin =
        static_cast<std::uint16_t>(is_saving() ? bus::ParameterOrigin::being_saved : origin_);
    s.phase = static_cast<std::uint16_t>(out.phase.phase);
    s.contact = static_cast<std::uint16_t>(sample.contact != 0 ? 1 : 0);
    s.clutch_stage = static_cast<std::uint16_t>(out.clutch.stage);
    s.firmware_version = identity_.firmware_version;
    s.build_id = identity_.build_id;
    s.board_id = bus::board_id(identity_.board);
    s.uptime_ms = app_.telemetry().tick;
    s.height_m = out.height.height_m;
    s.velocity_mps = out.height.velocity_mps;
    s.apex_height_m = out.phase.apex_height_m;
    s.leg_angle_rad = sample.leg_angle_rad;
    s.torque_nm = out.command.torque_nm;
    s.cable_travel_m = static_cast<float>(count_difference(sample.cable_count, sample.cable_home_count)) *
                       config().clutch.metres_per_count;
    s.coil_duty = out.command.coil_duty;
    s.missed_samples = ticks.missed_samples;
    s.refused_by_drive = ticks.refused_by_drive;
    s.last_interval_us = ticks.last_interval_us;
    s.longest_interval_us = ticks.longest_interval_us;
    s.releases = clutch.releases;
    s.catches = clutch.catches;
    s.missed_catches = clutch.missed;
    s.requests_taken = taken_;
    s.requests_refused = refused_;
    s.stale_stops = stale_stops_;
    s.bus_requests = bus_counts_.requests;
    s.bus_exceptions = bus_counts_.exceptions;
    s.bus_bad_frames = bus_counts_.bad_frames;
    s.reset_cause = static_cast<std::uint16_t>(identity_.reset_cause);
    s.logged_faults = static_cast<std::uint16_t>(faults_.count());
    s.starts = faults_.starts();
    s.unique_id_0 = identity_.unique_id[0];
    s.unique_id_1 = identity_.unique_id[1];
    s.unique_id_2 = identity_.unique_id[2];
    s.observed_contact = out.contact.contact ? 1 : 0;
    s.ground_force_n = out.contact.force_n;
    return s;
  }

 private:
  using State = bus::NodeState;

  void enter(State state, bus::Reason reason) {
    state_ = state;
    reason_ = reason;
    ticks_in_state_ = 0;
    if (state != State::running) by_stream_ = false;
  }

  /// On the bench to run is to make one trial.
  void keep_trial() {
    const control::Outputs& out = app_.telemetry().outputs;
    trial_.add(out.trial, app_.state().last_sample.cable_count, out.command.coil_duty);
    if (state_ == State::running && out.trial.ended) enter(State::idle, bus::Reason::trial_ended);
  }

  bool host_is_silent() const {
    const float longest_s = config().host_timeout_s;
    return longest_s > 0.0f && static_cast<float>(host_age_ticks_) > 1000.0f * longest_s;
  }

  void stop() {
    if (state_ == State::armed || state_ == State::running) enter(State::idle, bus::Reason::stopped);
  }

  /// What the controller's fault makes of the state.
  void follow(control::Fault fault) {
    const bool found = fault != control::Fault::none;
    switch (state_) {
      case State::starting:
        good_ticks_ = found ? 0 : good_ticks_ + 1;
        if (good_ticks_ >= kSettledTicks) {
          app_.clear_statistics();
          enter(State::idle, bus::Reason::idle);
        } else if (found && (fault == control::Fault::bad_configuration || ticks_in_state_ > kStartTicks)) {
          enter(State::fault, bus::Reason::fault);
        }
        return;
      case State::fault:
        if (!found) enter(State::idle, bus::Reason::idle);
        return;
      case State::idle:
      case State::armed:
      case State::running:
        if (found) enter(State::fault, bus::Reason::fault);
        return;
    }
  }

  bus::Refusal carry_out(bus::Request wanted) {
    using bus::Refusal;
    if (wanted == bus::Request::none) return Refusal::none;
    if (wanted == bus::Request::stop) {
      stop();
      return Refusal::none;
    }
    if (wanted == bus::Request::arm) {
      if (state_ != State::idle) return Refusal::not_in_this_state;
      enter(State::armed, bus::Reason::armed);
      return Refusal::none;
    }
    if (wanted == bus::Request::hop) {
      if (state_ != State::armed) return Refusal::not_in_this_state;
      if (rules_.held()) return Refusal::stop_stands;
      hear_host();
      enter(State::running, bus::Reason::none);
      return Refusal::none;
    }
    if (!may_configure()) return Refusal::not_in_this_state;
    switch (wanted) {
      case bus::Request::reset:
        app_.request_reset();
        return Refusal::none;
      case bus::Request::home:
        return app_.home() == Status::ok ? Refusal::none : Refusal::not_on_the_ground;
      case bus::Request::save:
        return save();
      case bus::Request::load_defaults:
        app_.configure(defaults_);
        note_change();
        return Refusal::none;
      default:
        return Refusal::unknown_request;
    }
  }

  bus::Refusal start_by_stream(const StreamCommand& command) {
    if (state_ != State::idle) return bus::Refusal::not_in_this_state;
    if (rules_.held()) return bus::Refusal::stop_stands;
    static constexpr const bus::Parameter& kAmplitude = *bus::parameter_named("torque_amplitude_nm");
    static constexpr const bus::Parameter& kPeriod = *bus::parameter_named("torque_period_s");
    if (!bus::allows(kAmplitude, command.torque_amplitude_nm) ||
        !bus::allows(kPeriod, command.torque_period_s))
      return bus::Refusal::value_not_allowed;
    control::Config config = app_.config();
    config.torque.amplitude_nm = command.torque_amplitude_nm;
    config.torque.period_s = command.torque_period_s;
    if (config.clutch.fitted != 0) config.clutch.release_in_flight = command.release_in_flight ? 1 : 0;
    const bus::Refusal refusal = configure(config);
    if (refusal != bus::Refusal::none) return refusal;
    enter(State::running, bus::Reason::none);
    by_stream_ = true;
    return bus::Refusal::none;
  }

  /// The ticks that a store takes are no fault: the node starts anew, with all that it knows.
  bus::Refusal save() {
    if constexpr (WearingStore<S>) {
      const bus::Refusal why = store_.may_save();
      if (why != bus::Refusal::none) return why;
      if (!save_limit_.take()) return bus::Refusal::saved_too_often;
    }
    if (is_saving()) return bus::Refusal::not_in_this_state;
    const bus::ParameterImage image = bus::to_image(app_.config());
    const Status saved = store_.save(image);
    if constexpr (SavesAside<S>) {
      if (saved != Status::ok) return bus::Refusal::store_failed;
      saving_ = true;
      changed_since_ = false;
      return bus::Refusal::none;
    }
    if (state_ == State::idle) begin_again();
    if (saved != Status::ok) return bus::Refusal::store_failed;
    origin_ = bus::ParameterOrigin::store;
    return bus::Refusal::none;
  }
  void follow_save() {
    if constexpr (SavesAside<S>) {
      if (!saving_ || store_.saved() == SaveProgress::under_way) return;
      saving_ = false;
      if (store_.saved() == SaveProgress::failed)
        static_cast<void>(note(bus::Refusal::store_failed));
      else if (!changed_since_)
        origin_ = bus::ParameterOrigin::store;
    }
  }
  void note_change() {
    origin_ = bus::ParameterOrigin::changed;
    if constexpr (SavesAside<S>) changed_since_ = true;
  }
  void begin_again() {
    good_ticks_ = 0;
    enter(State::starting, bus::Reason::starting);
  }

  /// Not inlined: what it reads into would lie on the stack under all that main() calls.
  [[gnu::noinline]] void load() {
    std::array<std::uint8_t, bus::kImageBytesMax> image;
    const Result<std::size_t> size = store_.load(image);
    if (size.ok() && size.value() == 0) return;
    control::Config config = defaults_;
    const bool usable =
        size.ok() && size.value() <= image.size() &&
        bus::from_image(std::span<const std::uint8_t>(image).first(size.value()), config) == Status::ok;
    if (usable) app_.configure(config);
    origin_ = usable ? bus::ParameterOrigin::store : bus::ParameterOrigin::store_unusable;
  }

  bus::Refusal note(bus::Refusal refusal) {
    ++(refusal == bus::Refusal::none ? taken_ : refused_);
    if (refusal != bus::Refusal::none) last_refusal_ = refusal;
    return refusal;
  }

  S& store_;
  FaultLog& faults_;
  control::Config defaults_;
  bus::Identity identity_;
  App<B> app_;
  TrialRecord trial_;
  SaveLimit save_limit_;
  bus::BusCounts bus_counts_;
  State state_ = State::starting;
  bus::Reason reason_ = bus::Reason::starting;
  bus::Refusal last_refusal_ = bus::Refusal::none;
  bus::ParameterOrigin origin_ = bus::ParameterOrigin::defaults;
  StreamRules rules_;
  bool by_stream_ = false;
  bool saving_ = false, changed_since_ = false;  ///< of a store that saves aside: since that save began
  std::uint16_t session_ = 1;
  std::uint32_t ticks_in_state_ = 0, good_ticks_ = 0;
  std::uint32_t host_age_ticks_ = 0xffffffffu;
  std::uint32_t taken_ = 0, refused_ = 0, stale_stops_ = 0;
};

}  // namespace furcula::firmware
