// See diagnosis.hpp.
#include "host/result/diagnosis.hpp"

namespace furcula::result {

std::string label(const Cause& cause) {
  std::string out = cause.effect.empty() ? cause.model_parameter : cause.effect;
  for (std::size_t i = 0; i < cause.locations.size(); ++i) out += (i == 0 ? "@" : ",") + cause.locations[i];
  return out;
}

std::string label(const std::vector<Cause>& causes) {
  std::string out;
  for (const Cause& c : causes) out += (out.empty() ? "" : " + ") + label(c);
  return out;
}

}  // namespace furcula::result
