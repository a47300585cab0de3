#include "host/optimise/graph.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace furcula::optimise {
namespace {

using Operation = Graph::Operation;
using Step = Graph::Step;

/// What is being recorded. The same operation on the same numbers is written down once.
struct Recording {
  std::vector<Step> steps;
  std::map<std::tuple<Operation, std::int32_t, std::int32_t, double>, std::int32_t> known;

  Recorded add(Operation what, std::int32_t a, std::int32_t b = -1, double constant = 0.0) {
    if ((what == Operation::add || what == Operation::multiply) && b < a) std::swap(a, b);
    const auto [place, fresh] =
        known.try_emplace({what, a, b, constant}, static_cast<std::int32_t>(steps.size()));
    if (fresh) steps.push_back({what, a, b, constant});
    Recorded out;
    out.at = place->second;
    return out;
  }
};
thread_local Recording* recording = nullptr;

Recording& current() {
  if (recording == nullptr) throw std::logic_error("a Recorded number outside of a recording");
  return *recording;
}
bool constant(const Recorded& x) { return x.at < 0; }

}  // namespace

Recorded operator+(const Recorded& x, const Recorded& y) {
  if (constant(x) && constant(y)) return x.constant + y.constant;
  if (constant(x)) return y + x;
  if (!constant(y)) return current().add(Operation::add, x.at, y.at);
  return y.constant == 0.0 ? x : current().add(Operation::shift, x.at, -1, y.constant);
}
Recorded operator-(const Recorded& x, const Recorded& y) {
  if (constant(y)) return x + Recorded(-y.constant);
  if (constant(x)) return -y + x;
  return current().add(Operation::subtract, x.at, y.at);
}
Recorded operator*(const Recorded& x, const Recorded& y) {
  if (constant(x) && constant(y)) return x.constant * y.constant;
  if (constant(x)) return y * x;
  if (!constant(y)) return current().add(Operation::multiply, x.at, y.at);
  if (y.constant == 0.0) return 0.0;
  return y.constant == 1.0 ? x : current().add(Operation::scale, x.at, -1, y.constant);
}
Recorded operator/(const Recorded& x, const Recorded& y) {
  if (constant(y)) return x * Recorded(1.0 / y.constant);
  return x * current().add(Operation::inverse, y.at);
}
Recorded operator-(const Recorded& x) { return x * Recorded(-1.0); }
Recorded sin(const Recorded& x) {
  return constant(x) ? Recorded(std::sin(x.constant)) : current().add(Operation::sine, x.at);
}
Recorded cos(const Recorded& x) {
  return constant(x) ? Recorded(std::cos(x.constant)) : current().add(Operation::cosine, x.at);
}
Recorded sqrt(const Recorded& x) {
  return constant(x) ? Recorded(std::sqrt(x.constant)) : current().add(Operation::root, x.at);
}

Graph::Graph(std::size_t inputs, const Function& f) : inputs_(inputs) {
  Recording all;
  std::vector<Recorded> in(inputs);
  for (std::size_t i = 0; i < inputs; ++i) {
    in[i].at = static_cast<std::int32_t>(i);
    all.steps.push_back({Operation::input, -1, -1, 0.0});
  }
  recording = &all;
  try {
    outputs_ = f(in);
  } catch (...) {
    recording = nullptr;
    throw;
  }
  recording = nullptr;

  // Only what an output hangs on is kept.
  std::vector<bool> needed(all.steps.size(), false);
  for (const Recorded& o : outputs_)
    if (o.at >= 0) needed[static_cast<std::size_t>(o.at)] = true;
  for (std::size_t i = all.steps.size(); i-- > 0;)
    if (needed[i])
      for (const std::int32_t from : {all.steps[i].a, all.steps[i].b})
        if (from >= 0) needed[static_cast<std::size_t>(from)] = true;
  std::vector<std::int32_t> now(all.steps.size(), -1);
  const auto moved = [&](std::int32_t at) { return at < 0 ? at : now[static_cast<std::size_t>(at)]; };
  for (std::size_t i = 0; i < all.steps.size(); ++i) {
    if (i >= inputs && !needed[i]) continue;
    now[i] = static_cast<std::int32_t>(steps_.size());
    Step s = all.steps[i];
    s.a = moved(s.a), s.b = moved(s.b);
    steps_.push_back(s);
  }
  for (Recorded& o : outputs_) o.at = moved(o.at);
}

