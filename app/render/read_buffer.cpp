#include "app/render/read_buffer.h"

namespace burrhole {
namespace {

constexpr GLbitfield kMapping = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
constexpr GLuint64 kNanosecondsAWait = 1'000'000'000;

}  // namespace

std::span<const Rgba8> ReadBuffer::read(const PixelRect& part) {
  const auto count = static_cast<std::size_t>(part.count());
  if (count > pixels_) {
    const auto bytes = static_cast<GLsizeiptr>(count * sizeof(Rgba8));
    buffer_ = make_buffer(gl_);
    gl_.NamedBufferStorage(buffer_.name(), bytes, nullptr, kMapping | GL_CLIENT_STORAGE_BIT);
    memory_ = static_cast<const Rgba8*>(gl_.MapNamedBufferRange(buffer_.name(), 0, bytes, kMapping));
    pixels_ = memory_ == nullptr ? 0 : count;
    if (memory_ == nullptr) return {};
  }
  gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.name());
  gl_.ReadPixels(part.lo.x, part.lo.y, part.size().x, part.size().y, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  const GLsync written = gl_.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  while (gl_.ClientWaitSync(written, GL_SYNC_FLUSH_COMMANDS_BIT, kNanosecondsAWait) == GL_TIMEOUT_EXPIRED) {
  }
  gl_.DeleteSync(written);
  return {memory_, count};
}

}  // namespace burrhole
