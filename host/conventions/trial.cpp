// The trial of conventions, see trial.hpp.
#include "host/conventions/trial.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <set>
#include <sstream>

#include "host/conventions/equation.hpp"
#include "host/conventions/equations.hpp"
#include "host/conventions/instants.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/quantile.hpp"

namespace furcula::conventions {
namespace {

/// More instants cost time and say the same.
constexpr std::size_t kMostInstants = 500;
/// Readings that are hardly further behind the best one than an estimated number, or a rare unit, costs are mentioned beside it.
const double kAsGood = 1.2 * kEstimated * kFarBetter;
/// A scale or a zero this near to one, or to none, is a cause of the catalogue, not a convention.
constexpr double kNearOne = 1.8, kNearZero_rad = 0.75;
/// Estimates of scales are off by what the model's inertia may be: units within that factor are tried, and those near by are named.
constexpr double kBesideUnit = 1.3;
/// Scales of several joints within this factor are one.
constexpr double kAlike = 2.0;
/// Between two rows of a log of a machine that is moved by drives.
constexpr double kShortest_s = 1e-5, kLongest_s = 1.0;
constexpr double kQuarter = std::numbers::pi / 2.0;

/// A change of how columns are read, of the machine's side or of its inputs.
struct Change {
  Reading reading;
  std::string what, map;
  std::vector<std::string> same;  ///< what of the machine would look the same
  double changes = 1.0;           ///< each estimated number counts for kEstimated more
  bool any_scale = false;  ///< of a position: its known units need not be named beside it, nor it beside them
};

struct Scored {
  double score = -std::numeric_limits<double>::infinity();  ///< the fit, less what its changes cost
  double fit = 0.0;
  std::string what, map;
  std::vector<std::string> same;
  double off = 0.0;            ///< the rest over the force, RMS, at the joint where that is most
  std::vector<double> off_of;  ///< at each joint
  bool given = false, any_scale = false, of_time = false;
};

std::string line_of(const std::string& ours, const std::string& theirs, double scale, double offset) {
  std::string out = ours + " = { column = \"" + theirs + "\"";
  if (scale != 1.0) out += ", scale = " + core::rounded(scale, 7);
  if (offset != 0.0) out += ", offset = " + core::rounded(offset, 7);
  return out + " }";
}

/// Lines of columns, and of the scales of some; one line a column.
std::string both_lines(std::string lines, const std::string& scales) {
  std::istringstream more(scales);
  for (std::string line; std::getline(more, line);) {
    const std::string key = line.substr(0, line.find('=') + 1);
    const std::size_t at = lines.starts_with(key) ? 0 : lines.find("\n" + key), scale = line.find(", scale");
    if (at == lines.npos)
      lines += (lines.empty() ? "" : "\n") + line;
    else if (scale != line.npos)
      lines.insert(lines.find(" }", at), line.substr(scale, line.rfind(" }") - scale));
  }
  return lines;
}

std::string and_list(const std::vector<std::string>& all) {
  std::string out;
  for (std::size_t i = 0; i < all.size(); ++i)
    out += (i == 0 ? "" : i + 1 == all.size() ? " and " : ", ") + all[i];
  return out;
}

/// Lines of line_of(), with what a map file says already of the columns.
std::string over_map(const std::string& lines, const std::map<std::string, Source>& sources) {
  std::istringstream all(lines);
  std::string out;
  for (std::string line; std::getline(all, line);) {
    const auto number = [&](const std::string& key, double otherwise) {
      const std::size_t at = line.find(", " + key + " = ");
      return at == line.npos ? otherwise : std::strtod(line.c_str() + at + key.size() + 5, nullptr);
    };
    const std::size_t from = line.find('"') + 1, to = line.find('"', from);
    const auto source = sources.find(line.substr(from, to - from));
    if (source != sources.end()) {
      const double scale = number("scale", 1.0);
      line = line_of(line.substr(0, line.find(" = ")), source->second.column, source->second.scale * scale,
                     source->second.offset * scale + number("offset", 0.0));
    }
    out += (out.empty() ? "" : "\n") + line;
  }
  return out;
}

bool whole_numbers(std::span<const Columns> recordings, std::size_t joint) {
  bool any = false;
  for (const Columns& c : recordings)
    for (const double x : c.position[joint]) {
      if (x != std::round(x)) return false;
      any = any || x != 0.0;
    }
  return any;
}

class Trial {
 public:
  Trial(const Family& family, std::span<const Columns> recordings)
      : family_(family), joints_(family.joints()), recordings_(recordings), n_(joints_.size()) {
    collect_signals();
    std::vector<double> intervals;
    for (const Columns& c : recordings_)
      for (std::size_t i = 1; i < c.time_s.size(); ++i) intervals.push_back(c.time_s[i] - c.time_s[i - 1]);
    if (!intervals.empty()) interval_ = core::median(std::move(intervals));
    std::vector<std::size_t> moving(n_);
    std::iota(moving.begin(), moving.end(), std::size_t{0});
    std::erase_if(moving, [&](std::size_t j) { return !moves(j); });
    if (!moving.empty()) instants_ = instants_of(recordings_, signals_, moving, kMostInstants);
    moving_ = moving;
  }

