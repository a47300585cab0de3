// The files of a bag: one, or those of a directory, in order.
#pragma once

#include <string>
#include <string_view>

#include "host/bags/sink.hpp"
#include "host/core/byte_source.hpp"

namespace furcula::bags {

/// What of a file's first bytes tells a bag.
inline constexpr std::size_t kHead = 16;

/// Whether a file that begins so is a bag, by its name and, of a database, its tables. `readable`: whether it can be opened again.
bool is_bag(const std::string& path, std::string_view head, bool readable);

/// Reads a bag's file. `source` gives all its bytes.
/// @throws core::DataError
void read_bag_file(const std::string& path, std::string_view head, core::ByteSource& source, Sink& sink);

/// Reads the files of a bag's directory in the order of its metadata.yaml, without one in that of their numbers.
/// @throws core::DataError, also where there is no bag in it.
void read_bag_directory(const std::string& path, Sink& sink);

}  // namespace furcula::bags
