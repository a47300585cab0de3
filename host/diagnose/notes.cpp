#include "host/diagnose/notes.hpp"

#include <algorithm>

#include "host/diagnose/laws.hpp"
#include "host/diagnose/wording.hpp"

namespace furcula::diagnose {
namespace {

/// Of each recording, RMS error of the position.
std::vector<double> errors_of_recordings(const model::Model& m, const HeldOut& held_out) {
  const std::vector<identify::ErrorSums> sums = held_out.sums(m, identify::Channel::motion);
  std::vector<identify::ErrorSums> of(held_out.recordings().size());
  for (std::size_t i = 0; i < sums.size(); ++i) of[held_out.windows()[i].recording] += sums[i];
  std::vector<double> rmse;
  for (const identify::ErrorSums& s : of) rmse.push_back(s.count > 0.0 ? s.errors().rmse : 0.0);
  return rmse;
}

}  // namespace

std::optional<std::string> note_one_scale(const model::Model& model, const std::vector<Finding>& findings) {
  using dynamics::Effect;
  if (model.kind != dynamics::Kind::motor_axis) return std::nullopt;
  const auto ratio = [&](Effect e, const char* key) -> std::optional<Estimate> {
    const auto found =
        std::find_if(findings.begin(), findings.end(), [&](const Finding& f) { return f.effect == e; });
    const double given = model.parameter(key);
    if (found == findings.end() || !(given > 0.0)) return std::nullopt;
    const Estimate& of = found->parameters.begin()->second;
    return Estimate{of.value / given, of.lower / given, of.upper / given};
  };
  const auto mass = ratio(Effect::mass_error, "mass_kg"),
             damping = ratio(Effect::damping_error, "damping_nspm");
  if (!mass || !damping || mass->lower > damping->upper || damping->lower > mass->upper) return std::nullopt;
  return "Mass and damping are both " + number(mass->value) + " times the model's: a force of " +
         number(1.0 / mass->value, 3) + " times what the logs say, or a position of " +
         number(mass->value, 3) +
         " times what they say, is the same law. Check the force's constant and the encoder's scale.";
}

std::optional<std::string> note_held_out_that_tells(const model::Model& model, const Selection& selection,
                                                    const HeldOut& held_out, const std::string& unit) {
  constexpr double kTells = 2.0;  // times the error
  const Hypothesis& chosen = selection.chosen;
  const std::vector<double> own = errors_of_recordings(chosen.fitted, held_out);
  for (const auto& [of, rival] : selection.equals) {
    if (always_same(model, rival.effects, chosen.effects)) continue;
    const std::vector<double> its = errors_of_recordings(rival.fitted, held_out);
    for (std::size_t i = 0; i < own.size(); ++i) {
      const double least = std::min(own[i], its[i]);
      if (!(least > 0.0) || std::max(own[i], its[i]) < kTells * least) continue;
      return held_out.recordings()[i].name + ", which is held out, tells them apart: its error (RMSE) is " +
             readable(own[i], unit) + " with " + names(chosen.effects) + " and " + readable(its[i], unit) +
             " with " + names(rival.effects) +
             ". Diagnose with it among the recordings that are fitted, and hold out others.";
    }
  }
  return std::nullopt;
}

}  // namespace furcula::diagnose