void Graph::forwards(const double* x, std::vector<double>& v) const {
  v.resize(steps_.size());
  std::copy_n(x, inputs_, v.begin());
  for (std::size_t i = inputs_; i < steps_.size(); ++i) {
    const Step& s = steps_[i];
    const double a = v[static_cast<std::size_t>(s.a)];
    switch (s.what) {
      case Operation::input:
        break;
      case Operation::add:
        v[i] = a + v[static_cast<std::size_t>(s.b)];
        break;
      case Operation::subtract:
        v[i] = a - v[static_cast<std::size_t>(s.b)];
        break;
      case Operation::multiply:
        v[i] = a * v[static_cast<std::size_t>(s.b)];
        break;
      case Operation::scale:
        v[i] = a * s.constant;
        break;
      case Operation::shift:
        v[i] = a + s.constant;
        break;
      case Operation::inverse:
        v[i] = 1.0 / a;
        break;
      case Operation::sine:
        v[i] = std::sin(a);
        break;
      case Operation::cosine:
        v[i] = std::cos(a);
        break;
      case Operation::root:
        v[i] = std::sqrt(a);
        break;
    }
  }
}

namespace {

constexpr std::size_t kWide = 8;  // directions at once
struct Directions {
  double d[kWide];
};

/// The derivative of a step of one operand, and the one after it.
struct Slopes {
  double first, second;
};
Slopes slopes(const Step& s, double a, double value) {
  switch (s.what) {
    case Operation::scale:
      return {s.constant, 0.0};
    case Operation::shift:
      return {1.0, 0.0};
    case Operation::inverse:
      return {-value * value, 2.0 * value * value * value};
    case Operation::sine:
      return {std::cos(a), -value};
    case Operation::cosine:
      return {-std::sin(a), -value};
    case Operation::root:
      return {0.5 / value, -0.25 / (value * a)};
    default:
      return {0.0, 0.0};
  }
}

/// Derivatives of all steps in the directions of the inputs first to first + kWide - 1.
void tangents(const std::vector<Step>& steps, std::size_t inputs, const std::vector<double>& v,
              const std::vector<Slopes>& slope, std::size_t first, std::vector<Directions>& t) {
  for (std::size_t i = 0; i < inputs; ++i)
    for (std::size_t k = 0; k < kWide; ++k) t[i].d[k] = first + k == i ? 1.0 : 0.0;
  for (std::size_t i = inputs; i < steps.size(); ++i) {
    const Step& s = steps[i];
    const auto a = static_cast<std::size_t>(s.a), b = static_cast<std::size_t>(s.b);
    Directions out;
    if (s.b < 0) {
      const double by = slope[i].first;
      for (std::size_t k = 0; k < kWide; ++k) out.d[k] = by * t[a].d[k];
    } else if (s.what == Operation::multiply) {
      const double va = v[a], vb = v[b];
      for (std::size_t k = 0; k < kWide; ++k) out.d[k] = vb * t[a].d[k] + va * t[b].d[k];
    } else if (s.what == Operation::add) {
      for (std::size_t k = 0; k < kWide; ++k) out.d[k] = t[a].d[k] + t[b].d[k];
    } else {
      for (std::size_t k = 0; k < kWide; ++k) out.d[k] = t[a].d[k] - t[b].d[k];
    }
    t[i] = out;
  }
}

}  // namespace

void Graph::values(const double* x, double* out) const {
  thread_local std::vector<double> v;
  forwards(x, v);
  for (std::size_t m = 0; m < outputs_.size(); ++m) {
    const Recorded& o = outputs_[m];
    out[m] = o.at < 0 ? o.constant : v[static_cast<std::size_t>(o.at)];
  }
}

