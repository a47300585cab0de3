// A message as flat numbers, whatever its encoding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace furcula::bags {

/// Sequences with more elements than these are no signals (images, scans): they are passed over.
inline constexpr std::size_t kMostElements = 256;
/// Of one message.
inline constexpr std::size_t kMostValues = 4096;

/// Times of messages lie within +-126 years: the difference of any two fits 64 bits.
inline constexpr std::int64_t kLatest_ns = 4'000'000'000'000'000'000;

/// Messages of one topic whose `form` and `texts` are equal have the same numbers in the same places.
struct Decoded {
  std::vector<double> values;
  std::vector<std::uint32_t> form;  ///< lengths of its sequences, in order; of JSON: a hash of its keys
  std::string texts;                ///< elements of sequences of strings, each with a NUL behind it
  std::int64_t stamp_ns = 0;        ///< of `header` or a field `stamp`; 0: none

  void clear() {
    values.clear();
    form.clear();
    texts.clear();
    stamp_ns = 0;
  }
};

}  // namespace furcula::bags
