// Where this build expects the image of the emulated Cortex-M4F.
#pragma once

namespace furcula::pil {

const char* own_image();

}  // namespace furcula::pil
