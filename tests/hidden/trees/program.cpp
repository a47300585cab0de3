#include "tests/hidden/trees/program.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace furcula::hidden::trees {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string last_line(const std::string& path) {
  std::ifstream file(path);
  std::string line, last;
  while (std::getline(file, line))
    if (!line.empty()) last = line;
  return last;
}

}  // namespace

std::string diagnosed(const std::string& program, const std::string& folder,
                      const std::vector<std::string>& logs, std::size_t held_out, double timeout_s) {
  const std::string out = folder + "/diagnosis", printed = folder + "/diagnosis.txt";
  std::filesystem::remove_all(out);
  std::string command = "timeout " + std::to_string(static_cast<long>(timeout_s)) + " " + quoted(program) +
                        " diagnose --model " + quoted(folder + "/model.toml") + " --hold-out";
  const std::size_t training = logs.size() - held_out;
  for (std::size_t i = training; i < logs.size(); ++i) command += " " + quoted(folder + "/" + logs[i]);
  command += " --out " + quoted(out);
  for (std::size_t i = 0; i < training; ++i) command += " " + quoted(folder + "/" + logs[i]);
  command += " > " + quoted(printed) + " 2>&1";
  const int status = std::system(command.c_str());  // NOLINT(concurrency-mt-unsafe)
  if (std::filesystem::exists(out + "/diagnosis.json")) return {};
  const std::string said = last_line(printed);
  return "status " + std::to_string(status / 256) + (said.empty() ? "" : ", " + said);
}

}  // namespace furcula::hidden::trees
