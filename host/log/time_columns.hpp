// Time that a foreign log holds in two columns, seconds and a fraction; and the line of a map file that adds them.
#pragma once

#include <span>
#include <string>

namespace furcula::log {

/// `time_s = { columns = ["stamp.secs", "stamp.nsecs"], scales = [1, 1e-9] }` where the log has such a pair; nothing where it has none.
/// `seconds` is the column of seconds, where it is known; else it is sought.
std::string line_that_adds(std::span<const std::string> columns, const std::string& seconds = {});

}  // namespace furcula::log
