// What a fit says of the free parameters, see reported.hpp.
#include "host/trees/reported.hpp"

#include <algorithm>
#include <cmath>

namespace furcula::trees {
namespace {

/// Two rows that are correlated by more than this are known in combination.
constexpr double kCorrelated = 0.95;
/// Recordings say little of a row whose variance they leave at this share of what it was beforehand, or more.
constexpr double kLittle = 0.5;
/// A row of whose variance more than this share comes from what is known beforehand rests on that, and on other rows.
constexpr double kRests = 0.1;
/// It is then known in combination with a row that it is correlated with by at least this.
constexpr double kTogether = 0.5;

using Values = std::array<double, 10>;

Values values_at(const TreeModel& model, std::size_t link, const BodyCoordinates& at) {
  return inertial_values(body_at(*model.urdf.links[link].inertia, at));
}

/// Of a URDF's ten numbers by the ten coordinates, from differences of the closed form.
Eigen::Matrix<double, 10, 10> jacobian(const TreeModel& model, std::size_t link, const BodyCoordinates& at) {
  constexpr double kStep = 1e-5;
  Eigen::Matrix<double, 10, 10> out;
  for (std::size_t k = 0; k < at.size(); ++k) {
    BodyCoordinates more = at, less = at;
    more[k] += kStep;
    less[k] -= kStep;
    const Values a = values_at(model, link, more), b = values_at(model, link, less);
    for (std::size_t i = 0; i < a.size(); ++i)
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = (a[i] - b[i]) / (2.0 * kStep);
  }
  return out;
}

bool stands_still(const TreeModel& model, std::size_t link, const std::vector<bool>& still) {
  for (int j = model.robot.links[link].joint; j >= 0;
       j = model.robot.model.shape().parent(static_cast<std::size_t>(j)))
    if (!still[static_cast<std::size_t>(j)]) return false;
  return true;
}

}  // namespace

Reported reported(const TreeModel& model, const Fit& fit) {
  Reported out;
  const auto unknowns = static_cast<Eigen::Index>(fit.unknowns.size());
  std::vector<Eigen::RowVectorXd> by,
      by_given;  // each row's derivative by the unknowns, here and at the given body
  for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
    const Unknown& u = fit.unknowns[k];
    if (u.of_cause || u.of_body || u.of_inputs) continue;
    Reported::Row row;
    row.name = std::string(kDriveParameters[u.parameter]) + "." + model.robot.joints[u.joint].name;
    row.unit = (model.prismatic(u.joint) ? kLinearDriveUnits : kDriveUnits)[u.parameter];
    row.unknown = k;
    row.given = value_of(Hypothesis{model.drives, {}}, u);
    row.value = value_of(fit.at, u);
    row.folds = fit.fold_value[k];
    out.rows.push_back(std::move(row));
    by.push_back(Eigen::RowVectorXd::Unit(unknowns, static_cast<Eigen::Index>(k)));
    by_given.push_back(by.back());
  }
  for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
    const Unknown& u = fit.unknowns[k];
    if (!u.of_body || u.parameter != 0) continue;
    BodyCoordinates at{};
    for (std::size_t c = 0; c < at.size(); ++c) at[c] = value_of(fit.at, fit.unknowns[k + c]);
    const Values given = values_at(model, u.link, {}), value = values_at(model, u.link, at);
    const Eigen::Matrix<double, 10, 10> derivative = jacobian(model, u.link, at),
                                        of_given = jacobian(model, u.link, {});
    std::vector<Values> folds;
    for (std::size_t f = 0; f < fit.fold_value[k + 1].size(); ++f) {
      BodyCoordinates there = at;
      // What is at a bound has no value of a fold.
      for (std::size_t c = 0; c < at.size(); ++c)
        if (f < fit.fold_value[k + c].size()) there[c] = fit.fold_value[k + c][f];
      folds.push_back(values_at(model, u.link, there));
    }
    for (std::size_t i = 0; i < kInertialNames.size(); ++i) {
      Reported::Row row;
      row.name = std::string(kInertialNames[i]) + "." + model.robot.links[u.link].name;
      row.unit = kInertialUnits[i];
      row.unknown = k;
      row.link = u.link;
      row.part = i;
      row.given = given[i];
      row.value = value[i];
      for (const Values& f : folds) row.folds.push_back(f[i]);
      out.rows.push_back(std::move(row));
      Eigen::RowVectorXd of = Eigen::RowVectorXd::Zero(unknowns);
      of.segment<10>(static_cast<Eigen::Index>(k)) = derivative.row(static_cast<Eigen::Index>(i));
      by.push_back(of);
      of.segment<10>(static_cast<Eigen::Index>(k)) = of_given.row(static_cast<Eigen::Index>(i));
      by_given.push_back(std::move(of));
    }
  }
  const auto stacked = [unknowns](const std::vector<Eigen::RowVectorXd>& rows) {
    Eigen::MatrixXd all(static_cast<Eigen::Index>(rows.size()), unknowns);
    for (std::size_t r = 0; r < rows.size(); ++r) all.row(static_cast<Eigen::Index>(r)) = rows[r];
    return all;
  };
  const Eigen::MatrixXd all = stacked(by), given = stacked(by_given);
  Eigen::VectorXd prior(unknowns);
  for (std::size_t k = 0; k < fit.unknowns.size(); ++k)
    prior(static_cast<Eigen::Index>(k)) = std::pow(fit.unknowns[k].prior_sd, 2);
  const auto of = [](const Eigen::MatrixXd& rows, const Eigen::MatrixXd& covariance) {
    return Eigen::MatrixXd(rows * covariance * rows.transpose());
  };
  out.covariance = of(all, fit.covariance);
  out.of_prior = of(all, fit.of_prior);
  out.prior_variance =
      of(all, prior.asDiagonal()).diagonal().cwiseMax(of(given, prior.asDiagonal()).diagonal());
  return out;
}

