#include "host/trees/search_state.hpp"

namespace furcula::trees {

std::set<std::string> names(const TreeModel& model, const Hypothesis& at) {
  std::set<std::string> out;
  for (const Cause& c : at.causes) out.insert(cause_name(model, c));
  return out;
}

}  // namespace furcula::trees
