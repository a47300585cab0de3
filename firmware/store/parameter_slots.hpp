// The two slots as the place where a node keeps its parameters (firmware/app/store.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/store/save_limit.hpp"
#include "firmware/store/slot_store.hpp"

namespace furcula::firmware {

/// Of the record around an image, which itself says what parameters it has (bus/parameter_image.hpp).
inline constexpr std::uint32_t kParameterRecordVersion = 1;

template <SlotFlash F>
class ParameterSlots {
 public:
  constexpr explicit ParameterSlots(F& flash) : store_(flash, kParameterRecordVersion) {}

  Result<std::size_t> load(std::span<std::uint8_t> into) const {
    const Loaded loaded = store_.load(into);
    if (loaded.reason == LoadReason::blank) return std::size_t{0};
    if (loaded.reason != LoadReason::loaded) return Status::invalid;
    return std::size_t{loaded.bytes};
  }
  Status save(std::span<const std::uint8_t> image) { return store_.save(image); }
  /// Whether the memory bears another save.
  bool is_worn() const { return store_.saves() >= kSavesMost; }

 private:
  SlotStore<F> store_;
};

}  // namespace furcula::firmware
