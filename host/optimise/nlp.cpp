#include "host/optimise/nlp.hpp"

#include <IpIpoptApplication.hpp>
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpTNLP.hpp>
#include <algorithm>
#include <cmath>

namespace furcula::optimise {
namespace {

/// The programme as Ipopt asks for it. Row 0 is its objective, row i + 1 its constraint i.
class ForIpopt final : public Ipopt::TNLP {
 public:
  using Index = Ipopt::Index;
  using Number = Ipopt::Number;

  ForIpopt(Nlp& nlp, const SolveOptions& options) : p_(nlp), options_(options) {
    const Triplets& linear = p_.linear();
    for (std::size_t k = 0; k < linear.row.size(); ++k)
      if (linear.row[k] == 0)
        objective_.emplace_back(linear.column[k], linear.value[k]);
      else
        constants_.push_back(k);
    Triplets jacobian;
    for (const auto& e : p_.elements()) e->places(jacobian, hessian_);
    for (std::size_t k = 0; k < jacobian.row.size(); ++k)
      if (jacobian.row[k] == 0)
        objective_entries_.emplace_back(k, jacobian.column[k]);
      else
        entries_.push_back(k);
    all_ = std::move(jacobian);
    values_.resize(all_.row.size());
  }

  Solution solution;

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = static_cast<Index>(p_.variables().size());
    m = static_cast<Index>(p_.rows().size()) - 1;
    jacobian = static_cast<Index>(entries_.size() + constants_.size());
    hessian = static_cast<Index>(hessian_.row.size());
    style = C_STYLE;
    return true;
  }
  bool get_bounds_info(Index n, Number* lower, Number* upper, Index m, Number* row_lower,
                       Number* row_upper) override {
    for (Index i = 0; i < n; ++i) {
      lower[i] = p_.variables()[static_cast<std::size_t>(i)].lower;
      upper[i] = p_.variables()[static_cast<std::size_t>(i)].upper;
    }
    for (Index i = 0; i < m; ++i) {
      row_lower[i] = p_.rows()[static_cast<std::size_t>(i) + 1].lower;
      row_upper[i] = p_.rows()[static_cast<std::size_t>(i) + 1].upper;
    }
    return true;
  }
  bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool, Number*) override {
    for (Index i = 0; i < n; ++i) x[i] = p_.variables()[static_cast<std::size_t>(i)].start;
    return true;
  }
  bool eval_f(Index n, const Number* x, bool fresh, Number& value) override {
    evaluate(n, x, fresh);
    value = rows_[0];
    return std::isfinite(value);
  }
  bool eval_g(Index n, const Number* x, bool fresh, Index m, Number* g) override {
    evaluate(n, x, fresh);
    std::copy_n(rows_.begin() + 1, m, g);
    return std::all_of(g, g + m, [](double v) { return std::isfinite(v); });
  }
  bool eval_grad_f(Index n, const Number* x, bool fresh, Number* gradient) override {
    differentiate(n, x, fresh);
    std::fill_n(gradient, n, 0.0);
    for (const auto& [variable, factor] : objective_) gradient[variable] += factor;
    for (const auto& [k, variable] : objective_entries_) gradient[variable] += values_[k];
    return true;
  }
  bool eval_jac_g(Index n, const Number* x, bool fresh, Index, Index, Index* rows, Index* columns,
                  Number* values) override {
    const Triplets& linear = p_.linear();
    if (values == nullptr) {
      for (const std::size_t k : entries_) {
        *rows++ = all_.row[k] - 1;
        *columns++ = all_.column[k];
      }
      for (const std::size_t k : constants_) {
        *rows++ = linear.row[k] - 1;
        *columns++ = linear.column[k];
      }
      return true;
    }
    differentiate(n, x, fresh);
    for (const std::size_t k : entries_) *values++ = values_[k];
    for (const std::size_t k : constants_) *values++ = linear.value[k];
    return true;
  }
  bool eval_h(Index, const Number* x, bool, Number objective, Index m, const Number* multipliers, bool, Index,
              Index* rows, Index* columns, Number* values) override {
    if (values == nullptr) {
      std::copy(hessian_.row.begin(), hessian_.row.end(), rows);
      std::copy(hessian_.column.begin(), hessian_.column.end(), columns);
      return true;
    }
    std::vector<double> by{objective};
    by.insert(by.end(), multipliers, multipliers + m);
    for (const auto& e : p_.elements()) {
      e->derivatives(x, by.data(), nullptr, values);
      values += e->hessian_entries();
    }
    return true;
  }
  bool intermediate_callback(Ipopt::AlgorithmMode, Index iteration, Number cost, Number violation, Number,
                             Number, Number, Number, Number, Number, Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    solution.iterations = iteration;
    return !options_.progress || options_.progress(iteration, cost, violation);
  }
  void finalize_solution(Ipopt::SolverReturn, Index n, const Number* x, const Number*, const Number*, Index,
                         const Number*, const Number*, Number cost, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    solution.x.assign(x, x + n);
    solution.cost = cost;
  }

