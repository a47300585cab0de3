// Fits of a tree by simulation, see fit.hpp.
#include "host/trees/fit.hpp"

#include <algorithm>
#include <cmath>

#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/core/error.hpp"
#include "host/core/parallel.hpp"
#include "host/trees/missing_torque.hpp"

namespace furcula::trees {
namespace {

constexpr std::size_t kBins = 24;
/// A start is known from the angles around it no better than so many times what their noise says: they bend, too.
constexpr double kStartDoubt = 2.0;
constexpr double kSmoothing_s = 0.02;
/// A motion of no more than so many times the noise, from end to end, is that of a joint at rest.
constexpr double kStill = 10.0;

double root_mean_square(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double v : x) sum += v * v;
  return x.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(x.size()));
}

}  // namespace

double stiffest_nmprad(const Drive& drive) {
  constexpr double kRings_radps = 800.0;
  return drive.rotor_inertia_kgm2 * kRings_radps * kRings_radps;
}

double steadiness(std::span<const double> value, std::span<const double> information) {
  double total = 0.0;
  for (const double i : information) total += i;
  if (!(total > 0.0)) return 0.0;
  double mean = 0.0, squared_weights = 0.0;
  for (std::size_t k = 0; k < value.size(); ++k) {
    mean += information[k] / total * value[k];
    squared_weights += information[k] * information[k] / (total * total);
  }
  double variance = 0.0;
  for (std::size_t k = 0; k < value.size(); ++k) {
    const double w = information[k] / total;
    variance += w * w * (value[k] - mean) * (value[k] - mean);
  }
  // Where one recording has nearly all of the information, the others cannot contradict it.
  const double freedom = 1.0 / squared_weights - 1.0;
  if (freedom < 0.3) return 2.0;
  variance /= std::max(0.1, 1.0 - squared_weights);
  // About Student's distribution at 2 %, no less than 3.5 for the many causes that are tried.
  const double limit = 3.2 * (1.0 + 2.2 / std::pow(freedom, 1.3));
  return std::abs(mean) / std::sqrt(std::max(variance, 1e-300)) / limit;
}

double value_of(const Hypothesis& h, const Unknown& u) {
  return u.of_cause ? h.causes[u.cause].values[u.parameter] : h.drives[u.joint].*kDriveMembers[u.parameter];
}
void set_value(Hypothesis& h, const Unknown& u, double value) {
  (u.of_cause ? h.causes[u.cause].values[u.parameter] : h.drives[u.joint].*kDriveMembers[u.parameter]) =
      value;
}

Scales scales_of(const TreeModel& model, std::span<const Recording> recordings) {
  Scales out;
  for (std::size_t j = 0; j < model.joints(); ++j) {
    std::vector<double> torque, velocity, acceleration;
    double low = 1e300, high = -1e300, noise = 0.0;
    for (const Recording& r : recordings) {
      const std::size_t step =
          std::max<std::size_t>(1, static_cast<std::size_t>(0.02 / std::max(r.interval_s, 1e-6)));
      noise = std::max(noise, r.angle_noise_rad[j]);
      for (std::size_t k = 0; k < r.rows(); k += step) {
        const LocalState s = local_state(r, j, k, kSmoothing_s);
        velocity.push_back(s.velocity_radps);
        acceleration.push_back(s.acceleration_radps2);
        const Drive& d = model.drives[j];
        torque.push_back(d.law == DriveLaw::torque
                             ? r.input[j][k]
                             : d.kp_nmprad * (r.input[j][k] - s.angle_rad) - d.kd_nmsprad * s.velocity_radps);
        low = std::min(low, s.angle_rad);
        high = std::max(high, s.angle_rad);
      }
    }
    out.torque_nm.push_back(std::max(root_mean_square(torque), 1e-6));
    out.velocity_radps.push_back(std::max(root_mean_square(velocity), 1e-3));
    out.acceleration_radps2.push_back(std::max(root_mean_square(acceleration), 1e-2));
    out.lowest_rad.push_back(low);
    out.highest_rad.push_back(high);
    out.still.push_back(high - low <= kStill * noise);
  }
  return out;
}

