#include "app/cli/frontier_option.h"

#include <fmt/format.h>

#include "app/cli/commands.h"
#include "app/cli/progress.h"
#include "app/job/run_folder.h"
#include "app/lab/frontier.h"

namespace burrhole::cli {

int run_frontier(const std::string& folder, unsigned workers, bool quiet) {
  const auto lock = take_output_folder(folder);
  if (!lock) return report(lock.error());
  Progress progress(quiet);
  FrontierOptions options;
  options.workers = workers;
  options.progress = [&](double share) { progress.show(share, "points of the frontier"); };
  const auto rows = measure_frontier(options);
  if (!rows) return report(rows.error());
  if (const Status written = write_frontier(*rows, folder); !written) return report(written.error());
  if (!quiet) print(fmt::format("{} rows in {}/frontier.csv, frontier.html and its plots beside it\n", rows->size(), folder));
  return kDone;
}

}  // namespace burrhole::cli
