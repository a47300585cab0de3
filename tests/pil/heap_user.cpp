// An image that uses the heap: it must not link (there is no _sbrk).
#include <cstdlib>

#include "firmware/startup/startup.hpp"

void furcula::firmware::on_exception() {
  for (;;) {
  }
}

int main() {
  volatile std::size_t size = 16;
  void* const block = std::malloc(size);
  return block == nullptr ? 1 : 0;
}
