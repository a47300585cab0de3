// Commands in messages: for a shell and for Python, with the names of files.
#pragma once

#include <string>
#include <string_view>

namespace furcula::core {

/// A word as a shell takes it.
std::string shell_word(const std::string& text);

/// Text as a string of Python.
std::string python_string(const std::string& text);

/// A command line that runs Python code.
std::string python_command(const std::string& code);

/// The file's path with another ending: "run.mat" and ".csv" make "run.csv".
std::string with_ending(const std::string& path, const std::string& ending);

}  // namespace furcula::core