std::vector<Window> windows_of(const TreeModel& model, std::span<const Recording> recordings, double window_s,
                               std::size_t most) {
  std::vector<Window> out;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const Recording& r = recordings[i];
    for (std::size_t first = 0; first + 1 < r.rows();) {
      std::size_t last = first;
      while (last + 1 < r.rows() && r.time_s[last + 1] - r.time_s[first] <= window_s * (1.0 + 1e-9) &&
             r.time_s[last + 1] - r.time_s[last] < 5.0 * r.interval_s + 1e-3)
        ++last;
      const bool gap =
          last + 1 < r.rows() && r.time_s[last + 1] - r.time_s[last] >= 5.0 * r.interval_s + 1e-3;
      if (r.time_s[last] - r.time_s[first] > 0.8 * window_s && last - first >= 8)
        out.push_back({i, first, last, window_s, {}, {}, {}, {}, {}});
      first = gap || last == first ? last + 1 : last;
    }
  }
  if (most > 0 && out.size() > most) {
    std::vector<Window> some;
    for (std::size_t k = 0; k < most; ++k) some.push_back(std::move(out[k * out.size() / most]));
    out = std::move(some);
  }
  std::size_t fewest = kBins;
  for (const Window& w : out) fewest = std::min(fewest, w.last - w.first);
  const std::size_t n = model.joints();
  for (Window& w : out) {
    const Recording& r = recordings[w.recording];
    w.start_precision = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(2 * n));
    for (std::size_t j = 0; j < n; ++j) {
      const LocalState s = local_state(r, j, w.first, kSmoothing_s);
      w.angle_rad.push_back(s.angle_rad);
      w.velocity_radps.push_back(s.velocity_radps);
      const double a = kStartDoubt * s.angle_sd_rad, v = kStartDoubt * s.velocity_sd_radps + 1e-4;
      w.start_precision(static_cast<Eigen::Index>(j)) = 1.0 / (a * a);
      w.start_precision(static_cast<Eigen::Index>(n + j)) = 1.0 / (v * v);
    }
    w.measured = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fewest * n));
    const double t0 = r.time_s[w.first], span = r.time_s[w.last] - t0;
    std::vector<double> count(fewest, 0.0);
    for (std::size_t k = w.first; k <= w.last; ++k) {
      const auto bin = std::min(
          fewest - 1, static_cast<std::size_t>((r.time_s[k] - t0) / span * static_cast<double>(fewest)));
      w.bin.push_back(bin);
      count[bin] += 1.0;
      for (std::size_t j = 0; j < n; ++j)
        w.measured(static_cast<Eigen::Index>(bin * n + j)) += r.angle_rad[j][k];
    }
    for (std::size_t b = 0; b < fewest; ++b)
      if (count[b] > 0.0)
        w.measured.segment(static_cast<Eigen::Index>(b * n), static_cast<Eigen::Index>(n)) /= count[b];
  }
  return out;
}

Problem::Problem(const TreeModel& model, const std::vector<Recording>& recordings,
                 std::vector<Window> windows, unsigned threads)
    : model_(model),
      recordings_(recordings),
      windows_(std::move(windows)),
      threads_(threads),
      maker_(model),
      scales_(scales_of(model, recordings)),
      bins_(windows_.empty() ? 0
                             : static_cast<std::size_t>(windows_.front().measured.size()) / model.joints()),
      folds_(recordings.size() >= 3 ? recordings.size() : 4) {
  if (windows_.empty())
    throw log::DataError(
        "no recording is long enough for a window; expected some tenths of a second without gaps");
  window_weight_.assign(windows_.size(), 1.0);
}

std::size_t Problem::fold_of(std::size_t window) const {
  if (recordings_.size() >= 3) return windows_[window].recording;
  return window * folds_ / windows_.size();
}

