#include "host/walk/mutation_nelder_mead.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "host/core/random.hpp"
#include "host/walk/state_json.hpp"

namespace furcula::walk {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr std::size_t kMutants = 32;
constexpr double kFirstScale = 0.2, kNextScale = 0.1, kMostScale = 0.3;  // of a parameter's range
constexpr double kChanged = 0.2;                                         // of the coordinates
constexpr double kAnywhere = 0.05;  // of those changed: drawn from their whole range
constexpr double kEdge = 0.05;      // of the simplex, as it is laid
constexpr double kFlat = 1e-3;      // such a simplex has converged
/// No better by so much in so many generations, or moves of the simplex.
constexpr double kBetter = 1e-3;
constexpr unsigned kMutationPatience = 25, kSimplexPatience = 30;

}  // namespace

MutationNelderMead::MutationNelderMead(Vector least, Vector most, std::uint64_t seed)
    : least_(std::move(least)),
      most_(std::move(most)),
      seed_(seed),
      best_{Vector::Zero(least_.size()), kNone},
      scale_(kFirstScale),
      last_better_(kNone) {
  mutate();
}

bool MutationNelderMead::gains() {
  if (!(best_.value < last_better_ - kBetter)) return false;
  last_better_ = best_.value;
  waited_ = 0;
  return true;
}

void MutationNelderMead::mutate() {
  phase_ = Phase::mutation;
  core::Random random(seed_, drawn_++);
  points_.assign(kMutants, best_.x);
  for (Vector& x : points_) {
    const auto certain = static_cast<Eigen::Index>(random.next() % static_cast<std::uint64_t>(x.size()));
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const bool changes = random.uniform(0.0, 1.0) < kChanged || i == certain;
      const bool anywhere = random.uniform(0.0, 1.0) < kAnywhere;
      const double step = scale_ * random.gaussian(), place = random.uniform(least_(i), most_(i));
      if (changes) x(i) = anywhere ? place : std::clamp(x(i) + step, least_(i), most_(i));
    }
  }
}

void MutationNelderMead::told_of_mutation(std::span<const double> values) {
  const auto least = std::min_element(values.begin(), values.end());
  const bool better = *least < best_.value;
  if (better) best_ = {points_[static_cast<std::size_t>(least - values.begin())], *least};
  scale_ = better ? std::min(1.2 * scale_, kMostScale) : 0.95 * scale_;
  if (!gains() && ++waited_ >= kMutationPatience)
    lay();
  else
    mutate();
}

void MutationNelderMead::lay() {
  phase_ = Phase::lay;
  waited_ = 0;
  core::Random random(seed_, drawn_++);
  points_.assign(static_cast<std::size_t>(best_.x.size()), best_.x);
  for (Eigen::Index i = 0; i < best_.x.size(); ++i) {
    // Inside of the range, on either side.
    const double edge = random.coin() ? kEdge : -kEdge, moved = best_.x(i) + edge;
    points_[static_cast<std::size_t>(i)](i) =
        moved < least_(i) || moved > most_(i) ? best_.x(i) - edge : moved;
  }
}

MutationNelderMead::Vector MutationNelderMead::centre() const {
  Vector sum = Vector::Zero(best_.x.size());
  const std::size_t count = simplex_.size() - moving();
  for (std::size_t i = 0; i < count; ++i) sum += simplex_[i].x;
  return sum / static_cast<double>(count);
}

void MutationNelderMead::reflect() {
  phase_ = Phase::reflection;
  const Vector middle = centre();
  points_.clear();
  for (std::size_t i = simplex_.size() - moving(); i < simplex_.size(); ++i)
    points_.push_back((2.0 * middle - simplex_[i].x).cwiseMax(least_).cwiseMin(most_));
}

MutationNelderMead::Next MutationNelderMead::next_of(std::size_t corner) const {
  const double value = reflected_[corner - first_moving()].value;
  if (value < simplex_.front().value) return Next::expansion;
  return value < simplex_[corner - 1].value ? Next::nothing : Next::contraction;
}

void MutationNelderMead::told_of_reflection(std::span<const double> values) {
  reflected_.clear();
  for (std::size_t k = 0; k < points_.size(); ++k) reflected_.push_back({points_[k], values[k]});
  const Vector middle = centre();
  points_.clear();
  for (std::size_t i = first_moving(); i < simplex_.size(); ++i) {
    const Corner& r = reflected_[i - first_moving()];
    const Vector& better = r.value < simplex_[i].value ? r.x : simplex_[i].x;
    switch (next_of(i)) {
      case Next::expansion:
        points_.push_back((2.0 * r.x - middle).cwiseMax(least_).cwiseMin(most_));
        break;
      case Next::contraction:
        points_.push_back(0.5 * (middle + better));
        break;
      case Next::nothing:
        break;
    }
  }
  phase_ = Phase::second;
  if (points_.empty()) told_of_second({});
}

