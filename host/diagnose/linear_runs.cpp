#include "host/diagnose/linear_runs.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>

#include "host/identify/dual.hpp"
#include "host/identify/simulate.hpp"
#include "host/identify/unknowns.hpp"
#include "host/machines/hopper.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;
using identify::Dual;
using identify::Recording;
using identify::Window;

using Memory = std::vector<std::array<double, 3>>;

/// What a machine remembers of its positions, of a hopper of its leg's compression: means over the past, which is forgotten with these time
/// constants. A spring that creeps hangs on that.
constexpr std::array<double, 3> kMemory_s{0.05, 0.2, 0.8};
Memory remembered(const model::Model& model, const Recording& r) {
  const bool leg = dynamics::has(model.kind, dynamics::LocationType::leg);
  const double straight_m = leg ? machines::touchdown_height_m(model) : 0.0;
  Memory out(r.rows());
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const double seen =
        leg ? std::max(0.0, r.touchdown_height_m(i, straight_m) - r.position[i]) : r.position[i];
    for (std::size_t k = 0; k < kMemory_s.size(); ++k) {
      const double kept = i > 0 ? std::exp(-(r.time_s[i] - r.time_s[i - 1]) / kMemory_s[k]) : 0.0;
      out[i][k] = i > 0 ? kept * out[i - 1][k] + (1.0 - kept) * seen : leg ? 0.0 : seen;
    }
  }
  return out;
}

struct Cumulative {
  Eigen::Matrix2d start;
  Eigen::Vector2d force;
  double position, velocity;
};

std::vector<Cumulative> run(const model::Model& model, const Recording& r, const Window& w, double position,
                            double velocity) {
  const auto unknowns = identify::effect_unknowns(Effect::force_offset, model.kind);
  const auto on = model.effects.find(Effect::force_offset);
  const Dual<4> constant(on == model.effects.end() ? 0.0 : on->second[0], 0);
  const identify::PlantSetup<Dual<4>> setup(model, unknowns, &constant);
  std::vector<Cumulative> all;
  all.reserve(w.rows());
  identify::simulate(setup, r, w, Dual<4>(position, 1), Dual<4>(velocity, 2),
                     [&](std::size_t, const Dual<4>& x, const Dual<4>& v, const Dual<4>&, const auto&) {
                       Cumulative c;
                       c.start << x.derivative(1), x.derivative(2), v.derivative(1), v.derivative(2);
                       c.force << x.derivative(0), v.derivative(0);
                       c.position = x.a;
                       c.velocity = v.a;
                       all.push_back(c);
                     });
  return all;
}

/// Up to where it is stuck: from there on its start does not matter any more.
std::size_t free_rows(const std::vector<Cumulative>& run) {
  constexpr double kStuck = 1e-4;
  std::size_t rows = 0;
  while (rows < run.size() && std::isfinite(run[rows].position) &&
         std::abs(run[rows].start.determinant()) > kStuck)
    ++rows;
  return rows;
}

std::optional<LinearRun> linearised(const model::Model& model, const Recording& r, const Window& w,
                                    const Memory* memory) {
  constexpr std::size_t kFewestFreeRows = 20;
  constexpr double kBefore_s = 0.01;
  auto start = identify::start_state(r, w, model);
  std::vector<Cumulative> c;
  std::size_t rows = 0;
  for (int round = 0;; ++round) {
    c = run(model, r, w, start.position, start.velocity);
    rows = free_rows(c);
    if (rows < kFewestFreeRows) return std::nullopt;
    if (round == 2) break;
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < rows; ++i) {
      const Eigen::Vector2d row = c[i].start.row(0).transpose();
      normal += row * row.transpose();
      right += row * (r.position[w.first + i] - c[i].position);
    }
    const Eigen::Vector2d step = normal.completeOrthogonalDecomposition().solve(right);
    start.position += step(0);
    start.velocity += step(1);
  }
  LinearRun out;
  out.recording = w.recording;
  out.noise = r.position_noise;
  out.interval_s = (r.time_s[w.first + rows - 1] - r.time_s[w.first]) / static_cast<double>(rows - 1);
  std::size_t before = w.first;
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t row = w.first + i;
    out.left.push_back(r.position[row] - c[i].position);
    if (i + 1 == rows) break;
    const double dt = r.time_s[row + 1] - r.time_s[row];
    const Eigen::Matrix2d by = c[i + 1].start * c[i].start.inverse();
    out.by.push_back(by);
    out.force.push_back(c[i + 1].force - by * c[i].force);
    const bool stride = w.kind == identify::WindowKind::stride;
    const bool impact = stride && (row + 1 == w.touchdown || row + 1 == w.liftoff);
    out.impact_speed.push_back(impact ? std::abs(c[i].velocity) : 0.0);
    RunSample s;
    s.position = c[i].position;
    s.velocity = c[i].velocity;
    s.acceleration = (c[i + 1].velocity - c[i].velocity) / dt;
    s.input = r.input[row];
    s.input_rate = (r.input[row + 1] - r.input[row]) / dt;
    while (before < row && r.time_s[before + 1] <= r.time_s[row] - kBefore_s) ++before;
    s.input_before = r.input[before] - r.input[row];
    s.time_s = r.time_s[row] - r.time_s.front();
    if (memory != nullptr) s.remembered = (*memory)[row];
    if (stride && row >= w.touchdown && row < w.liftoff)
      s.since_touchdown_s = r.time_s[row] - r.time_s[w.touchdown];
    if (stride && row >= w.liftoff) s.since_liftoff_s = r.time_s[row] - r.time_s[w.liftoff];
    out.samples.push_back(s);
  }
  return out;
}

}  // namespace

std::optional<LinearRun> linearised(const model::Model& model, const Recording& r, const Window& w) {
  return linearised(model, r, w, nullptr);
}

std::vector<LinearRun> linearised(const model::Model& model, const std::vector<Recording>& recordings,
                                  const std::vector<Window>& windows) {
  std::vector<LinearRun> all;
  std::map<std::size_t, Memory> memory;
  for (const Window& w : windows) {
    const Recording& r = recordings[w.recording];
    const auto own = memory.try_emplace(w.recording);
    if (own.second) own.first->second = remembered(model, r);
    if (auto one = linearised(model, r, w, &own.first->second)) all.push_back(std::move(*one));
  }
  return all;
}

std::pair<double, const char*> typical_force(const model::Model& model, const std::vector<LinearRun>& runs) {
  if (const auto weight = machines::rules(model.kind).weight) return {weight(model), "the weight"};
  double inputs = 0, forces = 0, rows = 0;
  for (const LinearRun& w : runs)
    for (const RunSample& s : w.samples) {
      inputs += s.input * s.input;
      forces += std::pow(machines::rules(model.kind).inertia(model) * s.acceleration, 2);
      ++rows;
    }
  if (inputs > 0) return {std::sqrt(inputs / rows), "the input's root mean square"};
  return {std::sqrt(forces / std::max(rows, 1.0)), "the usual inertia force"};
}

}  // namespace furcula::diagnose
