// The controller's parameters in a file: the store of a node (firmware/app/store.hpp) on a computer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "firmware/app/store.hpp"

namespace furcula::linux_sbc {

/// The image (furcula/bus/parameter_image.hpp) behind a line that says what it is, and its checksum. Written
/// whole or not at all.
class FileStore {
 public:
  /// Empty: keeps nothing.
  explicit FileStore(std::string path) : path_(std::move(path)) {}

  Result<std::size_t> load(std::span<std::uint8_t> into);
  /// The image in such a file's bytes. @returns its size; `invalid`: damaged, no such file, or larger.
  static Result<std::size_t> read(std::string_view file, std::span<std::uint8_t> into);
  /// Takes memory and time, which a robot that is idle has.
  Status save(std::span<const std::uint8_t> image);

 private:
  std::string path_;
};
static_assert(firmware::ParameterStore<FileStore>);

}  // namespace furcula::linux_sbc
