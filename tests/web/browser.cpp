// Chromium's command line.
#include "tests/web/browser.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace furcula::test {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "furcula-web-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder: " + pattern);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;  // the browser's last process may still be closing its profile
  fs::remove_all(path_, ignored);
}

std::optional<Browser> Browser::find() {
  const char* search = std::getenv("PATH");
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
    std::istringstream folders(search ? search : "");
    for (std::string folder; std::getline(folders, folder, ':');)
      if (fs::exists(fs::path(folder) / name)) return Browser(fs::path(folder) / name);
  }
  return std::nullopt;
}

std::string Browser::run(const std::string& arguments, const fs::path& page) const {
  const TemporaryFolder profile;
  // Nothing leaves the machine: no updates, no sync, and every host name fails to resolve.
  const std::string command =
      "timeout 120 " + program_.string() +
      " --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking "
      "--disable-component-update --disable-sync --disable-quic --disable-default-apps --disable-extensions "
      "--host-resolver-rules='MAP * ~NOTFOUND' --hide-scrollbars --virtual-time-budget=4000 --user-data-dir='" +
      profile.path().string() + "' " + arguments + " 'file://" + page.string() + "' 2>'" +
      (profile.path() / "stderr").string() + "'";
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) throw std::runtime_error("cannot run " + program_.string());
  std::string out;
  char buffer[65536];
  for (std::size_t n = 0; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
  if (const int status = pclose(pipe); status != 0)
    throw std::runtime_error(program_.string() + " ended with status " + std::to_string(status));
  return out;
}

std::string Browser::dom(const fs::path& page, int width) const {
  return run("--dump-dom --window-size=" + std::to_string(width) + ",1000", page);
}

void Browser::print(const fs::path& page, const fs::path& pdf) const {
  run("--no-pdf-header-footer --print-to-pdf='" + pdf.string() + "'", page);
}

namespace {

/// Collects what goes wrong from the page's first moment on.
constexpr const char* kWatch = R"(<script>
window.problems = [];
addEventListener('error', e => problems.push(String(e.message)), true);
addEventListener('securitypolicyviolation', e => problems.push('blocked ' + e.blockedURI));
</script>)";

}  // namespace

nlohmann::json look_at(const Browser& browser, std::string page, const std::string& probe, int width) {
  const TemporaryFolder folder;
  page.insert(page.find("<meta name=\"viewport\""), kWatch);
  page.insert(page.rfind("</body>"), probe);
  std::ofstream(folder.path() / "report.html", std::ios::binary) << page;
  const std::string dom = browser.dom(folder.path() / "report.html", width);
  const std::string open = "<pre id=\"seen\">";
  const std::size_t at = dom.find(open);
  if (at == std::string::npos) throw std::runtime_error("the probe left nothing on the page");
  std::string text = dom.substr(at + open.size(), dom.find("</pre>", at) - at - open.size());
  text = std::regex_replace(text, std::regex("&lt;"), "<");
  text = std::regex_replace(text, std::regex("&gt;"), ">");
  return nlohmann::json::parse(std::regex_replace(text, std::regex("&amp;"), "&"));
}

}  // namespace furcula::test
