// Decompresses zstd and lz4: parts of a bag, and a whole file while it is read.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "host/core/byte_source.hpp"

namespace furcula::bags {

/// What one part of a bag may hold when it is decompressed: far above what recorders write (4 MiB).
inline constexpr std::size_t kLargestPart = std::size_t{1} << 30;

enum class Decompressed {
  whole,
  cut,      ///< the bytes end too early; `to` has what there is
  damaged,  ///< they are not what the compressor writes, or more than `most`
};

/// All frames of `bytes`. `to` is overwritten; its size grows with what is really there, up to `most`.
Decompressed unzstd(std::string_view bytes, std::size_t most, std::string& to);
Decompressed unlz4(std::string_view bytes, std::size_t most, std::string& to);

/// Whether the bytes begin as zstd's.
inline bool is_zstd(std::string_view bytes) { return bytes.starts_with("\x28\xb5\x2f\xfd"); }

/// A file that was compressed as a whole. @throws core::DataError: its bytes are damaged. A file that ends too early ends here too.
class ZstdSource final : public core::ByteSource {
 public:
  ZstdSource(core::ByteSource& source, std::string name);
  ~ZstdSource() override;
  ZstdSource(const ZstdSource&) = delete;
  ZstdSource& operator=(const ZstdSource&) = delete;
  std::size_t read(char* to, std::size_t size) override;

 private:
  struct State;
  core::ByteSource& source_;
  std::string name_;
  std::unique_ptr<State> state_;
};

}  // namespace furcula::bags