std::vector<Unknown> Problem::unknowns(const Hypothesis& h) const {
  std::vector<Unknown> out;
  const auto torque_scale = [&](std::size_t parameter, std::size_t j) {
    const double torque = scales_.torque_nm[j];
    if (parameter == 0) return torque / std::max(1e-3, scales_.highest_rad[j] - scales_.lowest_rad[j]);
    if (parameter == 2) return torque / scales_.acceleration_radps2[j];
    return torque / scales_.velocity_radps[j];
  };
  for (const FreeParameter& f : model_.free) {
    const bool replaced = std::any_of(h.causes.begin(), h.causes.end(), [&](const Cause& c) {
      const bool same = (c.effect == Effect::damping_error && f.parameter == 3) ||
                        (c.effect == Effect::rotor_inertia_error && f.parameter == 2) ||
                        (c.effect == Effect::position_gain_error && f.parameter < 2);
      return same && std::find(c.sites.begin(), c.sites.end(), f.joint) != c.sites.end();
    });
    if (!replaced)
      out.push_back({false, 0, f.joint, f.parameter, f.lower, f.upper, torque_scale(f.parameter, f.joint)});
  }
  // What the model has of its own is held, as in every model file.
  for (std::size_t c = model_.causes.size(); c < h.causes.size(); ++c) {
    const Cause& cause = h.causes[c];
    const EffectInfo& e = info(cause.effect);
    const std::size_t site = cause.sites.front();
    const bool link = e.seat == Seat::link;
    const std::size_t j = e.seat == Seat::base ? 0
                          : link               ? static_cast<std::size_t>(model_.robot.links[site].joint)
                                               : site;
    const double torque = scales_.torque_nm[j], speed = scales_.velocity_radps[j],
                 range = scales_.highest_rad[j] - scales_.lowest_rad[j];
    for (std::size_t k = 0; k < e.parameter_count; ++k) {
      Unknown u{true, c, j, k, e.parameters()[k].lower, e.parameters()[k].upper, 1.0};
      switch (cause.effect) {
        case Effect::coulomb_friction:
        case Effect::asymmetric_friction:
        case Effect::force_offset:
          u.scale = 0.1 * torque;
          u.upper = 5.0 * torque;
          if (u.lower < 0.0) u.lower = -u.upper;
          break;
        case Effect::stribeck_friction:
          u.scale = k == 2 ? 0.1 * speed : 0.1 * torque;
          u.upper = k == 2 ? 2.0 * speed : 5.0 * torque;
          if (k == 2) u.lower = 0.01 * speed;
          break;
        case Effect::binding_spot:
          u.scale = k == 0 ? 0.1 * torque : 0.05 * range;
          if (k == 0) u.upper = 5.0 * torque;
          if (k == 1) u.lower = scales_.lowest_rad[j], u.upper = scales_.highest_rad[j];
          if (k == 2) u.lower = 0.01 * range, u.upper = 0.6 * range;
          break;
        case Effect::quadratic_drag:
          u.scale = 0.1 * torque / (speed * speed);
          break;
        case Effect::damping_error:
          u.scale = 0.1 * torque / speed;
          break;
        case Effect::rotor_inertia_error:
          u.scale = 0.1 * torque / scales_.acceleration_radps2[j];
          break;
        case Effect::position_gain_error:
          u.scale = 0.1 * std::max(1e-3, k == 0 ? model_.drives[j].kp_nmprad : model_.drives[j].kd_nmsprad);
          break;
        case Effect::mass_error:
          u.scale = 0.1 * model_.urdf.links[site].inertia->mass_kg;
          break;
        case Effect::payload:
          u.scale = k == 0 ? 0.1 * model_.urdf.links[site].inertia->mass_kg : 0.02;
          if (k > 0) u.lower = -1.0, u.upper = 1.0;
          break;
        case Effect::com_error:
          u.scale = 0.01;
          u.lower = -0.5, u.upper = 0.5;
          break;
        case Effect::torque_saturation:
          u.scale = 0.1 * torque;
          u.lower = 0.1 * torque;
          u.upper = 10.0 * torque;
          break;
        case Effect::torque_ripple:
          u.scale = k == 0 ? 0.1 * torque : k == 1 ? 0.1 : 0.3;
          break;
        case Effect::joint_elasticity:
          u.scale = 0.2 * cause.values[0];
          u.upper = stiffest_nmprad(model_.drives[j]);
          u.lower = std::min(10.0 * torque, 0.5 * u.upper);
          break;
        case Effect::actuator_delay:
        case Effect::actuator_lag:
          u.scale = 5e-3;
          u.upper = 0.1;
          break;
        case Effect::load_friction:
        case Effect::inertia_error:
        case Effect::torque_gain_error:
          u.scale = 0.1;
          break;
        case Effect::base_tilt:
        case Effect::encoder_offset:
          u.scale = 0.02;
          u.lower = -0.7, u.upper = 0.7;
          break;
      }
      out.push_back(u);
    }
  }
  return out;
}

