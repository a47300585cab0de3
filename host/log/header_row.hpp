// Where a log's header row is, what separates its columns, and how the rows below fit to it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/log/layout.hpp"
#include "host/log/top.hpp"
#include "host/log/wanted.hpp"

namespace furcula::log {

/// A field that is a number, with a point or a comma.
bool is_any_number(const std::string& field);

/// A row of numbers, empty fields among them.
bool all_numbers(const Fields& fields);

/// What stands between the columns: with which most of the names that are asked for are there, else what cuts the row most often; a comma
/// where none does. Blanks stand within names and beside other separators: only where there is none of those.
char separator_in(std::string_view row, const Fields& asked);

/// For messages: "';'", "a tab", "blanks".
std::string name_of(char separator);

/// "1 field", "2 fields"
std::string counted(std::size_t count, const char* one, const char* many);

/// The first few rows, in fields, without those that a buffer's end may cut.
std::vector<Fields> first_rows(RecordStream& records, char separator);

/// The comment above the rows that holds the names of their columns, or null.
const Top::Comment* header_comment(const Top& top, const Fields& row, char separator, const Wanted& wanted);

/// A row of numbers without a header row above.
struct Headless {
  std::uint64_t line;
  std::string row;
  char separator;
};
/// @throws core::DataError: what is there is a row of numbers.
[[noreturn]] void refuse_no_header(const Top& top, const Headless& first, const Wanted& wanted,
                                   const RecordStream& records);

/// Takes the sign of a comment off the first name: "! time_s" is time_s where that is a column that is used, and "! time_s" is none.
/// Where the sign stands alone between separators, the rows have a field less.
void strip_sign(Fields& names, const std::vector<Fields>& rows, const Wanted& wanted, Layout& layout,
                const RecordStream& records);

/// Ends of rows: a separator that stands behind the last field in the header row and not in the rows, or the other way round; an index in
/// front of the rows alone (R's write.table).
/// What nothing explains becomes the layout's rows_hint.
void fit_to_rows(Fields& names, const std::vector<Fields>& rows, Layout& layout, const RecordStream& records);

/// Whether the first of the rows is one of units ("s,rad,Nm").
bool units_row(const std::vector<Fields>& rows, std::size_t columns);

/// @throws core::DataError: numbers such as 0,001 where a point is expected.
void refuse_decimal_commas(const std::vector<Fields>& rows, const Layout& layout, const ColumnMap* map,
                           const RecordStream& records);

}  // namespace furcula::log
