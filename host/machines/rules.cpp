// The rules of a kind, see rules.hpp.
#include "host/machines/rules.hpp"

namespace furcula::machines {

const Rules& rules(dynamics::Kind kind) {
  return dynamics::with_machine(kind, []<class Machine>() -> const Rules& { return Machine::rules(); });
}

}  // namespace furcula::machines
