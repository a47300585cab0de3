// What a diagnosis concludes, of machines of one joint and of several.
#pragma once

#include <cstddef>
#include <string_view>

namespace furcula {

enum class Verdict { adequate, explained, partly_explained, unexplained, not_identifiable };

/// As in diagnosis.json.
constexpr std::string_view name(Verdict v) {
  constexpr std::string_view kNames[] = {"adequate", "explained", "partly_explained", "unexplained",
                                         "not_identifiable"};
  return kNames[static_cast<std::size_t>(v)];
}

}  // namespace furcula
