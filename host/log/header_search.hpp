// A header row below title lines: of a measurement program, or what a controller prints as it starts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host/log/header_row.hpp"
#include "host/log/top.hpp"
#include "host/log/wanted.hpp"

namespace furcula::log {

struct FoundHeader {
  std::string row;  ///< without the sign of a comment
  std::uint64_t line;
  char separator;
};

/// Seeks the header row below the first record, which `records` has just given, within 64 KiB: the first row that has all columns that are
/// asked for. Else, where the first record has none of them, the names above the first two rows of numbers, if it has as many; what is asked
/// for and missing is then missed there. If it is found, the stream goes on behind it, and the comments above it are taken.
/// `separator`: the map's, or that of a line "sep=".
/// @throws core::DataError: the rows of numbers begin below title lines alone.
std::optional<FoundHeader> find_header(RecordStream& records, const Wanted& wanted,
                                       std::optional<char> separator, Top& top, LogHeader& header);

}  // namespace furcula::log
