// Where a log's header row is, what separates its columns, and how the rows below fit to it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/log/layout.hpp"
#include "host/log/top.hpp"

namespace furcula::log {

using Fields = std::vector<std::string>;

/// The names that the file must have, as it calls them; those of time first.
Fields names_asked_for(const RigInfo& rig, const ColumnMap* map);

/// How many of the names are among the fields.
std::size_t found_among(const Fields& fields, const Fields& asked);

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
const Top::Comment* header_comment(const Top& top, const Fields& row, char separator, const Fields& asked);

/// @throws core::DataError: what is there is a row of numbers.
[[noreturn]] void refuse_no_header(const Top& top, const Fields& row, char separator, const Fields& asked,
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
