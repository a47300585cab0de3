#include "host/core/quantile.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace furcula::core {
namespace {

// In double: its fifteen digits are ten more than any threshold needs.
using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

}  // namespace

double chi_square_above(double level, double freedom) {
  return quantile(complement(boost::math::chi_squared_distribution<double, Policy>(freedom), level));
}

double chi_square_beyond(double value, double freedom) {
  return cdf(complement(boost::math::chi_squared_distribution<double, Policy>(freedom), value));
}

double student_t_within(double share, double freedom) {
  return quantile(
      complement(boost::math::students_t_distribution<double, Policy>(freedom), 0.5 * (1.0 - share)));
}

}  // namespace furcula::core
