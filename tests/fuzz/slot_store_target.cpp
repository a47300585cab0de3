// The store of the parameters on a flash memory with anything in it: first a byte of how much is asked for,
// then the words of both slots.
#include <array>
#include <vector>

#include "firmware/store/slot_store.hpp"
#include "tests/firmware/store/flash_model.hpp"
#include "tests/fuzz/target.hpp"

namespace furcula::fuzz {
namespace {

using Flash = test::FlashModel<32>;
using Store = firmware::SlotStore<Flash>;
constexpr std::uint32_t kLayout = 1;
constexpr std::uint8_t kUntouched = 0xee;

}  // namespace

bool accepts(std::string_view input) {
  if (input.empty()) return false;
  Flash flash(1);
  for (std::size_t i = 1; i < input.size() && i <= 2 * 4 * Flash::kSlotWords; ++i) {
    const std::size_t at = i - 1, word = at / 4;
    const auto byte = static_cast<std::uint32_t>(static_cast<std::uint8_t>(input[i]));
    static_cast<void>(flash.program(word >= Flash::kSlotWords ? 1u : 0u,
                                    static_cast<std::uint32_t>(word % Flash::kSlotWords),
                                    ~(0xffu << 8 * (at % 4)) | byte << 8 * (at % 4)));
  }
  Store store(flash, kLayout);
  std::vector<std::uint8_t> bytes(static_cast<std::uint8_t>(input[0]), kUntouched);
  const firmware::Loaded loaded = store.load(bytes);
  const bool taken = loaded.status() == Status::ok;
  if (taken) require(loaded.bytes <= bytes.size() && loaded.bytes <= Store::kMostBytes, "what was asked for");
  for (std::size_t i = taken ? loaded.bytes : 0; i < bytes.size(); ++i)
    require(bytes[i] == kUntouched, "nothing else is touched");

  // Whatever was there, what is saved now is loaded, and once more after the next one.
  for (const std::uint8_t value : {std::uint8_t{1}, std::uint8_t{2}}) {
    const std::array<std::uint8_t, 5> saved{value, 7, 0, 255, 3};
    require(store.save(saved) == Status::ok, "it can be saved to");
    std::array<std::uint8_t, 5> again{};
    require(store.load(again).status() == Status::ok && again == saved, "what was saved is loaded");
  }
  return taken;
}

}  // namespace furcula::fuzz
