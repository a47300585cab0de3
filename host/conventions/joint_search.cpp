// See joint_search.hpp.
#include "host/conventions/joint_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "host/conventions/equations.hpp"
#include "host/conventions/instants.hpp"
#include "host/core/message.hpp"

namespace furcula::conventions {
namespace {

constexpr std::size_t kMostInstants = 500, kInstantsOfScan = 120;
/// All patterns of signs of so many positions are tried.
constexpr std::size_t kAllSigns = 8;
constexpr std::size_t kStarts = 12, kSweeps = 4, kPatternsWithUnits = 3;
/// A pattern of signs this little behind the best is as good: no cause of the catalogue gains more by a wrong sign
/// (docs/decisions/0035-conventions-before-causes.md).
constexpr double kSame = 0.14;
/// So a sign counts for as much of a change. (A reading of one column alone has to be further ahead: it would reject a log.)
const double kSign = kSame / kFarBetter;
/// An estimated scale this near to one is one.
constexpr double kNearOne = 1.8;

/// A reading of all joints, and how well it fits.
struct Weighed {
  std::vector<double> position;
  std::vector<InputScale> input;
  std::vector<double> off;
  double fit = -std::numeric_limits<double>::infinity(), score = fit;
};

class Search {
 public:
  Search(const Family& family, std::span<const Columns> recordings)
      : family_(family), joints_(family.joints()), n_(joints_.size()) {
    std::vector<std::vector<const std::vector<double>*>> signals(2 * n_);
    for (const Columns& c : recordings)
      for (std::size_t j = 0; j < n_; ++j) {
        signals[j].push_back(&c.position[j]);
        signals[n_ + j].push_back(&c.input[j]);
      }
    for (std::size_t j = 0; j < n_; ++j) {
      span_.push_back(0.0);
      for (const auto* column : signals[j]) {
        const auto [low, high] = std::minmax_element(column->begin(), column->end());
        if (low != high) span_.back() = std::max(span_.back(), *high - *low);
      }
      if (span_.back() > 0.0) moving_.push_back(j);
    }
    if (!moving_.empty()) instants_ = instants_of(recordings, signals, moving_, kMostInstants);
  }

  std::optional<JointReadings> run() {
    if (n_ < 2 || instants_.size() < kFewestInstants) return std::nullopt;
    const Weighed named = weigh(std::vector<double>(n_, 1.0), 1, true);
    const bool fits = most(named.off) < kAsked && named.fit > kFarBetter;
    Weighed best = named;
    bool sure = true;
    if (!fits) {
      const Weighed found = weigh(best_of_all().position, 1);
      if (!(found.score > named.score)) return std::nullopt;
      sure = found.score > any_cause(named);
      if (most(found.off) >= kAsked) {
        if (!sure || !(found.fit > kFarBetter)) return std::nullopt;
        for (std::size_t j = 0; j < n_; ++j)
          if (found.off[j] * found.off[j] >= kUnexplained && found.off[j] > named.off[j]) return std::nullopt;
      }
      best = found;
    }
    JointReadings out{{}, {}, best.off, same_as(best), sure};
    for (std::size_t j = 0; j < n_; ++j) {
      out.position.push_back(reading(best.position[j], joints_[j].position));
      out.input.push_back(reading(best.input[j].scale, joints_[j].input));
    }
    return out;
  }

 private:
  static ColumnReading reading(double scale, Quantity quantity) {
    const double size = std::abs(scale);
    const auto is = [&](double si) { return std::abs(size / si - 1.0) < 1e-9; };
    ColumnReading out{scale, !is(1.0), ""};
    for (const Unit& u : units_of(quantity)) {
      if (!is(u.si) && !is(1.0 / u.si)) continue;
      out.estimated = false;
      out.what = (is(u.si) ? "in " : "not in ") + std::string(u.name);
    }
    if (out.estimated)
      out.what = "times " + core::rounded(size, 4) + ": a gear's ratio, a current or another unit?";
    if (scale < 0.0) out.what += out.what.empty() ? "of the other sign" : ", of the other sign";
    return out;
  }
  static double most(const std::vector<double>& off) { return *std::max_element(off.begin(), off.end()); }
  std::size_t step_of_scan() const { return std::max<std::size_t>(1, instants_.size() / kInstantsOfScan); }

