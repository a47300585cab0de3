// A headless Chromium for tests of pages: runs it on a local file and hands back what it made of it.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace furcula::test {

class Browser {
 public:
  /// The first of chromium, chromium-browser, google-chrome on the PATH.
  static std::optional<Browser> find();

  /// The page's DOM as text after its scripts ran. `width` in CSS pixels.
  std::string dom(const std::filesystem::path& page, int width = 1400) const;
  void print(const std::filesystem::path& page, const std::filesystem::path& pdf) const;

 private:
  explicit Browser(std::filesystem::path program) : program_(std::move(program)) {}
  /// Runs it with a profile of its own; returns what it wrote to stdout.
  std::string run(const std::string& arguments, const std::filesystem::path& page) const;
  std::filesystem::path program_;
};

/// A new empty folder that is removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A headless browser on virtual time draws hardly any frames: with this in its head they come by the clock.
inline constexpr const char* kFrames =
    "<script>window.requestAnimationFrame = f => setTimeout(() => f(performance.now()), 20);</script>";
inline constexpr const char* kNoBrowser =
    "no chromium on the PATH (scripts/setup installs it for the web tests)";

/// What probes of canvases use: get(id), wait(ms), pixelsOf(canvas), and pictureOf(canvas), a checksum of what is drawn.
inline constexpr const char* kPictureTools = R"(<script>
const get = id => document.getElementById(id);
const wait = ms => new Promise(done => setTimeout(done, ms));
const pixelsOf = canvas => canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
const pictureOf = canvas => {
  let sum = 0;
  for (const v of pixelsOf(canvas)) sum = (sum * 31 + v) >>> 0;
  return sum;
};
</script>)";

/// What a probe saw on this page: a <script> at its end that leaves JSON in <pre id="seen">, within 4 s of the page's time.
/// The page has `problems` from its first moment on: errors, and requests that its policy refused.
/// @throws std::runtime_error: nothing was left.
nlohmann::json look_at(const Browser& browser, std::string page, const std::string& probe, int width = 1400);

}  // namespace furcula::test
