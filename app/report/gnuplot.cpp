#include "app/report/gnuplot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "app/report/file.h"
#include "app/report/scratch_folder.h"
#include "core/base/child_attributes.h"

extern char** environ;

namespace burrhole {
namespace {

/// Starts `program script` with its streams redirected to files, so that no pipe can fill up. @returns the errno of the start; `status` is
/// then that of waitpid.
int run_on_files(const std::string& program, const std::string& script, const std::string& out, const std::string& complaint, int& status) {
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  posix_spawn_file_actions_addopen(&streams, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&streams, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&streams, STDERR_FILENO, complaint.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  std::string words[] = {program, script};
  char* arguments[] = {words[0].data(), words[1].data(), nullptr};
  pid_t child = 0;
  const ChildAttributes own_group(true);  // Ctrl-C ends this program in order, with its report
  const int code = ::posix_spawnp(&child, program.c_str(), &streams, own_group.get(), arguments, environ);
  posix_spawn_file_actions_destroy(&streams);
  if (code != 0) return code;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return 0;
}

std::string first_line(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \n");
  return begin == std::string::npos ? "no reason given" : text.substr(begin, text.find('\n', begin) - begin);
}

}  // namespace

std::string gnuplot_quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + '"';
}

Result<std::string> run_gnuplot(std::string_view script, const std::string& program, std::string_view last) {
  const ScratchFolder folder;
  if (folder.path().empty())
    return Error{ErrorCode::unavailable, "no temporary folder can be made for plots: " + std::string(std::strerror(errno)), {}};
  if (const Status written = write_file(folder.file("plot.gp"), script); !written) return written.error();
  int status = 0;
  const int code = run_on_files(program, folder.file("plot.gp"), folder.file("out"), folder.file("complaint"), status);
  if (code != 0) return Error{ErrorCode::unavailable, program + " cannot be run (" + std::strerror(code) + "); plots need gnuplot", {}};
  if (WIFSIGNALED(status))
    return Error{ErrorCode::unavailable, fmt::format("{} was ended by signal {}: try again", program, WTERMSIG(status)), {}};
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    const Result<std::string> complaint = read_file(folder.file("complaint"));
    return Error{ErrorCode::internal, program + " refused a plot: " + first_line(complaint ? *complaint : ""), {}};
  }
  Result<std::string> out = read_file(folder.file("out"));
  if (out && !std::string_view(*out).substr(0, out->find_last_not_of('\n') + 1).ends_with(last))
    return Error{
        ErrorCode::unavailable,
        program + " wrote a plot in part: free space in " + folder.path().parent_path().string() + ", or name another folder by TMPDIR",
        {}};
  return out;
}

}  // namespace burrhole
