// MCAP, see mcap.hpp.
#include "host/bags/mcap.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <vector>

#include "host/bags/compression.hpp"
#include "host/bags/cursor.hpp"
#include "host/core/commands.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bags {
namespace {

using core::DataError;

enum class Op : std::uint8_t {
  header = 1,
  footer = 2,
  schema = 3,
  channel = 4,
  message = 5,
  chunk = 6,
  data_end = 15
};

constexpr const char* kCopyAgain =
    "; expected the file as it was recorded: copy it again, or save what is whole with `mcap recover`";

/// Bytes in order, with their place in the file and the last eight of all.
class Input {
 public:
  explicit Input(core::ByteSource& source) : source_(source) {}

  std::uint64_t offset() const { return offset_; }

  /// Up to `size` bytes behind `to`, in steps: a length that the file claims allocates no more than is there.
  std::size_t append(std::uint64_t size, std::string& to) {
    constexpr std::size_t kStep = std::size_t{1} << 22;
    std::uint64_t got = 0;
    while (got < size) {
      const std::size_t before = to.size(),
                        step = static_cast<std::size_t>(std::min<std::uint64_t>(kStep, size - got));
      to.resize(before + step);
      std::size_t filled = 0;
      while (filled < step) {
        const std::size_t n = source_.read(to.data() + before + filled, step - filled);
        if (n == 0) break;
        filled += n;
      }
      to.resize(before + filled);
      note(std::string_view(to).substr(before));
      got += filled;
      if (filled < step) break;
    }
    return static_cast<std::size_t>(got);
  }

  /// False where the file ends before.
  bool skip(std::uint64_t size) {
    std::array<char, 1 << 16> buffer;
    while (size != 0) {
      const std::size_t n =
          source_.read(buffer.data(), static_cast<std::size_t>(std::min<std::uint64_t>(buffer.size(), size)));
      if (n == 0) return false;
      note({buffer.data(), n});
      size -= n;
    }
    return true;
  }

  bool ends_with_magic() const { return last_ == kMcapMagic; }

 private:
  void note(std::string_view bytes) {
    offset_ += bytes.size();
    last_.append(bytes.substr(bytes.size() - std::min<std::size_t>(bytes.size(), 8)));
    if (last_.size() > 8) last_.erase(0, last_.size() - 8);
  }

  core::ByteSource& source_;
  std::uint64_t offset_ = 0;
  std::string last_;
};

class Reader {
 public:
  Reader(core::ByteSource& source, const std::string& name, Sink& sink)
      : input_(source), name_(name), sink_(sink) {}

  void read() {
    std::string record;
    input_.append(kMcapMagic.size(), record);
    if (record != kMcapMagic)
      throw DataError(name_ + ": is no MCAP file: it begins with " + core::quoted(record) +
                      "; expected a bag, as ros2 bag record -s mcap writes");
    for (;;) {
      const std::uint64_t at = input_.offset();
      record.clear();
      const std::size_t head = input_.append(9, record);
      if (head < 9) return torn(at, head == 0 ? "before its end is marked" : "within a record's length");
      Cursor cursor(record);
      const auto op = static_cast<Op>(cursor.number<std::uint8_t>());
      const auto size = cursor.number<std::uint64_t>();
      if (op == Op::data_end || op == Op::footer) return;
      if (op != Op::schema && op != Op::channel && op != Op::message && op != Op::chunk) {
        if (static_cast<std::uint8_t>(op) == 0) throw damaged(at, "a record of the type 0");
        if (!input_.skip(size)) return torn(at, "within a record of " + std::to_string(size) + " bytes");
        continue;
      }
      if (size > kLargestPart)
        throw damaged(at,
                      "a record of " + std::to_string(size) + " bytes, where 1 GiB is the most that is read");
      record.clear();
      const bool whole = input_.append(size, record) == size;
      const std::string within = "within a record of " + std::to_string(size) + " bytes";
      // Where the file goes on to its regular end, the length is wrong, and nothing of it is to be believed.
      if (!whole && input_.ends_with_magic()) return torn(at, within);
      if (op == Op::chunk)
        chunk(at, record, whole);
      else if (whole)
        take(op, at, record);
      if (!whole) return torn(at, within);
    }
  }

 private:
  DataError damaged(std::uint64_t at, const std::string& what) const {
    return DataError(name_ + ": byte " + std::to_string(at) + ": " + what + kCopyAgain);
  }

  void torn(std::uint64_t at, const std::string& where) {
    if (input_.ends_with_magic() && at != input_.offset())
      throw damaged(
          at, "the file seems to end " + where + ", but is closed as a whole one is: it is damaged here");
    sink_.note(core::printable(name_) + ": the file ends at byte " + std::to_string(input_.offset()) + ", " +
               where +
               ": its recorder was stopped, or the file was not copied whole. What stands before is used.");
  }

