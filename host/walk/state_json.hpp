// Numbers of a search's state as JSON: exact, and infinite ones too, which JSON has not.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

namespace furcula::walk {

inline nlohmann::json state_json(double v) {
  return v == std::numeric_limits<double>::infinity() ? nlohmann::json("inf") : nlohmann::json(v);
}
inline double state_double(const nlohmann::json& j) {
  return j.is_string() && j.get<std::string>() == "inf" ? std::numeric_limits<double>::infinity()
                                                        : j.get<double>();
}

/// By columns, with their count, so that a matrix of another size is refused.
inline nlohmann::json state_json(const Eigen::MatrixXd& m) {
  nlohmann::json values = nlohmann::json::array();
  for (const double v : m.reshaped()) values.push_back(v);
  return {m.rows(), m.cols(), values};
}
inline Eigen::MatrixXd state_matrix(const nlohmann::json& j, Eigen::Index rows, Eigen::Index columns) {
  const auto values = j.at(2).get<std::vector<double>>();
  if (j.at(0) != rows || j.at(1) != columns || values.size() != static_cast<std::size_t>(rows * columns))
    throw std::invalid_argument("a matrix of another size");
  return Eigen::Map<const Eigen::MatrixXd>(values.data(), rows, columns);
}

}  // namespace furcula::walk