  std::optional<Finding> run() {
    if (const auto found = judged([&] {
          for (const Change& c : changes()) weigh(c);
          estimate_scales();
          estimate_zeros();
        }))
      return found;
    // Where a position and an input are exchanged, the input's noise says how many rows an instant takes.
    std::vector<std::size_t> inputs;
    for (const std::size_t j : moving_)
      if (!joints_[j].input_column.empty()) inputs.push_back(n_ + j);
    if (inputs.empty()) return std::nullopt;
    instants_ = instants_of(recordings_, signals_, inputs, kMostInstants);
    return judged([&] {
      std::vector<Change> all;
      exchanges(all);
      for (const Change& c : all) weigh(c);
    });
  }

  AsNamed as_named() {
    if (instants_.size() < kFewestInstants) return {};
    weigh({given(), "", "", {}, 0.0});
    if (all_.empty()) return {};
    return {true, all_.front().off_of};
  }

 private:
  /// The best of what `weigh_all` weighs beside the columns as named, if it is far better than those.
  template <class WeighAll>
  std::optional<Finding> judged(const WeighAll& weigh_all) {
    all_.clear();
    if (instants_.size() < kFewestInstants) return std::nullopt;
    weigh({given(), "", "", {}, 0.0});
    if (all_.empty()) return std::nullopt;
    if (all_.front().off < kAsked && all_.front().fit > kFarBetter) return std::nullopt;
    const double as_given = std::max(all_[0].score, all_[1].score), off_given = all_[1].off;
    weigh_all();
    const auto best = std::max_element(all_.begin(), all_.end(),
                                       [](const Scored& a, const Scored& b) { return a.score < b.score; });
    if (best->given || !(best->score > as_given) || !(best->fit > kFarBetter)) return std::nullopt;
    for (std::size_t j = 0; j < n_; ++j)
      if (const double left = best->off_of[j]; left * left >= kUnexplained && left > all_.front().off_of[j])
        return std::nullopt;
    Finding f{best->what, best->map, best->same, {}, off_given, best->off, best->of_time};
    std::vector<const Scored*> near;
    for (const Scored& s : all_)
      if (&s != &*best && !s.given && s.score > best->score - kAsGood) near.push_back(&s);
    std::stable_sort(near.begin(), near.end(),
                     [](const Scored* a, const Scored* b) { return a->score > b->score; });
    // Other columns first, then other readings of the same.
    std::set<std::string> columns{first_word(f.what)};
    for (const bool of_new_column : {true, false})
      for (const Scored* s : near) {
        const bool again = s->what.starts_with(f.what) ||
                           std::find(f.others.begin(), f.others.end(), s->what) != f.others.end();
        const bool unit_and_scale =
            s->any_scale != best->any_scale && first_word(s->what) == first_word(f.what);
        if (f.others.size() == 3 || again || unit_and_scale) continue;
        if (columns.insert(first_word(s->what)).second || !of_new_column) f.others.push_back(s->what);
      }
    return f;
  }

  static std::string first_word(const std::string& text) { return text.substr(0, text.find(' ')); }

  void collect_signals() {
    std::vector<std::vector<const std::vector<double>*>> of(3 * n_);
    for (const Columns& c : recordings_)
      for (std::size_t j = 0; j < n_; ++j) {
        of[j].push_back(&c.position[j]);
        of[n_ + j].push_back(&c.input[j]);
        const bool has = j < c.velocity.size() && !c.velocity[j].empty();
        of[2 * n_ + j].push_back(has ? &c.velocity[j] : nullptr);
      }
    for (std::size_t j = 0; j < n_; ++j) {
      auto& velocity = of[2 * n_ + j];
      has_velocity_.push_back(
          std::none_of(velocity.begin(), velocity.end(), [](auto* p) { return p == nullptr; }));
      if (!has_velocity_.back()) velocity = of[j];
    }
    signals_ = std::move(of);
    decode_inputs();
  }

