/// app/window/file_list.h: what of a folder a person can open: folders, scenes, scans, meshes. It knows no window.
///   Errors  bad_input: the folder cannot be read; one line.   Thread  any.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

enum class FileKind {
  folder,
  slices,  ///< the DICOM slices of the folder itself
  scene,
  scan,  ///< a file that states its unit of length
  mesh,  ///< a surface, without a unit of length
  grids  ///< .vdb: a bone model, or grids of another program, without a unit of length
};

struct FileLine {
  FileKind kind = FileKind::folder;
  std::string name;   ///< of the file; ".." for the folder above
  std::string about;  ///< what it is; the title of a scene
  std::filesystem::path path;
};

struct FolderList {
  std::filesystem::path folder;
  std::vector<FileLine> lines;  ///< the folder above, slices, folders by name, files by name
  std::size_t others = 0;       ///< files that cannot be opened
};

/// Reads names, the first bytes of files without a known ending, and small TOML files. Names that begin with a dot are left out.
[[nodiscard]] Result<FolderList> list_folder(const std::filesystem::path& folder);

/// @returns $BURRHOLE_DATA where it is a folder, otherwise the current folder.
[[nodiscard]] std::filesystem::path first_folder();

}  // namespace burrhole
