/// burrhole_bench: the speed comparisons, each beside a baseline of the same run. See docs/performance.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

#include "app/bench/areas.h"
#ifdef BH_WITH_RENDER
#include "app/bench/render_frames.h"
#endif
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
    "       burrhole_bench render --gl BACKEND [--size WIDTHxHEIGHT] [--out DIR] [--quick]\n"
    "  AREA          contact, erosion, servo, import or render; none means all\n"
    "  --out DIR     folder of bench.json (out/bench)\n"
    "  --simd LEVEL  auto (the best there is), sse4, avx2 or avx512\n"
    "  --gl BACKEND  osmesa, egl or window: in place of the area's rows the pictures a second that it draws of 128^3, 256^3 and\n"
    "                512^3 voxels, into DIR/render_frames.csv\n"
    "  --size WxH    of those pictures (1920x1080)\n"
    "  --quick       few iterations: checks that results agree, times mean little\n"
    "  --sabotage    flips one bit of every result before it is compared: each comparison must then be named\n"
    "exit: 0 done, 2 wrong usage, 3 results disagree, 4 no OpenGL\n";

struct Request {
  std::vector<Area> areas;
  std::string out = "out/bench";
  bool quick = false, sabotage = false, help = false;
#ifdef BH_WITH_RENDER
  FramesAsked frames;  ///< gl empty: not asked for
#endif
};

#ifdef BH_WITH_RENDER
/// "WIDTHxHEIGHT" in pixels.
Status read_size(const std::string& text, FramesAsked& out) {
  int read = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &out.width, &out.height, &read) != 2 || static_cast<std::size_t>(read) != text.size() ||
      std::min(out.width, out.height) < 16 || std::max(out.width, out.height) > 8192)
    return bad_input("--size " + text + " must be WIDTHxHEIGHT, each in [16, 8192]");
  return {};
}

/// @returns whether `word` is an option of the frames, its value taken; an Error where that is at fault.
Result<bool> read_frames_argument(const std::string& word, const std::string& value, FramesAsked& out) {
  if (word == "--size") {
    if (Status read = read_size(value, out); !read) return read.error();
    return true;
  }
  if (word != "--gl") return false;
  if (value != "osmesa" && value != "egl" && value != "window") return bad_input("--gl " + value + " must be osmesa, egl or window");
  out.gl = value;
  return true;
}
#endif

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
#ifdef BH_WITH_RENDER
    else if ((word == "--gl" || word == "--size") && n + 1 < count) {
      if (const auto read = read_frames_argument(word, arguments[++n], out.frames); !read) return read.error();
    }
#endif
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
#ifdef BH_WITH_RENDER
  if (!out.frames.gl.empty() && !(out.areas.size() == 1 && out.areas[0].name == "render"))
    return bad_input("--gl is for the area render alone");
#endif
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
#ifdef BH_WITH_RENDER
    if (!asked.frames.gl.empty()) {
      FramesAsked frames = asked.frames;
      frames.csv = asked.out + "/render_frames.csv";
      if (const Status done = bench_frames(bench, frames); !done) return report(done.error());
      continue;
    }
#endif
    if (const Status done = area.run(bench); !done) code = report(done.error());  // the others are measured all the same
  }
  fmt::print("{}", bench_table(bench.rows()));
  if (const Status written = write_file(asked.out + "/bench.json", bench_json(bench.rows())); !written) return report(written.error());
  for (const std::string& line : bench.disagreements()) fmt::print(stderr, "bench: {}\n", line);
  return bench.disagreements().empty() ? code : 3;
}
