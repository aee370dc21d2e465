#include "app/job/bone_exports.h"

#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "app/run/start_thread.h"
#include "app/stage/result_files.h"
#include "core/base/caught_error.h"
#include "core/base/output_file.h"
#include "volumes/export_bone.h"

namespace burrhole {
namespace {

std::string text_of(const std::string& name, const ExportReport& done) {
  const std::string size = done.triangles > 0 ? fmt::format("{} triangles", done.triangles)
                                              : fmt::format("{} x {} x {} voxels", done.dims.x, done.dims.y, done.dims.z);
  return fmt::format("{}: {}, {}, {:.1f} MB", name, done.format, size, static_cast<double>(done.bytes) * 1e-6);
}

}  // namespace

Result<ExportReport> write_bone(const Voxmap& bone, const std::string& path, const std::function<void()>& made) {
  try {
    if (const auto file = OutputFile::create(path); !file) return file.error();  // removed again: a mesh takes seconds
    bool is_made = false;
    auto done = export_bone(bone, {.path = path, .ball = true, .begin = [&] {
                                     is_made = true;
                                     if (made) made();
                                   }});
    if (done || is_made || done.error().code != ErrorCode::bad_input) return done;
    return export_bone(bone, {.path = path, .begin = made});
  } catch (...) {
    return caught_error();
  }
}

Result<std::unique_ptr<Voxmap>> BoneExports::copy_of(const Voxmap& bone) const {
  auto made = Voxmap::create(config_.bone, {});
  if (!made) return made.error();
  auto out = std::make_unique<Voxmap>(std::move(made).value());
  std::vector<BlockChange> changes;
  out->blocks().for_each_block([&](const Vec3i& block, const BlockValues&) {
    if (bone.blocks().find(block) == nullptr) changes.push_back({block, nullptr});
  });
  bone.blocks().for_each_block([&](const Vec3i& block, const BlockValues& values) { changes.push_back({block, &values}); });
  out->put_blocks(changes);
  return out;
}

Result<std::string> BoneExports::begin(const Voxmap& bone, double time, const std::string& format) {
  if (config_.folder.empty()) return bad_input("there is no output folder for the bone");
  const std::string name = export_file_name(time, format);
  if (const auto known = export_format(name); !known) return known.error();
  if (writing_.joinable()) writing_.join();
  auto copy = copy_of(bone);
  if (!copy) return copy.error();
  copy_ = std::move(copy).value();
  if (Status started = start_thread(writing_, [this, name] { write(*copy_, name); }); !started) return started.error();
  return name;
}

void BoneExports::write(const Voxmap& bone, const std::string& name) {
  const auto done = write_bone(bone, (std::filesystem::path(config_.folder) / name).string());
  if (!done && written_) written_ = done.error();
  if (config_.say) config_.say(done ? text_of(name, *done) : done.error().text(), !done);
}

Status BoneExports::finish() {
  if (writing_.joinable()) writing_.join();
  copy_.reset();
  return written_;
}

}  // namespace burrhole
