#include "app/cli/film.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "app/cli/png_writer.h"
#include "app/job/run_folder.h"
#include "core/base/assert.h"
#include "core/base/child_attributes.h"
#include "core/base/output_file.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

/// Endings of videos, and the name that ffmpeg has for each format.
constexpr std::array<std::pair<const char*, const char*>, 3> kVideos{{{".mp4", "mp4"}, {".mkv", "matroska"}, {".webm", "webm"}}};

/// @returns ffmpeg's name of the format; null: not a video.
const char* format_of(const std::string& ending) {
  for (const auto& [known, format] : kVideos)
    if (ending == known) return format;
  return nullptr;
}

/// Whether a name is `frame_`, digits and `.png`, as FolderFilm gives them.
bool is_frame(std::string_view name) {
  constexpr std::string_view kStart = "frame_", kEnd = ".png";
  if (!name.starts_with(kStart) || !name.ends_with(kEnd) || name.size() <= kStart.size() + kEnd.size()) return false;
  const std::string_view number = name.substr(kStart.size(), name.size() - kStart.size() - kEnd.size());
  return number.find_first_not_of("0123456789") == std::string_view::npos;
}

/// @returns the files in a folder that have names of frames.
std::vector<fs::path> find_frames(const std::string& folder, std::error_code& error) {
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (is_frame(entry->path().filename().string())) found.push_back(entry->path());
  return found;
}

/// Removes the frames of an earlier film.
Status remove_frames(const std::string& folder) {
  std::error_code error;
  const std::vector<fs::path> found = find_frames(folder, error);
  for (const fs::path& file : found)
    if (!error) fs::remove(file, error);
  if (error)
    return bad_input("cannot remove the frames of an earlier film: " + error.message() + "; give another folder by --video", folder);
  return {};
}

/// @returns the program's path, as a shell would find it; empty: there is none.
std::string find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (const std::string file = (fs::path(folder) / name).string(); access(file.c_str(), X_OK) == 0) return file;
  return {};
}

class FolderFilm final : public FilmWriter {
 public:
  /// @param own whether no other part of this process takes the folder.
  FolderFilm(std::string folder, bool own) : folder_(std::move(folder)), own_(own) {}
  Status take() {
    if (!own_ || lock_) return {};
    auto lock = take_output_folder(folder_, "--video");
    if (!lock) return lock.error();
    lock_.emplace(std::move(lock).value());
    return {};
  }
  Status add(const Image& image) override {
    if (frames_ == 0)
      if (Status begun = begin(); !begun) return begun;
    return writer_.add((fs::path(folder_) / fmt::format("frame_{:06}.png", frames_++)).string(), image);
  }
  Status finish() override { return frames_ > 0 ? writer_.wait() : Status(); }

 private:
  Status begin() {
    if (Status taken = take(); !taken) return taken;
    return remove_frames(folder_);
  }

  std::string folder_;
  bool own_;
  std::optional<FolderLock> lock_;
  PngWriter writer_;
};

/// Frames go to ffmpeg through a socket and not a pipe: if ffmpeg ends early, a send is an error and not a signal.
class VideoFilm final : public FilmWriter {
 public:
  VideoFilm(std::string program, std::string file, const char* format, int rate)
      : program_(std::move(program)), file_(std::move(file)), format_(format), rate_(rate) {}
  ~VideoFilm() override {
    if (process_ <= 0) return;
    close(socket_);
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }

  Status add(const Image& image) override {
    if (process_ == 0)
      if (Status started = start(image.width, image.height); !started) return started;
    BH_ASSERT(image.width == width_ && image.height == height_);
    const auto* bytes = reinterpret_cast<const char*>(image.pixels.data());
    std::size_t left = image.pixels.size() * sizeof(Rgba8);
    while (left > 0) {
      const ssize_t sent = send(socket_, bytes, left, MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent < 0) return failed("it reads no more frames");
      bytes += sent;
      left -= static_cast<std::size_t>(sent);
    }
    ++frames_;
    return {};
  }

