#include "host/walk/cma_es_restarts.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "host/walk/state_json.hpp"

namespace furcula::walk {
namespace {

constexpr std::size_t kFirstPopulation = 32;
/// How wide a round looks at first, of a parameter's range. With four times as much nearly all walks fall, and steps on the spot win.
constexpr double kSpread = 0.05;
/// Converged: no better by so much in so many generations.
constexpr double kBetter = 1e-3;
constexpr std::uint64_t kPatience = 60;
constexpr double kNone = std::numeric_limits<double>::infinity();

bool is_finite(const CmaEs::State& s) {
  return s.mean.allFinite() && s.covariance.allFinite() && s.sigma < 1e6;
}

}  // namespace

CmaEsRestarts::CmaEsRestarts(Eigen::Index size, std::uint64_t seed)
    : seed_(seed),
      strategy_(Vector::Zero(size), kSpread, kFirstPopulation, seed),
      round_best_(kNone),
      last_better_(kNone) {}

void CmaEsRestarts::tell(std::span<const double> values, const Vector& best) {
  for (const double v : values) round_best_ = std::min(round_best_, v);
  strategy_.tell(values);
  if (round_best_ < last_better_ - kBetter) {
    last_better_ = round_best_;
    waited_ = 0;
  } else if (++waited_ >= kPatience) {
    restart(best);
  }
  // Values that are all infinite lead nowhere: the spread may grow without end.
  if (!is_finite(strategy_.state())) restart(best);
}

void CmaEsRestarts::restart(const Vector& best) {
  ++restarts_;
  const std::size_t population = strategy_.state().population;
  const bool anew = restarts_ % 2 == 0;
  strategy_ = CmaEs(anew ? Vector(Vector::Zero(best.size())) : best, kSpread, population + population / 4,
                    seed_ + 0x9e3779b97f4a7c15u * restarts_);
  round_best_ = last_better_ = kNone;
  waited_ = 0;
}

std::string CmaEsRestarts::state() const {
  const CmaEs::State& s = strategy_.state();
  return nlohmann::json{{"population", s.population},
                        {"seed", s.seed},
                        {"generation", s.generation},
                        {"decomposed", s.decomposed},
                        {"sigma", s.sigma},
                        {"mean", state_json(s.mean)},
                        {"path", state_json(s.path)},
                        {"path_sigma", state_json(s.path_sigma)},
                        {"axes", state_json(s.axes)},
                        {"covariance", state_json(s.covariance)},
                        {"directions", state_json(s.directions)},
                        {"waited", waited_},
                        {"round_best", state_json(round_best_)},
                        {"last_better", state_json(last_better_)},
                        {"restarts", restarts_}}
      .dump();
}

void CmaEsRestarts::restore(const std::string& state) {
  const nlohmann::json j = nlohmann::json::parse(state);
  const Eigen::Index n = strategy_.state().mean.size();
  CmaEs::State s;
  s.population = j.at("population");
  s.seed = j.at("seed");
  s.generation = j.at("generation");
  s.decomposed = j.at("decomposed");
  s.sigma = j.at("sigma");
  s.mean = state_matrix(j.at("mean"), n, 1);
  s.path = state_matrix(j.at("path"), n, 1);
  s.path_sigma = state_matrix(j.at("path_sigma"), n, 1);
  s.axes = state_matrix(j.at("axes"), n, 1);
  s.covariance = state_matrix(j.at("covariance"), n, n);
  s.directions = state_matrix(j.at("directions"), n, n);
  waited_ = j.at("waited");
  round_best_ = state_double(j.at("round_best"));
  last_better_ = state_double(j.at("last_better"));
  restarts_ = j.at("restarts");
  strategy_ = CmaEs(std::move(s));
}

}  // namespace furcula::walk
