// The names of columns that a reading asks for.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "host/log/column_map.hpp"
#include "host/log/machine_types.hpp"

namespace furcula::log {

using Fields = std::vector<std::string>;

class Wanted {
 public:
  Wanted(const MachineType& rig, const ColumnMap* map) : rig_(rig), map_(map) {
    for (const ColumnInfo& c : rig.columns)
      if (c.required) add(std::string(c.name));
    if (map != nullptr)
      for (const auto& [ours, mapped] : map->columns)
        for (const MappedPart& p : mapped.parts)
          if (!among(asked_, p.column)) asked_.push_back(p.column);
  }

  const MachineType& rig() const { return rig_; }

  /// As the file calls them: those that the rig must have, time first, and all that the map names.
  const Fields& asked() const { return asked_; }

  /// How many of those asked for are among the fields.
  std::size_t found_among(const Fields& fields) const {
    return static_cast<std::size_t>(std::count_if(
        asked_.begin(), asked_.end(), [&](const std::string& name) { return among(fields, name); }));
  }
  bool all_among(const Fields& fields) const { return found_among(fields) == asked_.size(); }

  /// Whether a column of that name is used: it is asked for, or optional.
  bool uses(const std::string& name) const {
    return among(asked_, name) ||
           (rig_.column(name) != nullptr && (map_ == nullptr || !map_->columns.contains(name)));
  }

 private:
  static bool among(const Fields& fields, const std::string& name) {
    return std::find(fields.begin(), fields.end(), name) != fields.end();
  }
  void add(const std::string& ours) {
    const bool mapped = map_ != nullptr && map_->columns.contains(ours);
    if (!mapped) asked_.push_back(ours);
    if (mapped)
      for (const MappedPart& p : map_->columns.at(ours).parts) asked_.push_back(p.column);
  }

  const MachineType& rig_;
  const ColumnMap* map_;
  Fields asked_;
};

}  // namespace furcula::log
