#include "host/floating/likelihood.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/parallel.hpp"

namespace furcula::floating {
namespace {

/// A window's rows and columns in units of their standard deviations.
struct Scaled {
  Eigen::VectorXd row_sd, local_sd;
  Eigen::MatrixXd c;
  Eigen::LLT<Eigen::MatrixXd> m;  ///< 1 + C' C
};

Scaled scaled(const LinearWindow& w, const Variances& v) {
  Scaled s;
  s.row_sd.resize(w.y.size());
  for (Eigen::Index k = 0; k < w.y.size(); ++k)
    s.row_sd[k] = std::sqrt(v.noise[noise_of(static_cast<std::size_t>(k) % kRowSize)]);
  s.local_sd.resize(w.c.cols());
  for (Eigen::Index k = 0; k < w.c.cols(); ++k)
    s.local_sd[k] = std::sqrt(v.local[group_of(w.locals[static_cast<std::size_t>(k)])]);
  s.c = s.row_sd.cwiseInverse().asDiagonal() * w.c * s.local_sd.asDiagonal();
  Eigen::MatrixXd m = Eigen::MatrixXd::Identity(w.c.cols(), w.c.cols());
  m.selfadjointView<Eigen::Lower>().rankUpdate(s.c.transpose());
  s.m.compute(m);
  return s;
}

}  // namespace

Variances first_variances() {
  Variances v;
  v.noise = {1e-3 * 1e-3, 2e-3 * 2e-3, 4e-2 * 4e-2};
  for (std::size_t g = 0; g < kLocalGroups; ++g) v.local[g] = kLocalSd[g] * kLocalSd[g];
  return v;
}

Variances estimated(const std::vector<LinearWindow>& windows, const Variances& from, unsigned threads) {
  constexpr int kIterations = 20;
  struct Known {  // what no variance changes
    std::array<Eigen::MatrixXd, kNoiseGroups> cc;
    std::array<Eigen::VectorXd, kNoiseGroups> cy;
    std::array<double, kNoiseGroups> yy{}, rows{};
  };
  std::vector<Known> known(windows.size());
  core::parallel_for(windows.size(), threads, [&](std::size_t w) {
    const LinearWindow& l = windows[w];
    for (std::size_t g = 0; g < kNoiseGroups; ++g) {
      std::vector<Eigen::Index> of;
      for (Eigen::Index k = 0; k < l.y.size(); ++k)
        if (static_cast<std::size_t>(noise_of(static_cast<std::size_t>(k) % kRowSize)) == g) of.push_back(k);
      const Eigen::MatrixXd c = l.c(of, Eigen::all);
      const Eigen::VectorXd y = l.y(of);
      known[w].cc[g] = c.transpose() * c;
      known[w].cy[g] = c.transpose() * y;
      known[w].yy[g] = y.squaredNorm();
      known[w].rows[g] = static_cast<double>(of.size());
    }
  });
  struct Sums {
    std::array<double, kLocalGroups> local{}, locals{};
    std::array<double, kNoiseGroups> noise{}, rows{};
  };
  Variances v = from;
  std::vector<Sums> sums(windows.size());
  for (int k = 0; k < kIterations; ++k) {
    core::parallel_for(windows.size(), threads, [&](std::size_t w) {
      const LinearWindow& l = windows[w];
      const Known& of = known[w];
      const auto n = l.c.cols();
      Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(n, n);
      Eigen::VectorXd score = Eigen::VectorXd::Zero(n);
      for (std::size_t g = 0; g < kNoiseGroups; ++g) {
        precision += of.cc[g] / v.noise[g];
        score += of.cy[g] / v.noise[g];
      }
      for (Eigen::Index i = 0; i < n; ++i)
        precision(i, i) += 1.0 / v.local[group_of(l.locals[static_cast<std::size_t>(i)])];
      const Eigen::LLT<Eigen::MatrixXd> solver(precision);
      const Eigen::MatrixXd covariance = solver.solve(Eigen::MatrixXd::Identity(n, n));
      const Eigen::VectorXd x = solver.solve(score);
      Sums& s = sums[w] = {};
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto g = static_cast<std::size_t>(group_of(l.locals[static_cast<std::size_t>(i)]));
        s.local[g] += x[i] * x[i] + covariance(i, i);
        s.locals[g] += 1.0;
      }
      for (std::size_t g = 0; g < kNoiseGroups; ++g) {
        s.noise[g] = of.yy[g] - 2.0 * x.dot(of.cy[g]) + x.dot(of.cc[g] * x) +
                     (covariance.array() * of.cc[g].array()).sum();
        s.rows[g] = of.rows[g];
      }
    });
    Sums all;
    for (const Sums& s : sums) {
      for (std::size_t g = 0; g < kLocalGroups; ++g) all.local[g] += s.local[g], all.locals[g] += s.locals[g];
      for (std::size_t g = 0; g < kNoiseGroups; ++g) all.noise[g] += s.noise[g], all.rows[g] += s.rows[g];
    }
    for (std::size_t g = 0; g < kLocalGroups; ++g)
      if (all.locals[g] > 0.0) v.local[g] = all.local[g] / all.locals[g];
    for (std::size_t g = 0; g < kNoiseGroups; ++g) v.noise[g] = all.noise[g] / all.rows[g];
  }
  return v;
}

