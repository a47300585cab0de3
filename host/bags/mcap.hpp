// Reads MCAP files (mcap.dev/spec, version 0) from the first record to the last, without their index.
#pragma once

#include <string>
#include <string_view>

#include "host/bags/sink.hpp"
#include "host/core/byte_source.hpp"

namespace furcula::bags {

inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};

/// Hands on all messages of the data section. Of a file that ends too early what stands before its end, with a note. `name` stands for the
/// path in messages. Attachments, metadata and indexes are passed over. Memory: the largest chunk, twice.
/// @throws core::DataError naming the byte: no MCAP file, damaged, a compression that is not known.
void read_mcap(core::ByteSource& source, const std::string& name, Sink& sink);

}  // namespace furcula::bags