  /// A signed number that was read as an unsigned one, sign and magnitude or two's complement, never is negative and jumps by one
  /// amount where the sign changes.
  void decode_inputs() {
    for (std::size_t j = 0; j < n_; ++j) {
      if (joints_[j].input_column.empty()) continue;
      double low = std::numeric_limits<double>::infinity(), longest = 0.0;
      for (const auto* column : signals_[n_ + j])
        for (std::size_t i = 0; i < column->size(); ++i) {
          low = std::min(low, (*column)[i]);
          if (i > 0) longest = std::max(longest, std::abs((*column)[i] - (*column)[i - 1]));
        }
      // Values after a jump upwards are the sign's worth, and a little of the signal.
      const double jump = 0.5 * longest;
      double least = std::numeric_limits<double>::infinity(), most = 0.0;
      std::size_t jumps = 0;
      for (const auto* column : signals_[n_ + j])
        for (std::size_t i = 1; i < column->size(); ++i)
          if ((*column)[i] - (*column)[i - 1] > jump) {
            ++jumps;
            least = std::min(least, (*column)[i]), most = std::max(most, (*column)[i]);
          }
      if (!(low >= 0.0) || jumps < 2) continue;
      for (const bool complement : {false, true}) {
        const double worth = complement ? most : least;
        std::vector<const std::vector<double>*> decoded;
        for (const auto* column : signals_[n_ + j]) {
          auto& out = owned_.emplace_back(std::make_unique<std::vector<double>>(*column));
          bool negative = column->front() > worth;
          for (std::size_t i = 0; i < column->size(); ++i) {
            const double x = (*column)[i], step = i > 0 ? x - (*column)[i - 1] : 0.0;
            if (step > jump) negative = true;
            if (step < -jump) negative = false;
            if (negative) (*out)[i] = complement ? x - worth : worth - x;
          }
          decoded.push_back(out.get());
        }
        const std::string at = joints_[j].input_column + " never is negative and jumps by " +
                               core::rounded(worth, 4) + " where its sign changes: ";
        decoded_.push_back({j, signals_.size(),
                            at + (complement ? "it is signed (two's complement) and was read as unsigned"
                                             : "it is sign and magnitude, and the sign's bit was read as " +
                                                   core::rounded(worth, 4))});
        signals_.push_back(std::move(decoded));
      }
    }
  }

  bool moves(std::size_t j) const {
    for (const auto* column : signals_[j]) {
      const auto [low, high] = std::minmax_element(column->begin(), column->end());
      if (*high > *low) return true;
    }
    return false;
  }

  Reading given() const {
    Reading r{std::vector<std::size_t>(n_), std::vector<std::size_t>(n_), std::vector<double>(n_, 1.0),
              std::vector<double>(n_, 0.0)};
    for (std::size_t j = 0; j < n_; ++j) r.position_of[j] = j, r.input_of[j] = n_ + j;
    return r;
  }

