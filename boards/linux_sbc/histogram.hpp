// A histogram of durations that one thread fills and any thread may read.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <string>

namespace furcula::linux_sbc {

/// Bins: below 1 us, then doubling: [1, 2), [2, 4), ... us, the last one open. Adding takes no lock and no
/// memory. A reader sees each bin whole, the bins not of one instant.
class Histogram {
 public:
  static constexpr std::size_t kBins = 18;  ///< the last begins at 65,536 us

  void add(std::int64_t duration_ns) {
    const std::uint64_t ns = duration_ns > 0 ? static_cast<std::uint64_t>(duration_ns) : 0;
    const std::size_t bin = std::bit_width(ns / 1000u);
    raise(bins_[bin < kBins ? bin : kBins - 1]);
    sum_ns_.store(sum_ns_.load(std::memory_order_relaxed) + ns, std::memory_order_relaxed);
    if (ns > most_ns_.load(std::memory_order_relaxed)) most_ns_.store(ns, std::memory_order_relaxed);
  }

  std::uint64_t count(std::size_t bin) const { return bins_[bin].load(std::memory_order_relaxed); }
  std::uint64_t count() const;
  std::uint64_t most_ns() const { return most_ns_.load(std::memory_order_relaxed); }
  /// us; 0 where nothing was added.
  double mean_us() const;
  /// No more than this share (0 to 1) lasted longer than the returned bin's upper end, us; the maximum where
  /// that is less.
  double quantile_us(double share) const;

  /// The table that furculad prints, a line a bin that is not empty.
  std::string text(const char* title) const;

 private:
  static void raise(std::atomic<std::uint64_t>& counter) {
    counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  std::array<std::atomic<std::uint64_t>, kBins> bins_{};
  std::atomic<std::uint64_t> sum_ns_{0}, most_ns_{0};
};

}  // namespace furcula::linux_sbc
