#include "volumes/write/mesh_writer.h"

#include <fmt/format.h>

#include <bit>
#include <iterator>
#include <vector>

#include "core/base/output_file.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

static_assert(std::endian::native == std::endian::little, "STL is little endian, and so is the PLY that is written");

constexpr std::size_t kPiece = 1 << 16;  ///< [bytes] collected before they are written
constexpr const char* kSpace = "burrhole, bone surface. SPACE=LPS, unit mm";

/// Collects small records, and writes them in pieces.
class Records {
 public:
  explicit Records(OutputFile& file) : file_(file) { bytes_.reserve(2 * kPiece); }
  template <class T>
  void put(const T& value) {
    const auto from = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), from.begin(), from.end());
    if (bytes_.size() >= kPiece) flush();
  }
  void put_text(const std::string& text) {
    const auto from = std::as_bytes(std::span(text));
    bytes_.insert(bytes_.end(), from.begin(), from.end());
    if (bytes_.size() >= kPiece) flush();
  }
  void flush() {
    if (const Status written = file_.write(bytes_); !written) status_ = written;
    bytes_.clear();
  }
  [[nodiscard]] const Status& status() const noexcept { return status_; }

 private:
  OutputFile& file_;
  std::vector<std::byte> bytes_;
  Status status_;
};

Vec3f in_mm(const Vec3& metres) { return Vec3f(metres / kMillimetre); }

void put_vector(Records& out, const Vec3f& v) {
  for (std::size_t n = 0; n < 3; ++n) out.put(v[n]);
}

void put_stl(Records& out, const SurfaceMesh& mesh) {
  std::string header(kSpace);
  header.resize(80, ' ');
  out.put_text(header);
  out.put(static_cast<std::uint32_t>(mesh.indices.size() / 3));
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) {
    const auto corner = [&](std::size_t c) -> const Vec3& { return mesh.positions[mesh.indices[n + c]]; };
    const Vec3 across = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    const double length = glm::length(across);
    put_vector(out, length > 0.0 ? Vec3f(across / length) : Vec3f(0.0f));
    for (std::size_t c = 0; c < 3; ++c) put_vector(out, in_mm(corner(c)));
    out.put(std::uint16_t{0});
  }
}

void put_ply(Records& out, const SurfaceMesh& mesh) {
  out.put_text(
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
                  "z\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
                  kSpace, mesh.positions.size(), mesh.indices.size() / 3));
  for (const Vec3& position : mesh.positions) put_vector(out, in_mm(position));
  for (std::size_t n = 0; n < mesh.indices.size(); ++n) {
    if (n % 3 == 0) out.put(std::uint8_t{3});
    out.put(mesh.indices[n]);
  }
}

void put_obj(Records& out, const SurfaceMesh& mesh) {
  out.put_text(fmt::format("# {}\n", kSpace));
  for (const Vec3& position : mesh.positions) {
    const Vec3f mm = in_mm(position);
    out.put_text(fmt::format("v {} {} {}\n", mm.x, mm.y, mm.z));
  }
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3)
    out.put_text(fmt::format("f {} {} {}\n", mesh.indices[n] + 1, mesh.indices[n + 1] + 1, mesh.indices[n + 2] + 1));
}

}  // namespace

Result<std::uint64_t> write_mesh(const std::string& path, const std::string& format, const SurfaceMesh& mesh,
                                 const std::atomic<bool>* stop) {
  if (mesh.indices.size() / 3 > UINT32_MAX) return bad_input("more triangles than the format can count", path);
  auto file = OutputFile::create(path, stop);
  if (!file) return file.error();
  Records records(*file);
  (format == "STL" ? put_stl : format == "PLY" ? put_ply : put_obj)(records, mesh);
  records.flush();
  if (!records.status()) return records.status().error();
  return file->commit();
}

}  // namespace burrhole