  /// Adds what the change is worth with the inputs as logged, and with other signs and scales of them.
  double weigh(const Change& change) {
    Equations equations;
    if (!equations.write(family_, instants_, scans_ ? step_of_scan() : 1, change.reading))
      return -std::numeric_limits<double>::infinity();
    const std::vector<Equation>& e = equations.of;
    double best = -std::numeric_limits<double>::infinity();
    // One input scale a joint.
    const auto add = [&](const std::vector<InputScale>& how, double more, const std::string& what,
                         const std::string& map, const std::vector<std::string>& same,
                         bool any_cause = false) {
      Scored s;
      std::vector<Rest> rests;
      for (std::size_t j = 0; j < n_; ++j) {
        rests.push_back(any_cause ? e[j].solve(how[j], true) : rest_of(e[j], j, how[j]));
        s.off_of.push_back(rests.back().off());
        s.off = std::max(s.off, s.off_of.back());
      }
      s.fit = equations.fit(rests, instants_.size());
      s.score = s.fit - kFarBetter * (change.changes + more);
      s.what = change.what + (change.what.empty() || what.empty() ? "" : ", and ") + what;
      s.map = both_lines(change.map, map);
      s.same = change.same;
      s.same.insert(s.same.end(), same.begin(), same.end());
      s.given = s.what.empty();
      s.any_scale = change.any_scale;
      s.of_time = change.reading.time_scale != 1.0;
      best = std::max(best, s.score);
      all_.push_back(std::move(s));
    };
    solved_.assign(n_, {});
    const std::vector<InputScale> as_logged(n_);
    add(as_logged, 0.0, "", "", {});
    // As named the columns have the benefit of any cause, too, so that what is left speaks against the names.
    if (change.what.empty()) {
      add(as_logged, 0.0, "", "", {}, true);
    } else {
      std::vector<InputScale> likewise = as_logged;
      std::string lines;
      for (std::size_t j = 0; j < n_; ++j) {
        const double scale = change.reading.scale[j];
        if (!joints_[j].sets_position || scale == 1.0) continue;
        likewise[j].scale = scale;
        const std::string& column = joints_[j].input_column;
        lines += (lines.empty() ? "" : "\n") + line_of(column, column, scale, 0.0);
      }
      if (!lines.empty()) add(likewise, 0.0, "the set points likewise", lines, {});
    }
    if (scans_) return best;
    std::vector<std::size_t> driven;
    for (std::size_t j = 0; j < n_; ++j)
      if (!joints_[j].input_column.empty()) driven.push_back(j);
    std::vector<std::vector<std::size_t>> groups;
    if (driven.size() > 1) groups.push_back(driven);
    for (const std::size_t j : driven) groups.push_back({j});
    for (const auto& group : groups) {
      const auto scaled = [&](double scale, bool estimated) {
        std::vector<InputScale> how = as_logged;
        for (const std::size_t j : group) how[j] = {scale, estimated};
        return how;
      };
      std::vector<std::string> names;
      for (const std::size_t j : group) names.push_back(joints_[j].input_column);
      const auto map = [&](double scale) {
        std::string lines;
        for (const std::string& name : names)
          lines += (lines.empty() ? "" : "\n") + line_of(name, name, scale, 0.0);
        return lines;
      };
      const std::string they = and_list(names);
      add(scaled(-1.0, false), kSignOrExchange,
          they + (group.size() > 1 ? " have the other sign" : " has the other sign"), map(-1.0), {});
      const Scaled estimated = scaled_inputs(group, e);
      if (!estimated.what.empty())
        add(scaled(1.0, true), estimated.changes, estimated.what, estimated.map, estimated.same);
      if (estimated.common != 0.0) {
        add(scaled(estimated.common, false), 1.0 + kEstimated, about(group, {estimated.common}),
            map(estimated.common), same_of_scale(group, std::abs(estimated.common)));
        constexpr double kGrams = 1e-3;
        if (group.size() == n_ && group == driven &&
            std::abs(std::log(kGrams * estimated.common)) < std::log(kInertiaWithin))
          add(scaled(1.0 / kGrams, false), 1.0,
              "the model's masses are in g and its inertias in g m^2 (times 0.001)", "", {});
      }
      // Known units that are near to what is estimated, of one joint and so of all.
      const Quantity quantity = joints_[group.front()].input;
      if (std::any_of(group.begin(), group.end(),
                      [&](std::size_t j) { return joints_[j].input != quantity; }))
        continue;
      const double likely = std::abs(rest_of(e[group.front()], group.front(), {1.0, true}).input_scale);
      for (const Unit& u : units_of(quantity)) {
        double worth = 0.0;
        for (const std::size_t j : group) worth += rest_of(e[j], j, {u.si, false}).worth_of_drive();
        if (worth < kEstimated * kFarBetter) continue;
        if (!(std::abs(std::log(likely / u.si)) < std::log(kInertiaWithin))) continue;
        for (const double sign : {1.0, -1.0})
          add(scaled(sign * u.si, false),
              (u.rare ? 1.0 + kEstimated : 1.0) + (sign < 0.0 ? kSignOrExchange : 0.0),
              they + (group.size() > 1 ? " are in " : " is in ") + std::string(u.name) +
                  (sign < 0.0 ? ", of the other sign" : ""),
              map(sign * u.si), same_of_scale(group, u.si));
      }
    }
    return best;
  }

  /// What a change is worth while a scale or a zero is sought: with inputs as logged, on some of the instants, kept nowhere.
  double scanned(const Change& change) {
    const std::size_t before = all_.size();
    scans_ = true;
    const double score = weigh(change);
    scans_ = false;
    all_.resize(before);
    return score;
  }
  std::size_t step_of_scan() const {
    constexpr std::size_t kInstantsOfScan = 120;
    return std::max<std::size_t>(1, instants_.size() / kInstantsOfScan);
  }

  /// Solved once for each scale that is asked for.
  Rest rest_of(const Equation& e, std::size_t joint, InputScale how) {
    auto& known = solved_[joint];
    for (const auto& [key, rest] : known)
      if (key.estimated == how.estimated && (how.estimated || key.scale == how.scale)) return rest;
    return known.emplace_back(how, e.solve(how)).second;
  }

