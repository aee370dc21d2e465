/// burrhole_bench: the speed comparisons, each beside a baseline of the same run. See docs/performance.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

#include "app/bench/areas.h"
#include "app/report/file.h"
#include "core/base/simd.h"

namespace {

using namespace burrhole;

struct Area {
  std::string_view name;
  Status (*run)(Bench&);
};

constexpr std::array kAreas{
    Area{"contact", bench_contact}, Area{"erosion", bench_erosion}, Area{"import", bench_import},
#ifdef BH_WITH_RENDER
    Area{"render", bench_render},
#endif
    Area{"servo", bench_servo},  // last: it keeps the process's memory in place, and others measure theirs
};

constexpr const char* kUsage =
    "usage: burrhole_bench [AREA...] [--out DIR] [--simd LEVEL] [--quick] [--sabotage]\n"
    "  AREA          contact, erosion, servo, import or render; none means all\n"
    "  --out DIR     folder of bench.json (out/bench)\n"
    "  --simd LEVEL  auto (the best there is), sse4, avx2 or avx512\n"
    "  --quick       few iterations: checks that results agree, times mean little\n"
    "  --sabotage    flips one bit of every result before it is compared: each comparison must then be named\n"
    "exit: 0 done, 2 wrong usage, 3 results disagree, 4 no OpenGL\n";

struct Request {
  std::vector<Area> areas;
  std::string out = "out/bench";
  bool quick = false, sabotage = false, help = false;
};

Result<Request> read_arguments(int count, char** arguments) {
  Request out;
  for (int n = 1; n < count; ++n) {
    const std::string word = arguments[n];
    const auto area = std::ranges::find(kAreas, word, &Area::name);
    if (word == "--quick")
      out.quick = true;
    else if (word == "--sabotage")
      out.sabotage = true;
    else if (word == "--help")
      out.help = true;
    else if (word == "--out" && n + 1 < count)
      out.out = arguments[++n];
    else if (word == "--simd" && n + 1 < count) {
      if (Status chosen = choose_simd(arguments[++n]); !chosen) return chosen.error();
    } else if (word.starts_with("-"))
      return bad_input(fmt::format("{} is no option, or lacks its value; see --help", word));
    else if (area != kAreas.end())
      out.areas.push_back(*area);
    else {
      std::string known;
      for (const Area& each : kAreas) known += (known.empty() ? "" : ", ") + std::string(each.name);
      return bad_input(fmt::format("there is no area \"{}\"; this build has {}", word, known));
    }
  }
  if (out.areas.empty()) out.areas.assign(kAreas.begin(), kAreas.end());
  return out;
}

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::bad_input:
    case ErrorCode::out_of_range:
      return 2;
    case ErrorCode::check_failed:
      return 3;
    case ErrorCode::unavailable:
      return 4;
    case ErrorCode::internal:
      return 1;
  }
  return 1;
}

int report(const Error& error) {
  fmt::print(stderr, "bench: {}\n", error.text());
  return exit_code(error.code);
}

}  // namespace

int main(int count, char** arguments) {
  const auto request = read_arguments(count, arguments);
  if (!request) return report(request.error());
  if (request.value().help) {
    fmt::print("{}", kUsage);
    return 0;
  }
  const Request& asked = request.value();
  Bench bench(asked.quick, asked.sabotage);
  int code = 0;
  for (const Area& area : asked.areas) {
    fmt::print(stderr, "bench: {}\n", area.name);
    bench.start_area(std::string(area.name));
    if (const Status done = area.run(bench); !done) code = report(done.error());  // the others are measured all the same
  }
  fmt::print("{}", bench_table(bench.rows()));
  if (const Status written = write_file(asked.out + "/bench.json", bench_json(bench.rows())); !written) return report(written.error());
  for (const std::string& line : bench.disagreements()) fmt::print(stderr, "bench: {}\n", line);
  return bench.disagreements().empty() ? code : 3;
}
