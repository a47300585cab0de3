// Bags in SQLite, see sqlite.hpp. The tables: rosbag2_storage_sqlite3/src, schema versions 1 to 4.
#include "host/bags/sqlite.hpp"

#include <sqlite3.h>

#include <map>
#include <memory>
#include <new>
#include <tuple>
#include <utility>

#include "host/bags/compression.hpp"
#include "host/core/commands.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bags {
namespace {

class Database {
 public:
  explicit Database(const std::string& path) {
    // A bag that was not closed has a journal beside it, which cannot be read where nothing can be written: then without it.
    if (!open(path, SQLITE_OPEN_READONLY) || !answers()) {
      sqlite3_close(handle_);
      handle_ = nullptr;
      open("file:" + escaped(path) + "?immutable=1", SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
    }
  }
  ~Database() { sqlite3_close(handle_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  sqlite3* handle() const { return handle_; }
  std::string error() const { return sqlite3_errmsg(handle_); }

  bool has_table(const char* name) const {
    sqlite3_stmt* made = nullptr;
    if (sqlite3_prepare_v2(handle_, "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?1", -1,
                           &made, nullptr) != SQLITE_OK)
      return false;
    const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement(made, sqlite3_finalize);
    sqlite3_bind_text(made, 1, name, -1, SQLITE_STATIC);
    return sqlite3_step(made) == SQLITE_ROW;
  }

 private:
  bool open(const std::string& path, int flags) {
    const bool fine = sqlite3_open_v2(path.c_str(), &handle_, flags, nullptr) == SQLITE_OK;
    if (handle_ == nullptr) throw std::bad_alloc();
    sqlite3_limit(handle_, SQLITE_LIMIT_LENGTH, static_cast<int>(kLargestPart));
    // What a file from elsewhere says is not run: views, triggers, functions in its schema.
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_exec(handle_, "PRAGMA cell_size_check = 1", nullptr, nullptr, nullptr);
    return fine;
  }
  bool answers() const {
    return sqlite3_exec(handle_, "SELECT count(*) FROM sqlite_master", nullptr, nullptr, nullptr) ==
           SQLITE_OK;
  }
  static std::string escaped(const std::string& path) {
    std::string out;
    for (const char c : path)
      out += c == '%' ? "%25" : c == '?' ? "%3f" : c == '#' ? "%23" : std::string(1, c);
    return out;
  }

  sqlite3* handle_ = nullptr;
};

class Statement {
 public:
  Statement(const Database& database, const char* sql) {
    sqlite3_prepare_v2(database.handle(), sql, -1, &statement_, nullptr);
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  bool next() { return statement_ != nullptr && (result_ = sqlite3_step(statement_)) == SQLITE_ROW; }
  /// Whether all rows came.
  bool done() const { return statement_ != nullptr && result_ == SQLITE_DONE; }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  std::string_view bytes(int column) const {
    const void* data = sqlite3_column_blob(statement_, column);
    const int size = sqlite3_column_bytes(statement_, column);
    return data == nullptr ? std::string_view{}
                           : std::string_view(static_cast<const char*>(data), static_cast<std::size_t>(size));
  }
  std::string text(int column) const { return std::string(bytes(column)); }

 private:
  sqlite3_stmt* statement_ = nullptr;
  int result_ = SQLITE_ERROR;
};

}  // namespace

bool is_sqlite_bag(const std::string& path) {
  const Database database(path);
  return database.has_table("messages") && database.has_table("topics");
}

void read_sqlite_bag(const std::string& path, const std::string& name, Sink& sink) {
  const Database database(path);
  const std::string expected =
      "; expected a bag, as ros2 bag record writes: copy it again, or save what is whole with sqlite3 " +
      core::shell_word(name) + " .recover";
  std::map<std::string, std::pair<std::string, std::string>> definitions;
  if (database.has_table("message_definitions")) {
    Statement rows(database,
                   "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
    while (rows.next()) definitions[rows.text(0)] = {rows.text(1), rows.text(2)};
  }
  std::map<std::int64_t, std::size_t> numbers;
  Statement topics(database, "SELECT id, name, type, serialization_format FROM topics");
  while (topics.next()) {
    Channel channel{topics.text(1), topics.text(2), topics.text(3), {}, {}};
    if (const auto known = definitions.find(channel.type); known != definitions.end())
      std::tie(channel.schema_encoding, channel.definition) = known->second;
    numbers[topics.integer(0)] = sink.channel(channel);
  }
  if (!topics.done())
    throw core::DataError(name + ": cannot be read (SQLite: " + database.error() + ")" + expected);
  Statement messages(database, "SELECT topic_id, timestamp, data FROM messages ORDER BY id");
  std::uint64_t count = 0;
  while (messages.next()) {
    const auto topic = numbers.find(messages.integer(0));
    if (topic == numbers.end())
      throw core::DataError(name + ": message " + std::to_string(count + 1) + " is of the topic " +
                            std::to_string(messages.integer(0)) + ", which the table topics does not have" +
                            expected);
    sink.message(topic->second, messages.integer(1), messages.bytes(2));
    ++count;
  }
  if (messages.done()) return;
  if (count == 0)
    throw core::DataError(name + ": cannot be read (SQLite: " + database.error() + ")" + expected);
  sink.note(core::printable(name) + ": is damaged behind its message " + std::to_string(count) +
            " (SQLite: " + database.error() + "). What stands before is used.");
}

}  // namespace furcula::bags