  /// What of the machine would look like another scale of its inputs.
  std::vector<std::string> same_of_scale(const std::vector<std::size_t>& group, double scale) const {
    if (group.size() != driven_count() || n_ != group.size() || joints_[group.front()].sets_position)
      return {};
    return {"all masses, inertias, dampings and stiffnesses " + core::rounded(1.0 / scale, 3) +
            " times those of the model"};
  }

  struct Scaled {
    std::string what, map;
    std::vector<std::string> same;
    double changes = 0.0;  ///< one for all inputs in one known unit, or of about one scale
    double common = 0.0;   ///< of several inputs, all torques or all forces: one scale for all
  };
  /// What inputs with estimated scales seem to be; nothing where a scale is near to one.
  Scaled scaled_inputs(const std::vector<std::size_t>& which, const std::vector<Equation>& e) {
    Scaled out;
    std::vector<double> scales;
    double worth = 0.0;
    for (const std::size_t j : which) {
      const Rest rest = rest_of(e[j], j, {1.0, true});
      const double scale = rest.input_scale, size = std::abs(scale);
      if (!(size > kNearOne || size < 1.0 / kNearOne)) return {};
      worth += rest.worth_of_drive();
      scales.push_back(scale);
      out.map += (out.map.empty() ? "" : "\n") +
                 line_of(joints_[j].input_column, joints_[j].input_column, scale, 0.0);
    }
    if (worth < kEstimated * kFarBetter) return {};  // the input hardly matters: nothing is said of its unit
    const auto [low, high] = std::minmax_element(scales.begin(), scales.end());
    const bool alike = *low * *high > 0.0 && std::max(*high / *low, *low / *high) < kAlike;
    const bool like = std::all_of(which.begin(), which.end(), [&](std::size_t j) {
      return joints_[j].input == joints_[which.front()].input && !joints_[j].sets_position;
    });
    if (which.size() > 1 && like) out.common = core::median(scales);
    out.what = about(which, alike ? std::vector<double>{core::median(scales)} : scales);
    out.changes = (1.0 + kEstimated) * (alike ? 1.0 : static_cast<double>(which.size()));
    out.same = same_of_scale(which, std::abs(scales.front()));
    return out;
  }

  /// That inputs have these scales, or one for all, and what that may be.
  std::string about(const std::vector<std::size_t>& which, const std::vector<double>& scales) const {
    std::vector<std::string> names, factors;
    for (const std::size_t j : which) names.push_back(joints_[j].input_column);
    for (const double s : scales) factors.push_back(core::rounded(1.0 / s, 2));
    const bool many = which.size() > 1;
    return and_list(names) + (many ? " are " : " is ") + "about " + and_list(factors) + " times what " +
           (many ? "they are" : "it is") + " in " + std::string(si_unit(joints_[which.front()].input)) +
           ": " + questions(which, std::abs(core::median(scales)));
  }

  /// What inputs with this scale may be.
  std::string questions(const std::vector<std::size_t>& which, double scale) const {
    const Joint& joint = joints_[which.front()];
    if (joint.sets_position) return "another unit?";
    const std::string si(si_unit(joint.input)), size = core::rounded(scale, 3);
    std::vector<std::string> out;
    if (scale > 1.0) out.push_back("the motor's, before a gear of " + size);
    out.push_back("a current, with " + size + " " + si + "/A (torque constant times gear)");
    // Per mille of the rated torque reach some hundreds.
    double most = 0.0;
    for (const std::size_t j : which)
      for (const auto* column : signals_[n_ + j])
        for (const double x : *column) most = std::max(most, std::abs(x));
    constexpr double kFewPerMille = 50.0, kMostPerMille = 3000.0;
    if (most > kFewPerMille && most < kMostPerMille)
      out.push_back("per mille of a rated " + core::rounded(1000.0 * scale, 3) + " " + si);
    for (const Unit& u : units_of(joint.input))
      if (std::abs(std::log(scale / u.si)) < std::log(kBesideUnit))
        out.push_back(std::string(u.name) + " (" + core::rounded(u.si, 3) + " " + si + ")");
    std::string text;
    for (std::size_t i = 0; i < out.size(); ++i)
      text += (i == 0 ? "" : i + 1 == out.size() ? ", or " : ", ") + out[i];
    return text + "?";
  }
  std::size_t driven_count() const {
    return static_cast<std::size_t>(std::count_if(joints_.begin(), joints_.end(),
                                                  [](const Joint& j) { return !j.input_column.empty(); }));
  }

  std::vector<std::size_t> of_quantity(Quantity q) const {
    std::vector<std::size_t> out;
    for (const std::size_t j : moving_)
      if (joints_[j].position == q) out.push_back(j);
    return out;
  }

