#include "host/reproduce/identification_study.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "furcula/dynamics/hopper.hpp"
#include "furcula/dynamics/links.hpp"
#include "host/core/error.hpp"
#include "host/core/parallel.hpp"
#include "host/identify/equation_fit.hpp"
#include "host/identify/prediction.hpp"
#include "host/reproduce/examples.hpp"
#include "host/reproduce/plain_fit.hpp"

namespace furcula::reproduce {
namespace {

using identify::Recording;
using identify::StartState;
using identify::Unknown;
using identify::Window;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::size_t index_of(const model::Model& m, std::string_view name) {
  return *dynamics::parameter_index(m.kind, name);
}
void set(model::Model& m, std::string_view name, double value) { m.parameters[index_of(m, name)] = value; }
void set_free(model::Model& m, std::string_view name, double lower, double upper) {
  m.free[index_of(m, name)] = {lower, upper};
}

/// What is known before the first fit; nothing of the rig's truth.
model::Model believed(const VirtualRig& rig, dynamics::Kind kind) {
  model::Model m;
  m.kind = kind;
  m.parameters.resize(dynamics::info(kind).parameters.size());
  set(m, "mass_kg", rig.weighed_kg);
  set(m, "stiffness_npm", rig.stiffness_npm);
  set(m, "rest_height_m", rig.rest_height_m);
  set(m, "damping_stance_nspm", 5.0);
  set(m, "damping_flight_nspm", 1.0);
  set(m, "restitution_touchdown", 1.0);
  set(m, "restitution_liftoff", 1.0);
  set(m, "link_length_m", 0.15);
  set(m, "touchdown_angle_rad", 20.0 * std::numbers::pi / 180.0);
  set(m, "gravity_mps2", 9.81);
  return m;
}

template <class Predicted>
TrajectoryErrors errors_of(const Recording& r, const Window& w, const Predicted& run) {
  TrajectoryErrors e;
  const auto rows = static_cast<double>(w.rows());
  double z_mean = 0.0, v_mean = 0.0, z_spread = 0.0, v_spread = 0.0;
  for (std::size_t i = w.first; i <= w.last; ++i) {
    z_mean += r.position[i] / rows;
    v_mean += r.velocity_smoothed[i] / rows;
  }
  for (std::size_t i = w.first; i <= w.last; ++i) {
    const double z = run.position[i - w.first] - r.position[i];
    const double v = run.velocity[i - w.first] - r.velocity_smoothed[i];
    e.nmse_height += z * z;
    e.nmse_velocity += v * v;
    e.mae_height_m += std::abs(z) / rows;
    e.mae_velocity_mps += std::abs(v) / rows;
    e.worst_height_m = std::max(e.worst_height_m, std::abs(z));
    z_spread += (r.position[i] - z_mean) * (r.position[i] - z_mean);
    v_spread += (r.velocity_smoothed[i] - v_mean) * (r.velocity_smoothed[i] - v_mean);
  }
  e.nmse_height /= z_spread;
  e.nmse_velocity /= v_spread;
  return e;
}

/// One window of each recording.
struct Data {
  std::vector<Recording> recordings;
  std::vector<Window> windows;
};

/// Recording i is left out of fold i % folds.
std::vector<Window> seen_by(const std::vector<Window>& windows, std::size_t fold, std::size_t folds) {
  std::vector<Window> seen;
  for (std::size_t i = 0; i < windows.size(); ++i)
    if (i % folds != fold) seen.push_back(windows[i]);
  return seen;
}

Data one_window_each(const std::vector<log::Log>& logs, const model::Model& m,
                     std::vector<Window> (*find)(const Recording&, std::size_t, const model::Model&),
                     std::size_t which, const char* what) {
  Data d{identify::make_recordings(logs, m.kind), {}};
  for (std::size_t i = 0; i < d.recordings.size(); ++i) {
    const auto found = find(d.recordings[i], i, m);
    if (found.size() <= which) throw core::DataError(d.recordings[i].name + ": no whole " + what);
    d.windows.push_back(found[which]);
  }
  return d;
}

/// Fits and cross-validates. `fit(start, windows)` gives values, `predict(values, i)` recording i's errors.
template <class Fit, class Predict>
Estimates cross_validate(std::string phase, std::string method, const std::vector<Unknown>& unknowns,
                         const std::vector<double>& start, const std::vector<Window>& windows,
                         std::size_t folds, unsigned threads, const Fit& fit, const Predict& predict) {
  Estimates e;
  e.phase = std::move(phase);
  e.method = std::move(method);
  for (const Unknown& u : unknowns) {
    e.names.push_back(u.name);
    e.units.push_back(u.unit);
  }
  e.folds.resize(folds);
  e.errors.resize(windows.size());
  core::parallel_for(folds + 1, threads, [&](std::size_t fold) {
    if (fold == folds) {
      e.values = fit(start, windows);
      return;
    }
    e.folds[fold] = fit(start, seen_by(windows, fold, folds));
    for (std::size_t i = fold; i < windows.size(); i += folds) e.errors[i] = predict(e.folds[fold], i);
  });
  return e;
}

/// Where a prediction starts: what a window's first tenth gives, or its first row as measured, which is the
/// document's way.
enum class Start { estimated, measured };

StartState start_of(const Recording& r, const Window& w, const model::Model& reference, Start start) {
  if (start == Start::estimated) return identify::start_state(r, w, reference);
  StartState measured;
  measured.position = r.position[w.first];
  measured.velocity = r.velocity_smoothed[w.first];
  return measured;
}

TrajectoryErrors predicted(const model::Model& m, const model::Model& reference, const Data& d,
                           const Window& w, Start start = Start::estimated) {
  const Recording& r = d.recordings[w.recording];
  return errors_of(r, w, identify::predict(m, r, w, start_of(r, w, reference, start)));
}

/// Each recording's velocity replaced.
template <class Velocity>
Data with_velocity(Data d, const Velocity& velocity) {
  for (Recording& r : d.recordings) r.velocity_smoothed = velocity(r);
  return d;
}

std::vector<double> recorded_velocity(const Recording& r) { return r.velocity; }

std::vector<double> velocity_of_15_hz(const Recording& r) { return filtered_velocity(r.time_s, r.position); }

/// The smooth velocity of `delay_s` ago.
std::vector<double> late_velocity(const Recording& r, double delay_s) {
  std::vector<double> v(r.rows());
  std::size_t at = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double time_s = std::max(r.time_s[i] - delay_s, r.time_s.front());
    while (at + 2 < v.size() && r.time_s[at + 1] <= time_s) ++at;
    const double share = (time_s - r.time_s[at]) / (r.time_s[at + 1] - r.time_s[at]);
    v[i] = (1.0 - share) * r.velocity_smoothed[at] + share * r.velocity_smoothed[at + 1];
  }
  return v;
}

/// By how much the recorded velocity lags the smooth one in the windows: least squares of
/// v - v_smooth = -delay dv_smooth/dt.
double recorded_delay_s(const Data& d) {
  double products = 0.0, squares = 0.0;
  for (const Window& w : d.windows) {
    const Recording& r = d.recordings[w.recording];
    for (std::size_t i = w.first + 1; i < w.last; ++i) {
      const double slope =
          (r.velocity_smoothed[i + 1] - r.velocity_smoothed[i - 1]) / (r.time_s[i + 1] - r.time_s[i - 1]);
      products -= (r.velocity[i] - r.velocity_smoothed[i]) * slope;
      squares += slope * slope;
    }
  }
  return products / squares;
}

/// Recording i by the estimate of the fold that did not see it: `predict(values, i, data, start)`.
template <class Predict>
std::vector<OtherJudging> judged_otherwise(const Estimates& e, const Data& ours, const Data& theirs,
                                           const std::string& velocity, const Predict& predict) {
  std::vector<OtherJudging> all;
  const auto judge = [&](std::string what, const Data& d, Start start) {
    all.push_back({std::move(what), {}});
    for (std::size_t i = 0; i < d.windows.size(); ++i)
      all.back().errors.push_back(predict(e.folds[i % e.folds.size()], i, d, start));
  };
  judge("judged by " + velocity, theirs, Start::estimated);
  judge("started from the measured state", ours, Start::measured);
  judge("started from the measured state and judged, both by " + velocity, theirs, Start::measured);
  return all;
}

/// `judged`: what predictions are compared with, the same recordings.
Estimates of_phase(std::string phase, bool by_equation, const model::Model& m, const Data& d,
                   const Data& judged, std::size_t folds, unsigned threads) {
  const std::vector<Unknown> unknowns = identify::free_unknowns(m);
  return cross_validate(
      std::move(phase), by_equation ? "equation" : "simulation", unknowns, identify::values_in(m, unknowns),
      d.windows, folds, threads,
      [&](const std::vector<double>& start, const std::vector<Window>& windows) {
        return by_equation ? identify::fit_by_equation(m, unknowns, start, d.recordings, windows).values
                           : identify::fit_by_simulation(m, unknowns, start, d.recordings, windows,
                                                         identify::Weighting::nmse)
                                 .values;
      },
      [&](const std::vector<double>& values, std::size_t i) {
        const model::Model fitted = identify::with_values(m, unknowns, values);
        return predicted(fitted, fitted, judged, judged.windows[i]);
      });
}

/// A stride of the linear model from apex to apex, its torque restarted at the touch-down that it predicts
/// (section 4.2.1.1).
identify::Run stride(const model::Model& m, const Recording& r, const Window& w, const Experiment& e,
                     Start from = Start::estimated) {
  dynamics::Hopper<double> plant(
      dynamics::from_table<dynamics::HopperLinearParameters<double>>(std::span<const double>(m.parameters)));
  const StartState start = start_of(r, w, m, from);
  plant.reset(start.position, start.velocity);
  identify::Run run;
  double touchdown_s = 0.0;
  for (std::size_t i = w.first;; ++i) {
    run.position.push_back(plant.height_m());
    run.velocity.push_back(plant.velocity_mps());
    if (i == w.last) return run;
    const double dt_s = r.time_s[i + 1] - r.time_s[i];
    const double since_s = r.time_s[i] + 0.5 * dt_s - touchdown_s;
    plant.advance(
        plant.in_stance() ? e.amplitude_nm * std::sin(2.0 * std::numbers::pi * since_s / e.period_s) : 0.0,
        dt_s);
    for (const auto& event : plant.events())
      if (event.kind == dynamics::ContactEvent<double>::Kind::touchdown)
        touchdown_s = r.time_s[i] + event.offset_s;
  }
}

/// Where torque starts hangs on the parameters in a way that no derivative of a run sees: finite differences.
struct StrideCost {
  const model::Model& model;
  const std::vector<Unknown>& unknowns;
  const Recording& recording;
  const Window& window;
  const Experiment& experiment;
  double height_weight, velocity_weight;