  Status finish() override {
    if (process_ == 0) return {};  // no frame
    close(socket_);
    int status = 0;
    pid_t ended = 0;
    do ended = waitpid(process_, &status, 0);
    while (ended < 0 && errno == EINTR);
    process_ = 0;
    if (ended < 0) return failed(std::strerror(errno));  // part_ removes what there is
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
      return failed(WIFEXITED(status) ? fmt::format("exit {}", WEXITSTATUS(status)) : std::string("it was ended"));
    const auto done = part_->commit();
    return done ? Status() : Status(done.error());
  }

 private:
  Error failed(const std::string& why) const {
    return {ErrorCode::unavailable, "ffmpeg failed (" + why + ") and wrote no video; give a folder to get its frames", file_};
  }

  Status start(int width, int height) {
    width_ = width;
    height_ = height;
    auto part = OutputFile::create(file_);
    if (!part) return part.error();
    part_.emplace(std::move(part).value());
    if (part_->temporary().empty()) return bad_input("a video cannot be written into a pipe or a device: name a file", file_);
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return failed(std::strerror(errno));
    // Most players need 4:2:0, which has even sides.
    std::vector<std::string> words{"ffmpeg",
                                   "-loglevel",
                                   "error",
                                   "-y",
                                   "-f",
                                   "rawvideo",
                                   "-pix_fmt",
                                   "rgba",
                                   "-s",
                                   fmt::format("{}x{}", width, height),
                                   "-r",
                                   std::to_string(rate_),
                                   "-i",
                                   "pipe:0",
                                   "-vf",
                                   "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                   "-pix_fmt",
                                   "yuv420p",
                                   "-f",
                                   format_,
                                   "file:" + part_->temporary()};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    // In a process group of its own: Ctrl-C ends the run, which then completes the video.
    const ChildAttributes attributes(true);
    const int refused = posix_spawn(&process_, program_.c_str(), &actions, attributes.get(), arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    socket_ = ends[0];
    if (refused == 0) return {};
    close(socket_);
    process_ = 0;
    return failed(std::strerror(refused));
  }

  std::string program_, file_;
  std::optional<OutputFile> part_;  // ffmpeg writes its temporary file
  const char* format_;
  int rate_;                    // [1/s]
  int width_ = 0, height_ = 0;  // [pixels] of a frame
  int socket_ = -1;
  pid_t process_ = 0;  // 0: not started, or ended
};

}  // namespace

Result<std::unique_ptr<FilmWriter>> FilmWriter::create(const FilmOptions& options) {
  const std::string& path = options.path;
  const fs::path given(path);
  std::string ending = given.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::error_code ignored;
  const bool is_folder = fs::is_directory(given, ignored);
  const char* format = format_of(ending);
  if (format != nullptr && is_folder) return bad_input("a video has this name, but it is a folder: choose another name", path);
  if (format == nullptr && !is_folder && !ending.empty()) return bad_input("a film is a folder, or a file .mp4, .mkv or .webm", path);
  if (format == nullptr && is_folder && !options.replace)
    if (const auto frames = find_frames(path, ignored); !frames.empty())
      return bad_input(
          fmt::format("holds {} {}, {} for example: give another folder by --video, or --force to replace them", frames.size(),
                      frames.size() == 1 ? "frame of a film" : "frames of a film", std::ranges::min(frames).filename().string()),
          path);
  if (format == nullptr) {
    const bool own =
        options.run_folder.empty() || fs::weakly_canonical(given, ignored) != fs::weakly_canonical(options.run_folder, ignored);
    auto film = std::make_unique<FolderFilm>(path, own);
    if (is_folder)  // another one is made and taken with the first frame
      if (const Status taken = film->take(); !taken) return taken.error();
    return std::unique_ptr<FilmWriter>(std::move(film));
  }
  const std::string program = find_program("ffmpeg");
  if (program.empty())
    return Error{ErrorCode::unavailable, "a video needs the program ffmpeg, which is not installed; give a folder to get its frames", path};
  const std::string folder = given.parent_path().empty() ? "." : given.parent_path().string();
  if (!fs::is_directory(folder, ignored))
    return bad_input("there is no such folder for the video: make it, or give another by --video", folder);
  if (access(folder.c_str(), W_OK) != 0) return bad_input("cannot write into the folder of the video: give another by --video", folder);
  return std::unique_ptr<FilmWriter>(std::make_unique<VideoFilm>(program, path, format, options.fps));
}

}  // namespace burrhole::cli
