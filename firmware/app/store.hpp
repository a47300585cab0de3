// The seam to where parameters are kept over a restart: flash slots on a controller, a file on a computer.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "furcula/bus/node_words.hpp"
#include "furcula/core/status.hpp"

namespace furcula::firmware {

/// A store keeps one image of at most bus::kImageBytesMax bytes. What load() gives is whole, or it is not
/// given.
template <class S>
concept ParameterStore = requires(S& store, std::span<std::uint8_t> into,
                                  std::span<const std::uint8_t> image) {
  /// The image's bytes, at the beginning of `into`: how many. 0: nothing was ever saved. `invalid`:
  /// something was, and it is damaged or longer than `into`.
  { store.load(into) } -> std::same_as<Result<std::size_t>>;
  /// May take long: ticks are missed meanwhile. A power cut leaves the old image or the new one.
  { store.save(image) } -> std::same_as<Status>;
};

/// A store whose memory wears says besides whether it may be written to now; a node then also limits how often
/// (firmware/store/save_limit.hpp).
template <class S>
concept WearingStore = ParameterStore<S> && requires(S& store) {
  /// none, or why not.
  { store.may_save() } -> std::same_as<bus::Refusal>;
};

/// Of a store that saves while the ticks go on.
enum class SaveProgress : std::uint8_t { under_way, done, failed };

/// Its save() takes the image, or refuses it, at once; saved() says what came of the last one that it took.
template <class S>
concept SavesAside = ParameterStore<S> && requires(const S& store) {
  { store.saved() } -> std::same_as<SaveProgress>;
};

/// Keeps nothing: for a board without a place to keep it.
struct NoStore {
  static Result<std::size_t> load(std::span<std::uint8_t>) { return std::size_t{0}; }
  static Status save(std::span<const std::uint8_t>) { return Status::disconnected; }
};
static_assert(ParameterStore<NoStore>);

}  // namespace furcula::firmware