  bool operator()(double const* const* at, double* residuals) const {
    const std::vector<double> values(at[0], at[0] + unknowns.size());
    const auto run = stride(identify::with_values(model, unknowns, values), recording, window, experiment);
    for (std::size_t i = 0; i < window.rows(); ++i) {
      *residuals++ = height_weight * (run.position[i] - recording.position[window.first + i]);
      *residuals++ = velocity_weight * (run.velocity[i] - recording.velocity_smoothed[window.first + i]);
    }
    return true;
  }
};

std::vector<double> fit_strides(const model::Model& m, const std::vector<Unknown>& unknowns,
                                std::vector<double> values, const Data& d, const std::vector<Window>& windows,
                                const std::vector<Experiment>& experiments) {
  ceres::Problem problem;
  for (const Window& w : windows) {
    const Recording& r = d.recordings[w.recording];
    const auto weight = [&](const std::vector<double>& of) {
      const auto begin = of.begin() + static_cast<std::ptrdiff_t>(w.first);
      const auto end = of.begin() + static_cast<std::ptrdiff_t>(w.last) + 1;
      const double mean = std::accumulate(begin, end, 0.0) / static_cast<double>(w.rows());
      double squares = 0.0;
      for (auto v = begin; v != end; ++v) squares += (*v - mean) * (*v - mean);
      return 1.0 / std::sqrt(squares);
    };
    auto* cost = new ceres::DynamicNumericDiffCostFunction<StrideCost>(new StrideCost{
        m, unknowns, r, w, experiments[w.recording], weight(r.position), weight(r.velocity_smoothed)});
    cost->AddParameterBlock(static_cast<int>(unknowns.size()));
    cost->SetNumResiduals(2 * static_cast<int>(w.rows()));
    problem.AddResidualBlock(cost, nullptr, values.data());
  }
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    problem.SetParameterLowerBound(values.data(), static_cast<int>(i), unknowns[i].lower);
    problem.SetParameterUpperBound(values.data(), static_cast<int>(i), unknowns[i].upper);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return values;
}

/// NMSE(z) + NMSE(z') over all windows, mean, from the starts that `reference` gives them.
double mean_nmse(const model::Model& m, const model::Model& reference, const Data& d) {
  double sum = 0.0;
  for (const Window& w : d.windows) {
    const TrajectoryErrors e = predicted(m, reference, d, w);
    sum += (e.nmse_height + e.nmse_velocity) / static_cast<double>(d.windows.size());
  }
  return sum;
}

/// The same with the start of each run fitted to it ...
double nmse_with_fitted_starts(const model::Model& m, const Data& d) {
  return identify::fit_by_simulation(m, {}, {}, d.recordings, d.windows, identify::Weighting::nmse).squares /
         static_cast<double>(d.windows.size());
}

/// ... and with the measured state as the start.
double nmse_with_measured_starts(const model::Model& m, const Data& d) {
  double sum = 0.0;
  for (const Window& w : d.windows) {
    const TrajectoryErrors e = predicted(m, m, d, w, Start::measured);
    sum += (e.nmse_height + e.nmse_velocity) / static_cast<double>(d.windows.size());
  }
  return sum;
}

PlainStudy plain_study(const std::string& phase, const model::Model& m, const Data& d, std::size_t folds) {
  const std::vector<Unknown> unknowns = identify::free_unknowns(m);
  const std::vector<double> start = identify::values_in(m, unknowns);
  PlainStudy s;
  model::Model ours;
  s.estimates = cross_validate(
      phase, "simulation, the plain way", unknowns, start, d.windows, folds, 1,
      [&](const std::vector<double>& from, const std::vector<Window>& windows) {
        const double begin_s = now_s();
        const PlainFit fit = fit_plainly(m, unknowns, from, d.recordings, windows);
        const double middle_s = now_s();
        const auto by_ours =
            identify::fit_by_simulation(m, unknowns, from, d.recordings, windows, identify::Weighting::nmse);
        s.plain_s += middle_s - begin_s;
        s.ours_s += now_s() - middle_s;
        s.evaluations += fit.evaluations;
        s.converged += fit.converged ? 1 : 0;
        ++s.fits;
        if (windows.size() == d.windows.size()) ours = identify::with_values(m, unknowns, by_ours.values);
        return fit.values;
      },
      [&](const std::vector<double>& values, std::size_t i) {
        const model::Model fitted = identify::with_values(m, unknowns, values);
        return predicted(fitted, fitted, d, d.windows[i]);
      });
  const model::Model plain = identify::with_values(m, unknowns, s.estimates.values);
  s.plain_nmse = mean_nmse(plain, ours, d);
  s.ours_nmse = mean_nmse(ours, ours, d);
  s.plain_nmse_fitted = nmse_with_fitted_starts(plain, d);
  s.ours_nmse_fitted = nmse_with_fitted_starts(ours, d);
  s.plain_nmse_measured = nmse_with_measured_starts(plain, d);
  s.ours_nmse_measured = nmse_with_measured_starts(ours, d);
  return s;
}

/// Mean of M(theta) / lever^2 over the measured stances, kg.
double effective_mass_kg(const dynamics::Links<double>& links, const Data& stances) {
  double sum = 0.0, rows = 0.0;
  for (const Window& w : stances.windows)
    for (std::size_t i = w.first; i <= w.last; ++i) {
      const double height_m = stances.recordings[w.recording].position[i];
      const auto pose = links.pose(std::acos(height_m / (2.0 * links.link_length)));
      sum += links.standing_inertia(pose) / (pose.lever * pose.lever);
      rows += 1.0;
    }
  return sum / rows;
}

double equivalent_flight_damping_nspm(const model::Model& truth, const Data& flights) {
  double speed = 0.0, squares = 0.0;
  for (const Window& w : flights.windows)
    for (std::size_t i = w.first; i <= w.last; ++i) {
      const double v = flights.recordings[w.recording].velocity_smoothed[i];
      speed += std::abs(v);
      squares += v * v;
    }
  return truth.parameter("damping_flight_nspm") +
         truth.effects.at(dynamics::Effect::coulomb_friction)[0] * speed / squares;
}

/// (m, e, b, a) of a kilogram at the toe, which stands still in stance: z = 2 L cos theta makes
/// M = [[2 L^2 (1 - cos 2 theta), 2 L sin theta], [., 1]] of it, singular along the motion.
constexpr const char* kToeNames[] = {"mass_kg", "inertia_e_kgm", "inertia_b_kgm", "inertia_a_kgm2"};
std::array<double, 4> toe_mass(double length_m) {
  return {1.0, 2.0 * length_m, length_m, 2.0 * length_m * length_m};
}

}  // namespace