Eigen::VectorXd Problem::simulated(const Setup& setup, const Window& w) const {
  const std::size_t n = joints(), rows = w.last - w.first + 1;
  std::vector<double> out(rows * n);
  run(setup, recordings_[w.recording], w.first, w.last, w.angle_rad, w.velocity_radps, out);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(w.measured.size());
  std::vector<double> count(bins_, 0.0);
  for (std::size_t k = 0; k < rows; ++k) {
    count[w.bin[k]] += 1.0;
    for (std::size_t j = 0; j < n; ++j) mean(static_cast<Eigen::Index>(w.bin[k] * n + j)) += out[k * n + j];
  }
  for (std::size_t b = 0; b < bins_; ++b)
    if (count[b] > 0.0)
      mean.segment(static_cast<Eigen::Index>(b * n), static_cast<Eigen::Index>(n)) /= count[b];
  // A run that has flown apart says no more than that it is far off.
  return mean.unaryExpr([](double x) { return std::isfinite(x) ? std::clamp(x, -1e6, 1e6) : 1e6; });
}

Eigen::VectorXd Problem::residual(const Setup& setup, std::size_t window) const {
  return weight_.cwiseProduct(windows_[window].measured - simulated(setup, windows_[window]));
}

Eigen::MatrixXd Problem::product(std::size_t window, const Eigen::MatrixXd& columns) const {
  const Start& s = starts_[window];
  const Eigen::MatrixXd with_start = s.columns.transpose() * columns;
  return window_weight_[window] *
         (columns.transpose() * columns - with_start.transpose() * (s.inverse * with_start));
}

void Problem::weigh(const Hypothesis& h) {
  const std::size_t n = joints();
  const auto size = static_cast<Eigen::Index>(bins_ * n);
  const Setup setup = make(h);
  weight_ = Eigen::VectorXd::Ones(size);
  std::vector<Eigen::VectorXd> left(windows_.size());
  starts_.assign(windows_.size(), {});
  core::parallel_for(windows_.size(), threads_, [&](std::size_t i) {
    Window w = windows_[i];
    const Eigen::VectorXd r = residual(setup, i), base = w.measured - r;
    Start& s = starts_[i];
    s.columns.resize(size, static_cast<Eigen::Index>(2 * n));
    for (std::size_t k = 0; k < 2 * n; ++k) {
      std::vector<double>& x = k < n ? w.angle_rad : w.velocity_radps;
      const double step = k < n ? 1e-5 : 1e-4, before = x[k % n];
      x[k % n] += step;
      s.columns.col(static_cast<Eigen::Index>(k)) = (simulated(setup, w) - base) / step;
      x[k % n] = before;
    }
    left[i] = r;
  });
  // What each bin's residual is worth: from the residuals that are left once the starts are fitted; twice, since the weights decide on the starts.
  for (int round = 0; round < 2; ++round) {
    Eigen::MatrixXd squares(size, static_cast<Eigen::Index>(windows_.size()));
    for (std::size_t i = 0; i < windows_.size(); ++i) {
      const Eigen::MatrixXd s = weight_.asDiagonal() * starts_[i].columns;
      Eigen::MatrixXd normal = s.transpose() * s;
      normal.diagonal() += windows_[i].start_precision;
      const Eigen::VectorXd start = normal.llt().solve(s.transpose() * weight_.cwiseProduct(left[i]));
      squares.col(static_cast<Eigen::Index>(i)) = (left[i] - starts_[i].columns * start).cwiseAbs2();
    }
    for (std::size_t j = 0; j < n; ++j) {
      double noise = 1e-9;
      for (const Recording& r : recordings_) noise = std::max(noise, r.angle_noise_rad[j]);
      for (std::size_t b = 0; b < bins_; ++b) {
        // Of this bin and its neighbours, the mean without the largest tenth.
        std::vector<double> all;
        for (std::size_t k = b > 2 ? b - 2 : 0; k < std::min(bins_, b + 3); ++k)
          for (Eigen::Index i = 0; i < squares.cols(); ++i)
            all.push_back(squares(static_cast<Eigen::Index>(k * n + j), i));
        std::sort(all.begin(), all.end());
        all.resize(all.size() - all.size() / 10);
        double mean = 0.0;
        for (const double v : all) mean += v / static_cast<double>(all.size());
        weight_(static_cast<Eigen::Index>(b * n + j)) = 1.0 / std::sqrt(mean + noise * noise / 4.0);
      }
    }
  }
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    Start& s = starts_[i];
    s.columns = weight_.asDiagonal() * s.columns;
    Eigen::MatrixXd normal = s.columns.transpose() * s.columns;
    normal.diagonal() += windows_[i].start_precision;
    s.inverse = normal.llt().solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
  }
  window_weight_.assign(windows_.size(), 1.0);
  std::vector<double> loss;
  for (std::size_t i = 0; i < windows_.size(); ++i)
    loss.push_back(product(i, weight_.cwiseProduct(left[i]))(0, 0));
  std::vector<double> sorted = loss;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const double typical = sorted[sorted.size() / 2];
  for (std::size_t i = 0; i < windows_.size(); ++i)
    window_weight_[i] = std::min(1.0, 25.0 * typical / std::max(loss[i], 1e-300));
}

