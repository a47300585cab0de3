// The reader of images: what it takes has the header's length, and reads the same from its bytes alone.
#include <string>

#include "host/core/error.hpp"
#include "host/flash/image.hpp"
#include "tests/fuzz/target.hpp"

bool furcula::fuzz::accepts(std::string_view input) {
  try {
    const flash::Image image = flash::read_elf(input, "input");
    require(image.bytes.size() == image.header.length, "the length is the header's");
    require(image.board().size() <= image.header.names.board.size(), "the name is within its room");
    const flash::Image again = flash::image_of(image.bytes, "its bytes");
    require(again.version() == image.version() && again.board() == image.board(), "its bytes say the same");
  } catch (const core::DataError&) {
    return false;
  }
  return true;
}
