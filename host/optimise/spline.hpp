// Angles over a phase of a gait: B-splines over equal intervals, and points of Gauss to integrate over them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace furcula::optimise {

/// Of degree 5 with four continuous derivatives, clamped at both ends: the first coefficient is the first value,
/// and the last the last. The argument runs from 0 to 1.
class Spline {
 public:
  static constexpr std::size_t kDegree = 5, kOrder = kDegree + 1;

  explicit Spline(std::size_t intervals) : intervals_(intervals) {}
  std::size_t intervals() const { return intervals_; }
  std::size_t coefficients() const { return intervals_ + kDegree; }
  std::size_t interval_at(double s) const;

  /// The coefficients' shares in the value and all its derivatives; those of `first` to first + kDegree
  /// alone are not zero. `interval` chooses the side at a knot.
  struct Basis {
    std::size_t first = 0;
    std::array<std::array<double, kOrder>, kOrder> share{};
  };
  Basis basis(double s, std::size_t interval) const;
  Basis basis(double s) const { return basis(s, interval_at(s)); }

  /// Coefficients of the spline that is nearest to these values at equal distances, ends included.
  std::vector<double> fitted(const std::vector<double>& values) const;

 private:
  double knot(std::ptrdiff_t i) const;
  std::size_t intervals_;
};

/// On [0, 1]; exact to degree 7.
struct GaussPoint {
  double at, weight;
};
inline constexpr std::array<GaussPoint, 4> kGauss{{{0.06943184420297371, 0.17392742256872692},
                                                   {0.33000947820757187, 0.32607257743127307},
                                                   {0.66999052179242813, 0.32607257743127307},
                                                   {0.93056815579702629, 0.17392742256872692}}};

}  // namespace furcula::optimise
