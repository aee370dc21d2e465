#include "app/cli/film.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "app/cli/png_writer.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

/// Endings of videos, and the name that ffmpeg has for each format.
constexpr std::array<std::pair<const char*, const char*>, 3> kVideos{{{".mp4", "mp4"}, {".mkv", "matroska"}, {".webm", "webm"}}};

/// @returns ffmpeg's name of the format; null: the path is a folder.
const char* format_of(const std::string& path) {
  for (const auto& [ending, format] : kVideos)
    if (path.ends_with(ending)) return format;
  return nullptr;
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
  explicit FolderFilm(std::string folder) : folder_(std::move(folder)) {}
  Status add(const Image& image) override {
    if (frames_ == 0)
      if (Status cleared = clear(); !cleared) return cleared;
    return writer_.add((fs::path(folder_) / fmt::format("frame_{:06}.png", frames_++)).string(), image);
  }
  Status finish() override { return writer_.wait(); }

 private:
  Status clear() const {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) return bad_input("cannot make the folder of the film: " + error.message(), folder_);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error))
      if (const std::string name = entry.path().filename().string(); name.starts_with("frame_") && name.ends_with(".png"))
        fs::remove(entry.path(), error);
    if (error) return bad_input("cannot remove the frames of an earlier film: " + error.message(), folder_);
    return {};
  }

  std::string folder_;
  PngWriter writer_;
};

/// Frames go to ffmpeg through a socket and not a pipe: if ffmpeg ends early, a send is an error and not a signal.
class VideoFilm final : public FilmWriter {
 public:
  VideoFilm(std::string program, std::string file, const char* format, int rate)
      : program_(std::move(program)), file_(std::move(file)), part_(file_ + ".part"), format_(format), rate_(rate) {}
  ~VideoFilm() override {
    if (process_ <= 0) return;
    close(socket_);
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    std::error_code ignored;
    fs::remove(part_, ignored);
  }

  Status add(const Image& image) override {
    if (process_ == 0)
      if (Status started = start(image.width, image.height); !started) return started;
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
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = 0;
    std::error_code error;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      fs::remove(part_, error);
      return failed(WIFEXITED(status) ? fmt::format("exit {}", WEXITSTATUS(status)) : std::string("it was ended"));
    }
    fs::rename(part_, file_, error);
    if (error) return bad_input("cannot write the video: " + error.message(), file_);
    return {};
  }

 private:
  Error failed(const std::string& why) const { return {ErrorCode::unavailable, "ffmpeg failed (" + why + ") and wrote no video", file_}; }

  Status start(int width, int height) {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return failed(std::strerror(errno));
    // Most players need 4:2:0, which has even sides.
    std::vector<std::string> words{"ffmpeg",   "-loglevel",
                                   "error",    "-y",
                                   "-f",       "rawvideo",
                                   "-pix_fmt", "rgba",
                                   "-s",       fmt::format("{}x{}", width, height),
                                   "-r",       std::to_string(rate_),
                                   "-i",       "pipe:0",
                                   "-vf",      "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                   "-pix_fmt", "yuv420p",
                                   "-f",       format_,
                                   part_};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    const int refused = posix_spawn(&process_, program_.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    socket_ = ends[0];
    if (refused == 0) return {};
    close(socket_);
    process_ = 0;
    return failed(std::strerror(refused));
  }

  std::string program_, file_, part_;
  const char* format_;
  int rate_;  // [1/s]
  int socket_ = -1;
  pid_t process_ = 0;  // 0: not started, or ended
};

}  // namespace

Result<std::unique_ptr<FilmWriter>> FilmWriter::create(const std::string& path, int rate) {
  if (const char* format = format_of(path)) {
    const std::string program = find_program("ffmpeg");
    if (program.empty())
      return Error{ErrorCode::unavailable, "a video needs the program ffmpeg, which is not installed; give a folder to get its frames",
                   path};
    std::error_code error;
    if (const fs::path folder = fs::path(path).parent_path(); !folder.empty() && !fs::is_directory(folder, error))
      return bad_input("there is no such folder for the video", folder.string());
    return std::unique_ptr<FilmWriter>(std::make_unique<VideoFilm>(program, path, format, rate));
  }
  return std::unique_ptr<FilmWriter>(std::make_unique<FolderFilm>(path));
}

}  // namespace burrhole::cli
