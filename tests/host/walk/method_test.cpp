// The methods of a search on functions whose minimum is known, and each against what it says of itself.
#include "host/walk/method.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <nlopt.hpp>
#include <string>

#include "host/walk/esch.hpp"
#include "host/walk/mutation_nelder_mead.hpp"

using namespace furcula::walk;
using Vector = Eigen::VectorXd;

namespace {

constexpr Eigen::Index kSize = 20;

Vector all(double value) { return Vector::Constant(kSize, value); }

/// Least, 0, at 0.2; some directions count a hundred times.
double bowl(const Vector& x) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) sum += (i % 3 == 0 ? 100.0 : 1.0) * std::pow(x(i) - 0.2, 2);
  return sum;
}

double best_after(Method& method, std::size_t evaluations, const std::function<double(const Vector&)>& f) {
  double best = HUGE_VAL;
  Vector at = all(0.0);
  for (std::size_t n = 0; n < evaluations;) {
    std::vector<double> values;
    for (const Vector& x : method.ask()) {
      values.push_back(f(x));
      if (values.back() < best) best = values.back(), at = x;
    }
    n += values.size();
    method.tell(values, at);
  }
  return best;
}

}  // namespace

TEST_CASE("each method descends a bowl, within the ranges where it knows them") {
  // Of random points in the ranges the best of 10,000 is far above 100.
  const auto descended = [](MethodKind kind, std::uint64_t seed) {
    const Vector least = all(-0.5), most = all(0.7);
    return best_after(*make_method(kind, least, most, seed), 10000, [&](const Vector& x) {
      if (kind != MethodKind::cmaes) {
        CHECK((x - least).minCoeff() >= 0.0);
        CHECK((most - x).minCoeff() >= 0.0);
      }
      return bowl(x);
    });
  };
  for (const std::uint64_t seed : {1u, 2u}) {
    CHECK(descended(MethodKind::cmaes, seed) < 1e-4);
    CHECK(descended(MethodKind::esch, seed) < 1.0);
    CHECK(descended(MethodKind::mutation, seed) < 0.1);
  }
}

TEST_CASE("a generation of ESCH at once is what NLopt asks one after the other") {
  std::vector<Vector> one_by_one;
  nlopt::opt search(nlopt::GN_ESCH, kSize);
  search.set_lower_bounds(std::vector<double>(kSize, -0.5));
  search.set_upper_bounds(std::vector<double>(kSize, 0.7));
  search.set_maxeval(40 + 5 * 60);
  std::function<double(const std::vector<double>&)> f = [&](const std::vector<double>& x) {
    one_by_one.emplace_back(Eigen::Map<const Vector>(x.data(), kSize));
    return bowl(one_by_one.back());
  };
  search.set_min_objective([](const std::vector<double>& x, std::vector<double>&,
                              void* data) { return (*static_cast<decltype(f)*>(data))(x); },
                           &f);
  nlopt::srand(7);
  std::vector<double> x(kSize, 0.0);
  double value = 0.0;
  search.optimize(x, value);
  REQUIRE(one_by_one.size() == 340);

  Esch esch(all(-0.5), all(0.7), 7);
  std::size_t n = 0;
  while (n < one_by_one.size()) {
    const auto points = esch.ask();
    CHECK(points.size() == (n == 0 ? 40 : 60));
    std::vector<double> values;
    for (const Vector& p : points) {
      CHECK(p == one_by_one[n++]);
      values.push_back(bowl(p));
    }
    esch.tell(values, all(0.0));
  }
}

TEST_CASE("values that ESCH was not told do not bring its points again, which is said") {
  Esch one(all(-0.5), all(0.7), 7), other(all(-0.5), all(0.7), 8);
  best_after(one, 200, bowl);
  other.restore(one.state());
  CHECK_THROWS_WITH(other.ask(), Catch::Contains("another version"));
}

TEST_CASE("mutation gives way to a simplex, which follows a valley that no coordinate has") {
  // A valley along the diagonal, a hundred times as steep across.
  const auto valley = [](const Vector& x) {
    const double along = x.sum() / std::sqrt(static_cast<double>(x.size()));
    const double across = x.squaredNorm() - along * along;
    return 100.0 * across + std::pow(along - 2.0, 2);
  };
  MutationNelderMead method(all(-0.5), all(0.7), 1);
  CHECK(best_after(method, 60000, valley) < 1e-3);
  CHECK(method.restarts() > 0);
}
