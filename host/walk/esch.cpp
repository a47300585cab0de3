#include "host/walk/esch.hpp"

#include <bit>
#include <cmath>
#include <nlopt.hpp>
#include <stdexcept>
#include <utility>

#include "host/walk/state_json.hpp"

namespace furcula::walk {
namespace {

// NLopt's own numbers.
constexpr std::size_t kParents = 40, kOffspring = 60;

/// What NLopt is told, and what it asks.
struct Play {
  const std::vector<double>& known;
  std::size_t wanted;
  nlopt::opt& search;
  std::size_t asked = 0;
  std::uint64_t hash = 0;  ///< of what it asked whose value is known
  std::vector<Eigen::VectorXd> points;
};

std::uint64_t mixed(std::uint64_t hash, double x) {
  hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 32);
}

double answer(unsigned n, const double* x, double*, void* data) {
  Play& play = *static_cast<Play*>(data);
  const std::size_t i = play.asked++;
  if (i < play.known.size()) {
    for (unsigned k = 0; k < n; ++k) play.hash = mixed(play.hash, x[k]);
    return play.known[i];
  }
  play.points.emplace_back(Eigen::Map<const Eigen::VectorXd>(x, static_cast<Eigen::Index>(n)));
  if (play.points.size() == play.wanted) play.search.force_stop();
  return HUGE_VAL;
}

}  // namespace

Esch::Esch(Vector least, Vector most, std::uint64_t seed)
    : least_(std::move(least)), most_(std::move(most)), seed_(seed) {}

const std::vector<Method::Vector>& Esch::ask() {
  if (!points_.empty()) return points_;
  nlopt::opt search(nlopt::GN_ESCH, static_cast<unsigned>(least_.size()));
  search.set_lower_bounds(std::vector<double>(least_.begin(), least_.end()));
  search.set_upper_bounds(std::vector<double>(most_.begin(), most_.end()));
  search.set_population(kParents);
  Play play{values_, values_.empty() ? kParents : kOffspring, search, 0, 0, {}};
  search.set_min_objective(answer, &play);
  nlopt::srand(static_cast<unsigned long>((seed_ ^ (seed_ >> 32)) & 0xffffffffu));
  std::vector<double> x(static_cast<std::size_t>(least_.size()), 0.0);
  double value = 0.0;
  try {
    search.optimize(x, value);
  } catch (const nlopt::forced_stop&) {
    // By `answer`.
  }
  if (play.hash != hash_ || play.points.size() != play.wanted)
    throw std::runtime_error("NLopt's ESCH does not ask again what it asked before: another version of it?");
  points_ = std::move(play.points);
  return points_;
}

void Esch::tell(std::span<const double> values, const Vector& /*best*/) {
  for (const Vector& point : points_)
    for (const double x : point) hash_ = mixed(hash_, x);
  values_.insert(values_.end(), values.begin(), values.end());
  points_.clear();
}

std::string Esch::state() const {
  nlohmann::json values = nlohmann::json::array();
  for (const double v : values_) values.push_back(state_json(v));
  return nlohmann::json{{"hash", hash_}, {"values", values}}.dump();
}

void Esch::restore(const std::string& state) {
  const nlohmann::json j = nlohmann::json::parse(state);
  values_.clear();
  points_.clear();
  hash_ = j.at("hash");
  for (const nlohmann::json& v : j.at("values")) values_.push_back(state_double(v));
  if (!values_.empty() && (values_.size() < kParents || (values_.size() - kParents) % kOffspring != 0))
    throw std::invalid_argument("not whole generations of ESCH");
}

}  // namespace furcula::walk
