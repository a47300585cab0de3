// The leg's part of a machine: its toe on the ground, and the spring at its knee.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/hidden/trees/machine.hpp"

namespace furcula::hidden::trees {
namespace {

constexpr double kGuard_s = 0.5e-3;  // after an event there is no other

// Where f, which falls from f(0) = `first` > 0 to f(end) = `last` <= 0, is zero (Illinois).
template <typename F>
double root(double end, double first, double last, double close_to, F&& f) {
  double low = 0.0, high = end, x = end;
  for (int i = 0; i < 60; ++i) {
    x = low + (high - low) * first / (first - last);
    const double now = f(x);
    if (std::fabs(now) < close_to) break;
    if (now > 0.0) {
      low = x;
      first = now;
      last /= 2;
    } else {
      high = x;
      last = now;
      first /= 2;
    }
  }
  return x;
}

}  // namespace

Point Machine::toe(const State& s) const {
  return dynamics_.point(robot_.leg->knee, robot_.leg->toe_m, s.q, s.v);
}

double Machine::height_m(const State& s) const { return toe(s).at.z - s.ground_m; }

Pinned Machine::pinned(const Matrix& mass, const State& s, const Modes& modes, Pair& drift) const {
  Pinned out(mass, size());
  if (!s.stance) return out;
  const Point p = toe(s);
  Values x{}, z{};
  for (std::size_t j = 0; j < size(); ++j) {
    if (modes[j] == Mode::held) continue;
    x[j] = p.move[j].x;
    z[j] = p.move[j].z;
  }
  drift = {p.a.x, p.a.z};
  out.hold(x, z);
  return out;
}

Pair Machine::ground_force(const State& s, double t, const Values& input, const Values& disturbance) const {
  return s.stance ? rates(s, t, input, disturbance, modes(s, t, input, disturbance)).force : Pair{};
}

void Machine::stop_toe(State& s) const {
  Matrix mass;
  Values bias{};
  mass_and_bias(s, mass, bias);
  Pinned solver(mass, size());
  const Point p = toe(s);
  Values x{}, z{};
  for (std::size_t j = 0; j < size(); ++j) {
    x[j] = p.move[j].x;
    z[j] = p.move[j].z;
  }
  solver.hold(x, z);
  const Pinned::Solution change = solver.solve({}, {p.v.x, p.v.z});
  for (std::size_t j = 0; j < size(); ++j) s.v[j] += change.a[j];
  s.impulse_ns = change.force;
}

void Machine::stand(State& s) const {
  const Point p = toe(s);
  s.toe_m = {p.at.x, p.at.z};
  stop_toe(s);
}

double Machine::stretch_rad(const State& s) const {
  const Leg& leg = *robot_.leg;
  if (leg.switched && !(s.stance && s.caught)) return 0.0;
  return std::max(s.q[leg.knee] - (leg.switched ? s.rest_rad : leg.rest_rad), 0.0);
}

double Machine::knee_torque(const State& s) const {
  return -robot_.leg->spring_nmprad * stretch_rad(s) - (s.stance ? 0.0 : switch_.second_nm);
}

double Machine::spring_energy_j(const State& s) const {
  const double stretch = stretch_rad(s);
  return 0.5 * robot_.leg->spring_nmprad * stretch * stretch;
}

void Machine::catch_spring(State& s) const {
  s.caught = true;
  s.rest_rad = s.q[robot_.leg->knee] + switch_.offset_rad;
}

double Machine::next_catch_s(const State& s) const {
  const bool waits = robot_.leg->switched && s.stance && !s.caught;
  return waits ? s.touch_down_s + switch_.delay_s : std::numeric_limits<double>::infinity();
}

void Machine::touch_down(State& s, double t) const {
  stand(s);
  const std::size_t knee = robot_.leg->knee;
  s.stance = true;
  s.caught = false;
  s.touch_down_s = t;
  s.touch_down_rad = s.q[knee];
  s.touch_down_radps = s.v[knee];
  if (robot_.leg->switched && switch_.delay_s <= 0.0) catch_spring(s);
}

void Machine::lift_off(State& s, double t) const {
  s.stance = s.caught = false;
  s.lift_off_s = t;
}

bool Machine::would_rise(const State& s, double t, const Values& input, const Values& disturbance) const {
  State free = s;
  free.stance = free.caught = false;
  const Values a = acceleration(free, t, input, disturbance);
  const Point p = toe(free);
  double rises = p.a.z;
  for (std::size_t j = 0; j < size(); ++j) rises += p.move[j].z * a[j];
  return rises > 0.0;
}

// What a step of the integration leaves: nanometres. Joints at rest in dry friction stay.
void Machine::stay_put(State& s) const {
  const Point p = toe(s);
  const Pair away{p.at.x - s.toe_m.x, p.at.z - s.toe_m.z};
  if (std::hypot(away.x, away.z) < 1e-10 && std::hypot(p.v.x, p.v.z) < 1e-9) return;
  Matrix mass;
  Values bias{}, x{}, z{};
  mass_and_bias(s, mass, bias);
  for (std::size_t j = 0; j < size(); ++j) {
    if (acts_[j].dry() && s.v[j] == 0.0) {
      for (std::size_t k = 0; k < size(); ++k) mass[j][k] = mass[k][j] = 0.0;
      mass[j][j] = 1.0;
      continue;
    }
    x[j] = p.move[j].x;
    z[j] = p.move[j].z;
  }
  Pinned solver(mass, size());
  solver.hold(x, z);
  const Values back = solver.solve({}, away).a, slower = solver.solve({}, {p.v.x, p.v.z}).a;
  for (std::size_t j = 0; j < size(); ++j) {
    s.q[j] += back[j];
    s.v[j] += slower[j];
  }
}

double Machine::with_contact(const State& s, State& next, double t, double reached, const Values& input,
                             const Values& disturbance, const Modes& modes) const {
  const auto after = [&](double by) {
    State out = stepped(s, t, by, input, disturbance, modes);
    if (out.stance) stay_put(out);
    return out;
  };
  if (s.stance) stay_put(next);
  if (s.phase_kept) return reached;

  if (!s.stance) {
    if (t + reached < s.lift_off_s + kGuard_s || height_m(next) >= 0.0 || toe(next).v.z >= 0.0)
      return reached;
    const double first = height_m(s);
    // Below the ground since it left: at once.
    double by = reached;
    if (first > 0.0) {
      by = root(reached, first, height_m(next), 1e-12, [&](double x) { return height_m(after(x)); });
      next = after(by);
    }
    touch_down(next, t + by);
    return by;
  }

  if (t + reached < s.touch_down_s + kGuard_s) return reached;
  const auto upwards = [&](const State& at, double when) {
    return ground_force(at, when, input, disturbance).z;
  };
  const double first = upwards(s, t);
  if (first <= 0.0) {
    if (!would_rise(s, t, input, disturbance)) return reached;
    next = s;
    lift_off(next, t);
    return 0.0;
  }
  const double last = upwards(next, t + reached);
  if (last > 0.0) return reached;
  const double by = root(reached, first, last, 1e-9, [&](double x) { return upwards(after(x), t + x); });
  const State left = after(by);
  if (!would_rise(left, t + by, input, disturbance)) return reached;
  next = left;
  lift_off(next, t + by);
  return by;
}

}  // namespace furcula::hidden::trees
