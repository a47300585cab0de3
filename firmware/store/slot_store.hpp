// A block of bytes (the robot's parameters) kept over a power cut: two slots of a flash memory in turn. A
// save goes to the slot that does not hold the newest whole record, so that the other survives whatever
// happens.
//
// A record, in words: 0 magic, 1 layout version, 2 sequence number, 3 length in bytes, then the bytes padded
// with 0xFF to a word, then the CRC-32 of everything before it. The CRC is programmed last.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/store/flash.hpp"
#include "furcula/core/crc32.hpp"
#include "furcula/core/status.hpp"

namespace furcula::firmware {

/// What load() found. Everything but `loaded` means: use the defaults, and say why.
enum class LoadReason : std::uint8_t {
  loaded = 0,
  blank = 1,         ///< nothing was ever saved
  damaged = 2,       ///< records were begun, and none is whole
  other_layout = 3,  ///< the newest record is of another layout, or longer than asked for: of other firmware
};

struct Loaded {
  LoadReason reason = LoadReason::damaged;
  unsigned slot = 0;           ///< of the newest whole record, where there is one
  std::uint32_t sequence = 0;  ///< its number
  std::uint32_t bytes = 0;     ///< its length, where it was loaded
  /// ok: the bytes were loaded. invalid: they were not, see `reason`; asking again changes nothing.
  constexpr Status status() const { return reason == LoadReason::loaded ? Status::ok : Status::invalid; }
};

template <SlotFlash F>
class SlotStore {
 public:
  static constexpr std::uint32_t kMagic = 0x46435053u;
  static constexpr std::uint32_t kHeaderWords = 4;
  /// Bytes that a record can hold.
  static constexpr std::uint32_t kMostBytes = 4 * (F::kSlotWords - kHeaderWords - 1);

  /// `layout_version` is that of the bytes: raise it whenever their meaning changes. Keeps a reference.
  constexpr SlotStore(F& flash, std::uint32_t layout_version)
      : flash_(flash), layout_version_(layout_version) {}

  /// Copies the newest whole record to the beginning of `into`, which stays as it is unless that is `loaded`.
  Loaded load(std::span<std::uint8_t> into) const {
    Loaded found;
    const Newest newest = find_newest();
    if (!newest.exists) {
      found.reason = is_blank() ? LoadReason::blank : LoadReason::damaged;
      return found;
    }
    found.slot = newest.slot;
    found.sequence = flash_.read(newest.slot, 2);
    const std::uint32_t bytes = flash_.read(newest.slot, 3);
    if (flash_.read(newest.slot, 1) != layout_version_ || bytes > into.size()) {
      found.reason = LoadReason::other_layout;
      return found;
    }
    for (std::uint32_t i = 0; i < bytes; ++i)
      into[i] = static_cast<std::uint8_t>(flash_.read(newest.slot, kHeaderWords + i / 4) >> (8 * (i % 4)));
    found.bytes = bytes;
    found.reason = LoadReason::loaded;
    return found;
  }

  /// Saves since the memory was new, as the newest whole record counts them: each erased one of the two slots.
  std::uint32_t saves() const {
    const Newest newest = find_newest();
    return newest.exists ? flash_.read(newest.slot, 2) : 0;
  }

  /// Erases the other slot and writes the bytes there; blocks as long as the memory takes. `invalid`: too
  /// many bytes. `disconnected`: the memory did not take them; what was saved before can still be loaded, and
  /// saving again is right.
  Status save(std::span<const std::uint8_t> bytes) {
    if (bytes.size() > kMostBytes) return Status::invalid;
    const Newest newest = find_newest();
    const unsigned slot = newest.exists ? 1 - newest.slot : 0;
    if (flash_.erase(slot) != Status::ok) return Status::disconnected;

    const std::array<std::uint32_t, kHeaderWords> header{kMagic, layout_version_,
                                                         newest.exists ? flash_.read(newest.slot, 2) + 1 : 1,
                                                         static_cast<std::uint32_t>(bytes.size())};
    Crc32 crc;
    for (std::uint32_t i = 0; i < kHeaderWords; ++i)
      if (!put(slot, i, header[i], crc)) return Status::disconnected;
    std::uint32_t index = kHeaderWords;
    for (std::uint32_t first = 0; first < bytes.size(); first += 4) {
      std::uint32_t word = kErasedWord;
      const std::uint32_t end = std::min<std::uint32_t>(4, static_cast<std::uint32_t>(bytes.size()) - first);
      for (std::uint32_t i = 0; i < end; ++i)
        word = (word & ~(0xffu << (8 * i))) | static_cast<std::uint32_t>(bytes[first + i]) << (8 * i);
      if (!put(slot, index++, word, crc)) return Status::disconnected;
    }
    const std::uint32_t value = crc.value();
    return put(slot, index, value, crc) ? Status::ok : Status::disconnected;
  }

 private:
  struct Newest {
    bool exists = false;
    unsigned slot = 0;
  };

  /// Programs a word, and reads it back.
  bool put(unsigned slot, std::uint32_t index, std::uint32_t word, Crc32& crc) {
    crc.add_word(word);
    return flash_.program(slot, index, word) == Status::ok && flash_.read(slot, index) == word;
  }

  bool is_whole(unsigned slot) const {
    if (flash_.read(slot, 0) != kMagic) return false;
    const std::uint32_t bytes = flash_.read(slot, 3);
    if (bytes > kMostBytes) return false;
    const std::uint32_t words = kHeaderWords + (bytes + 3) / 4;
    Crc32 crc;
    for (std::uint32_t i = 0; i < words; ++i) crc.add_word(flash_.read(slot, i));
    return flash_.read(slot, words) == crc.value();
  }

  Newest find_newest() const {
    const bool whole[kSlots] = {is_whole(0), is_whole(1)};
    if (!whole[0] && !whole[1]) return {};
    if (!whole[0] || !whole[1]) return {true, whole[1] ? 1u : 0u};
    // Sequence numbers wrap: less than half of their range ahead is newer.
    const auto ahead = static_cast<std::int32_t>(flash_.read(1, 2) - flash_.read(0, 2));
    return {true, ahead > 0 ? 1u : 0u};
  }

  bool is_blank() const {
    for (unsigned slot = 0; slot < kSlots; ++slot)
      for (std::uint32_t i = 0; i < kHeaderWords; ++i)
        if (flash_.read(slot, i) != kErasedWord) return false;
    return true;
  }

  F& flash_;
  std::uint32_t layout_version_;
};

}  // namespace furcula::firmware