std::size_t Estimates::index(std::string_view name) const {
  const auto it = std::find(names.begin(), names.end(), name);
  if (it == names.end()) throw std::out_of_range(phase + ": no parameter " + std::string(name));
  return static_cast<std::size_t>(it - names.begin());
}

std::pair<double, double> Estimates::range(std::string_view name) const {
  const std::size_t i = index(name);
  double low = folds.front()[i], high = low;
  for (const auto& f : folds) {
    low = std::min(low, f[i]);
    high = std::max(high, f[i]);
  }
  return {low, high};
}

double Estimates::spread(std::string_view name) const {
  const std::size_t i = index(name);
  double sum = 0.0;
  for (const auto& f : folds) sum += f[i];
  const auto [low, high] = range(name);
  return (high - low) * static_cast<double>(folds.size()) / sum;
}

double damped_frequency_radps(double mass_kg, double stiffness_npm, double damping_nspm) {
  const double damping_ratio = damping_nspm / (2.0 * std::sqrt(stiffness_npm * mass_kg));
  return std::sqrt(stiffness_npm / mass_kg) * std::sqrt(1.0 - damping_ratio * damping_ratio);
}

std::vector<double> filtered_velocity(const std::vector<double>& time_s,
                                      const std::vector<double>& height_m) {
  std::vector<double> v(height_m.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::size_t from = i > 0 ? i - 1 : 0, to = std::min(i + 1, v.size() - 1);
    v[i] = (height_m[to] - height_m[from]) / (time_s[to] - time_s[from]);
  }
  // 1 / ((s + 1) (s^2 + s + 1)) by the bilinear transform, at the rate of the rows: a first-order and a
  // second-order section, each started at rest on its first value.
  const double rate_hz = static_cast<double>(v.size() - 1) / (time_s.back() - time_s.front());
  const double c = 1.0 / std::tan(std::numbers::pi * 15.0 / rate_hz);
  const auto pass = [c](std::vector<double>& x) {
    double before = x.front(), out = before;
    for (double& now : x) {
      out = (now + before + (c - 1.0) * out) / (c + 1.0);
      before = now;
      now = out;
    }
    double x1 = x.front(), x2 = x1, y1 = x1, y2 = x1;
    for (double& now : x) {
      const double y =
          (now + 2.0 * x1 + x2 - (2.0 - 2.0 * c * c) * y1 - (c * c - c + 1.0) * y2) / (c * c + c + 1.0);
      x2 = x1;
      x1 = now;
      y2 = y1;
      y1 = y;
      now = y;
    }
  };
  pass(v);
  std::reverse(v.begin(), v.end());
  pass(v);
  std::reverse(v.begin(), v.end());
  return v;
}