void MutationNelderMead::told_of_second(std::span<const double> values) {
  // All against the simplex as it was.
  std::vector<Corner> after = simplex_;
  bool some = false;
  std::size_t k = 0;
  for (std::size_t i = first_moving(); i < simplex_.size(); ++i) {
    const Corner& r = reflected_[i - first_moving()];
    const Next next = next_of(i);
    if (r.value < after[i].value) after[i] = r;
    some = some || next != Next::contraction;
    if (next == Next::nothing) continue;
    if (values[k] < after[i].value) {
      after[i] = {points_[k], values[k]};
      some = true;
    }
    ++k;
  }
  simplex_ = std::move(after);
  if (some)
    moved();
  else
    shrink();
}

void MutationNelderMead::shrink() {
  phase_ = Phase::shrinking;
  points_.clear();
  for (std::size_t i = 1; i < simplex_.size(); ++i)
    points_.push_back(0.5 * (simplex_.front().x + simplex_[i].x));
}

void MutationNelderMead::moved() {
  std::stable_sort(simplex_.begin(), simplex_.end(),
                   [](const Corner& a, const Corner& b) { return a.value < b.value; });
  if (simplex_.front().value < best_.value) best_ = simplex_.front();
  double wide = 0.0;
  for (const Corner& c : simplex_) wide = std::max(wide, (c.x - simplex_.front().x).cwiseAbs().maxCoeff());
  if ((gains() || ++waited_ < kSimplexPatience) && wide > kFlat) return reflect();
  ++restarts_;
  waited_ = 0;
  scale_ = kNextScale;
  mutate();
}

void MutationNelderMead::tell(std::span<const double> values, const Vector& /*best*/) {
  switch (phase_) {
    case Phase::mutation:
      return told_of_mutation(values);
    case Phase::lay:
      simplex_ = {best_};
      for (std::size_t k = 0; k < points_.size(); ++k) simplex_.push_back({points_[k], values[k]});
      return moved();
    case Phase::reflection:
      return told_of_reflection(values);
    case Phase::second:
      return told_of_second(values);
    case Phase::shrinking:
      for (std::size_t k = 0; k < points_.size(); ++k) simplex_[k + 1] = {points_[k], values[k]};
      return moved();
  }
}

std::string MutationNelderMead::state() const {
  const auto corners = [](const std::vector<Corner>& all) {
    nlohmann::json out = nlohmann::json::array();
    for (const Corner& c : all) out.push_back({state_json(c.x), state_json(c.value)});
    return out;
  };
  nlohmann::json points = nlohmann::json::array();
  for (const Vector& x : points_) points.push_back(state_json(x));
  return nlohmann::json{{"drawn", drawn_},
                        {"phase", static_cast<int>(phase_)},
                        {"points", points},
                        {"best", corners({best_})},
                        {"scale", scale_},
                        {"last_better", state_json(last_better_)},
                        {"waited", waited_},
                        {"restarts", restarts_},
                        {"simplex", corners(simplex_)},
                        {"reflected", corners(reflected_)}}
      .dump();
}

void MutationNelderMead::restore(const std::string& state) {
  const nlohmann::json j = nlohmann::json::parse(state);
  const auto corners = [&](const nlohmann::json& all) {
    std::vector<Corner> out;
    for (const nlohmann::json& c : all)
      out.push_back({state_matrix(c.at(0), least_.size(), 1), state_double(c.at(1))});
    return out;
  };
  drawn_ = j.at("drawn");
  phase_ = static_cast<Phase>(j.at("phase").get<int>());
  points_.clear();
  for (const nlohmann::json& x : j.at("points")) points_.push_back(state_matrix(x, least_.size(), 1));
  best_ = corners(j.at("best")).at(0);
  scale_ = j.at("scale");
  last_better_ = state_double(j.at("last_better"));
  waited_ = j.at("waited");
  restarts_ = j.at("restarts");
  simplex_ = corners(j.at("simplex"));
  reflected_ = corners(j.at("reflected"));
}

}  // namespace furcula::walk