void Graph::jacobian(const double* x, double* out) const {
  thread_local std::vector<double> v;
  thread_local std::vector<Slopes> slope;
  thread_local std::vector<Directions> t;
  forwards(x, v);
  slope.resize(steps_.size());
  t.resize(steps_.size());
  for (std::size_t i = inputs_; i < steps_.size(); ++i)
    if (steps_[i].b < 0) slope[i] = slopes(steps_[i], v[static_cast<std::size_t>(steps_[i].a)], v[i]);
  for (std::size_t first = 0; first < inputs_; first += kWide) {
    tangents(steps_, inputs_, v, slope, first, t);
    const std::size_t many = std::min(kWide, inputs_ - first);
    for (std::size_t m = 0; m < outputs_.size(); ++m)
      for (std::size_t k = 0; k < many; ++k)
        out[m * inputs_ + first + k] =
            outputs_[m].at < 0 ? 0.0 : t[static_cast<std::size_t>(outputs_[m].at)].d[k];
  }
}

void Graph::hessian(const double* x, const double* by, double* out) const {
  thread_local std::vector<double> v, back;
  thread_local std::vector<Slopes> slope;
  thread_local std::vector<Directions> t, r;
  forwards(x, v);
  slope.resize(steps_.size());
  t.resize(steps_.size());
  r.resize(steps_.size());
  for (std::size_t i = inputs_; i < steps_.size(); ++i)
    if (steps_[i].b < 0) slope[i] = slopes(steps_[i], v[static_cast<std::size_t>(steps_[i].a)], v[i]);
  // Backwards: what the weighted sum changes by with each step's value.
  back.assign(steps_.size(), 0.0);
  for (std::size_t m = 0; m < outputs_.size(); ++m)
    if (outputs_[m].at >= 0) back[static_cast<std::size_t>(outputs_[m].at)] += by[m];
  for (std::size_t i = steps_.size(); i-- > inputs_;) {
    const Step& s = steps_[i];
    const auto a = static_cast<std::size_t>(s.a), b = static_cast<std::size_t>(s.b);
    if (s.b < 0) {
      back[a] += back[i] * slope[i].first;
    } else if (s.what == Operation::multiply) {
      const double va = v[a], vb = v[b];
      back[a] += back[i] * vb;
      back[b] += back[i] * va;
    } else {
      back[a] += back[i];
      back[b] += s.what == Operation::add ? back[i] : -back[i];
    }
  }
  // The same, and its derivatives in the directions.
  for (std::size_t first = 0; first < inputs_; first += kWide) {
    tangents(steps_, inputs_, v, slope, first, t);
    std::fill(r.begin(), r.end(), Directions{});
    for (std::size_t i = steps_.size(); i-- > inputs_;) {
      const Step& s = steps_[i];
      const auto a = static_cast<std::size_t>(s.a), b = static_cast<std::size_t>(s.b);
      const Directions here = r[i];
      const double w = back[i];
      if (s.b < 0) {
        const double p = slope[i].first, q = w * slope[i].second;
        for (std::size_t k = 0; k < kWide; ++k) r[a].d[k] += p * here.d[k] + q * t[a].d[k];
      } else if (s.what == Operation::multiply) {
        const double va = v[a], vb = v[b];
        for (std::size_t k = 0; k < kWide; ++k) r[a].d[k] += vb * here.d[k] + w * t[b].d[k];
        for (std::size_t k = 0; k < kWide; ++k) r[b].d[k] += va * here.d[k] + w * t[a].d[k];
      } else if (s.what == Operation::add) {
        for (std::size_t k = 0; k < kWide; ++k) r[a].d[k] += here.d[k];
        for (std::size_t k = 0; k < kWide; ++k) r[b].d[k] += here.d[k];
      } else {
        for (std::size_t k = 0; k < kWide; ++k) r[a].d[k] += here.d[k];
        for (std::size_t k = 0; k < kWide; ++k) r[b].d[k] -= here.d[k];
      }
    }
    const std::size_t many = std::min(kWide, inputs_ - first);
    for (std::size_t i = 0; i < inputs_; ++i)
      for (std::size_t k = 0; k < many; ++k) out[i * inputs_ + first + k] = r[i].d[k];
  }
}

