#include "app/cli/recorded_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/cli/commands.h"
#include "app/job/provenance.h"
#include "app/report/file.h"
#include "app/stage/result_files.h"
#include "core/base/hash.h"
#include "core/base/physics_version.h"
#include "core/config/toml_messages.h"

namespace burrhole::cli {

Result<std::string> session_of(const std::string& file_or_folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(file_or_folder, ignored)) return file_or_folder;
  const auto path = std::filesystem::path(file_or_folder) / kSessionFile;
  if (!std::filesystem::exists(path, ignored))
    return bad_input("holds no session.sqlite: a run writes one where its scene has the table [record]", file_or_folder);
  return path.string();
}

Result<LoadedScene> load_recorded(const SessionReader& session, std::size_t ticks, bool display) {
  auto document = TomlDocument::parse(session.meta().scene, session.meta().scene_path);
  if (!document) return document.error();
  (void)document->rename();              // keys of earlier versions
  (void)document->unset("record.path");  // of earlier versions it may lead out of the output folder; a replay records nothing
  RecordedFile plan;
  if (Status written = plan.write(session, "markups"); !written) return written.error();
  if (!plan.path().empty())
    if (Status set = document->set("approach.markups=" + toml_string(plan.path())); !set) return set.error();
  Issues issues;
  auto loaded = load_scene(*document, scene_context(), issues, {.tool_text = session.meta().tool, .progress = {}, .say = {}});
  if (!loaded) return issues.front();
  if (!display) (void)loaded->scene.effects.remove("display");
  loaded->scene.duration = static_cast<double>(ticks) / loaded->scene.servo_hz;
  return std::move(*loaded);
}

std::optional<BoneHashes> bone_hashes(const SessionReader& session, const LoadedScene& loaded) {
  const auto recorded = std::ranges::find(session.hashes(), "volume", &SessionHash::kind);
  if (!loaded.import || recorded == session.hashes().end()) return std::nullopt;
  const auto now = volume_hash(*loaded.bone);
  if (!now) return std::nullopt;
  return BoneHashes{recorded->value, hash_text(*now)};
}

std::string changed_bone(const SessionReader& session, const LoadedScene& loaded) {
  const auto hashes = bone_hashes(session, loaded);
  if (!hashes || hashes->recorded == hashes->now) return {};
  return fmt::format(
      "{}: is not the bone of the recorded run: it was replaced or is read differently since, so that results differ; put the earlier file "
      "there",
      loaded.scene.volume.scan ? loaded.scene.volume.scan->request.path : session.meta().scene_path);
}

std::string why_different(const SessionMeta& meta) {
  if (meta.physics_version == kPhysicsVersion) return {};
  return fmt::format("recorded with physics version {}, replayed with {}: equal results are promised for equal versions only",
                     meta.physics_version, kPhysicsVersion);
}

Status RecordedFile::write(const SessionReader& session, const std::string& kind) {
  for (const SessionEvent& event : session.events()) {
    if (event.kind != kind) continue;
    const std::string name = std::filesystem::path(event.text).filename().string();  // its ending names the format
    const std::string ending = name.substr(std::min(name.find('.'), name.size()));
    folder_ = std::make_unique<ScratchFolder>();
    if (folder_->path().empty()) return bad_input("no temporary folder can be made: name one by TMPDIR");
    path_ = (folder_->path() / (kind + ending)).string();
    if (Status written = write_file(path_, event.data); !written) return written;
  }
  return {};
}

}  // namespace burrhole::cli
