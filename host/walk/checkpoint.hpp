// A search's checkpoint: a file from which an interrupted search goes on, and says so where it cannot.
//
// Three lines: what it is with bytes and CRC-32 of the rest, what search it is of with its state, the method's state. Numbers are exact.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/walk/search.hpp"
#include "host/walk/walk_file.hpp"

namespace furcula::walk {

/// What must be the same for a search to go on: names and values, as messages have them.
using Settings = std::vector<std::pair<std::string, std::string>>;
/// `program`: its name and version.
Settings settings_of(const Model& model, const SearchOptions& options, const std::string& program);

struct Checkpoint {
  Settings settings;
  std::uint32_t build = 0;  ///< core::own_build_id of the program that wrote it
  SearchState state;
};

std::string format_checkpoint(const Checkpoint& checkpoint);
/// `name` is for messages. @throws core::DataError: cut short, damaged, of another format.
Checkpoint parse_checkpoint(std::string_view text, const std::string& name);

/// The file that is there becomes `path`.previous first.
void write_checkpoint(const Checkpoint& checkpoint, const std::string& path);

struct FoundCheckpoint {
  Checkpoint checkpoint;
  std::string file;  ///< that it is from
  std::string note;  ///< where it is `path`.previous, why; else empty
};
/// `path`, or, where that is gone or damaged, `path`.previous. @throws core::DataError where neither can be used.
FoundCheckpoint read_checkpoint(const std::string& path);

/// What in the checkpoint is otherwise than asked, in words; empty: nothing.
std::string difference(const Settings& written, const Settings& asked);

}  // namespace furcula::walk
