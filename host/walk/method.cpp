#include "host/walk/method.hpp"

#include "host/walk/cma_es_restarts.hpp"

namespace furcula::walk {

std::unique_ptr<Method> make_method(MethodKind kind, const Eigen::VectorXd& least,
                                    const Eigen::VectorXd& /*most*/, std::uint64_t seed) {
  switch (kind) {
    case MethodKind::cmaes: break;
  }
  return std::make_unique<CmaEsRestarts>(least.size(), seed);
}

}  // namespace furcula::walk
