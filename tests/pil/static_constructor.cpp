// An image with an object that is constructed before main(): it must not link (reset_handler runs none).
#include "firmware/startup/startup.hpp"

void furcula::firmware::on_exception() {
  for (;;) {
  }
}

namespace {
struct Constructed {
  Constructed();
  volatile int value = 0;
};
Constructed::Constructed() { value = 1; }
Constructed constructed;
}  // namespace

int main() { return constructed.value; }