IdentificationStudy run_identification_study(const StudyOptions& o) {
  const auto tell = [&](double fraction, std::string_view doing) {
    if (o.progress) o.progress(fraction, doing);
  };
  IdentificationStudy out;
  tell(0.0, "recordings");
  out.rig = draw_rig(o.seed, o.stances, o.flights, o.change);
  const VirtualRig& rig = out.rig;
  const double from_s = now_s();

  tell(0.05, "stance");
  model::Model linear = believed(rig, dynamics::kKindOf<dynamics::machines::HopperLinear>);
  const Data stances = one_window_each(rig.stance_logs, linear, identify::stances, 0, "stance");
  model::Model of_stance = linear;
  set_free(of_stance, "mass_kg", 0.5, 3.0);
  set_free(of_stance, "damping_stance_nspm", 0.0, 50.0);
  out.stance = of_phase("stance", false, of_stance, stances, stances, o.stance_folds, o.threads);
  const Data raw = with_velocity(stances, recorded_velocity);
  const auto judged = [](const model::Model& m) {
    return [m, unknowns = identify::free_unknowns(m)](const std::vector<double>& values, std::size_t i,
                                                      const Data& d, Start start) {
      const model::Model fitted = identify::with_values(m, unknowns, values);
      return predicted(fitted, fitted, d, d.windows[i], start);
    };
  };
  out.stance.otherwise =
      judged_otherwise(out.stance, stances, raw, "the velocity that the rig records", judged(of_stance));
  out.recorded_delay_s = recorded_delay_s(stances);
  if (o.equation) {
    out.stance_by_equation = of_phase("stance", true, of_stance, stances, stances, o.stance_folds, o.threads);
    out.stance_by_equation_raw = of_phase("stance", true, of_stance, raw, stances, o.stance_folds, o.threads);
    for (const double delay_s : {0.5e-3, 1e-3, 1.5e-3, 2e-3, 2.5e-3}) {
      const Data late = with_velocity(stances, [&](const Recording& r) { return late_velocity(r, delay_s); });
      const Estimates e = of_phase("stance", true, of_stance, late, stances, o.stance_folds, o.threads);
      double nmse = 0.0;
      for (const TrajectoryErrors& t : e.errors)
        nmse += (t.nmse_height + t.nmse_velocity) / static_cast<double>(e.errors.size());
      const double damping = e.value("damping_stance_nspm");
      out.equation_by_delay.push_back(
          {delay_s, damping, damped_frequency_radps(e.value("mass_kg"), rig.stiffness_npm, damping), nmse});
    }
  }
  for (const auto& freed : {std::vector<const char*>{"mass_kg"}, std::vector<const char*>{"stiffness_npm"},
                            std::vector<const char*>{"mass_kg", "stiffness_npm"}}) {
    model::Model m = linear;
    set_free(m, "damping_stance_nspm", 0.0, 50.0);
    std::string what;
    for (const char* name : freed) {
      set_free(m, name, 0.3 * m.parameter(name), 3.0 * m.parameter(name));
      what += (what.empty() ? "" : ", ") + std::string(name);
    }
    const auto unknowns = identify::free_unknowns(m);
    const model::Model fitted = identify::with_values(
        m, unknowns,
        identify::fit_by_simulation(m, unknowns, identify::values_in(m, unknowns), stances.recordings,
                                    stances.windows, identify::Weighting::nmse)
            .values);
    const double mass = fitted.parameter("mass_kg"), stiffness = fitted.parameter("stiffness_npm"),
                 damping = fitted.parameter("damping_stance_nspm");
    out.variants.push_back({what, mass, stiffness, damping, damped_frequency_radps(mass, stiffness, damping),
                            mean_nmse(fitted, fitted, stances)});
  }

  tell(0.3, "flight");
  model::Model of_flight = linear;
  set_free(of_flight, "damping_flight_nspm", 0.0, 20.0);
  const Data flights = one_window_each(rig.flight_logs, linear, identify::flights, 1, "flight");
  out.flight = of_phase("flight", false, of_flight, flights, flights, o.flight_folds, o.threads);
  constexpr const char* kFiltered = "a velocity filtered at 15 Hz as the document's";
  out.flight.otherwise = judged_otherwise(out.flight, flights, with_velocity(flights, velocity_of_15_hz),
                                          kFiltered, judged(of_flight));
  if (o.equation)
    out.flight_by_equation = of_phase("flight", true, of_flight, flights, flights, o.flight_folds, o.threads);

  {
    const model::Model& t = rig.truth;
    out.effective_stance_mass_kg = effective_mass_kg(
        {t.parameter("inertia_a_kgm2"), t.parameter("inertia_b_kgm"), t.parameter("inertia_e_kgm"),
         t.parameter("link_length_m"), t.parameter("mass_kg")},
        stances);
    constexpr double kWeighedKg = 1.62;
    const auto table = table_parameters();
    dynamics::Links<double> links{table.inertia_a_kgm2, table.inertia_b_kgm, table.inertia_e_kgm,
                                  table.link_length_m, kWeighedKg};
    out.table_mass_ratio = effective_mass_kg(links, stances) / kWeighedKg;
    links.a = links_of_section_3_2_2(0.075, 0.0194).a;
    out.printed_links_mass_ratio = effective_mass_kg(links, stances) / kWeighedKg;
  }
  {
    const model::Model fitted =
        identify::with_values(of_flight, identify::free_unknowns(of_flight), out.flight.values);
    for (const Window& w : flights.windows) {
      const auto floor = identify::noise_floor(fitted, flights.recordings, {w},
                                               identify::start_states(flights.recordings, {w}, fitted));
      out.flight_floor.push_back({floor.at("height").nmse, floor.at("velocity").nmse});
    }
  }
  out.equivalent_flight_damping_nspm = equivalent_flight_damping_nspm(rig.truth, flights);

  tell(0.4, "whole strides");
  model::Model whole = linear;
  set(whole, "mass_kg", out.stance.value("mass_kg"));
  set(whole, "damping_stance_nspm", out.stance.value("damping_stance_nspm"));
  set(whole, "damping_flight_nspm", out.flight.value("damping_flight_nspm"));
  set_free(whole, "restitution_touchdown", 0.3, 1.2);
  set_free(whole, "restitution_liftoff", 0.3, 1.2);
  const Data strides{stances.recordings,
                     one_window_each(rig.stance_logs, linear, identify::strides, 0, "stride").windows};
  const auto unknowns = identify::free_unknowns(whole);
  out.strides = cross_validate(
      "stride", "simulation", unknowns, {0.9, 1.0}, strides.windows, o.stance_folds, o.threads,
      [&](const std::vector<double>& start, const std::vector<Window>& windows) {
        return fit_strides(whole, unknowns, start, strides, windows, rig.stance_experiments);
      },
      [&](const std::vector<double>& values, std::size_t i) {
        const Window& w = strides.windows[i];
        const Recording& r = strides.recordings[w.recording];
        return errors_of(r, w,
                         stride(identify::with_values(whole, unknowns, values), r, w,
                                rig.stance_experiments[w.recording]));
      });
  out.strides.otherwise =
      judged_otherwise(out.strides, strides, with_velocity(strides, velocity_of_15_hz), kFiltered,
                       [&](const std::vector<double>& values, std::size_t i, const Data& d, Start start) {
                         const Window& w = d.windows[i];
                         const Recording& r = d.recordings[w.recording];
                         return errors_of(r, w,
                                          stride(identify::with_values(whole, unknowns, values), r, w,
                                                 rig.stance_experiments[w.recording], start));
                       });
  for (const Window& w : strides.windows) {
    const Recording& r = strides.recordings[w.recording];
    std::size_t i = w.first;
    while (i < w.last && r.input[i] == 0.0) ++i;
    out.stride_torque_late_s.push_back(r.time_s[i] - r.time_s[w.touchdown]);
  }
  {
    const auto worse = [](const TrajectoryErrors& a, const TrajectoryErrors& b) {
      return a.nmse_height + a.nmse_velocity < b.nmse_height + b.nmse_velocity;
    };
    const auto [best, worst] =
        std::minmax_element(out.strides.errors.begin(), out.strides.errors.end(), worse);
    for (const auto it : {best, worst}) {
      const auto i = static_cast<std::size_t>(it - out.strides.errors.begin());
      const Window& w = strides.windows[i];
      const Recording& r = strides.recordings[w.recording];
      const auto& values = out.strides.folds[i % o.stance_folds];
      const auto begin = static_cast<std::ptrdiff_t>(w.first), end = static_cast<std::ptrdiff_t>(w.last) + 1;
      out.good_and_poor.push_back(
          {r.name,
           {r.time_s.begin() + begin, r.time_s.begin() + end},
           {r.position.begin() + begin, r.position.begin() + end},
           stride(identify::with_values(whole, unknowns, values), r, w, rig.stance_experiments[w.recording])
               .position});
    }
  }

  tell(0.6, "non-linear model");
  model::Model nonlinear = believed(rig, dynamics::kKindOf<dynamics::machines::HopperNonlinear>);
  set(nonlinear, "damping_flight_nspm", out.flight.value("damping_flight_nspm"));
  set(nonlinear, "inertia_a_kgm2", 42e-4);  // table 3.1
  set(nonlinear, "inertia_b_kgm", 75e-4);
  set(nonlinear, "inertia_e_kgm", 38e-3);
  set_free(nonlinear, "mass_kg", 1.0, 3.0);
  set_free(nonlinear, "stiffness_npm", 400.0, 900.0);
  set_free(nonlinear, "damping_stance_nspm", 0.0, 50.0);
  set_free(nonlinear, "inertia_a_kgm2", 0.0, 0.05);
  set_free(nonlinear, "inertia_b_kgm", 0.0, 0.1);
  set_free(nonlinear, "inertia_e_kgm", 0.0, 0.3);
  const Data turning = one_window_each(rig.stance_logs, nonlinear, identify::stances, 0, "stance");
  if (o.nonlinear) {
    out.nonlinear =
        of_phase("stance, non-linear", false, nonlinear, turning, turning, o.stance_folds, o.threads);
    const auto free = identify::free_unknowns(nonlinear);
    const model::Model fitted = identify::with_values(nonlinear, free, out.nonlinear.values);
    model::Model heavier = fitted;
    const auto direction = toe_mass(fitted.parameter("link_length_m"));
    for (std::size_t i = 0; i < 4; ++i)
      set(heavier, kToeNames[i], fitted.parameter(kToeNames[i]) + 0.1 * direction[i]);
    const auto cost = [&](const model::Model& m, const std::vector<Unknown>& moved) {
      return identify::fit_by_simulation(m, moved, identify::values_in(m, moved), turning.recordings,
                                         turning.windows, identify::Weighting::nmse)
          .squares;
    };
    const double fitted_cost = cost(fitted, {});
    out.toe_mass_cost_change = std::abs(cost(heavier, {}) / fitted_cost - 1.0);
    model::Model without = nonlinear;
    for (const char* name : {"inertia_a_kgm2", "inertia_b_kgm"}) {
      set(without, name, 0.0);
      without.free.erase(index_of(without, name));
    }
    out.nmse_of_a_and_b = (cost(without, identify::free_unknowns(without)) - fitted_cost) /
                          static_cast<double>(turning.windows.size());
    out.b_at_bound = identify::at_bounds(out.nonlinear.values, free)[out.nonlinear.index("inertia_b_kgm")] ||
                     out.nonlinear.value("inertia_b_kgm") < 1e-4;
  }
  out.seconds = now_s() - from_s;

  if (o.plain) {
    tell(0.85, "the plain way");
    out.plain.push_back(plain_study("stance", of_stance, stances, o.stance_folds));
    out.plain.push_back(plain_study("flight", of_flight, flights, o.flight_folds));
    out.plain.push_back(plain_study("stance, non-linear", nonlinear, turning, o.stance_folds));
  }
  out.rig.stance_logs.clear();
  out.rig.flight_logs.clear();
  tell(1.0, "done");
  return out;
}

}  // namespace furcula::reproduce