std::vector<double> fit_locals(const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                               const Variances& v, bool from_scratch, Point& point, const Settings& settings,
                               int steps) {
  const Plant plant = plant_of(point.machine);
  std::vector<double> out(windows.size());
  core::parallel_for(windows.size(), settings.threads, [&](std::size_t w) {
    const Recording& recording = recordings[windows[w].recording];
    const std::vector<Window> one{windows[w]};
    Eigen::VectorXd row_sd(kRowSize);
    for (std::size_t k = 0; k < kRowSize; ++k)
      row_sd[static_cast<Eigen::Index>(k)] = std::sqrt(v.noise[noise_of(k)]);
    Local local_sd;
    for (std::size_t k = 0; k < kLocals; ++k)
      local_sd[static_cast<Eigen::Index>(k)] = std::sqrt(v.local[static_cast<std::size_t>(group_of(k))]);
    const Variant here{&point.machine, &plant};
    const auto cost = [&](const Local& x) {
      const Eigen::MatrixXd r = residuals(recording, one[0], x, std::span(&here, 1), settings.step_s);
      double sum = x.cwiseQuotient(local_sd).squaredNorm();
      for (Eigen::Index k = 0; k < r.rows(); k += kRowSize)
        sum += r.col(0).segment(k, kRowSize).cwiseQuotient(row_sd).squaredNorm();
      return std::isfinite(sum) ? sum : 1e300;
    };
    struct Run {
      Local x;
      double cost, damping = 1e-2;
    };
    const auto improve = [&](Run& run, int most) {
      Point p{point.machine, {}, {run.x}};
      const std::vector<Recording>& all = recordings;
      Settings single = settings;
      single.threads = 1;
      for (int n = 0; n < most; ++n) {
        p.locals[0] = run.x;
        const LinearWindow l = std::move(linearised(all, one, {}, p, false, single).front());
        const Scaled s = scaled(l, v);
        const Eigen::MatrixXd normal = s.m.reconstructedMatrix();
        Eigen::VectorXd z(s.c.cols());
        for (Eigen::Index k = 0; k < z.size(); ++k)
          z[k] = run.x[static_cast<Eigen::Index>(l.locals[static_cast<std::size_t>(k)])] / s.local_sd[k];
        const Eigen::VectorXd gradient = s.c.transpose() * l.y.cwiseQuotient(s.row_sd) - normal * z;
        bool better = false;
        double gain = 0.0;
        for (int attempt = 0; attempt < 5 && !better; ++attempt) {
          Eigen::MatrixXd m = normal;
          m.diagonal() *= 1.0 + run.damping;
          const Eigen::VectorXd step = m.llt().solve(gradient);
          Local x = run.x;
          for (Eigen::Index k = 0; k < z.size(); ++k)
            x[static_cast<Eigen::Index>(l.locals[static_cast<std::size_t>(k)])] += step[k] * s.local_sd[k];
          const double now = cost(x);
          if (now < run.cost) {
            gain = run.cost - now;
            run.x = x, run.cost = now, better = true;
            run.damping = std::max(1e-6, 0.1 * run.damping);
          } else {
            run.damping *= 10.0;
          }
        }
        if (!better || gain < 1e-3 * run.cost) break;
      }
    };
    std::vector<Run> runs;
    if (from_scratch) {
      const std::array<double, 2> flat = flat_foot(recording, one[0], point.machine, plant);
      for (const double share : {0.0, 1.0}) {
        Run run{Local::Zero(), 0.0};
        run.x[1] = share * flat[0], run.x[2] = share * flat[1];
        run.cost = cost(run.x);
        improve(run, 3);
        runs.push_back(run);
      }
    } else {
      runs.push_back({point.locals[w], cost(point.locals[w])});
    }
    Run& best = *std::min_element(runs.begin(), runs.end(),
                                  [](const Run& a, const Run& b) { return a.cost < b.cost; });
    improve(best, steps);
    point.locals[w] = best.x;
    out[w] = best.cost;
  });
  return out;
}

