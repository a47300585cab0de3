#include "host/walk/method.hpp"

#include "host/walk/cma_es_restarts.hpp"
#include "host/walk/esch.hpp"
#include "host/walk/mutation_nelder_mead.hpp"

namespace furcula::walk {

std::unique_ptr<Method> make_method(MethodKind kind, const Eigen::VectorXd& least,
                                    const Eigen::VectorXd& most, std::uint64_t seed) {
  switch (kind) {
    case MethodKind::esch:
      return std::make_unique<Esch>(least, most, seed);
    case MethodKind::mutation:
      return std::make_unique<MutationNelderMead>(least, most, seed);
    case MethodKind::cmaes:
      break;
  }
  return std::make_unique<CmaEsRestarts>(least.size(), seed);
}

}  // namespace furcula::walk
