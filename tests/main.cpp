// The tests' main: Catch2, and an exit status for "skipped" (77), which Catch2 2.13 does not have.
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
  return failed == 0 && furcula::test::skipped ? 77 : failed;
}
