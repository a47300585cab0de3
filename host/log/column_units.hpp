// Units in columns' names and below them, where they are not ours.
#pragma once

#include "host/log/header_row.hpp"
#include "host/log/layout.hpp"
#include "host/log/machine_types.hpp"

namespace furcula::log {

/// @throws core::DataError: `height_mm` where the rig has `height_m` and the file has not.
void refuse_wrong_units(const Layout& layout, const MachineType& rig, const RecordStream& records);

/// @throws core::DataError: a row of units says another unit than a column's name, and no scale makes ours of it.
void refuse_units_row(const Fields& units, const Layout& layout, const ColumnMap* map,
                      const RecordStream& records);

}  // namespace furcula::log
