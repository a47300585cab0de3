#include "host/diagnose/verdict.hpp"

#include <algorithm>

#include "host/diagnose/findings.hpp"
#include "host/diagnose/posterior.hpp"
#include "host/diagnose/repeatability.hpp"
#include "host/identify/simulation_fit.hpp"

namespace furcula::diagnose {
namespace {

/// Two looks at the held-out recordings: predictions from the first 50 ms, and free runs with the best
/// start state, which the start's own noise does not blur.
bool noise_alone(const Diagnosis& d, const HeldOut& held_out) {
  const identify::Fit look =
      identify::fit_by_simulation(d.extended_model, {}, {}, held_out.recordings(), held_out.windows());
  double rows = 0.0;
  double squares = 0.0;
  for (const auto& share : look.shares) {
    rows += share[identify::Channel::motion].rows;
    squares += share[identify::Channel::motion].squares;
  }
  return held_out.nmse(d.extended) <= kWithinNoise * (held_out.nmse(d.noise_floor) + kNumerics) ||
         squares <= kWithinNoise * rows;
}

Verdict decided(const Diagnosis& d, const HeldOut& held_out, const VerdictInputs& inputs) {
  constexpr double kSmallRemainder = 0.1;
  if (!d.beyond_bounds.empty()) return Verdict::not_identifiable;
  if (d.findings.empty()) {
    if (d.nothing_left) return d.contact_switch.is_refuted() ? Verdict::unexplained : Verdict::adequate;
    return inputs.few_windows ? Verdict::not_identifiable : Verdict::unexplained;
  }
  if (other_channels_alone(d.findings)) {
    const bool helps =
        std::any_of(d.findings.begin(), d.findings.end(), [](const Finding& f) { return f.helps; });
    if (!helps) return Verdict::not_identifiable;
    return d.nothing_left ? Verdict::explained : Verdict::partly_explained;
  }
  // What helps on the training recordings, the held-out ones may refute.
  if (inputs.undecided || !helps_held_out(d, held_out, inputs.slip_alone)) return Verdict::not_identifiable;
  const bool far_off = most_beside(held_out.nmse(d.extended), held_out.nmse(d.noise_floor)) < 0.5;
  if (far_off && !d.nothing_left) return Verdict::partly_explained;
  return d.nothing_left || d.unnamed_share < kSmallRemainder ? Verdict::explained : Verdict::partly_explained;
}

}  // namespace

bool random_alone(const Diagnosis& d, const HeldOut& held_out) {
  const bool numerics = held_out.nmse(d.extended) <= kNumerics;
  const auto& left = d.remainder;
  return left ? !left->is_structured() && left->repeats() && (numerics || !left->is_coloured())
              : falls_repeat(d.extended_model, held_out.recordings(), held_out.windows(), held_out.starts());
}

bool helps_held_out(const Diagnosis& d, const HeldOut& held_out, bool slip_alone) {
  constexpr double kFarOff = 2.0;
  return held_out.nmse(d.extended) < (slip_alone ? kFarOff : 1.0) * held_out.nmse(d.refitted);
}

void judge(Diagnosis& d, const HeldOut& held_out, const VerdictInputs& inputs) {
  const double floor = held_out.nmse(d.noise_floor), before = held_out.nmse(d.refitted),
               after = held_out.nmse(d.extended);
  // The noise floor is mostly that of the start states: where more is known, it does not decide.
  d.nothing_left = inputs.random_alone || (!d.remainder && noise_alone(d, held_out));
  d.residual_white = d.remainder ? d.remainder->new_finds.white() : d.nothing_left;
  // Where all that is left comes at random, that is nothing to explain but for what a flexible law predicts of it.
  const double to_explain =
      d.nothing_left && d.remainder ? std::max(0.0, d.remainder->predictable.share) : 1.0;
  d.unexplained_fraction = before > 0.0 ? std::clamp(to_explain * (after - floor) / before, 0.0, 1.0) : 0.0;
  const bool missing = d.remainder && d.remainder->is_structured();
  d.unnamed_share =
      unnamed_share(before, after, floor, missing ? &d.remainder->predictable : nullptr, d.nothing_left);
  d.verdict = decided(d, held_out, inputs);
  if (d.findings.empty() || other_channels_alone(d.findings)) d.unnamed_share = 0.0;
}

void judge_names(Diagnosis& d) {
  if (d.verdict != Verdict::explained || d.findings.empty()) return;
  for (const Finding& f : d.findings)
    if (f.confidence >= 0.5) return;
  d.verdict = d.none_of_catalogue > 0.5 ? Verdict::partly_explained : Verdict::not_identifiable;
}

}  // namespace furcula::diagnose
