// CMA-ES that starts again where it has converged: each time with a quarter more walks, about the best walk or, every second time, from the
// start.
#pragma once

#include "host/walk/cma_es.hpp"
#include "host/walk/method.hpp"

namespace furcula::walk {

class CmaEsRestarts final : public Method {
 public:
  CmaEsRestarts(Eigen::Index size, std::uint64_t seed);

  const std::vector<Vector>& ask() override { return strategy_.ask(); }
  void tell(std::span<const double> values, const Vector& best) override;
  unsigned restarts() const override { return restarts_; }
  std::string state() const override;
  void restore(const std::string& state) override;

 private:
  void restart(const Vector& best);

  std::uint64_t seed_, waited_ = 0;
  CmaEs strategy_;
  double round_best_, last_better_;
  unsigned restarts_ = 0;
};

}  // namespace furcula::walk
