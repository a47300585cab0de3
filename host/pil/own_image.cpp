#include "host/pil/own_image.hpp"

namespace furcula::pil {

const char* own_image() { return FURCULA_M4F_IMAGE; }

}  // namespace furcula::pil
