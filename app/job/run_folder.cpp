#include "app/job/run_folder.h"

#include <algorithm>
#include <system_error>

#include "app/session/session.h"
#include "app/stage/result_files.h"
#include "core/base/output_file.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSessionParts[] = {"", "-wal", "-shm", "-journal"};  // of SQLite
constexpr const char* kProbeFile = ".burrhole-probe";

/// @returns whether there is a file or a link of that name, wherever the link leads.
bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

/// @returns whether a name is that of a result, or of a temporary file of one, which a killed run left.
bool is_result(const std::string& name) {
  if (name == kLockFile || name == kSetAsideFolder || name == kDroppedFolder || name == kEarlierBoneFile || name == kChosenSceneFile)
    return false;
  if (is_result_name(name)) return true;
  const auto is_part_of = [&](const std::string& file) { return is_temporary_of(name, file); };
  return is_part_of(kSummaryFile) || is_part_of(kReportFile) || is_part_of(kBoneFile) || is_part_of(kSoundFile) ||
         is_part_of(kChosenSceneFile) || is_part_of(kProbeFile) ||
         std::ranges::any_of(kPictureNames, [&](const char* picture) { return is_part_of(std::string(picture) + ".png"); });
}

Status make_output_folder(const std::string& folder, const std::string& option) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder))
    return bad_input("the output folder cannot be created: " + (error ? error.message() : "not a folder") + "; give another by " + option,
                     folder);
  // Writes as the check: permissions do not show a read-only medium or a full disk, and do not apply to root.
  auto probe = OutputFile::create((fs::path(folder) / kProbeFile).string());
  Status written = probe ? probe->write("probe") : Status(probe.error());
  if (written) written = probe->seek(0);  // writes what is buffered
  if (!written) return bad_input("the output folder: " + written.error().message, folder);
  return {};
}

}  // namespace

Result<FolderLock> take_output_folder(const std::string& folder, const char* option) {
  if (!folder.empty())
    if (const Status made = make_output_folder(folder, option); !made) return made.error();
  return FolderLock::take(folder, option);
}

Status check_is_ours(const std::string& folder) {
  std::error_code ignored;
  std::optional<std::string> foreign;
  for (fs::directory_iterator at(folder, ignored), end; !ignored && at != end; at.increment(ignored)) {
    const std::string name = at->path().filename().string();
    if (name == kSummaryFile || name == kEarlierBoneFile || name == kLockFile || name == kSetAsideFolder || name == kDroppedFolder)
      return {};
    if (at->path().extension() == ".sqlite" && is_session_file(at->path().string())) return {};
    if (name != kChosenSceneFile && is_result_name(name) && (!foreign || name < *foreign)) foreign = name;
  }
  if (!foreign) return {};
  return bad_input("is no result of burrhole drill: give another folder by --out, or --force to replace it",
                   (fs::path(folder) / *foreign).string());
}

Status check_source(const LoadedScene& loaded, const std::string& folder) {
  const auto& scan = loaded.scene.volume.scan;
  std::error_code ignored;
  if (folder.empty() || !scan || !loaded.scene.output.bone) return {};
  if (!fs::equivalent(scan->request.path, fs::path(folder) / kBoneFile, ignored)) return {};
  return bad_input("is the bone that this run would replace: give another folder by --out, or copy the file", scan->request.path);
}

fs::path EarlierResults::aside() const { return fs::path(config_.folder) / kSetAsideFolder; }

bool EarlierResults::is_input(const fs::path& file) const {
  return std::ranges::any_of(config_.inputs, [&](const std::string& input) {
    std::error_code ignored;
    return fs::equivalent(input, file, ignored);
  });
}

Result<std::vector<std::string>> EarlierResults::found() const {
  const fs::path folder(config_.folder);
  std::error_code error, ignored;
  std::vector<std::string> out;
  fs::directory_iterator at;
  do at = fs::directory_iterator(folder, error);
  while (error == std::errc::interrupted);
  for (const fs::directory_iterator end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    const fs::file_status status = at->symlink_status(ignored);
    // An input that this run does not write itself stays where the scene or a replay reads it.
    const bool stays = name == kBoneFile && !config_.writes_bone && is_input(at->path());
    if (is_result(name) && !stays && (fs::is_regular_file(status) || fs::is_symlink(status))) out.push_back(name);
  }
  if (error) return bad_input("the output folder cannot be read: " + error.message(), config_.folder);
  std::vector<std::string> sessions;
  if (config_.session) sessions.push_back(*config_.session);
  // A run without a session would leave that of the earlier results beside its own.
  if (std::ranges::find(out, kSummaryFile) != out.end() && config_.session != kSessionFile) sessions.emplace_back(kSessionFile);
  for (const std::string& session : sessions)
    if (is_session_file((folder / session).string()))
      for (const char* part : kSessionParts)
        if (fs::is_regular_file(folder / (session + part), ignored)) out.push_back(session + part);
  return out;
}

