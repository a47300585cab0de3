// The tests' main: Catch2, and an exit status for "skipped", which Catch2 2.13 does not have: 77, or Catch2 3's own, 4.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdio>

#include "tests/skip.hpp"

namespace furcula::test {
namespace {
bool skipped = false;
}
void skip(const char* reason) {
  skipped = true;
  std::printf("SKIPPED: %s\n", reason);
}
}  // namespace furcula::test

int main(int argc, char** argv) {
  const int failed = Catch::Session().run(argc, argv);
  constexpr int kSkipped = CATCH_VERSION_MAJOR >= 3 ? 4 : 77;
  return failed == 0 && furcula::test::skipped ? kSkipped : failed;
}