  Change scaled_positions(const std::vector<std::size_t>& which, double scale,
                          const std::string& unit) const {
    Change c{given(), "", "", {}};
    std::vector<std::string> names;
    for (const std::size_t j : which) {
      c.reading.scale[j] = scale;
      names.push_back(joints_[j].position_column);
      c.map += (c.map.empty() ? "" : "\n") +
               line_of(joints_[j].position_column, joints_[j].position_column, scale, 0.0);
    }
    c.what = and_list(names) + (names.size() > 1 ? " are " : " is ") + unit;
    return c;
  }

  std::vector<Change> changes() const {
    std::vector<Change> out;
    for (const Quantity q : {Quantity::angle, Quantity::length}) {
      const std::vector<std::size_t> which = of_quantity(q);
      if (which.empty()) continue;
      for (const Unit& u : units_of(q)) {
        const std::string in = "in " + std::string(u.name);
        const auto push = [&](Change c) {
          if (u.rare) c.changes += kEstimated;
          out.push_back(std::move(c));
        };
        push(scaled_positions(which, u.si, in));
        if (which.size() > 1)
          for (const std::size_t j : which) push(scaled_positions({j}, u.si, in));
      }
      const bool whole = std::all_of(which.begin(), which.end(),
                                     [&](std::size_t j) { return whole_numbers(recordings_, j); });
      if (q == Quantity::angle && whole)
        for (int bits = 8; bits <= 24; ++bits)
          out.push_back(scaled_positions(which, 2.0 * std::numbers::pi / std::ldexp(1.0, bits),
                                         "in encoder counts, every value a whole number, " +
                                             core::shortest(std::ldexp(1.0, bits)) + " a turn"));
      const auto turned = [&](const std::vector<std::size_t>& joints) {
        Change c = scaled_positions(joints, -1.0, "of the other sign");
        c.changes = kSignOrExchange;
        out.push_back(std::move(c));
      };
      turned(which);
      if (which.size() > 1)
        for (const std::size_t j : which) turned({j});
    }
    for (const Unit& u : units_of_time()) {
      if (const double interval = u.si * interval_; interval < kShortest_s || interval > kLongest_s) continue;
      Change c{given(), "time_s is in " + std::string(u.name), line_of("time_s", "time_s", u.si, 0.0), {}};
      c.reading.time_scale = u.si;
      if (u.rare) c.changes += kEstimated;
      out.push_back(c);
    }
    const std::vector<std::string> gravities = family_.other_gravities();
    for (std::size_t g = 0; g < gravities.size(); ++g) {
      Change c{given(), gravities[g], "", {}};
      c.reading.gravity = g + 1;
      out.push_back(c);
    }
    if (n_ == 1) numbers_of_the_model(out);
    for (const auto& d : decoded_) {
      Change c{given(), d.what, "", {}};
      c.reading.input_of[d.joint] = d.signal;
      out.push_back(c);
    }
    exchanges(out);
    return out;
  }

  /// Those in other units than SI. (A URDF's are looked at when it is read.)
  void numbers_of_the_model(std::vector<Change>& out) const {
    const Joint& joint = joints_.front();
    if (joint.lightest < 1.0)  // else its weight would change, too
      for (const Unit& u : units_of_inertia(joint.position)) {
        Change c{
            given(),
            std::string(joint.position == Quantity::length ? "the model's mass" : "the model's inertia") +
                " is in " + std::string(u.name) + " (times " + core::shortest(u.si) + ")",
            "",
            {}};
        c.reading.inertia_scale = u.si;
        out.push_back(std::move(c));
      }
    if (joint.position == Quantity::angle)
      for (const Unit& u : units_of(Quantity::torque)) {
        if (u.rare) continue;
        Change c{given(),
                 "the model's gravity or stiffness is in " + std::string(u.name) + " (times " +
                     core::shortest(u.si) + ")",
                 "",
                 {}};
        c.reading.passive_scale = u.si;
        out.push_back(std::move(c));
      }
  }

