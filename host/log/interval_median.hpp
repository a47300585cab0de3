// Median of positive numbers of which there are too many to keep: counts by value to three digits.
#pragma once

#include <bit>
#include <cstdint>
#include <map>
#include <unordered_map>

namespace furcula::log {

class IntervalMedian {
 public:
  /// `value` > 0 and finite.
  void add(double value) {
    const std::uint64_t key = std::bit_cast<std::uint64_t>(value) >> kDroppedBits;
    if (last_ == nullptr || key != last_key_) {
      last_ = &buckets_[key];
      last_key_ = key;
    }
    ++last_->count;
    last_->mean += (value - last_->mean) / static_cast<double>(last_->count);
    ++count_;
  }

  /// Mean of the values that share sign, exponent and ten bits of the fraction with the (lower) median:
  /// within 0.1 % of it. 0 if there are none.
  double value() const {
    const std::map<std::uint64_t, Bucket> ordered(buckets_.begin(), buckets_.end());
    std::uint64_t below = 0;
    for (const auto& [key, bucket] : ordered) {
      below += bucket.count;
      if (2 * below >= count_) return bucket.mean;
    }
    return 0.0;
  }

 private:
  // 11 bits of exponent and 10 of fraction remain: two million buckets at the very most.
  static constexpr int kDroppedBits = 42;
  struct Bucket {
    std::uint64_t count = 0;
    double mean = 0.0;
  };
  std::unordered_map<std::uint64_t, Bucket> buckets_;
  Bucket* last_ = nullptr;  // stays valid: an unordered_map's elements do not move
  std::uint64_t last_key_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace furcula::log