 private:
  void evaluate(Index n, const Number* x, bool fresh) {
    if (!fresh && !rows_.empty()) return;
    rows_ = p_.evaluate(std::vector<double>(x, x + n));
    differentiated_ = false;
  }
  void differentiate(Index n, const Number* x, bool fresh) {
    if (fresh) evaluate(n, x, true);
    if (differentiated_) return;
    double* at = values_.data();
    for (const auto& e : p_.elements()) {
      e->derivatives(x, nullptr, at, nullptr);
      at += e->jacobian_entries();
    }
    differentiated_ = true;
  }

  Nlp& p_;
  const SolveOptions& options_;
  std::vector<std::pair<int, double>> objective_;
  std::vector<std::pair<std::size_t, int>> objective_entries_;
  std::vector<std::size_t> constants_, entries_;
  Triplets all_, hessian_;
  std::vector<double> rows_, values_;
  bool differentiated_ = false;
};

const char* word(Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case Ipopt::Solve_Succeeded:
      return "solved";
    case Ipopt::Solved_To_Acceptable_Level:
      return "solved to an acceptable level";
    case Ipopt::Infeasible_Problem_Detected:
      return "infeasible";
    case Ipopt::Maximum_Iterations_Exceeded:
      return "too many iterations";
    case Ipopt::Maximum_CpuTime_Exceeded:
      return "too long";
    case Ipopt::Restoration_Failed:
      return "no way back to the constraints";
    case Ipopt::User_Requested_Stop:
      return "stopped";
    case Ipopt::Diverging_Iterates:
      return "diverged";
    case Ipopt::Search_Direction_Becomes_Too_Small:
      return "steps too small";
    default:
      return "failed";
  }
}

}  // namespace

void WholeElement::values(const double* x, double* rows) const {
  std::vector<double> out(rows_, 0.0);
  f_(x, out.data(), nullptr);
  for (std::size_t i = 0; i < rows_; ++i) rows[i] += out[i];
}
void WholeElement::places(Triplets& jacobian, Triplets&) const {
  for (std::size_t r = 0; r < rows_; ++r)
    for (std::size_t v = 0; v < variables_; ++v) {
      jacobian.row.push_back(static_cast<int>(r));
      jacobian.column.push_back(static_cast<int>(v));
    }
}
void WholeElement::derivatives(const double* x, const double*, double* jacobian, double*) const {
  if (jacobian == nullptr) return;
  std::vector<double> out(rows_, 0.0);
  f_(x, out.data(), jacobian);
}

std::vector<double> Nlp::evaluate(const std::vector<double>& x) const {
  std::vector<double> out(rows_.size(), 0.0);
  for (std::size_t k = 0; k < linear_.row.size(); ++k)
    out[static_cast<std::size_t>(linear_.row[k])] +=
        linear_.value[k] * x[static_cast<std::size_t>(linear_.column[k])];
  for (const auto& e : elements_) e->values(x.data(), out.data());
  return out;
}

Solution solve(Nlp& nlp, const SolveOptions& options) {
  Ipopt::SmartPtr<ForIpopt> problem = new ForIpopt(nlp, options);
  Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt = new Ipopt::IpoptApplication(false);
  const auto set = ipopt->Options();
  set->SetStringValue("sb", "yes");
  set->SetIntegerValue("print_level", 0);
  set->SetStringValue("linear_solver", "mumps");
  set->SetIntegerValue("max_iter", options.iterations);
  set->SetNumericValue("tol", options.tolerance);
  set->SetNumericValue("constr_viol_tol", 1e-9);
  set->SetNumericValue("acceptable_tol", 1e-5);
  set->SetNumericValue("acceptable_constr_viol_tol", 1e-8);
  set->SetIntegerValue("acceptable_iter", 10);
  set->SetNumericValue("max_cpu_time", options.cpu_s);
  set->SetStringValue("mu_strategy", options.monotone ? "monotone" : "adaptive");
  set->SetNumericValue("bound_relax_factor", 0.0);
  if (!nlp.has_hessian()) {
    set->SetStringValue("hessian_approximation", "limited-memory");
    set->SetIntegerValue("limited_memory_max_history", 30);
  }
  if (options.barrier < 0.1) {
    set->SetStringValue("mu_strategy", "monotone");
    set->SetNumericValue("mu_init", options.barrier);
    set->SetNumericValue("bound_push", options.barrier);
    set->SetNumericValue("bound_frac", options.barrier);
    set->SetNumericValue("slack_bound_push", options.barrier);
    set->SetNumericValue("slack_bound_frac", options.barrier);
  }
  ipopt->Initialize();
  const Ipopt::ApplicationReturnStatus status = ipopt->OptimizeTNLP(problem);
  Solution& s = problem->solution;
  s.status = word(status);
  s.found = status == Ipopt::Solve_Succeeded || status == Ipopt::Solved_To_Acceptable_Level;
  if (!s.x.empty()) {
    const std::vector<double> rows = nlp.evaluate(s.x);
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const Nlp::Row& r = nlp.rows()[i];
      const double by = std::max(r.lower - rows[i], rows[i] - r.upper);
      // What only defines the cost can always be met, and says nothing about the task.
      if (by <= s.violation || r.what == kCostRow) continue;
      s.violation = by;
      s.worst = r.what;
    }
  }
  return std::move(s);
}

}  // namespace furcula::optimise
