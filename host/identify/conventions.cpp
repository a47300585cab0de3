// The equation of a machine of one joint for the trial of conventions, see conventions.hpp.
#include "host/identify/conventions.hpp"

#include <cmath>

#include "host/conventions/trial.hpp"
#include "host/identify/simulate.hpp"
#include "host/machines/hopper.hpp"
#include "host/machines/rules.hpp"

namespace furcula::identify {
namespace {

using conventions::Forces;
using conventions::Quantity;
using conventions::State;

class OneJoint final : public conventions::Family {
 public:
  OneJoint(const model::Model& model, const Recording& like) : like_(like) {
    const machines::Rules& rules = machines::rules(model.kind);
    const bool rotary = dynamics::info(model.kind).rotary;
    conventions::Joint joint;
    joint.position_column = rules.columns.position;
    if (rules.cut != machines::Cut::releases)
      joint.input_column = rules.columns.input;  // there the input is a coil
    joint.position = rotary ? Quantity::angle : Quantity::length;
    joint.input =
        rotary || dynamics::has(model.kind, dynamics::LocationType::leg) ? Quantity::torque : Quantity::force;
    joint.heaviest = conventions::kInertiaWithin;  // with the motor's rotor
    // Weight and inertia are of one mass.
    if (dynamics::parameter_index(model.kind, "gravity_mps2")) joint.lightest = 1.0;
    joints_.push_back(joint);
    leg_ = dynamics::has(model.kind, dynamics::LocationType::leg);
    belt_ = dynamics::has(model.kind, dynamics::LocationType::belt);
    if (leg_) touchdown_m_ = machines::touchdown_height_m(model);
    setups_.emplace_back(model, std::vector<Unknown>{}, nullptr);
    inertia_ = rules.inertia(model);
    for (const auto& [index, bounds] : model.free)
      for (const double end : {bounds.lower, bounds.upper}) {
        const double away = end - model.parameters[index];
        if (!(std::abs(away) > 0.0)) continue;
        model::Model other = model;
        other.parameters[index] = end;
        // From the model's value to each bound a column of its own, so that what is not linear is met at both.
        probes_.push_back({PlantSetup<double>(other, {}, nullptr), rules.inertia(other)});
        free_.push_back({0.0, 1.0});
      }
    // A joint's axis may stand upright.
    if (const auto at = dynamics::parameter_index(model.kind, "gravity_torque_nm");
        at && model.parameters[*at] != 0.0) {
      model::Model other = model;
      other.parameters[*at] = 0.0;
      setups_.emplace_back(other, std::vector<Unknown>{}, nullptr);
      gravities_.emplace_back(
          "gravity does not turn the joint, as if its axis were upright (gravity_torque_nm = 0 in [parameters])");
    }
    // A rail may lie, or stand where the model says that it lies. (Turned over it is its position that has the other sign.)
    constexpr double kGravity_mps2 = 9.81;
    if (const auto at = dynamics::parameter_index(model.kind, "gravity_mps2"); at && !leg_) {
      model::Model other = model;
      const bool lies = model.parameters[*at] == 0.0;
      other.parameters[*at] = lies ? kGravity_mps2 : 0.0;
      setups_.emplace_back(other, std::vector<Unknown>{}, nullptr);
      gravities_.emplace_back(
          lies
              ? "gravity acts along the axis of motion (gravity_mps2 = 9.81 in [parameters])"
              : "gravity acts across the axis of motion and not along it (gravity_mps2 = 0 in [parameters])");
    }
  }

  const std::vector<conventions::Joint>& joints() const override { return joints_; }
  std::vector<std::string> other_gravities() const override { return gravities_; }
  std::vector<conventions::FreeParameter> free_parameters() const override { return free_; }

  bool forces(const State& s, std::size_t gravity, Forces& out) const override {
    constexpr double kNear_m = 0.010;  // of the touch-down height: an impact
    if (leg_ && s.low[0] < touchdown_m_ + kNear_m && s.high[0] > touchdown_m_ - kNear_m) return false;
    const double free = acceleration(setups_[gravity], s, 0.0),
                 pushed = acceleration(setups_[gravity], s, 1.0);
    out.needed.assign(1, inertia_ * (s.acceleration[0] - free));
    out.input_gain.assign(1, inertia_ * (pushed - free));
    out.of_drive.assign(1, 0.0);
    out.inertia.assign(1, inertia_);
    out.log_det = std::log(inertia_);
    out.mass.assign(1, inertia_);
    out.by_free.resize(probes_.size());
    out.inertia_by_free.resize(probes_.size());
    for (std::size_t k = 0; k < probes_.size(); ++k) {
      const double with = probes_[k].inertia * (s.acceleration[0] - acceleration(probes_[k].setup, s, 0.0));
      out.by_free[k].assign(1, with - out.needed[0]);
      out.inertia_by_free[k].assign(1, probes_[k].inertia - inertia_);
    }
    return true;
  }

 private:
  double acceleration(const PlantSetup<double>& setup, const State& s, double input) const {
    constexpr double kProbe_s = 1e-6;  // read off a step this short
    return identify::acceleration(setup, like_, s.position[0], s.velocity[0], belt_ ? 1.0 : input, kProbe_s);
  }

  const Recording& like_;
  std::vector<conventions::Joint> joints_;
  std::vector<PlantSetup<double>> setups_;
  std::vector<std::string> gravities_;
  struct Probe {
    PlantSetup<double> setup;
    double inertia;
  };
  std::vector<Probe> probes_;  ///< each with a free parameter at a bound
  std::vector<conventions::FreeParameter> free_;
  double inertia_ = 1.0;
  bool leg_ = false, belt_ = false;
  double touchdown_m_ = 0.0;
};

/// Rows in which something holds the machine are no part of any equation.
bool held(const Recording& r, machines::Cut cut, std::size_t i) {
  if (cut == machines::Cut::flights) return !r.contact.empty() && r.contact[i] != 0.0;
  if (cut == machines::Cut::releases) return r.input[i] == 0.0 || r.velocity_smoothed[i] == 0.0;
  return false;
}

std::vector<conventions::Columns> trial_columns(const model::Model& model,
                                                const std::vector<Recording>& recordings) {
  const machines::Cut cut = machines::rules(model.kind).cut;
  std::vector<conventions::Columns> all;
  for (const Recording& r : recordings) {
    conventions::Columns c{r.name, r.time_s, {r.position}, {r.input}, {}, std::vector<bool>(r.rows(), false)};
    if (r.velocity_recorded) c.velocity.push_back(r.velocity);
    for (const auto& [ours, of] : r.mapped)
      if (of.parts.size() == 1) c.sources[ours] = {of.parts[0].column, of.parts[0].scale, of.offset};
    for (std::size_t i = 0; i + 1 < r.rows(); ++i) c.breaks[i] = held(r, cut, i) || held(r, cut, i + 1);
    all.push_back(std::move(c));
  }
  return all;
}

}  // namespace

void require_conventions(const model::Model& model, const std::vector<Recording>& recordings) {
  if (recordings.empty()) return;
  conventions::require_convention(OneJoint(model, recordings.front()), trial_columns(model, recordings));
}

std::optional<conventions::Finding> find_convention(const model::Model& model,
                                                    const std::vector<Recording>& recordings) {
  return conventions::find_convention(OneJoint(model, recordings.front()), trial_columns(model, recordings));
}

conventions::AsNamed as_named(const model::Model& model, const std::vector<Recording>& recordings) {
  return conventions::as_named(OneJoint(model, recordings.front()), trial_columns(model, recordings));
}

}  // namespace furcula::identify
