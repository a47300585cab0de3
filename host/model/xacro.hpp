// The program xacro, which makes URDF files of their templates.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace furcula::model {

inline constexpr std::chrono::seconds kXacroTime{30};
inline constexpr std::size_t kXacroBytes = std::size_t{1} << 20U;  ///< as files that are read

/// What `xacro FILE` writes; nothing where PATH has no such program. No shell is involved.
/// @throws core::DataError naming the file: xacro fails, with what it says; takes longer than `allowed`; writes more than kXacroBytes or nothing.
std::optional<std::string> expand_xacro(const std::string& path,
                                        std::chrono::milliseconds allowed = kXacroTime);

}  // namespace furcula::model