Status EarlierResults::put_back() const {
  const fs::path folder(config_.folder);
  std::error_code error;
  fs::remove_all(folder / kDroppedFolder, error);
  std::vector<std::string> names;
  if (fs::is_directory(aside(), error))
    for (fs::recursive_directory_iterator at(aside(), error), end; !error && at != end; at.increment(error))
      if (!at->is_directory() || at->is_symlink()) names.push_back(at->path().lexically_relative(aside()).string());
  const bool has_results = is_there(folder / kSummaryFile);  // which the run that was killed has not written
  for (const std::string& name : names)                      // its session has a log, which is not that of the session that comes back
    if (!has_results && is_session_file((aside() / name).string()))
      for (const char* part : kSessionParts) fs::remove((folder / name).string() + part, error);
  for (const std::string& name : names) {
    if (has_results && is_there(folder / name)) continue;
    fs::create_directories((folder / name).parent_path(), error);
    fs::rename(aside() / name, folder / name, error);
    if (error) return bad_input("the results of an earlier run cannot be put back: " + error.message(), (aside() / name).string());
  }
  fs::remove_all(aside(), error);
  return {};
}

Result<EarlierResults> EarlierResults::set_aside(EarlierResultsConfig config) {
  EarlierResults out(std::move(config));
  if (out.config_.folder.empty()) return out;
  if (Status complete = out.put_back(); !complete) return complete.error();
  const auto names = out.found();
  if (!names) return names.error();
  const fs::path kept = fs::path(out.config_.folder) / kEarlierBoneFile;
  if (std::ranges::find(*names, kBoneFile) != names->end() && out.is_input(kept))
    return bad_input(
        "is an input of this run, and the name that the bone of the earlier run would get: copy the file, or give another folder by --out",
        kept.string());
  for (const std::string& name : *names) {
    const fs::path from = fs::path(out.config_.folder) / name, to = out.aside() / name;
    std::error_code error;
    fs::create_directories(to.parent_path(), error);
    if (!error) fs::rename(from, to, error);
    if (error) return bad_input("the results of an earlier run cannot be set aside: " + error.message(), from.string());
    out.moved_.push_back(name);
  }
  return out;
}

EarlierResults::EarlierResults(EarlierResults&& other) noexcept
    : config_(std::move(other.config_)), moved_(std::exchange(other.moved_, {})) {
  other.config_.folder.clear();
}

EarlierResults::~EarlierResults() {
  if (config_.folder.empty() || moved_.empty()) return;
  bool all = true;
  std::error_code error;
  for (const std::string& name : moved_) {
    fs::rename(aside() / name, fs::path(config_.folder) / name, error);
    all = all && !error;
  }
  if (all) fs::remove_all(aside(), error);
}

Status EarlierResults::drop() {
  if (config_.folder.empty() || !is_there(aside())) return {};
  const fs::path folder(config_.folder), bone = aside() / kBoneFile, kept = folder / kEarlierBoneFile, dropped = folder / kDroppedFolder;
  std::error_code error, ignored;
  const bool has_bone = is_there(bone);
  if (has_bone) fs::rename(bone, kept, error);
  if (error) return bad_input("the bone of an earlier run cannot be set aside: " + error.message(), bone.string());
  // Until here a kill leaves results that put_back() finds; from here on it leaves what it deletes.
  fs::rename(aside(), dropped, error);
  if (error) {
    if (has_bone) fs::rename(kept, bone, ignored);
    return bad_input("the results of an earlier run cannot be deleted: " + error.message(), aside().string());
  }
  fs::remove_all(dropped, ignored);
  moved_.clear();
  return {};
}

void EarlierResults::replaced() const {
  const fs::path file = fs::path(config_.folder) / kEarlierBoneFile;
  std::error_code ignored;
  if (!config_.folder.empty() && config_.writes_bone && !is_input(file)) fs::remove(file, ignored);
}

}  // namespace burrhole
