// The reader of model files.
#include "host/core/error.hpp"
#include "host/model/reader.hpp"
#include "host/model/writer.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {

bool accepts(std::string_view input) {
  model::Model model;
  try {
    model = model::parse_model(input, "input");
  } catch (const core::DataError&) {
    return false;
  }
  const std::string written = model::format_model(model);
  const model::Model again = model::parse_model(written, "input");
  require(again.parameters == model.parameters && again.effects == model.effects,
          "a written model reads back the same");
  require(model::format_model(again) == written, "a model that was read is written the same");
  return true;
}

}  // namespace furcula::fuzz
