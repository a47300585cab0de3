// Units of columns, see column_units.hpp.
#include "host/log/column_units.hpp"

#include <algorithm>
#include <cctype>

#include "host/core/message.hpp"

namespace furcula::log {
namespace {

// Suffixes that are units: `height_mm` is `height_m` in another unit, `torque_enable` is not a torque.
constexpr std::string_view kUnits[]{
    "s",    "ms",    "us",    "ns",   "min", "h",       "m",     "mm",  "cm",     "um",  "km",   "in",
    "inch", "ft",    "rad",   "mrad", "deg", "degrees", "turns", "rev", "counts", "mps", "mmps", "cmps",
    "kmph", "radps", "degps", "rpm",  "rps", "hz",      "n",     "kn",  "mn",     "lbf", "kgf",  "gf",
    "nm",   "mnm",   "nmm",   "ncm",  "knm", "lbft",    "lbin",  "kg",  "g",      "v",   "mv",   "kv",
    "a",    "ma",    "c",     "k",    "f",   "degc",    "degf",  "w",   "pct"};

// "height" and "mm" of "height_mm"; no unit if the suffix is none.
struct NameParts {
  std::string_view quantity;
  std::string_view unit;
};

NameParts parts(std::string_view name) {
  const std::size_t underscore = name.rfind('_');
  if (underscore == std::string_view::npos) return {name, {}};
  const std::string_view suffix = name.substr(underscore + 1);
  if (std::find(std::begin(kUnits), std::end(kUnits), suffix) == std::end(kUnits)) return {name, {}};
  return {name.substr(0, underscore), suffix};
}

/// Other units of ours, and what makes ours of them.
struct OtherUnit {
  std::string_view unit, ours;
  const char* scale;
};
constexpr OtherUnit kOtherUnits[]{{"ms", "s", "1e-3"},
                                  {"us", "s", "1e-6"},
                                  {"ns", "s", "1e-9"},
                                  {"min", "s", "60"},
                                  {"mm", "m", "1e-3"},
                                  {"cm", "m", "1e-2"},
                                  {"um", "m", "1e-6"},
                                  {"km", "m", "1e3"},
                                  {"deg", "rad", "0.0174532925199433"},
                                  {"degrees", "rad", "0.0174532925199433"},
                                  {"mrad", "rad", "1e-3"},
                                  {"turns", "rad", "6.28318530717959"},
                                  {"rev", "rad", "6.28318530717959"},
                                  {"mmps", "mps", "1e-3"},
                                  {"cmps", "mps", "1e-2"},
                                  {"degps", "radps", "0.0174532925199433"},
                                  {"rpm", "radps", "0.104719755119660"},
                                  {"rps", "radps", "6.28318530717959"},
                                  {"mnm", "nm", "1e-3"},
                                  {"nmm", "nm", "1e-3"},
                                  {"ncm", "nm", "1e-2"},
                                  {"knm", "nm", "1e3"},
                                  {"kn", "n", "1e3"},
                                  {"mn", "n", "1e-3"},
                                  {"kgf", "n", "9.80665"},
                                  {"gf", "n", "9.80665e-3"},
                                  {"mv", "v", "1e-3"},
                                  {"ma", "a", "1e-3"}};

const OtherUnit* other_unit(std::string_view unit, std::string_view ours) {
  for (const OtherUnit& u : kOtherUnits)
    if (u.unit == unit && u.ours == ours) return &u;
  return nullptr;
}

[[noreturn]] void refuse_unit(const std::string& name, std::string_view unit, const std::string& ours,
                              const RecordStream& records) {
  const OtherUnit* known = other_unit(unit, parts(ours).unit);
  throw core::DataError(
      place(records) + "column " + core::quoted(name) + " has the unit '" + std::string(unit) +
      "'; expected '" + core::printable(ours) + "' (convert it, or give a --map file with " +
      (known == nullptr ? "a scale"
                        : "the line " + core::printable(ours) + " = { column = \"" + core::printable(name) +
                              "\", scale = " + known->scale + " }") +
      ")");
}

}  // namespace

void refuse_wrong_units(const Layout& layout, const MachineType& rig, const RecordStream& records) {
  for (const std::string& name : layout.file_columns) {
    const NameParts theirs = parts(name);
    if (rig.column(name) != nullptr || theirs.unit.empty()) continue;
    for (const ColumnInfo& ours : rig.columns) {
      const bool same_quantity =
          ours.kind != ColumnKind::flag && parts(ours.name).quantity == theirs.quantity;
      const auto& columns = layout.file_columns;
      if (same_quantity && std::find(columns.begin(), columns.end(), ours.name) == columns.end())
        refuse_unit(name, theirs.unit, std::string(ours.name), records);
    }
    // angle_knee_deg where angle_knee_rad is meant. What none of our quantities begins like stays unknown.
    const std::string_view quantity = theirs.quantity;
    std::string_view meant;
    for (const ColumnPattern& p : rig.patterns) {
      if (!quantity.starts_with(p.prefix) || quantity.size() == p.prefix.size()) continue;
      const std::string ours = std::string(quantity) + "_" + std::string(p.unit);
      const auto& columns = layout.file_columns;
      if (std::find(columns.begin(), columns.end(), ours) != columns.end()) {
        meant = {};
        break;
      }
      if (meant.empty()) meant = p.unit;
    }
    if (!meant.empty())
      refuse_unit(name, theirs.unit, std::string(quantity) + "_" + std::string(meant), records);
  }
}

void refuse_units_row(const std::vector<std::string>& units, const Layout& layout, const ColumnMap* map,
                      const RecordStream& records) {
  for (const Channel& c : layout.channels) {
    if (!c.known || c.sources.size() != 1 || c.sources.front().scale != 1.0) continue;
    std::string unit;
    for (const char sign : units[c.sources.front().column])
      if (std::isalnum(static_cast<unsigned char>(sign)) != 0)
        unit += static_cast<char>(std::tolower(static_cast<unsigned char>(sign)));
    const OtherUnit* other = other_unit(unit, parts(c.name).unit);
    if (other == nullptr) continue;
    const std::string& theirs = layout.file_columns[c.sources.front().column];
    throw core::DataError(place(records) + "the row of units below the header row says '" + unit +
                          "' of column " + core::quoted(theirs) + "; expected '" + std::string(other->ours) +
                          "' (in " + (map != nullptr ? map->path : "a --map file") + " the line " +
                          core::printable(c.name) + " = { column = \"" + core::printable(theirs) +
                          "\", scale = " + other->scale + " })");
  }
}

}  // namespace furcula::log