double Problem::misfit(const Hypothesis& h) const {
  const std::size_t n = joints();
  const Setup setup = make(h);
  std::vector<std::vector<double>> off(windows_.size()), motion(windows_.size());
  core::parallel_for(windows_.size(), threads_, [&](std::size_t i) {
    const Window& w = windows_[i];
    const Eigen::VectorXd r = w.measured - simulated(setup, w);
    for (std::size_t j = 0; j < n; ++j) {
      const auto of_joint = [&](const Eigen::VectorXd& x) {
        return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>>(
            x.data() + j, static_cast<Eigen::Index>(bins_),
            Eigen::InnerStride<>(static_cast<Eigen::Index>(n))));
      };
      const Eigen::VectorXd y = of_joint(w.measured);
      off[i].push_back(of_joint(r).squaredNorm());
      motion[i].push_back((y.array() - y.mean()).matrix().squaredNorm());
    }
  });
  double most = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    double squares = 0.0, about_mean = 1e-12;
    for (std::size_t i = 0; i < windows_.size(); ++i) {
      squares += off[i][j];
      about_mean += motion[i][j];
    }
    most = std::max(most, squares / about_mean);
  }
  return most;
}

std::vector<std::vector<double>> Problem::ripple_cycles(const Hypothesis& h) const {
  constexpr int kMostCycles = 48;
  constexpr double kSwings = 0.05;  // of the missing torque's square
  std::vector<std::vector<double>> out;
  for (const TorqueSamples& s : missing_torque(*this, recordings_, h, windows_.front().span_s, 3000)) {
    const auto& q = s.own().angle_rad;
    const auto& y = s.missing_nm;
    std::vector<std::pair<double, double>> best;
    const double range = scales_.highest_rad[s.joint] - scales_.lowest_rad[s.joint];
    for (int cycles = 2; cycles <= kMostCycles && y.size() > 100; ++cycles) {
      if (cycles * range < 9.0) continue;  // one and a half cycles of travel
      Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
      Eigen::Vector3d right = Eigen::Vector3d::Zero();
      double squares = 0.0;
      for (std::size_t i = 0; i < y.size(); ++i) {
        const Eigen::Vector3d row(1.0, std::sin(cycles * q[i]), std::cos(cycles * q[i]));
        normal += row * row.transpose();
        right += row * y[i];
        squares += y[i] * y[i];
      }
      const double constant = right(0) * right(0) / normal(0, 0);
      best.emplace_back(
          (right.dot(Eigen::Vector3d(normal.ldlt().solve(right))) - constant) / std::max(squares, 1e-300),
          cycles);
    }
    std::sort(best.rbegin(), best.rend());
    out.emplace_back();
    for (std::size_t k = 0; k < best.size() && k < 2 && best[k].first > kSwings; ++k)
      out.back().push_back(best[k].second);
  }
  return out;
}

std::vector<double> Problem::losses(const Hypothesis& h) const {
  const Setup setup = make(h);
  std::vector<double> out(windows_.size());
  core::parallel_for(windows_.size(), threads_,
                     [&](std::size_t i) { out[i] = product(i, residual(setup, i))(0, 0); });
  return out;
}

