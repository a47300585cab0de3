// Running the robot with planted faults, see trial.hpp.
#include "host/safety/trial.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "boards/sim_host/can_board.hpp"
#include "firmware/app/app.hpp"
#include "host/sim/simulate.hpp"

namespace furcula::safety {
namespace {

using sim_host::CanBoard;
using sim_host::RigFault;
using sim_host::SimBoard;

SimBoard& rig_of(SimBoard& board) { return board; }
SimBoard& rig_of(CanBoard& board) { return board.rig(); }

std::uint32_t tick_of(double time_s) {
  return static_cast<std::uint32_t>(std::max(0l, std::lround(time_s * 1e3)));
}

template <class Board>
class Judge {
 public:
  /// `config` is the robot's, `given` what the controller is told.
  Judge(Board& board, const control::Config& config, const control::Config& given, bool is_own,
        const sim::Scenario& scenario, Use use)
      : board_(board),
        rig_(rig_of(board)),
        config_(config),
        given_(given),
        is_own_(is_own),
        app_(std::in_place, board, given) {
    app_->set_run(use == Use::hopping);
    onset_tick_ = 0xffffffffu;
    for (const auto& f : scenario.faults) {
      onset_tick_ = std::min(onset_tick_, tick_of(f.time_s));
      deaf_ = deaf_ || sim_host::silences_bus(f.kind);
    }
  }

  Trial run() {
    while (board_.wait_for_tick()) {
      if (rig_.take_restart()) start_anew();
      app_->tick();
      look();
    }
    if (trial_.fault != control::Fault::none) {
      trial_.torque_off_ticks = last_torque_tick_ > found_ ? last_torque_tick_ - found_ : 0;
      const std::uint32_t most = deaf_ ? kDeafDriveTicks : kTorqueOffTicks;
      if (trial_.torque_off_ticks > most) trial_.set(Unsafe::torque_after_fault);
    }
    return trial_;
  }

 private:
  /// As a board does after its supply failed: idle, and nobody tells it to run.
  void start_anew() {
    if constexpr (requires { board_.restart(); }) board_.restart();
    app_.emplace(board_, config_);
    app_->set_run(false);
  }

  void look() {
    const auto& out = rig_.telemetry().outputs;
    const auto& plant = rig_.plant();
    const std::uint32_t tick = tick_of(rig_.time_s());
    const auto wanted_nm = std::abs(static_cast<double>(out.command.torque_nm));
    if (!std::isfinite(plant.height_m()) || !std::isfinite(wanted_nm) ||
        !std::isfinite(out.command.coil_duty))
      trial_.set(Unsafe::not_finite);
    if (trial_.fault == control::Fault::none && out.fault != control::Fault::none) {
      trial_.fault = out.fault;
      found_ = tick;
      trial_.early = tick < onset_tick_;
      trial_.false_alarm = trial_.early && is_own_;
      trial_.found_tick = tick < onset_tick_ ? 0 : tick - onset_tick_;
    }
    const bool faulty = trial_.fault != control::Fault::none;
    // What acts from this tick on.
    const auto acts_nm = std::abs(static_cast<double>(rig_.command().torque_nm));
    if (faulty && acts_nm > kDriveStepNm) last_torque_tick_ = tick;
    if (faulty && wanted_nm != 0.0) trial_.set(Unsafe::torque_after_fault);
    if (faulty) judge_spring();
    const bool coil = out.command.coil_duty > 0.0f;
    if (faulty && coil) trial_.set(Unsafe::coil_after_fault);
    coil_in_stance_ = coil && plant.in_stance() ? coil_in_stance_ + 1 : 0;
    trial_.longest_coil_in_stance_ticks = std::max(trial_.longest_coil_in_stance_ticks, coil_in_stance_);
    if (coil_in_stance_ > kCoilInStanceTicks) trial_.set(Unsafe::coil_in_stance);
    if (wanted_nm > static_cast<double>(given_.limits.torque_nm)) trial_.set(Unsafe::torque_beyond_limit);

    if (out.landing && !trial_.lands && tick >= onset_tick_) {
      trial_.lands = true;
      trial_.landing_tick = tick - onset_tick_;
    }
    const bool reacted = faulty || out.landing;
    if (reacted) trial_.lowest_after_m = std::min(trial_.lowest_after_m, plant.height_m());
    if (reacted && std::abs(plant.velocity_mps()) > kStillMps) trial_.moving_ticks = tick - onset_tick_;

    trial_.highest_m = std::max(trial_.highest_m, plant.height_m());
    trial_.lowest_m = std::min(trial_.lowest_m, plant.height_m());
    if (trial_.highest_m > kHighestM) trial_.set(Unsafe::off_the_rail);
    if (!faulty && hip_above_ground_m() < kFallenM) trial_.set(Unsafe::fall_unnoticed);
    if (plant.in_stance() && !stood_) {
      ++trial_.hops;
      trial_.hardest_mps = std::max(trial_.hardest_mps, -body_mps_);
      if (reacted) trial_.hardest_after_mps = std::max(trial_.hardest_after_mps, -body_mps_);
      trial_.fastest_toe_mps = std::max(trial_.fastest_toe_mps, -toe_mps_);
      if (trial_.hardest_mps > kHardestMps || trial_.fastest_toe_mps > kFastestToeMps)
        trial_.set(Unsafe::hard_impact);
    }
    stood_ = plant.in_stance();
    toe_mps_ = plant.toe_velocity_mps();
    body_mps_ = plant.velocity_mps();
  }