  /// With positions so read, and each input as it fits best, or `as_logged`. Given the positions each joint's equation has its own input.
  Weighed weigh(const std::vector<double>& position, std::size_t step, bool as_logged = false) {
    Reading r{std::vector<std::size_t>(n_), std::vector<std::size_t>(n_), position,
              std::vector<double>(n_, 0.0)};
    for (std::size_t j = 0; j < n_; ++j) r.position_of[j] = j, r.input_of[j] = n_ + j;
    Weighed out{position, std::vector<InputScale>(n_), std::vector<double>(n_, 0.0)};
    Equations e;
    if (!e.write(family_, instants_, step, r)) return out;
    std::vector<Rest> rests;
    for (std::size_t j = 0; j < n_; ++j) {
      Rest rest = e.of[j].solve(out.input[j]);
      double score = -0.5 * std::log(std::max(rest.mean_square, 1e-300));
      if (!as_logged && !joints_[j].input_column.empty())
        for (const auto& [scale, changes] : scales_of_input(e.of[j], j, position[j])) {
          const Rest other = e.of[j].solve(scale);
          const double with = -0.5 * std::log(std::max(other.mean_square, 1e-300)) - kFarBetter * changes;
          if (with > score) score = with, rest = other, out.input[j] = {other.input_scale, scale.estimated};
        }
      out.off[j] = rest.off();
      rests.push_back(rest);
    }
    out.fit = e.fit(rests, instants_.size());
    out.score = out.fit - kFarBetter * changes_of(out);
    return out;
  }

  /// Other scales of a joint's input, and what a change to each costs.
  std::vector<std::pair<InputScale, double>> scales_of_input(const Equation& e, std::size_t j,
                                                             double position) const {
    std::vector<std::pair<InputScale, double>> out{{{-1.0, false}, kSign}};
    if (joints_[j].sets_position) {
      if (position != 1.0) out.push_back({{position, false}, 0.0});
      return out;
    }
    const double likely = std::abs(e.solve({1.0, true}).input_scale);
    if (likely < kNearOne && likely > 1.0 / kNearOne) return out;
    for (const Unit& u : units_of(joints_[j].input))
      if (!u.rare && std::abs(std::log(likely / u.si)) < std::log(kNearOne))
        for (const double sign : {1.0, -1.0})
          out.push_back({{sign * u.si, false}, 1.0 + (sign < 0.0 ? kSign : 0.0)});
    out.push_back({{1.0, true}, 1.0 + kEstimated});
    return out;
  }

  /// What all joints have in common counts once.
  double changes_of(const Weighed& w) const {
    const auto of_group = [](const std::vector<double>& scales, double unit) {
      if (scales.empty()) return 0.0;
      std::size_t signs = 0, units = 0, alike = 0;
      for (const double s : scales) {
        signs += s < 0.0 ? 1 : 0;
        units += std::abs(s) != 1.0 ? 1 : 0;
        alike += std::abs(std::log(std::abs(s / scales[0]))) < std::log(1.3) ? 1 : 0;
      }
      if (signs == scales.size()) signs = 1;
      if (alike == scales.size() && units > 0) units = 1;
      return kSign * static_cast<double>(signs) + unit * static_cast<double>(units);
    };
    std::vector<double> positions, inputs;
    double unit = 1.0;
    for (const std::size_t j : moving_) positions.push_back(w.position[j]);
    for (std::size_t j = 0; j < n_; ++j) {
      // Set points that follow the position's reading are no change of their own.
      if (joints_[j].input_column.empty() || (joints_[j].sets_position && w.input[j].scale == w.position[j]))
        continue;
      inputs.push_back(w.input[j].scale);
      if (w.input[j].estimated) unit = 1.0 + kEstimated;
    }
    return of_group(positions, 1.0) + of_group(inputs, unit);
  }

  /// The columns as named with the benefit of any cause, so that what is left speaks against the names.
  double any_cause(const Weighed& named) const {
    Reading r{std::vector<std::size_t>(n_), std::vector<std::size_t>(n_), named.position,
              std::vector<double>(n_, 0.0)};
    for (std::size_t j = 0; j < n_; ++j) r.position_of[j] = j, r.input_of[j] = n_ + j;
    Equations e;
    if (!e.write(family_, instants_, 1, r)) return -std::numeric_limits<double>::infinity();
    std::vector<Rest> rests;
    for (const Equation& of : e.of) rests.push_back(of.solve({}, true));
    return e.fit(rests, instants_.size());
  }

  const Weighed& scanned(const std::vector<double>& position) {
    const auto found = known_.find(position);
    if (found != known_.end()) return found->second;
    return known_.emplace(position, weigh(position, step_of_scan())).first->second;
  }

  /// Patterns of signs of positions in these units, the best first.
  std::vector<const Weighed*> with_signs(const std::vector<double>& units) {
    std::vector<const Weighed*> out;
    const auto pattern = [&](std::size_t bits) {
      std::vector<double> position = units;
      for (std::size_t k = 0; k < moving_.size(); ++k)
        if ((bits >> k & 1U) != 0) position[moving_[k]] *= -1.0;
      return position;
    };
    if (moving_.size() <= kAllSigns) {
      for (std::size_t bits = 0; bits < std::size_t{1} << moving_.size(); ++bits)
        out.push_back(&scanned(pattern(bits)));
    } else {
      std::mt19937_64 random(1);
      for (std::size_t start = 0; start < kStarts; ++start)
        out.push_back(&descended(pattern(start == 0 ? 0 : random()), {}));
    }
    std::stable_sort(out.begin(), out.end(),
                     [](const Weighed* a, const Weighed* b) { return a->score > b->score; });
    return out;
  }