Products Problem::products(const Hypothesis& h, const std::vector<Unknown>& unknowns,
                           const std::vector<Hypothesis>& probes) const {
  const auto size = static_cast<Eigen::Index>(bins_ * joints());
  const auto columns = static_cast<Eigen::Index>(1 + unknowns.size() + probes.size());
  std::vector<Setup> setups{make(h)};
  std::vector<double> step;
  for (const Unknown& u : unknowns) {
    // Inwards at the upper bound.
    double d = 1e-3 * u.scale;
    const double value = value_of(h, u);
    if (value + d > u.upper) d = -d;
    Hypothesis moved = h;
    set_value(moved, u, value + d);
    step.push_back(d);
    setups.push_back(make(moved));
  }
  for (const Hypothesis& p : probes) setups.push_back(make(p));
  Products out;
  out.window.resize(windows_.size());
  std::vector<Eigen::MatrixXd> of(windows_.size());
  core::parallel_for(windows_.size(), threads_, [&](std::size_t i) {
    Eigen::MatrixXd c(size, columns);
    const Eigen::VectorXd base = residual(setups[0], i);
    c.col(0) = base;
    for (std::size_t k = 1; k < setups.size(); ++k) {
      // The simulation's change is minus the residual's.
      const Eigen::VectorXd change = base - residual(setups[k], i);
      c.col(static_cast<Eigen::Index>(k)) = k <= unknowns.size() ? change / step[k - 1] : change;
    }
    of[i] = product(i, c);
    out.window[i] = of[i].cast<float>();
  });
  out.all = Eigen::MatrixXd::Zero(columns, columns);
  out.fold.assign(folds_, Eigen::MatrixXd::Zero(columns, columns));
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    out.all += of[i];
    out.fold[fold_of(i)] += of[i];
  }
  return out;
}

