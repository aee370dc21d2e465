#include "app/render/upload_ring.h"

#include <cstring>

namespace burrhole {
namespace {

constexpr GLbitfield kMapping = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
constexpr GLuint64 kNanosecondsAWait = 1'000'000'000;

}  // namespace

UploadRing::UploadRing(const GladGLContext& gl) : gl_(gl), buffer_(make_buffer(gl)) {
  constexpr auto kBytes = static_cast<GLsizeiptr>(kSlots * kSlotBytes);
  gl.NamedBufferStorage(buffer_.name(), kBytes, nullptr, kMapping);
  memory_ = static_cast<std::byte*>(gl.MapNamedBufferRange(buffer_.name(), 0, kBytes, kMapping));
}

UploadRing::~UploadRing() {
  for (GLsync fence : read_)
    if (fence != nullptr) gl_.DeleteSync(fence);
}

std::optional<std::size_t> UploadRing::stage(std::initializer_list<std::span<const std::byte>> parts) {
  std::size_t bytes = 0;
  for (const auto& part : parts) bytes += part.size();
  if (memory_ == nullptr || bytes > kSlotBytes) return std::nullopt;
  if (GLsync& fence = read_[next_]; fence != nullptr) {
    while (gl_.ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, kNanosecondsAWait) == GL_TIMEOUT_EXPIRED) {
    }
    gl_.DeleteSync(fence);
    fence = nullptr;
  }
  const std::size_t first = next_ * kSlotBytes;
  std::size_t at = first;
  for (const auto& part : parts) {
    std::memcpy(memory_ + at, part.data(), part.size());
    at += part.size();
  }
  gl_.BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer_.name());
  return first;
}

void UploadRing::finish() {
  gl_.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  read_[next_] = gl_.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  next_ = (next_ + 1) % kSlots;
}

}  // namespace burrhole
