// Bags that were cut or changed: they end in rows or in one message, never otherwise.
#include <catch2/catch.hpp>
#include <fstream>
#include <random>
#include <sstream>

#include "host/log/reader.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

std::string bytes_of(const std::string& name) {
  std::ostringstream out;
  out << std::ifstream(test::source("tests/host/bags/data/" + name), std::ios::binary).rdbuf();
  return out.str();
}

/// The rows, or none where it is refused. The message names the file.
std::size_t rows_of(const std::string& bytes, std::string* notes = nullptr) {
  try {
    log::ColumnMap map;
    map.all_topics = true;
    const log::Log log = log::parse_log(bytes, "run.mcap", "tree", &map);
    if (notes != nullptr)
      for (const std::string& note : log.notes) *notes += note + "\n";
    return log.rows();
  } catch (const core::DataError& e) {
    CHECK_THAT(e.what(), Contains("run.mcap"));
    return 0;
  }
}

const char* const kFiles[]{"plain.mcap", "chunks.mcap",        "lz4.mcap",
                           "mixed.mcap", "messages_zstd.mcap", "partial.mcap"};

}  // namespace

TEST_CASE("a bag that is cut anywhere gives what stands before the cut, and says so") {
  for (const char* name : kFiles) {
    const std::string whole = bytes_of(name);
    const std::size_t all = rows_of(whole);
    REQUIRE(all > 0);
    std::size_t before = 0;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      std::string notes;
      const std::size_t rows = rows_of(whole.substr(0, size), &notes);
      INFO(name << " cut to " << size << " bytes: " << notes);
      CHECK(rows <= all);
      if (std::string(name) == "plain.mcap") {
        CHECK(rows >= before);
        if (rows > 0 && rows < all)
          CHECK_THAT(notes, Contains("the file ends at byte " + std::to_string(size)));
      }
      before = rows;
    }
  }
}

TEST_CASE("the messages of a chunk that is cut are used") {
  const std::string whole = bytes_of("chunks.mcap");
  // Within the first chunk, which begins behind the header.
  std::string notes;
  CHECK(rows_of(whole.substr(0, 2300), &notes) >= 2);
  CHECK_THAT(notes, Contains("within a record of"));
}

TEST_CASE("a bag of which bytes have changed gives rows or a message") {
  std::mt19937_64 random(20);
  for (const char* name : kFiles) {
    const std::string whole = bytes_of(name);
    for (int trial = 0; trial < 400; ++trial) {
      std::string bytes = whole;
      for (std::uint64_t n = 1 + random() % 3; n > 0; --n)
        bytes[random() % bytes.size()] = static_cast<char>(random() & 0xFF);
      rows_of(bytes);
    }
    // Lengths.
    for (std::size_t at = 8; at + 8 < std::min<std::size_t>(whole.size(), 400); ++at) {
      std::string bytes = whole;
      for (std::size_t k = 0; k < 8; ++k) bytes[at + k] = k < 7 ? '\xff' : '\x7f';
      rows_of(bytes);
    }
  }
}

TEST_CASE("a chunk whose bytes have changed is refused with its place, whatever the change makes of it") {
  std::string bytes = bytes_of("chunks.mcap");
  bytes[bytes.find("shoulder", 1500)] ^= 1;
  CHECK_THAT(test::error_message([&] { log::parse_log(bytes, "run.mcap", "tree"); }),
             Contains("run.mcap: byte ") &&
                 Contains("a chunk's checksum (CRC) is wrong; expected the file as it was recorded"));
}

TEST_CASE("a file that is no MCAP file in spite of its first letters is refused") {
  CHECK_THAT(test::error_message([&] { log::parse_log("\x89MCAP1\r\nabc", "run.mcap", "tree"); }),
             Contains("run.mcap: is no MCAP file"));
}

TEST_CASE("a database that is cut or changed gives rows or a message") {
  const test::TemporaryFolder folder;
  const std::string whole = bytes_of("bag/bag_0.db3");
  std::mt19937_64 random(21);
  const auto rows = [&](const std::string& bytes) -> std::size_t {
    const std::string path = folder.file("run.db3", bytes);
    try {
      return log::read_log(path, "tree").rows();
    } catch (const core::DataError& e) {
      CHECK_THAT(e.what(), Contains("run.db3"));
      return 0;
    }
  };
  REQUIRE(rows(whole) == 10);
  for (std::size_t size = 0; size < whole.size(); size += 97) CHECK(rows(whole.substr(0, size)) <= 10);
  for (int trial = 0; trial < 300; ++trial) {
    std::string bytes = whole;
    for (std::uint64_t n = 1 + random() % 3; n > 0; --n)
      bytes[random() % bytes.size()] = static_cast<char>(random() & 0xFF);
    rows(bytes);
  }
}
