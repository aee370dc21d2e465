#include "app/cli/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>

#include "app/cli/commands.h"
#include "core/base/output_file.h"
#include "core/config/toml_messages.h"

namespace burrhole::cli {

void prepare_streams() {
  // A closed standard output is opened for reading only: writes to it still fail.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    while (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      if (::open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY) < 0) break;
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

void print(const std::string& text) {
  const std::string safe = printable_text(text);
  errno = 0;
  if (std::fwrite(safe.data(), 1, safe.size(), stdout) != safe.size() || std::fflush(stdout) != 0) throw NoOutput{errno != 0 ? errno : EIO};
}

void note(const std::string& text) noexcept { std::fwrite(text.data(), 1, text.size(), stderr); }

int report(const NoOutput& failure) {
  constexpr int kByPipe = 128 + SIGPIPE;  // as a shell reports a program that the signal ended
  if (failure.code == EPIPE) return kByPipe;
  return report(write_error("standard output", failure.code));
}

}  // namespace burrhole::cli