std::vector<Local> locals_at(const std::vector<LinearWindow>& windows, const Variances& variances,
                             const Eigen::VectorXd& theta, const std::vector<Local>& from) {
  std::vector<Local> out = from;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const LinearWindow& l = windows[w];
    const Scaled s = scaled(l, variances);
    const Eigen::VectorXd x =
        s.local_sd.cwiseProduct(s.m.solve(s.c.transpose() * (l.y - l.a * theta).cwiseQuotient(s.row_sd)));
    for (Eigen::Index k = 0; k < x.size(); ++k)
      out[w][static_cast<Eigen::Index>(l.locals[static_cast<std::size_t>(k)])] = x[k];
  }
  return out;
}

Evidence evidence(const std::vector<LinearWindow>& windows, const Variances& variances,
                  const std::vector<double>& weights, unsigned threads) {
  const auto n = windows.front().a.cols();
  // As many sums whatever the threads: the same bits.
  std::vector<Evidence> parts(std::min<std::size_t>(8, windows.size()));
  core::parallel_for(parts.size(), threads, [&](std::size_t part) {
    Evidence& e = parts[part];
    e.information = Eigen::MatrixXd::Zero(n, n);
    e.score = Eigen::VectorXd::Zero(n);
    for (std::size_t w = part; w < windows.size(); w += parts.size()) {
      const LinearWindow& l = windows[w];
      const Scaled s = scaled(l, variances);
      const Eigen::VectorXd y = l.y.cwiseQuotient(s.row_sd);
      const Eigen::MatrixXd a = s.row_sd.cwiseInverse().asDiagonal() * l.a;
      // L^-1 C' (a, y), so that what is subtracted is a square.
      const Eigen::MatrixXd ca = s.m.matrixL().solve(s.c.transpose() * a);
      const Eigen::VectorXd cy = s.m.matrixL().solve(s.c.transpose() * y);
      e.information.selfadjointView<Eigen::Lower>().rankUpdate(a.transpose(), weights[w]);
      e.information.selfadjointView<Eigen::Lower>().rankUpdate(ca.transpose(), -weights[w]);
      e.score += weights[w] * (a.transpose() * y - ca.transpose() * cy);
    }
  });
  Evidence out = parts.front();
  for (std::size_t k = 1; k < parts.size(); ++k) {
    out.information += parts[k].information;
    out.score += parts[k].score;
  }
  out.information = Eigen::MatrixXd(out.information.selfadjointView<Eigen::Lower>());
  return out;
}

}  // namespace furcula::floating
