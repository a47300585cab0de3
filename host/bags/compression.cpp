// zstd and lz4, see compression.hpp.
#include "host/bags/compression.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <new>

#include "host/core/error.hpp"

namespace furcula::bags {
namespace {

/// Calls step(from, from_size, to, to_size) until it is done: both sizes become what was used, the result is whether a frame is complete,
/// or nothing where the bytes are damaged. The output grows by doubling: a length that a file claims allocates nothing.
enum class Step { frame_ends, goes_on, damaged };
template <class F>
Decompressed grow(std::string_view bytes, std::size_t most, std::string& to, const F& step) {
  std::size_t used = 0, made = 0;
  bool complete = bytes.empty();
  to.resize(std::min({std::max<std::size_t>(4096, 4 * bytes.size()), most + 1, std::size_t{1} << 24}));
  for (;;) {
    std::size_t from = bytes.size() - used, room = to.size() - made;
    switch (step(bytes.data() + used, from, to.data() + made, room)) {
      case Step::damaged:
        to.resize(made);
        return Decompressed::damaged;
      case Step::frame_ends:
        complete = true;
        break;
      case Step::goes_on:
        complete = false;
        break;
    }
    const bool moved = from != 0 || room != 0;
    used += from;
    made += room;
    if (made > most) {
      to.resize(most);
      return Decompressed::damaged;
    }
    if (complete && used == bytes.size()) break;
    if (made == to.size())
      to.resize(std::min(most + 1, 2 * to.size()));
    else if (!moved || (used == bytes.size() && room == 0))
      break;
  }
  to.resize(made);
  return complete ? Decompressed::whole : Decompressed::cut;
}

}  // namespace

Decompressed unzstd(std::string_view bytes, std::size_t most, std::string& to) {
  // Kept from call to call: messages are small, and a context is not.
  thread_local const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                                     ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  ZSTD_DCtx_reset(context.get(), ZSTD_reset_session_only);
  return grow(bytes, most, to,
              [&](const char* from, std::size_t& from_size, char* out, std::size_t& out_size) {
                ZSTD_inBuffer in{from, from_size, 0};
                ZSTD_outBuffer room{out, out_size, 0};
                const std::size_t result = ZSTD_decompressStream(context.get(), &room, &in);
                from_size = in.pos;
                out_size = room.pos;
                if (ZSTD_isError(result) != 0) return Step::damaged;
                return result == 0 ? Step::frame_ends : Step::goes_on;
              });
}

Decompressed unlz4(std::string_view bytes, std::size_t most, std::string& to) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(made,
                                                                             LZ4F_freeDecompressionContext);
  return grow(
      bytes, most, to, [&](const char* from, std::size_t& from_size, char* out, std::size_t& out_size) {
        const std::size_t result = LZ4F_decompress(context.get(), out, &out_size, from, &from_size, nullptr);
        if (LZ4F_isError(result) != 0) {
          from_size = out_size = 0;
          return Step::damaged;
        }
        return result == 0 ? Step::frame_ends : Step::goes_on;
      });
}

struct ZstdSource::State {
  std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context{ZSTD_createDCtx(), ZSTD_freeDCtx};
  std::array<char, 1 << 16> bytes;
  ZSTD_inBuffer in{bytes.data(), 0, 0};
};

ZstdSource::ZstdSource(core::ByteSource& source, std::string name)
    : source_(source), name_(std::move(name)), state_(std::make_unique<State>()) {
  if (!state_->context) throw std::bad_alloc();
}
ZstdSource::~ZstdSource() = default;

std::size_t ZstdSource::read(char* to, std::size_t size) {
  ZSTD_outBuffer out{to, size, 0};
  while (out.pos == 0 && size != 0) {
    const bool used = state_->in.pos == state_->in.size;
    if (used)
      state_->in = {state_->bytes.data(), source_.read(state_->bytes.data(), state_->bytes.size()), 0};
    const bool at_end = state_->in.size == 0;
    const std::size_t result = ZSTD_decompressStream(state_->context.get(), &out, &state_->in);
    if (ZSTD_isError(result) != 0)
      throw core::DataError(name_ + ": is damaged (zstd: " + ZSTD_getErrorName(result) +
                            "); expected the file as it was recorded: copy it again");
    if (at_end && out.pos == 0) return 0;
  }
  return out.pos;
}

}  // namespace furcula::bags