  void exchanges(std::vector<Change>& out) const {
    const auto add = [&](const std::vector<std::pair<std::size_t, std::size_t>>& positions,
                         const std::vector<std::pair<std::size_t, std::size_t>>& inputs,
                         const std::string& what, const std::string& map) {
      Change c{given(), what, map, {}};
      for (const auto& [j, signal] : positions) c.reading.position_of[j] = signal;
      for (const auto& [j, signal] : inputs) c.reading.input_of[j] = signal;
      // A position in place of an input is another kind of thing: a whole change, as two signals are compared that have nothing in common.
      const bool alike =
          std::all_of(positions.begin(), positions.end(), [&](const auto& of) { return of.second < n_; });
      c.changes = alike ? kSignOrExchange : 1.0;
      out.push_back(c);
    };
    const auto exchanged = [&](const std::string& a, const std::string& b) {
      return std::pair(a + " and " + b + " are exchanged",
                       line_of(a, b, 1.0, 0.0) + "\n" + line_of(b, a, 1.0, 0.0));
    };
    for (std::size_t j = 0; j < n_; ++j) {
      const Joint& a = joints_[j];
      if (!a.input_column.empty()) {
        const auto [what, map] = exchanged(a.position_column, a.input_column);
        add({{j, n_ + j}}, {{j, j}}, what, map);
      }
      if (has_velocity_[j])
        add({{j, 2 * n_ + j}}, {}, a.position_column + " and the velocity are exchanged", "");
      for (std::size_t k = j + 1; k < n_; ++k) {
        const Joint& b = joints_[k];
        if (a.position != b.position) continue;
        const auto [place, place_map] = exchanged(a.position_column, b.position_column);
        add({{j, k}, {k, j}}, {}, place, place_map);
        if (a.input_column.empty() || b.input_column.empty() || a.sets_position != b.sets_position) continue;
        const auto [input, input_map] = exchanged(a.input_column, b.input_column);
        add({}, {{j, n_ + k}, {k, n_ + j}}, input, input_map);
        add({{j, k}, {k, j}}, {{j, n_ + k}, {k, n_ + j}}, place + ", and " + input,
            place_map + "\n" + input_map);
      }
    }
  }

  /// Scales of positions that are no known unit: a gear's ratio, counts of an encoder.
  void estimate_scales() {
    for (const Quantity q : {Quantity::angle, Quantity::length}) {
      const std::vector<std::size_t> all = of_quantity(q);
      if (all.empty()) continue;
      std::vector<std::vector<std::size_t>> groups{all};
      if (all.size() > 1)
        for (const std::size_t j : all) groups.push_back({j});
      for (const auto& which : groups) {
        const auto value = [&](double log_scale) {
          // With words, so that set points are read likewise.
          return scanned(scaled_positions(which, std::exp(log_scale), "scaled"));
        };
        constexpr double kStep = 0.25;
        double at = 0.0, most = -std::numeric_limits<double>::infinity();
        for (double x = std::log(1e-6); x <= std::log(1e3); x += kStep) {
          if (std::abs(x) < std::log(kNearOne)) continue;
          const double score = value(x);
          if (score > most) most = score, at = x;
        }
        at = refined(value, at, kStep);
        const double scale = std::exp(at);
        if (scale < kNearOne && scale > 1.0 / kNearOne) continue;
        const bool whole = std::all_of(which.begin(), which.end(),
                                       [&](std::size_t j) { return whole_numbers(recordings_, j); });
        std::string text =
            core::rounded(1.0 / scale, 4) + " times what is expected in " + std::string(si_unit(q));
        if (whole && q == Quantity::angle)
          text += ", every value a whole number: encoder counts, about " +
                  core::rounded(2.0 * std::numbers::pi / scale, 3) + " a turn";
        else if (whole)
          text += ", every value a whole number: encoder counts";
        else
          text += ": the motor's side of a gear?";
        Change c = scaled_positions(which, scale, text);
        c.changes = 1.0 + kEstimated;
        c.any_scale = true;
        weigh(c);
      }
    }
  }