  /// One joint after the other gets the sign, and of these units the one, that fits best.
  const Weighed& descended(const std::vector<double>& from, const std::vector<double>& units) {
    const Weighed* best = &scanned(from);
    for (std::size_t sweep = 0; sweep < kSweeps; ++sweep) {
      const Weighed* before = best;
      for (const std::size_t j : moving_) {
        std::vector<double> position = best->position;
        std::vector<double> options{-position[j]};
        for (const double u : units)
          if (joints_[j].position == Quantity::angle) options.insert(options.end(), {u, -u});
        for (const double option : options) {
          position[j] = option;
          if (const Weighed& w = scanned(position); w.score > best->score) best = &w;
        }
      }
      if (best == before) break;
    }
    return *best;
  }

  /// Signs and known units alone explain it.
  bool explained(const Weighed& w) const {
    return most(w.off) < kAsked &&
           std::none_of(w.input.begin(), w.input.end(), [](const InputScale& s) { return s.estimated; });
  }

  const Weighed& best_of_all() {
    constexpr double kDegree = std::numbers::pi / 180.0, kTurn = 2.0 * std::numbers::pi;
    // Angles in degrees span more than angles in rad: all joints, and those of the largest spans, are taken for degrees.
    std::vector<std::size_t> by_span;
    for (const std::size_t j : moving_)
      if (joints_[j].position == Quantity::angle) by_span.push_back(j);
    std::stable_sort(by_span.begin(), by_span.end(),
                     [&](std::size_t a, std::size_t b) { return span_[a] > span_[b]; });
    std::vector<std::vector<double>> starts{std::vector<double>(n_, 1.0)};
    const auto start = [&](std::size_t count, double unit) {
      starts.emplace_back(n_, 1.0);
      for (std::size_t i = 0; i < count; ++i) starts.back()[by_span[i]] = unit;
    };
    start(by_span.size(), kDegree);
    start(by_span.size(), kTurn);
    for (std::size_t k = 1; k < by_span.size(); ++k) start(k, kDegree);
    std::vector<const Weighed*> first;
    for (const std::vector<double>& units : starts) {
      const std::vector<const Weighed*> patterns = with_signs(units);
      if (explained(*patterns.front())) return *patterns.front();
      first.insert(first.end(), patterns.begin(), patterns.end());
    }
    std::stable_sort(first.begin(), first.end(),
                     [](const Weighed* a, const Weighed* b) { return a->score > b->score; });
    const Weighed* best = first.front();
    // Each joint's own unit; 1 / kDegree: what was taken for degrees is in rad.
    first.resize(std::min(first.size(), kPatternsWithUnits));
    for (const Weighed* from : first)
      best = better(*best, descended(from->position, {1.0, kDegree, kTurn, 1.0 / kDegree}));
    best = better(*best, *with_signs(units_of_all(*best)).front());
    return *best;
  }

  static const Weighed* better(const Weighed& a, const Weighed& b) { return b.score > a.score ? &b : &a; }
  static std::vector<double> units_of_all(const Weighed& w) {
    std::vector<double> units = w.position;
    for (double& u : units) u = std::abs(u);
    return units;
  }

  /// Columns that may change their signs together.
  std::vector<std::vector<std::string>> same_as(const Weighed& best) {
    std::vector<std::vector<std::string>> out;
    const double here = scanned(best.position).fit;
    for (const Weighed* w : with_signs(units_of_all(best))) {
      if (w->fit < here - kSame) continue;
      std::vector<std::string> columns;
      for (const std::size_t j : moving_)
        if (w->position[j] * best.position[j] < 0.0) columns.push_back(joints_[j].position_column);
      if (columns.empty()) continue;
      for (std::size_t j = 0; j < n_; ++j)
        if (!joints_[j].input_column.empty() && w->input[j].scale * best.input[j].scale < 0.0)
          columns.push_back(joints_[j].input_column);
      out.push_back(std::move(columns));
    }
    std::stable_sort(out.begin(), out.end(),
                     [](const auto& a, const auto& b) { return a.size() < b.size(); });
    // Without those that are two of them, one after the other.
    std::vector<std::vector<std::string>> kept;
    for (std::vector<std::string>& columns : out) {
      std::sort(columns.begin(), columns.end());
      bool composed = false;
      for (const auto& a : kept)
        for (const auto& b : kept) {
          std::vector<std::string> both;
          std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
          composed = composed || both == columns;
        }
      if (!composed) kept.push_back(std::move(columns));
    }
    return kept;
  }

  const Family& family_;
  const std::vector<Joint>& joints_;
  std::size_t n_;
  std::vector<double> span_;  ///< of each position
  std::vector<std::size_t> moving_;
  std::vector<Instant> instants_;
  std::map<std::vector<double>, Weighed> known_;  ///< of scans
};

}  // namespace

std::optional<JointReadings> find_joint_readings(const Family& family, std::span<const Columns> recordings) {
  return Search(family, recordings).run();
}

}  // namespace furcula::conventions
