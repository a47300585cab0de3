// Reads the SQLite files (.db3) that rosbag2 writes.
#pragma once

#include <string>

#include "host/bags/sink.hpp"

namespace furcula::bags {

/// Whether the database has rosbag2's tables.
bool is_sqlite_bag(const std::string& path);

/// Hands on all messages of the file at `path`, in the order in which they were recorded. `name` stands for it in messages. Of a damaged
/// file what could be read, with a note. @throws core::DataError: nothing could be read, or it has other tables.
void read_sqlite_bag(const std::string& path, const std::string& name, Sink& sink);

}  // namespace furcula::bags
