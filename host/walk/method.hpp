// How walks are sought: a method is asked for points and told their values, so that a whole generation runs at once.
//
// Points are shares of the parameters' ranges from their start values: the start is zero.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace furcula::walk {

enum class MethodKind : std::uint8_t { cmaes, esch, mutation };
inline constexpr std::array<std::string_view, 3> kMethodNames{"cmaes", "esch", "mutation"};

class Method {
 public:
  using Vector = Eigen::VectorXd;

  virtual ~Method() = default;
  Method() = default;
  Method(const Method&) = delete;
  Method& operator=(const Method&) = delete;

  /// The points of the next generation. Asked again before it is told, it gives the same ones.
  virtual const std::vector<Vector>& ask() = 0;
  /// Their values, the least best, infinite where there is none. `best` is the best walk's point so far, inside of the ranges.
  virtual void tell(std::span<const double> values, const Vector& best) = 0;
  virtual unsigned restarts() const = 0;

  /// All that it goes on from: JSON in one line. After ask() it is the state before it.
  virtual std::string state() const = 0;
  /// @throws std::exception where the text is no state of such a method.
  virtual void restore(const std::string& state) = 0;
};

/// Ranges are `least` to `most`; a seed gives one sequence of points for one sequence of values.
std::unique_ptr<Method> make_method(MethodKind kind, const Eigen::VectorXd& least,
                                    const Eigen::VectorXd& most, std::uint64_t seed);

}  // namespace furcula::walk