Fit Problem::fit(Hypothesis from, const FitOptions& options) const {
  Fit out;
  out.at = std::move(from);
  out.unknowns = unknowns(out.at);
  const auto count = static_cast<Eigen::Index>(out.unknowns.size());
  for (const Unknown& u : out.unknowns)
    set_value(out.at, u, std::clamp(value_of(out.at, u), u.lower, u.upper));
  double damping = 1e-3;
  Products p = products(out.at, out.unknowns, {});
  out.loss = p.all(0, 0);
  for (int iteration = 0; iteration < options.iterations && count > 0; ++iteration) {
    bool better = false;
    double gained = 0.0;
    for (int attempt = 0; attempt < 4 && !better; ++attempt) {
      // Unknowns at a bound that the gradient pushes against stay there.
      std::vector<Eigen::Index> moving;
      for (Eigen::Index k = 0; k < count; ++k) {
        const Unknown& u = out.unknowns[static_cast<std::size_t>(k)];
        const double value = value_of(out.at, u), push = p.all(0, k + 1);
        if (!((value <= u.lower && push < 0.0) || (value >= u.upper && push > 0.0))) moving.push_back(k);
      }
      const auto m = static_cast<Eigen::Index>(moving.size());
      Eigen::MatrixXd normal(m, m);
      Eigen::VectorXd right(m);
      for (Eigen::Index a = 0; a < m; ++a) {
        const double sa = out.unknowns[static_cast<std::size_t>(moving[static_cast<std::size_t>(a)])].scale;
        right(a) = sa * p.all(0, moving[static_cast<std::size_t>(a)] + 1);
        for (Eigen::Index b = 0; b < m; ++b)
          normal(a, b) =
              sa * out.unknowns[static_cast<std::size_t>(moving[static_cast<std::size_t>(b)])].scale *
              p.all(moving[static_cast<std::size_t>(a)] + 1, moving[static_cast<std::size_t>(b)] + 1);
      }
      normal.diagonal() *= 1.0 + damping;
      normal.diagonal().array() += 1e-9 * std::max(1e-12, normal.diagonal().maxCoeff());
      const Eigen::VectorXd step = normal.ldlt().solve(right);
      Hypothesis trial = out.at;
      for (Eigen::Index a = 0; a < m; ++a) {
        const Unknown& u = out.unknowns[static_cast<std::size_t>(moving[static_cast<std::size_t>(a)])];
        // No step of more than ten times what matters: far out the columns say nothing.
        const double moved = value_of(out.at, u) + u.scale * std::clamp(step(a), -10.0, 10.0);
        set_value(trial, u, std::clamp(moved, u.lower, u.upper));
      }
      double loss = 0.0;
      for (const double l : losses(trial)) loss += l;
      if (loss < out.loss) {
        better = true;
        gained = out.loss - loss;
        out.at = trial;
        out.loss = loss;
        damping = std::max(1e-6, damping * 0.2);
      } else {
        damping = std::min(1e6, damping * 20.0);
      }
    }
    if (!better) break;
    p = products(out.at, out.unknowns, {});
    if (gained < 1e-4 * out.loss) break;
  }
  // A sandwich: the windows' gradients scatter as their residuals do, whatever these are made of.
  out.at_bound.assign(out.unknowns.size(), false);
  std::vector<Eigen::Index> inside;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Unknown& u = out.unknowns[static_cast<std::size_t>(k)];
    const double value = value_of(out.at, u), near = 1e-6 * std::max(std::abs(u.upper), u.scale);
    out.at_bound[static_cast<std::size_t>(k)] =
        value <= u.lower + 1e-9 * u.scale || value >= u.upper - std::min(near, 1e-3 * u.scale);
    // What nothing depends on has no scatter either.
    if (!out.at_bound[static_cast<std::size_t>(k)] &&
        p.all(k + 1, k + 1) * u.scale * u.scale > 1e-9 * out.loss)
      inside.push_back(k + 1);
  }
  const auto m = static_cast<Eigen::Index>(inside.size());
  out.covariance = Eigen::MatrixXd::Zero(count, count);
  if (m > 0) {
    Eigen::MatrixXd information(m, m), scatter = Eigen::MatrixXd::Zero(m, m);
    for (Eigen::Index a = 0; a < m; ++a)
      for (Eigen::Index b = 0; b < m; ++b)
        information(a, b) = p.all(inside[static_cast<std::size_t>(a)], inside[static_cast<std::size_t>(b)]);
    for (const Eigen::MatrixXf& w : p.window) {
      Eigen::VectorXd g(m);
      for (Eigen::Index a = 0; a < m; ++a)
        g(a) = static_cast<double>(w(0, inside[static_cast<std::size_t>(a)]));
      scatter += g * g.transpose();
    }
    const double windows = static_cast<double>(p.window.size());
    const Eigen::VectorXd unit = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = unit.asDiagonal() * information * unit.asDiagonal();
    const Eigen::MatrixXd inverse =
        unit.asDiagonal() * (scaled + 1e-10 * Eigen::MatrixXd::Identity(m, m)).inverse() * unit.asDiagonal();
    const Eigen::MatrixXd c =
        inverse * scatter * inverse * (windows / std::max(1.0, windows - static_cast<double>(m)));
    for (Eigen::Index a = 0; a < m; ++a)
      for (Eigen::Index b = 0; b < m; ++b)
        out.covariance(inside[static_cast<std::size_t>(a)] - 1, inside[static_cast<std::size_t>(b)] - 1) =
            c(a, b);
  }
  out.fold_value.assign(out.unknowns.size(), {});
  out.fold_information.assign(out.unknowns.size(), {});
  for (const Eigen::MatrixXd& fold : p.fold) {
    Eigen::MatrixXd normal(m, m);
    Eigen::VectorXd right(m);
    for (Eigen::Index a = 0; a < m; ++a) {
      right(a) = fold(0, inside[static_cast<std::size_t>(a)]);
      for (Eigen::Index b = 0; b < m; ++b)
        normal(a, b) = fold(inside[static_cast<std::size_t>(a)], inside[static_cast<std::size_t>(b)]);
    }
    if (m == 0) continue;
    const Eigen::VectorXd unit =
        normal.diagonal().cwiseMax(1e-12 * normal.diagonal().maxCoeff() + 1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled =
        unit.asDiagonal() * normal * unit.asDiagonal() + 1e-7 * Eigen::MatrixXd::Identity(m, m);
    const Eigen::MatrixXd inverse = unit.asDiagonal() * scaled.inverse() * unit.asDiagonal();
    const Eigen::VectorXd step = inverse * right;
    for (Eigen::Index a = 0; a < m; ++a) {
      const auto k = static_cast<std::size_t>(inside[static_cast<std::size_t>(a)] - 1);
      out.fold_value[k].push_back(value_of(out.at, out.unknowns[k]) + step(a));
      out.fold_information[k].push_back(1.0 / inverse(a, a));
    }
  }
  out.window_loss.resize(p.window.size());
  for (std::size_t i = 0; i < p.window.size(); ++i)
    out.window_loss[i] = static_cast<double>(p.window[i](0, 0));
  return out;
}

}  // namespace furcula::trees
