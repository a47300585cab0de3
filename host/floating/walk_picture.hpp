// The picture of a walking robot on its identification's page: measured, and what the model as given and the identified one predict.
#pragma once

#include <string>
#include <vector>

#include "host/floating/identify.hpp"

namespace furcula::floating {

/// `html` is the section's content, `json` what walk_script draws in it.
struct WalkPicture {
  std::string html, json;
};

/// Up to 10 s, those with the largest errors of the identified model. `given` and `identified` are of the same windows of `recordings`; drawn
/// with the lengths of `model`.
WalkPicture walk_picture(const Machine& model, const std::vector<Recording>& recordings,
                         const WindowErrors& given, const WindowErrors& identified);

/// Channels of a row by their errors in units of their noise, the largest first.
std::vector<std::size_t> worst_first(const WindowErrors& errors);

}  // namespace furcula::floating