GraphElement::GraphElement(std::shared_ptr<const Graph> graph, std::vector<Sum> inputs, std::vector<int> rows,
                           std::vector<double> factors)
    : graph_(std::move(graph)),
      sums_(std::move(inputs)),
      rows_(std::move(rows)),
      factors_(std::move(factors)) {
  if (sums_.size() != graph_->inputs() || rows_.size() != graph_->outputs() ||
      factors_.size() != graph_->outputs())
    throw std::logic_error("a graph of other inputs or outputs");
  for (Sum& sum : sums_)
    for (auto& [variable, factor] : sum) {
      const auto place = std::find(variables_.begin(), variables_.end(), variable);
      const auto at = place - variables_.begin();
      if (place == variables_.end()) variables_.push_back(variable);
      variable = static_cast<int>(at);
    }
  for (std::size_t m = 0; m < rows_.size(); ++m)
    if (rows_[m] >= 0) used_.push_back(m);
}

std::vector<double> GraphElement::inputs_at(const double* x) const {
  std::vector<double> z(sums_.size(), 0.0);
  for (std::size_t i = 0; i < sums_.size(); ++i)
    for (const auto& [place, factor] : sums_[i])
      z[i] += factor * x[variables_[static_cast<std::size_t>(place)]];
  return z;
}

void GraphElement::values(const double* x, double* rows) const {
  std::vector<double> out(graph_->outputs());
  graph_->values(inputs_at(x).data(), out.data());
  for (const std::size_t m : used_) rows[rows_[m]] += factors_[m] * out[m];
}

void GraphElement::places(Triplets& jacobian, Triplets& hessian) const {
  for (const std::size_t m : used_)
    for (const int v : variables_) {
      jacobian.row.push_back(rows_[m]);
      jacobian.column.push_back(v);
    }
  for (std::size_t i = 0; i < variables_.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      hessian.row.push_back(std::max(variables_[i], variables_[j]));
      hessian.column.push_back(std::min(variables_[i], variables_[j]));
    }
}

void GraphElement::derivatives(const double* x, const double* multipliers, double* jacobian,
                               double* hessian) const {
  const std::vector<double> z = inputs_at(x);
  const std::size_t n = z.size(), count = variables_.size();
  if (jacobian != nullptr) {
    std::vector<double> j(graph_->outputs() * n);
    graph_->jacobian(z.data(), j.data());
    for (const std::size_t m : used_) {
      std::fill_n(jacobian, count, 0.0);
      for (std::size_t i = 0; i < n; ++i)
        for (const auto& [place, factor] : sums_[i]) jacobian[place] += factors_[m] * factor * j[m * n + i];
      jacobian += count;
    }
  }
  if (hessian == nullptr) return;
  std::vector<double> by(graph_->outputs(), 0.0), h(n * n), half(n * count, 0.0), whole(count * count, 0.0);
  for (const std::size_t m : used_) by[m] = multipliers[rows_[m]] * factors_[m];
  graph_->hessian(z.data(), by.data(), h.data());
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      for (const auto& [place, factor] : sums_[j])
        half[i * count + static_cast<std::size_t>(place)] += factor * h[i * n + j];
  for (std::size_t i = 0; i < n; ++i)
    for (const auto& [place, factor] : sums_[i])
      for (std::size_t v = 0; v < count; ++v)
        whole[static_cast<std::size_t>(place) * count + v] += factor * half[i * count + v];
  for (std::size_t u = 0; u < count; ++u)
    for (std::size_t v = 0; v <= u; ++v) *hessian++ = whole[u * count + v];
}

}  // namespace furcula::optimise
