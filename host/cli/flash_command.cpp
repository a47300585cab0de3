// `furcula flash`: an image is checked, written to a board, and read back.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/core/byte_source.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/flash/boards.hpp"
#include "host/flash/image.hpp"
#include "host/flash/tools.hpp"

namespace furcula::cli {
namespace {

struct FlashOptions {
  std::string board, elf, tool;
  bool dry_run = false;
};

const flash::FlashBoard& board_of(const std::string& name) {
  std::vector<std::string_view> names;
  for (const flash::FlashBoard& board : flash::boards()) {
    if (board.name == name) return board;
    names.push_back(board.name);
  }
  throw UsageError("--board: no board " + core::quoted(name) + "; expected one of " + core::listed(names) +
                   core::did_you_mean(name, names));
}

/// An ELF file of at most 16 MiB, with all its symbols.
std::string read_file(const std::string& path) {
  core::FileSource source(path, "an ELF file of a board's image");
  std::string text;
  std::vector<char> block(1 << 16);
  for (std::size_t n = 0; (n = source.read(block.data(), block.size())) != 0;) {
    text.append(block.data(), n);
    if (text.size() > 16u << 20) throw core::DataError(path + ": larger than any image");
  }
  return text;
}

flash::Image image_for(const flash::FlashBoard& board, const std::string& path) {
  flash::Image image = flash::read_elf(read_file(path), path);
  if (image.board() != board.name)
    throw core::DataError(path + ": an image for the board " + core::quoted(image.board()) + "; expected " +
                          board.name);
  return image;
}

/// The tool to use. With --dry-run one that is not there will do.
std::string tool_for(const flash::FlashBoard& board, const FlashOptions& options) {
  std::vector<std::string_view> able;
  for (const std::string_view tool : flash::kTools)
    if (flash::suits(tool, board)) able.push_back(tool);
  if (!options.tool.empty()) {
    if (std::find(able.begin(), able.end(), options.tool) == able.end())
      throw UsageError("--tool: " + core::quoted(options.tool) + " does not flash " + board.name +
                       "; expected one of " + core::listed(able));
    able = {options.tool};
  }
  for (const std::string_view tool : able)
    if (!flash::find_in_path(tool).empty()) return std::string(tool);
  if (options.dry_run) return std::string(able.front());
  throw Refusal("no program to flash " + board.name + " with is in PATH; expected one of " +
                core::listed(able) + " (Debian's packages openocd, stlink-tools and dfu-util have them)");
}

/// The last lines of what a program said, for a message.
std::string end_of(const std::string& said) {
  std::size_t begin = said.size();
  for (int lines = 0; begin != 0 && begin != std::string::npos && lines < 8; ++lines)
    begin = said.rfind('\n', begin - 1);
  return begin == std::string::npos ? said : said.substr(begin);
}

/// A folder that is removed with all in it.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "furcula-flash-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw Refusal("no temporary folder can be made");
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::string& path() const { return path_; }
  std::string file(std::string_view name) const { return path_ + "/" + std::string(name); }

 private:
  std::string path_;
};

/// What the chip holds now; the tools have verified it, and so do we.
void check_read_back(const flash::Image& image, const std::string& path, const std::string& tool) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.size() < image.bytes.size())
    throw Refusal(tool + " read back " + std::to_string(bytes.size()) + " bytes of " +
                  std::to_string(image.bytes.size()));
  bytes.resize(image.bytes.size());
  const auto [here, there] = std::mismatch(image.bytes.begin(), image.bytes.end(), bytes.begin());
  if (here != image.bytes.end())
    throw Refusal("the board holds another byte at " + std::to_string(here - image.bytes.begin()) +
                  " from the image's beginning: flash it again");
  std::cout << "on the board: firmware " << flash::image_of(std::move(bytes), "the board's image").version()
            << "\n";
}

void flash_board(const FlashOptions& options) {
  const flash::FlashBoard& board = board_of(options.board);
  const std::string elf = options.elf.empty() ? "build/cortex-m4f/bin/" + board.name + ".elf" : options.elf;
  if (options.elf.empty() && !std::filesystem::exists(elf))
    throw core::DataError(elf +
                          ": no such image; expected one after cmake --preset cortex-m4f && cmake --build "
                          "--preset cortex-m4f, or --elf FILE");
  const flash::Image image = image_for(board, elf);
  std::cout << elf << ": " << board.name << ", firmware " << image.version() << ", " << image.bytes.size()
            << " bytes, CRC good\n";
  const std::string tool = tool_for(board, options);
  const std::vector<flash::Command> commands = flash::commands(tool, board, image.bytes.size());
  if (options.dry_run) {
    for (const flash::Command& command : commands) std::cout << flash::as_typed(command) << "\n";
    return;
  }
  const Folder folder;
  std::ofstream(folder.file(flash::kImageFile), std::ios::binary)
      .write(reinterpret_cast<const char*>(image.bytes.data()),
             static_cast<std::streamsize>(image.bytes.size()));
  const std::string program = flash::find_in_path(tool);
  for (const flash::Command& command : commands) {
    std::cerr << flash::as_typed(command) << "\n";
    const flash::Ran ran = flash::run(program, command, folder.path());
    if (ran.status != 0)
      throw Refusal(tool + " ended with status " + std::to_string(ran.status) + "; it said:\n" +
                    end_of(ran.said) + "\nIs the board connected and supplied? " + board.hint);
  }
  check_read_back(image, folder.file(flash::kReadBackFile), tool);
}

}  // namespace

void add_flash_command(CLI::App& app) {
  const auto options = std::make_shared<FlashOptions>();
  CLI::App* command = app.add_subcommand("flash", "Write a firmware image to a board, and read it back");
  command->add_option("--board", options->board, "Name of the board, as its folder in boards/")->required();
  command->add_option("--elf", options->elf, "The image; build/cortex-m4f/bin/BOARD.elf unless given");
  command->add_option("--tool", options->tool,
                      "openocd, st-flash or dfu-util; the first that is there unless given");
  command->add_flag("--dry-run", options->dry_run, "Check the image and print the commands");
  command->callback([options] { flash_board(*options); });
}

}  // namespace furcula::cli
