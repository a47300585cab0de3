// Writing model files, see writer.hpp.
#include "host/model/writer.hpp"

#include "host/core/atomic_file.hpp"
#include "host/core/strict_toml.hpp"

namespace furcula::model {
std::string format_model(const Model& model) {
  const auto& kind = dynamics::info(model.kind);
  std::string out = "[model]\nkind = \"" + std::string(kind.name) + "\"\nschema = 1\n\n[parameters]\n";
  for (std::size_t i = 0; i < kind.parameters.size(); ++i)
    out += std::string(kind.parameters[i].name) + " = " + core::toml_float(model.parameters.at(i)) + "\n";
  if (model.clutch)
    for (std::size_t i = 0; i < kClutchMembers.size(); ++i)
      out += std::string(dynamics::kClutchParameters[i].name) + " = " +
             core::toml_float((*model.clutch).*kClutchMembers[i]) + "\n";
  if (!model.free.empty()) out += "\n[free]\n";
  for (const auto& [index, bounds] : model.free)
    out += std::string(kind.parameters[index].name) + " = [" + core::toml_float(bounds.lower) + ", " +
           core::toml_float(bounds.upper) + "]\n";
  for (const auto& [effect, values] : model.effects) {
    const auto& info = dynamics::info(effect);
    out += "\n[effect." + std::string(info.name) + "]\n";
    for (std::size_t i = 0; i < info.parameter_count; ++i)
      out += std::string(dynamics::name_on(info.parameters()[i], model.kind)) + " = " +
             core::toml_float(values[i]) + "\n";
  }
  return out;
}

void write_model(const Model& model, const std::string& path) {
  core::write_file_atomically(path, format_model(model));
}

}  // namespace furcula::model
