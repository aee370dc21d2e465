/// app/stage/result_files.h: names of the files that a run writes into its output folder, apart from the session, whose name a scene sets.
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>

namespace burrhole {

inline constexpr const char* kSummaryFile = "summary.json";
inline constexpr const char* kReportFile = "report.html";
inline constexpr const char* kBoneFile = "bone.vdb";
inline constexpr const char* kEarlierBoneFile = "bone.earlier.vdb";  ///< of an earlier run, until this run has written its own
inline constexpr const char* kSoundFile = "sound.wav";
inline constexpr const char* kSessionFile = "session.sqlite";  ///< unless the scene names another
inline constexpr const char* kChosenSceneFile = "scene.toml";  ///< of a site on a scan that a person chose
inline constexpr const char* kLockFile = ".burrhole-run";
inline constexpr const char* kSetAsideFolder = ".burrhole-earlier";  ///< results of an earlier run, until this one starts
inline constexpr const char* kDroppedFolder = ".burrhole-dropped";   ///< the same, while they are deleted
/// Pictures, without their ending .png.
inline constexpr const char* kPictureNames[] = {"overview", "before", "during", "breakthrough", "after", "cutaway"};

/// @returns the name of a file of the bone at a time [s] of the run. @param format its ending without the dot.
[[nodiscard]] inline std::string export_file_name(double time, std::string_view format) {
  char at[64];
  std::snprintf(at, sizeof at, "%.3f", time);
  return "bone_at_" + std::string(at) + "s." + std::string(format);
}
/// @returns whether a name is one of export_file_name().
[[nodiscard]] inline bool is_export_name(std::string_view name) {
  constexpr std::string_view kStart = "bone_at_", kTime = "0123456789.";
  if (!name.starts_with(kStart)) return false;
  const std::size_t end = name.find_first_not_of(kTime, kStart.size());
  return end != std::string_view::npos && end > kStart.size() && name.substr(end).starts_with("s.");
}

/// @returns whether a file or folder of that name in the output folder would be replaced by another result of the run.
[[nodiscard]] inline bool is_result_name(std::string_view name) {
  for (const char* const file :
       {kSummaryFile, kReportFile, kBoneFile, kEarlierBoneFile, kSoundFile, kChosenSceneFile, kLockFile, kSetAsideFolder, kDroppedFolder})
    if (name == file) return true;
  if (is_export_name(name)) return true;
  return std::ranges::any_of(kPictureNames, [&](const char* picture) { return name == std::string(picture) + ".png"; });
}

}  // namespace burrhole