  /// On each tick; a key that has just come out has not let the cable move yet.
  void judge_spring() {
    const auto* clutched = rig_.plant().clutched();
    if (clutched == nullptr) return;
    trial_.caught_at_end = clutched->caught();
    const bool long_ago = tick_of(rig_.time_s()) > found_ + tick_of(kSpringCaughtS);
    const bool seen_loose =
        std::abs(rig_.measured_cable_travel_m()) > static_cast<double>(config_.clutch.moved_m);
    // On its stop a leg takes no force from the spring: it shows as soon as it bears something.
    const bool bears =
        rig_.plant().in_stance() && leg_fold_m() > 2.0 * static_cast<double>(config_.clutch.tooth_pitch_m);
    const bool blind = rig_.active(RigFault::encoder_frozen);  // the cable's encoder is broken as well
    const bool unknown = long_ago && bears && !blind && !clutched->caught() && !seen_loose;
    unknown_ticks_ = unknown ? unknown_ticks_ + 1 : 0;
    if (unknown_ticks_ > kUnknownTicks) trial_.set(Unsafe::spring_unknown);
  }

  double hip_above_ground_m() const {
    return rig_.plant().touchdown_height_m() - leg_fold_m() + rig_.plant().toe_height_m();
  }
  double leg_fold_m() const {
    const double length_m = static_cast<double>(config_.link_length_m);
    return rig_.plant().touchdown_height_m() - 2.0 * length_m * std::cos(rig_.plant().leg_angle_rad());
  }

  Board& board_;
  SimBoard& rig_;
  control::Config config_, given_;
  bool is_own_;
  std::optional<firmware::App<Board>> app_;
  Trial trial_;
  std::uint32_t onset_tick_, found_ = 0, last_torque_tick_ = 0, coil_in_stance_ = 0, unknown_ticks_ = 0;
  bool deaf_ = false, stood_ = false;
  double toe_mps_ = 0.0, body_mps_ = 0.0;
};

/// Calls `visit` with a board of that rig and its controller's configuration.
template <class Visit>
auto on_rig(Rig rig, const model::Model& model, const sim::Scenario& scenario, std::uint64_t seed,
            const Visit& visit) {
  const sim_host::RigConfig rig_config = sim::rig_config(model, scenario, seed);
  control::Config config = sim::controller_config(model, scenario);
  if (rig == Rig::on_bus) {
    CanBoard board(rig_config);
    CanBoard::adapt(config);
    return visit(board, config);
  }
  SimBoard board(rig_config);
  return visit(board, config);
}

bool is_at(Moment moment, const control::Outputs& out) {
  using control::ClutchStage;
  const bool stance = out.phase.phase == control::Phase::stance;
  switch (moment) {
    case Moment::flight:
      return !stance && out.clutch.stage == ClutchStage::caught && out.phase.since_liftoff_s > 0.002f;
    case Moment::stance:
      return stance && out.phase.since_touchdown_s > 0.04f;
    case Moment::released:
      return out.clutch.stage == ClutchStage::folding && out.clutch.path.fold_m > 0.02f;
    case Moment::catching:
      return out.clutch.stage == ClutchStage::catching;
  }
  return false;
}

}  // namespace

Trial run_trial(const model::Model& model, const sim::Scenario& scenario, std::uint64_t seed, Rig rig,
                std::span<const DrawnParameter> parameters, Use use, bool blind) {
  return on_rig(rig, model, scenario, seed, [&](auto& board, control::Config config) {
    if (blind) config.observer.touchdown_force_n = 1e9f;
    control::Config given = config;
    Trial refused;
    refused.refused = true;
    for (const DrawnParameter& drawn : parameters) {
      if (!bus::allows(*drawn.parameter, drawn.value)) return refused;
      drawn.parameter->put(given, drawn.value);
    }
    if (control::check(given) != Status::ok) return refused;
    return Judge<std::remove_reference_t<decltype(board)>>(board, config, given, parameters.empty(), scenario,
                                                           use)
        .run();
  });
}

model::Model robot() {
  model::Model model;
  model.kind = dynamics::kKindOf<dynamics::machines::HopperNonlinear>;
  model.parameters = {1.5,  600.0, 0.289, 5.0,  1.0, 1.0, 1.0, 0.15, 0.3490658503988659,
                      9.81, 42e-4, 75e-4, 38e-3};
  model.clutch = model::Clutch{0.020, 0.020, 20.0, 3e-3 / 0.7};
  return model;
}

sim::Scenario hopping(double duration_s) {
  sim::Scenario scenario;
  scenario.start_position = 0.35;
  scenario.duration_s = duration_s;
  scenario.amplitude = 3.0;
  scenario.period_s = 0.3;
  scenario.release_in_flight = true;
  scenario.contraction_m = 0.05;
  scenario.sensors = {true, true, true, true};
  return scenario;
}

double instant_of(Moment moment, std::uint64_t seed, Rig rig) {
  const sim::Scenario scenario = hopping(6.0);
  return on_rig(rig, robot(), scenario, seed, [&](auto& board, const control::Config& config) {
    firmware::App app(board, config);
    while (board.wait_for_tick()) {
      app.tick();
      const SimBoard& r = rig_of(board);
      if (r.time_s() > 1.0 && is_at(moment, r.telemetry().outputs)) return r.time_s();
    }
    return scenario.duration_s;
  });
}

}  // namespace furcula::safety
