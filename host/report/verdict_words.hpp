// A verdict as a page says it.
#pragma once

#include "host/core/verdict.hpp"
#include "host/report/page.hpp"

namespace furcula::report {

struct VerdictWords {
  const char* title;
  Tone tone;
  const char* meaning;
};
VerdictWords words(Verdict v);

}  // namespace furcula::report
