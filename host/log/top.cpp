// What stands above the rows, see top.hpp.
#include "host/log/top.hpp"

#include <algorithm>
#include <cctype>

#include "host/core/message.hpp"
#include "host/log/file_kind.hpp"
#include "host/log/header_row.hpp"

namespace furcula::log {
namespace {

constexpr std::string_view kRostopic = "%time,field.";       // the header row of `rostopic echo -p`
constexpr std::size_t kMostMetadata = std::size_t{1} << 20;  // bytes, so that memory stays bounded

// Offset of the first byte that is not UTF-8, or npos.
std::size_t first_not_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    const unsigned char lead = byte(i);
    const std::size_t length = lead < 0x80                    ? 1
                               : lead >= 0xC2 && lead <= 0xDF ? 2
                               : lead >= 0xE0 && lead <= 0xEF ? 3
                               : lead >= 0xF0 && lead <= 0xF4 ? 4
                                                              : 0;
    if (length == 0 || i + length > text.size()) return i;
    for (std::size_t k = i + 1; k < i + length; ++k)
      if ((byte(k) & 0xC0) != 0x80) return i;
    // Overlong forms, surrogates, and what lies beyond the last code point.
    if ((lead == 0xE0 && byte(i + 1) < 0xA0) || (lead == 0xED && byte(i + 1) > 0x9F) ||
        (lead == 0xF0 && byte(i + 1) < 0x90) || (lead == 0xF4 && byte(i + 1) > 0x8F))
      return i;
    i += length;
  }
  return std::string_view::npos;
}

void take_metadata(std::string_view record, const RecordStream& records, const Wanted* wanted,
                   LogHeader& header) {
  const std::size_t colon = record.find(':');
  if (colon == std::string_view::npos) return;
  std::string key(trimmed(record.substr(1, colon - 1)));
  if (key.empty()) return;
  if (key == "rig") key = "machine_type";  // its name in earlier logs
  const std::string value(trimmed(record.substr(colon + 1)));
  if (key == "format" && value != "furcula-log/1")
    throw core::DataError(place(records) + "format is " + core::quoted(value) + "; expected furcula-log/1");
  if (key == "machine_type" && wanted != nullptr && value != wanted->rig().name)
    throw core::DataError(place(records) + "machine_type is " + core::quoted(value) + "; expected " +
                          std::string(wanted->rig().name) + ", as the model, the map or --machine says");
  if (key == "machine_type" && machine_type_named(value) == nullptr) {
    std::vector<std::string_view> rigs;
    for (const MachineType& r : kMachineTypes) rigs.push_back(r.name);
    throw core::DataError(place(records) + "machine_type is " + core::quoted(value) + "; expected one of " +
                          core::listed(rigs) + core::did_you_mean(value, rigs));
  }
  header.metadata.insert_or_assign(key, value);
}

/// Bytes that are no UTF-8 are taken as Latin-1, in which each byte is the code point of its number.
std::string from_latin1(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      out += c;
    } else {
      out += static_cast<char>(0xC0 | (byte >> 6));
      out += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return out;
}

/// Excel's first line "sep=;".
std::optional<char> separator_line(std::string_view record) {
  if (record.size() > 2 && record.front() == '"' && record.back() == '"')
    record = record.substr(1, record.size() - 2);
  if (record.size() != 5 || std::tolower(static_cast<unsigned char>(record[0])) != 's' ||
      std::tolower(static_cast<unsigned char>(record[1])) != 'e' ||
      std::tolower(static_cast<unsigned char>(record[2])) != 'p' || record[3] != '=')
    return std::nullopt;
  const char sign = record[4];
  constexpr std::string_view kOfNumbers = "+-.\"";
  if (std::isalnum(static_cast<unsigned char>(sign)) != 0 || kOfNumbers.find(sign) != kOfNumbers.npos)
    return std::nullopt;
  return sign;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) + 1 - first);
}

std::string place(const RecordStream& records) {
  return records.name() + ":" + std::to_string(records.line()) + ": ";
}

std::string_view comment_text(std::string_view comment) {
  const std::size_t first = comment.find_first_not_of(comment.front());
  return first == comment.npos ? std::string_view{} : trimmed(comment.substr(first));
}

void take_comment(std::string_view comment, const RecordStream& records, const Wanted* wanted, Top& top,
                  LogHeader& header) {
  constexpr std::size_t kComments = 8;
  top.comment_bytes += comment.size();
  if (top.comment_bytes > kMostMetadata)
    throw core::DataError(place(records) + "more than 1 MiB of comments; expected a header row");
  if (comment.front() == '#') take_metadata(comment, records, wanted, header);
  if (top.comments.size() == kComments) top.comments.erase(top.comments.begin());
  top.comments.push_back({std::string(comment_text(comment)), records.line()});
}

Top read_top(RecordStream& records, const Wanted* wanted, LogHeader& header) {
  Top top;
  const std::string path = records.name();
  const std::string_view head = records.ahead(kHead);
  if (const std::string what = other_file(head, path); !what.empty())
    throw core::DataError(path + ": " + what);
  if (std::string what = other_text(head, path); !what.empty()) top.other_text = path + ": " + what;

  std::string_view record;
  bool anything = false;
  while (records.next(record)) {
    if (records.fault() != nullptr)
      throw core::DataError(place(records) + records.fault() + unknown_file_hint(path));
    if (!anything) top.separator = separator_line(record);
    if (!anything && top.separator) {
      anything = true;
      continue;
    }
    anything = true;
    std::string text(record);
    if (const std::size_t bad = first_not_utf8(record); bad != std::string_view::npos) {
      if (top.not_utf8.empty())
        top.not_utf8 = place(records) + "byte " + std::to_string(bad + 1) + " of the line, " +
                       core::quoted(record.substr(bad, 1)) + ", is not UTF-8; expected UTF-8 text" +
                       unknown_file_hint(path);
      text = from_latin1(record);
    }
    const std::string_view content = trimmed(text);
    if (content.empty()) continue;
    const bool nul = text.find('\0') != std::string::npos;
    if (!nul && is_comment(content) && !content.starts_with(kRostopic) &&
        (content.front() == '#' || wanted == nullptr ||
         !wanted->uses(fields_of(content, separator_in(content, wanted->asked())).front()))) {
      take_comment(content, records, wanted, top, header);
      continue;
    }
    if (nul)
      top.flaw = place(records) + "a NUL byte; expected the text of a CSV log" + unknown_file_hint(path);
    else if (records.open_quote())
      top.flaw =
          place(records) + "a quote is not closed; expected a header row of a CSV log, with a closing '\"'";
    top.row = std::move(text);
    return top;
  }
  throw core::DataError(path + ":1: " + (anything ? "there is no header row" : "the file is empty") +
                        "; expected a CSV log with a header row" +
                        (anything ? "" : " (was the recording stopped before it was written, or copied?)"));
}

}  // namespace furcula::log
