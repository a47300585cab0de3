// A computer's file of parameters, with anything in it.
#include <algorithm>
#include <array>
#include <string_view>

#include "furcula/bus/parameter_image.hpp"
#include "host/core/parameter_file.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  constexpr std::uint8_t kUntouched = 0xee;
  std::array<std::uint8_t, bus::kImageBytesMax> bytes;
  bytes.fill(kUntouched);
  const Result<std::size_t> size = core::ParameterFile::read(input, bytes);
  require(!size.ok() || size.value() < input.size(), "an image is shorter than its file");
  for (std::size_t i = size.ok() ? size.value() : 0; i < bytes.size(); ++i)
    require(bytes[i] == kUntouched, "nothing else is touched");
  if (!size.ok()) return false;
  // What was read is what stands in the file behind its title.
  const std::string_view image = input.substr(input.find('\n') + 1, size.value());
  require(std::equal(image.begin(), image.end(), bytes.begin(),
                     [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; }),
          "the image is the file's");
  control::Config config;
  const auto read = bus::from_image(std::span<const std::uint8_t>(bytes).first(size.value()), config);
  require(read != Status::ok || control::check(config) == Status::ok, "what a node takes of it makes sense");
  return true;
}

}  // namespace furcula::fuzz