  /// A record outside of chunks, or within one.
  void take(Op op, std::uint64_t at, std::string_view record) {
    try {
      Cursor c(record);
      if (op == Op::message)
        message(at, c);
      else if (op == Op::channel)
        channel(at, c);
      else if (op == Op::schema)
        schema(c);
    } catch (const Cut&) {
      throw damaged(at, "a record that is shorter than what it holds");
    }
  }

  void schema(Cursor& c) {
    const auto id = c.number<std::uint16_t>();
    Schema s;
    s.name = c.text();
    s.encoding = c.text();
    s.text = c.text();
    if (id != 0) schemas_[id] = std::move(s);
  }

  void channel(std::uint64_t at, Cursor& c) {
    const auto id = c.number<std::uint16_t>(), of = c.number<std::uint16_t>();
    Channel channel;
    channel.topic = c.text();
    channel.message_encoding = c.text();
    if (of != 0) {
      const auto schema = schemas_.find(of);
      if (schema == schemas_.end())
        throw damaged(at, "the channel " + core::quoted(channel.topic) + " has the schema " +
                              std::to_string(of) + ", which stands nowhere before it");
      channel.type = schema->second.name;
      channel.schema_encoding = schema->second.encoding;
      channel.definition = schema->second.text;
    }
    numbers_.resize(std::max<std::size_t>(numbers_.size(), id + std::size_t{1}));
    numbers_[id] = sink_.channel(channel);
  }

  void message(std::uint64_t at, Cursor& c) {
    const auto id = c.number<std::uint16_t>();
    c.number<std::uint32_t>();  // sequence
    const auto log_ns = c.number<std::uint64_t>();
    c.number<std::uint64_t>();  // publish time
    if (id >= numbers_.size() || !numbers_[id])
      throw damaged(at,
                    "a message of the channel " + std::to_string(id) + ", which stands nowhere before it");
    sink_.message(*numbers_[id], static_cast<std::int64_t>(log_ns & INT64_MAX), c.take(c.left()));
  }

  void chunk(std::uint64_t at, std::string_view record, bool whole) {
    std::uint64_t size = 0;
    std::uint32_t crc = 0;
    std::string_view compression, bytes;
    try {
      Cursor c(record);
      c.skip(2, 8);  // times of its first and last message
      size = c.number<std::uint64_t>();
      crc = c.number<std::uint32_t>();
      compression = c.text();
      const auto stored = c.number<std::uint64_t>();
      if (whole && stored > c.left()) throw Cut{};
      bytes = c.take(static_cast<std::size_t>(std::min<std::uint64_t>(stored, c.left())));
    } catch (const Cut&) {
      if (!whole) return;
      throw damaged(at, "a chunk that is shorter than what it holds");
    }
    const std::string place = "the chunk with the compression " + core::quoted(compression);
    if (size > kLargestPart)
      throw damaged(at,
                    "a chunk of " + std::to_string(size) + " bytes, where 1 GiB is the most that is read");
    if (!compression.empty()) {
      Decompressed result = Decompressed::damaged;
      if (compression == "zstd")
        result = unzstd(bytes, static_cast<std::size_t>(size), chunk_);
      else if (compression == "lz4")
        result = unlz4(bytes, static_cast<std::size_t>(size), chunk_);
      else
        throw DataError(
            name_ + ": byte " + std::to_string(at) + ": a chunk has the compression " +
            core::quoted(compression) +
            "; expected none, zstd or lz4: write the file anew, mcap compress --compression zstd " +
            core::shell_word(name_) + " -o " + core::shell_word(core::with_ending(name_, "-zstd.mcap")));
      if (whole && (result != Decompressed::whole || chunk_.size() != size))
        throw damaged(at, "a chunk does not decompress (" + std::string(compression) + ") to the " +
                              std::to_string(size) + " bytes that it should have");
      bytes = chunk_;
    } else if (whole && bytes.size() != size) {
      throw damaged(at, "a chunk has " + std::to_string(bytes.size()) + " bytes and should have " +
                            std::to_string(size));
    }
    if (whole && crc != 0 && ::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) != crc)
      throw damaged(at, "a chunk's checksum (CRC) is wrong");
    while (!bytes.empty()) {
      Cursor c(bytes);
      if (bytes.size() < 9) break;
      const auto op = static_cast<Op>(c.number<std::uint8_t>());
      const auto length = c.number<std::uint64_t>();
      if (length > c.left()) break;
      take(op, at, c.take(static_cast<std::size_t>(length)));
      bytes.remove_prefix(9 + static_cast<std::size_t>(length));
    }
    if (whole && !bytes.empty()) throw damaged(at, "a chunk ends within a record");
  }

  struct Schema {
    std::string name, encoding, text;
  };
  Input input_;
  const std::string& name_;
  Sink& sink_;
  std::map<std::uint16_t, Schema> schemas_;
  std::vector<std::optional<std::size_t>> numbers_;  ///< of channels, by their ids
  std::string chunk_;
};

}  // namespace

void read_mcap(core::ByteSource& source, const std::string& name, Sink& sink) {
  Reader(source, name, sink).read();
}

}  // namespace furcula::bags