  /// Zeros of angles: a quarter or half turn, or whatever fits.
  void estimate_zeros() {
    for (const std::size_t j : of_quantity(Quantity::angle)) {
      const Joint& joint = joints_[j];
      // The drive counts its set points from the same zero, if not its own encoder is read.
      const auto change = [&](double offset, bool set_points) {
        Change c{given(), "", line_of(joint.position_column, joint.position_column, 1.0, offset), {}};
        c.reading.offset[j] = offset;
        if (set_points) {
          c.reading.input_offset.assign(n_, 0.0);
          c.reading.input_offset[j] = offset;
          c.map += "\n" + line_of(joint.input_column, joint.input_column, 1.0, offset);
        }
        const double degrees = offset * 180.0 / std::numbers::pi;
        c.what = "the zero of " + joint.position_column + " is off by " +
                 (std::abs(std::abs(offset) - kQuarter) < 1e-9 ? std::string("a quarter turn")
                  : std::abs(offset) > 2.0 * kQuarter - 1e-9   ? std::string("half a turn")
                                                               : core::rounded(degrees, 3) + " degrees") +
                 " (the model's angle is the log's " + (offset < 0.0 ? "- " : "+ ") +
                 core::rounded(std::abs(offset), 5) + " rad)" +
                 (set_points ? ", and that of " + joint.input_column + " likewise" : "");
        if (joint.last && !joint.link.empty())
          c.same.push_back("the body of link " + joint.link + ", turned by " + core::rounded(degrees, 3) +
                           " degrees about the joint's axis");
        return c;
      };
      for (const bool set_points : {false, true}) {
        if (set_points && !joint.sets_position) continue;
        const auto value = [&](double offset) { return scanned(change(offset, set_points)); };
        for (const double quarter : {kQuarter, 2.0 * kQuarter, -kQuarter}) weigh(change(quarter, set_points));
        constexpr double kStep = std::numbers::pi / 12.0;
        double at = 0.0, most = -std::numeric_limits<double>::infinity();
        for (int k = 3; k <= 21; ++k) {
          const double score = value(k * kStep);
          if (score > most) most = score, at = k * kStep;
        }
        at = refined(value, at, kStep);
        if (at > std::numbers::pi) at -= 2.0 * std::numbers::pi;
        const double from_quarter = std::abs(at - kQuarter * std::round(at / kQuarter));
        // A quarter is the likelier reading of what is nearly one.
        if (std::abs(at) < kNearZero_rad || from_quarter < 0.1) continue;
        Change c = change(at, set_points);
        c.changes = 1.0 + kEstimated;
        weigh(c);
      }
    }
  }

  /// The best place within a step of a grid's best, by golden sections.
  static double refined(const std::function<double(double)>& value, double at, double step) {
    const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
    double low = at - step, high = at + step;
    double a = high - golden * (high - low), b = low + golden * (high - low), fa = value(a), fb = value(b);
    constexpr int kRounds = 14;
    for (int round = 0; round < kRounds; ++round) {
      if (fa > fb)
        high = b, b = a, fb = fa, a = high - golden * (high - low), fa = value(a);
      else
        low = a, a = b, fa = fb, b = low + golden * (high - low), fb = value(b);
    }
    return 0.5 * (low + high);
  }

  struct Decoded {
    std::size_t joint, signal;
    std::string what;
  };
  const Family& family_;
  const std::vector<Joint>& joints_;
  std::span<const Columns> recordings_;
  std::size_t n_;
  double interval_ = 0.0;  ///< median, in the log's unit of time
  std::vector<std::vector<const std::vector<double>*>> signals_;
  std::vector<bool> has_velocity_;
  std::vector<std::unique_ptr<std::vector<double>>> owned_;
  std::vector<Decoded> decoded_;
  std::vector<std::size_t> moving_;
  std::vector<Instant> instants_;
  bool scans_ = false;  ///< a number is being sought
  std::vector<Scored> all_;
  std::vector<std::vector<std::pair<InputScale, Rest>>>
      solved_;  ///< [joint], of the equations that are weighed
};

}  // namespace

std::optional<Finding> find_convention(const Family& family, std::span<const Columns> recordings) {
  return Trial(family, recordings).run();
}

AsNamed as_named(const Family& family, std::span<const Columns> recordings) {
  return Trial(family, recordings).as_named();
}

void require_convention(const Family& family, std::span<const Columns> recordings, Asked asked) {
  const std::optional<Finding> f = find_convention(family, recordings);
  if (!f || (asked == Asked::time_alone && !f->of_time)) return;
  const auto percent = [](double share) { return core::rounded(100.0 * share, 2) + " %"; };
  std::string message = recordings.front().path;
  if (recordings.size() > 1) message += " and " + std::to_string(recordings.size() - 1) + " more";
  message += ": it seems that " + f->what + (f->what.ends_with('?') ? "" : ".") + " So read, " +
             percent(f->off_read) + " of the joint's force (RMS) stays unexplained; as named " +
             percent(f->off_given) + ".";
  for (const std::string& same : f->same) message += " The recordings would be the same with " + same + ".";
  for (std::size_t i = 0; i < f->others.size(); ++i)
    message += (i == 0 ? " Nearly as good: " : "; ") + f->others[i] + (i + 1 == f->others.size() ? "." : "");
  message += " No cause was looked for.";
  if (!f->map.empty()) {
    std::string lines = over_map(f->map, recordings.front().sources);
    for (std::size_t i = 0; (i = lines.find('\n', i)) != lines.npos; i += 2) lines.replace(i, 1, ", ");
    message += " To read it so, write in a map file (--map) " + lines + ".";
  }
  throw core::DataError(message + " Where model and columns are right, --trust-columns skips this check");
}

}  // namespace furcula::conventions
