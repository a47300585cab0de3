#include "host/diagnose/wording.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "host/core/message.hpp"

namespace furcula::diagnose {
namespace {

template <class Names>
std::string joined(const Names& all, const char* between) {
  std::string text;
  for (const auto& name : all) text += (text.empty() ? "" : between) + std::string(name);
  return text;
}

std::string times(int count) { return count == 1 ? "once" : std::to_string(count) + " times"; }

/// The finding that another law could take the place of; none: nullptr.
const Finding* undecided(const Diagnosis& d) {
  for (const Finding& f : d.findings)
    if (f.undecided) return &f;
  return nullptr;
}

/// The channel whose error is told: the main one, or the one that all findings are judged on.
struct Told {
  std::string channel, unit;
};
Told told(const Diagnosis& d) {
  Told all{d.main_channel, d.main_unit};
  if (d.findings.empty() || d.findings.front().channel.empty()) return all;
  const std::string& channel = d.findings.front().channel;
  for (const Finding& f : d.findings)
    if (f.channel != channel) return all;
  return {channel, channel == "contact" ? "s" : channel == "leg_angle" ? "rad" : "N m"};
}

std::string before_and_after(const Diagnosis& d, const Errors& before, const Errors& after) {
  const auto [channel, unit] = told(d);
  const auto b = before.find(channel), a = after.find(channel);
  if (b == before.end() || a == after.end()) return "";
  return "from " + readable(b->second.rmse, unit) + " to " + readable(a->second.rmse, unit);
}

/// "a random force of 0.25 N": what the machine does not repeat, where that is more than the noise.
std::string random_force(const Diagnosis& d) {
  const Remainder& left = *d.remainder;
  return std::string(left.unit == "N" ? "a random force of " : "a random torque of ") +
         number(left.largest_random_force(), 2) + " " + left.unit + " (" +
         number(100.0 * left.largest_random_force() / left.typical_force, 2) + " % of " + left.typical_is +
         ")";
}

/// What is left of a model of which nothing more is to be explained.
std::string what_is_left(const Diagnosis& d) {
  constexpr double kWorthAWord = 1e-3;
  if (!d.remainder || d.remainder->random_force < kWorthAWord * d.remainder->typical_force)
    return "measuring noise";
  return "measuring noise and what the machine does not repeat, " + random_force(d);
}

/// Why what is left has a cause, as far as that is known.
std::string why_unexplained(const Diagnosis& d) {
  if (!d.remainder) return "";
  const Remainder& left = *d.remainder;
  if (left.is_structured())
    return ". A flexible law of the motion, the input and the time, learned on the training recordings, takes off " +
           number(100.0 * left.predictable.share, 2) + " % of the held-out squares, with a " +
           (left.unit == "N" ? "force" : "torque") + " of " + number(left.predictable.force, 2) + " " +
           left.unit + (d.correlated_with.empty() ? "" : "; " + d.correlated_with.front().description);
  if (left.is_coloured())
    return ". The filter's innovations in successive rows are correlated (" +
           number(left.new_finds.correlation, 2) + "): they are not sensor noise";
  if (left.random_force_held_out > 2.0 * left.random_force)
    return ". The held-out recordings lack " + number(left.random_force_held_out, 2) + " " + left.unit +
           " that the training recordings do not: another machine, or one that has changed";
  if (!left.repeats())
    return ". It looks like " + random_force(d) +
           (d.correlated_with.empty() ? ", which nothing in the recordings predicts"
                                      : "; " + d.correlated_with.front().description);
  return "";
}

/// What stands beside the noise floor after the extension.
std::string beside_the_floor(const Diagnosis& d) {
  const auto [channel, unit] = told(d);
  const auto after = d.extended.find(channel), floor = d.noise_floor.find(channel);
  if (after == d.extended.end() || floor == d.noise_floor.end() || !(floor->second.rmse > 0.0)) return "";
  return "; the noise floor is " + readable(floor->second.rmse, unit);
}

/// "; or, the same law, encoder_offset: 1.05 rad".
std::string other_words(const Finding& f, const Diagnosis& d) {
  std::string text;
  for (const Rival& r : f.indistinguishable_from) {
    if (!r.same_law || r.names.size() != 1) continue;
    const auto effect = dynamics::effect_named(r.names.front());
    if (!effect) continue;
    std::string values;
    for (const auto& p : dynamics::info(*effect).parameters()) {
      const auto found = r.parameters.find(r.names.front() + "." + std::string(name_on(p, d.kind)));
      if (found == r.parameters.end()) continue;
      const std::string unit(unit_on(p, d.kind));
      values +=
          (values.empty() ? ": " : ", ") + number(found->second.value) + (unit.empty() ? "" : " " + unit);
    }
    text += "; or, the same law, " + r.names.front() + values;
  }
  return text;
}

/// "1.62 kg, not 1.55 kg": a finding's values, beside the model's own where one takes its place.
std::string values_of(const Finding& f, const Diagnosis& d) {
  const auto& info = dynamics::info(f.effect);
  std::string values;
  for (const auto& p : info.parameters()) {
    const std::string key(name_on(p, d.kind)), unit(unit_on(p, d.kind));
    const auto found = f.parameters.find(key);
    if (found == f.parameters.end()) continue;
    const auto with_unit = [&](double value) { return number(value) + (unit.empty() ? "" : " " + unit); };
    values += (values.empty() ? "" : ", ") + (info.parameter_count > 1 ? key + " " : "") +
              with_unit(found->second.value);
    const std::string_view of_model = p.model_parameter.empty() ? key : p.model_parameter;
    const auto given = std::find_if(d.parameters.begin(), d.parameters.end(),
                                    [&](const auto& row) { return row.name == of_model; });
    if (is_wrong_parameter(f.effect) && given != d.parameters.end())
      values += ", not " + with_unit(given->baseline);
  }
  return " (" + std::string(info.name) + ": " + values + other_words(f, d) + ")";
}

/// "the model lacks dry friction (...), and the model's mass is wrong (...)", of all findings.
std::string what_is_wrong(const Diagnosis& d) {
  std::string lacking, wrong;
  for (const Finding& f : d.findings) {
    const std::string title(dynamics::info(f.effect).title);
    if (is_wrong_parameter(f.effect))
      wrong += (wrong.empty() ? "" : " and ") + title + " is wrong" + values_of(f, d);
    else
      lacking += (lacking.empty() ? "the model lacks " : " and ") + title + values_of(f, d);
  }
  return lacking + (lacking.empty() || wrong.empty() ? "" : ", and ") + wrong;
}

std::string sentence(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string beyond_bounds(const Diagnosis& d) {
  std::string text;
  for (const auto& p : d.beyond_bounds)
    text += (text.empty() ? "" : " and ") + p.name + " = " + number(p.value) + " " + p.unit + " (bounds " +
            number(p.lower) + " to " + number(p.upper) + ")";
  return text;
}

double highest_confidence(const Diagnosis& d) {
  double highest = 0.0;
  for (const Finding& f : d.findings) highest = std::max(highest, f.confidence);
  return highest;
}

}  // namespace

bool any_believed(const Diagnosis& d) { return highest_confidence(d) >= 0.5; }

bool is_wrong_parameter(dynamics::Effect effect) {
  return dynamics::info(effect).title.starts_with("the model's ");
}

std::string number(double value, int digits) { return core::rounded(value, digits); }

std::string with_interval(const Estimate& e, const std::string& unit) {
  return number(e.value) + (unit.empty() ? "" : " " + unit) + " (" + number(e.lower) + " to " +
         number(e.upper) + ")";
}

std::string names(const std::vector<dynamics::Effect>& effects) {
  std::vector<std::string_view> all;
  for (auto e : effects) all.push_back(dynamics::info(e).name);
  return joined(all, " + ");
}
std::string names(const std::vector<std::string>& effects) { return joined(effects, " + "); }

std::string readable(double value, const std::string& unit) {
  return unit == "m" ? number(1e3 * value) + " mm" : number(value) + " " + unit;
}

namespace {

/// Whether what is named lowers the held-out error; a slip of the encoder that nothing predicts need not.
bool lower(const Diagnosis& d) {
  const std::string channel = told(d).channel;
  const auto before = d.refitted.find(channel), after = d.extended.find(channel);
  return before == d.refitted.end() || after == d.extended.end() || after->second.rmse < before->second.rmse;
}

std::string summary_of(const Diagnosis& d) {
  std::string channel = told(d).channel;
  std::replace(channel.begin(), channel.end(), '_', ' ');
  const std::string where = "held-out " + channel + " error (RMSE)";
  const std::string named = what_is_wrong(d);
  const std::string falls = std::string(d.findings.size() > 1 ? ": with them the " : ": with it the ") +
                            where + (lower(d) ? " falls " : " goes ") +
                            before_and_after(d, d.refitted, d.extended);
  const std::string no_finding = "It looks as if " + named + falls + ". But a confidence of " +
                                 number(highest_confidence(d), 2) + " is no finding";
  switch (d.verdict) {
    case Verdict::adequate:
      return "The model is adequate: after moving its free parameters, nothing is left but " +
             what_is_left(d) + " (" + where + " " + before_and_after(d, d.baseline, d.refitted) + ").";
    case Verdict::explained:
      if (!any_believed(d)) {
        const std::vector<std::string>& why = d.findings.front().lowered_by;
        return no_finding + (why.empty() ? "" : ": " + why.front()) + ".";
      }
      return sentence(named + falls + beside_the_floor(d) + ".");
    case Verdict::partly_explained:
      if (!any_believed(d))
        return no_finding + ", and structure remains that no effect of the catalogue removes.";
      if (d.unnamed_share <= 0.5)
        return sentence(named + falls + ", but structure remains that no effect of the catalogue removes.");
      return "Most of what is wrong with the model is not in the catalogue. A part of it looks as if " +
             named + falls + ".";
    case Verdict::unexplained:
      if (d.nothing_left && d.contact_switch.is_refuted())
        return "The motion is predicted down to the measuring noise, but " +
               identify::in_words(d.contact_switch) + ". No effect of the catalogue explains that.";
      return "The model is wrong in a way that no effect of the catalogue explains: the " + where +
             " stays at " + readable(d.refitted.at(d.main_channel).rmse, d.main_unit) +
             ", above the measuring noise" + why_unexplained(d) + ".";
    case Verdict::not_identifiable: {
      if (!d.beyond_bounds.empty())
        return "Nothing can be named: the bounds of the free parameters exclude what the recordings ask for, " +
               beyond_bounds(d) + ".";
      if (d.findings.empty())
        return "The recordings are too few or too poor to tell whether the model is right.";
      const Finding* open = undecided(d);
      if (open == nullptr)
        return "No cause is named with confidence: the training recordings look as if " + named +
               ", but on the held-out ones the " + where + " goes " +
               before_and_after(d, d.refitted, d.extended) +
               ". Either the recordings differ from one another, or what is missing is not in the catalogue.";
      const auto rival =
          std::find_if(open->indistinguishable_from.begin(), open->indistinguishable_from.end(),
                       [](const Rival& r) { return !r.same_law; });
      return "Something is wrong, and these recordings cannot tell what: " + named + "; " +
             names(rival->names) + " in place of " + std::string(dynamics::info(open->effect).name) +
             " explains them equally well.";
    }
  }
  return "";
}

}  // namespace

std::string summary(const Diagnosis& d) {
  if (d.windows_excluded == 0) return summary_of(d);
  return summary_of(d) + " No figure is of " + std::to_string(d.windows_excluded) +
         " held-out windows that hold or follow a slip of the encoder, which cannot be predicted.";
}

std::string experiment_that_tells(const Diagnosis& d, const std::vector<std::string>& sets) {
  constexpr int kMostRecordings = 20;
  const std::string all = joined(sets, ", ");
  if (d.experiments.empty() || d.experiments.front().recordings > kMostRecordings)
    return "By simulation no experiment of the library tells " + all + " apart within " +
           std::to_string(kMostRecordings) +
           " recordings: measure one of them directly, on a scale or with a spring balance.";
  const Experiment& best = d.experiments.front();
  std::string text =
      "Record " + best.what + ", " + times(best.recordings) +
      ", and diagnose it together with these recordings. By simulation it tells " + all +
      " apart best: each fitted to all recordings, the two nearest predictions still differ by " +
      readable(best.apart, d.main_unit) + " (RMS).";
  if (d.experiments.size() > 1 && d.experiments[1].recordings <= kMostRecordings)
    text += " Next best: " + d.experiments[1].what + ", " + times(d.experiments[1].recordings) + ".";
  return text;
}

std::string next_experiment(const Diagnosis& d) {
  switch (d.verdict) {
    case Verdict::adequate:
      return "None is needed. To test the model further, record motion that the recordings do not hold yet: "
             "slower, faster, longer.";
    case Verdict::unexplained:
      if (d.nothing_left && d.contact_switch.is_refuted())
        return "Check the contact switch: does it stick, is it wired to this foot, is its polarity right? Press it by hand and watch "
               "its column. If it is right, check the touchdown height of the model.";
      [[fallthrough]];
    case Verdict::partly_explained:
      if (!d.correlated_with.empty())
        return "Repeat one recording unchanged, then vary " + d.correlated_with.front().signal +
               " alone: the residual is correlated with it most.";
      return "Repeat one recording unchanged: error that repeats is due to the machine, the rest is measurement noise.";
    case Verdict::explained:
    case Verdict::not_identifiable:
      if (!d.beyond_bounds.empty())
        return "Widen those bounds in the model file's [free] and diagnose again; where the parameter cannot be so, "
               "check the recordings' units and the held parameters first.";
      if (const Finding* open = undecided(d)) return open->next_experiment;
      if (!d.findings.empty()) return d.findings.front().next_experiment;
      return "Record more: several hops or strokes at different amplitudes and speeds, in at least five recordings.";
  }
  return "";
}

}  // namespace furcula::diagnose