ParameterVerdict parameter_verdict(const TreeModel& model, const Reported& all, std::size_t row,
                                   const std::vector<bool>& still) {
  const auto i = static_cast<Eigen::Index>(row);
  const double variance = all.covariance(i, i);
  ParameterVerdict out{"identified", {}};
  double most = 0.0;
  for (std::size_t o = 0; o < all.rows.size(); ++o) {
    const auto j = static_cast<Eigen::Index>(o);
    if (o == row || !(variance * all.covariance(j, j) > 0.0)) continue;
    const double c = std::abs(all.covariance(i, j)) / std::sqrt(variance * all.covariance(j, j));
    if (c > most) {
      most = c;
      out.with = all.rows[o].name;
    }
  }
  const Reported::Row& r = all.rows[row];
  const bool rests = all.of_prior(i, i) > kRests * variance;
  const bool little =
      r.link && (variance > kLittle * all.prior_variance(i) || stands_still(model, *r.link, still));
  const bool together = most > kCorrelated || (rests && most > kTogether);
  if (little || (rests && !together))
    out.verdict = "not_excited";
  else if (together)
    out.verdict = "correlated";
  if (out.verdict != "correlated") out.with.clear();
  return out;
}

Interval interval_of(const Fit& fit, const Reported& all, std::size_t row) {
  const auto i = static_cast<Eigen::Index>(row);
  const Reported::Row& r = all.rows[row];
  const double half = 1.96 * std::sqrt(all.covariance(i, i));
  Interval out{r.value - half, r.value + half};
  const std::string_view part = kInertialNames[r.part];
  if (r.part == 0) {
    const Unknown& u = fit.unknowns[r.unknown];
    out.lower = std::max(out.lower, std::min(r.value, r.given * std::exp(2.0 * u.lower)));
    out.upper = std::min(out.upper, std::max(r.value, r.given * std::exp(2.0 * u.upper)));
  } else if (part.starts_with("ixx") || part.starts_with("iyy") || part.starts_with("izz")) {
    out.lower = std::max(out.lower, 0.0);
  }
  return out;
}

}  // namespace furcula::trees
