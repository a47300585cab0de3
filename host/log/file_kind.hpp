// Files that are given as a log and are none: what they are, by how they begin, and what makes a log of them.
#pragma once

#include <string>
#include <string_view>

namespace furcula::log {

/// Of what a file begins with, so many bytes are looked at: the first page of an SQLite file, in which its tables are named.
inline constexpr std::size_t kHead = 4096;

/// What the file is and how a log is made of it, to follow its name; empty: it is none of those known. Only what no CSV file begins with.
std::string other_file(std::string_view head, const std::string& path);

/// The same of text (XML, JSON, TOML, a bus's recording), which a title line could begin as, too: for a file in which no header row was found.
std::string other_text(std::string_view head, const std::string& path);

/// What to do with a file that is no text and not known either.
std::string unknown_file_hint(const std::string& path);

}  // namespace furcula::log
