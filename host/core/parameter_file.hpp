// The controller's parameters in a file: the store of a node (firmware/app/store.hpp) on a computer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "furcula/core/status.hpp"

namespace furcula::core {

/// The image (furcula/bus/parameter_image.hpp) behind a line that says what it is, and its CRC-32. Written
/// whole or not at all.
class ParameterFile {
 public:
  /// Empty: keeps nothing.
  explicit ParameterFile(std::string path) : path_(std::move(path)) {}

  /// @returns the image's size; 0 where there is no such file, and only there; `invalid`: damaged, larger, or
  /// something that cannot be read as a file (no permission, a folder, a loop of links).
  Result<std::size_t> load(std::span<std::uint8_t> into) const;
  /// The image in such a file's bytes. @returns its size; `invalid`: damaged, no such file, or larger.
  static Result<std::size_t> read(std::string_view file, std::span<std::uint8_t> into);
  /// Takes memory and time, which a robot that is idle has.
  Status save(std::span<const std::uint8_t> image) const;

 private:
  std::string path_;
};

}  // namespace furcula::core
