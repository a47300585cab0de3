// A range for an option's number. (CLI::Range lets through what is not a number.)
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "host/core/message.hpp"

namespace furcula::cli {

inline CLI::Validator within(double lower, double upper) {
  const std::string expected = "a number from " + core::shortest(lower) + " to " + core::shortest(upper);
  return {[=](std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && value >= lower && value <= upper;
            return good ? std::string() : "'" + text + "' is not " + expected;
          },
          expected};
}

}  // namespace furcula::cli
