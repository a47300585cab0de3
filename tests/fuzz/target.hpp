// What each fuzz target provides: libFuzzer calls it with inputs of its own (libfuzzer_entry.cpp), the tests
// with the files of the corpus (replay.cpp).
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace furcula::fuzz {

/// Whether the reader takes the input. A core::DataError is a refusal; anything else that the reader throws,
/// and an input that is taken and does not survive writing and reading again, ends the program.
bool accepts(std::string_view input);

/// Ends the program where a property does not hold, in every build type.
inline void require(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "property broken: %s\n", property);
  std::abort();
}

}  // namespace furcula::fuzz
