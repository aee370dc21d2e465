#include "app/window/file_list.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "app/window/file_browser.h"

using namespace burrhole;

namespace {

namespace fs = std::filesystem;

/// A folder that goes with the test.
struct Folder {
  Folder() : path(fs::temp_directory_path() / ("burrhole-files-" + std::to_string(getpid()))) {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { fs::remove_all(path); }
  void write(const std::string& name, const std::string& bytes) const {
    fs::create_directories((path / name).parent_path());
    std::ofstream(path / name, std::ios::binary) << bytes;
  }
  fs::path path;
};

std::vector<std::string> names_of(const FolderList& list) {
  std::vector<std::string> out;
  for (const FileLine& line : list.lines) out.push_back(line.name);
  return out;
}

const std::string kSlice = std::string(128, '\0') + "DICM" + "the rest";

}  // namespace

TEST_CASE("files: what can be opened is listed with what it is, folders first; the rest is counted") {
  const Folder folder;
  folder.write("b/inside.nii", "");
  folder.write("A/inside.nii", "");
  folder.write(".hidden/inside.nii", "");
  folder.write("scan.NII.GZ", "");
  folder.write("skull.stl", "");
  folder.write("bone.vdb", "");
  folder.write("my scene.toml", "title = \"Mine\"\n[volume]\nsource = \"phantom:plate\"\n");
  folder.write("raw.toml", "dims = [1, 2, 3]\n");
  folder.write("tool.toml", "name = \"a tool\"\n");
  folder.write("torn.toml", "title = \n");
  folder.write("notes.txt", "DICM");
  folder.write("0001", kSlice);
  folder.write("0002", kSlice);
  folder.write(".DS_Store", "");
  const auto list = list_folder(folder.path.string() + "/");
  REQUIRE(list.ok());
  CHECK(names_of(*list) == std::vector<std::string>{"..", "The scan in this folder and those below", "A", "b", "bone.vdb", "my scene.toml",
                                                    "raw.toml", "scan.NII.GZ", "skull.stl", "torn.toml"});
  CHECK(list->others == 2);  // the tool and the notes
  const std::vector<FileKind> kinds{FileKind::folder, FileKind::slices, FileKind::folder, FileKind::folder, FileKind::grids,
                                    FileKind::scene,  FileKind::scan,   FileKind::scan,   FileKind::mesh,   FileKind::scene};
  for (std::size_t n = 0; n < kinds.size(); ++n) CHECK(list->lines[n].kind == kinds[n]);
  CHECK(list->lines[1].about == "DICOM, 2 files here");
  CHECK(list->lines[1].path == folder.path);
  CHECK(list->lines[5].about == "scene: Mine");
  CHECK(list->lines[9].about.find("torn.toml:1") != std::string::npos);
  CHECK(list->lines[0].path == folder.path.parent_path());
}

TEST_CASE("files: a folder that is not there, and a file in place of a folder, are one line") {
  const Folder folder;
  folder.write("a.nii", "");
  for (const char* name : {"none", "a.nii"}) {
    const auto list = list_folder(folder.path / name);
    REQUIRE_FALSE(list.ok());
    CHECK(list.error().text().find(name) != std::string::npos);
    CHECK(list.error().text().find('\n') == std::string::npos);
  }
  const auto root = list_folder("/");
  REQUIRE(root.ok());
  CHECK(std::ranges::none_of(root->lines, [](const FileLine& line) { return line.name == ".."; }));
}

TEST_CASE("browser: a person goes into folders and back, and a folder that has gone leaves the list as it was") {
  const Folder folder;
  folder.write("one/deep/a.nii", "");
  folder.write("two/b.mha", "");
  FileBrowser browser(folder.path);
  REQUIRE(browser.choices().size() == 3);
  CHECK(browser.choices()[2].title == "two/");
  CHECK_FALSE(browser.open(2).has_value());
  CHECK(browser.folder() == folder.path / "two");
  const auto file = browser.open(1);
  REQUIRE(file.has_value());
  CHECK(file->path == folder.path / "two" / "b.mha");
  browser.leave();
  CHECK(browser.folder() == folder.path);
  CHECK(browser.selection().at() == 2);  // where the person came from
  fs::remove_all(folder.path / "one");
  CHECK_FALSE(browser.open(1).has_value());
  CHECK(browser.folder() == folder.path);
  CHECK(browser.problem().find("one") != std::string::npos);
  CHECK(browser.choices().size() == 3);
  CHECK_FALSE(browser.open(99).has_value());
  CHECK_FALSE(browser.open(2).has_value());
  CHECK(browser.problem().empty());
}
