/// app/bench/main.cpp: burrhole_bench compares computation times with baselines that are timed in the same run. See docs/performance.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "app/bench/areas.h"
#ifdef BH_WITH_RENDER
#include "app/bench/growth_run.h"
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
    Area{"contact", bench_contact}, Area{"erosion", bench_erosion}, Area{"import", bench_import}, Area{"mesh", bench_mesh},
#ifdef BH_WITH_RENDER
    Area{"growth", bench_growth},   Area{"render", bench_render},
#endif
    Area{"step", bench_step},       Area{"servo", bench_servo},  // last: it locks the process's memory, which would change the memory that other areas measure
};

constexpr const char* kAbout = "Compares computation times with baselines that are timed in the same run.";
constexpr const char* kFooter = "exit: 0 done, 2 usage error, 3 results disagree, 4 no OpenGL";

struct Request {
  std::vector<std::string> names;  ///< of areas; empty: all
  std::vector<Area> areas;
  std::string out = "out/bench";
  std::string revision;  ///< of the sources, for bench.json
  bool quick = false, sabotage = false;
#ifdef BH_WITH_RENDER
  FramesRequest frames;  ///< gl empty: not requested
  int growth_edge = 0;   ///< [voxels] 0: not requested
#endif
};

#ifdef BH_WITH_RENDER
/// "WIDTHxHEIGHT" in pixels.
void read_size(const std::string& text, FramesRequest& out) {
  int read = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &out.width, &out.height, &read) != 2 || static_cast<std::size_t>(read) != text.size() ||
      std::min(out.width, out.height) < 16 || std::max(out.width, out.height) > 8192)
    throw CLI::ValidationError("--size", text + " must be WIDTHxHEIGHT, each in [16, 8192]");
}

void add_frames_options(CLI::App& app, FramesRequest& frames) {
  app.add_option("--gl", frames.gl,
                 "only with the area render: measures instead the pictures per second of osmesa, egl or window for 128^3, 256^3 and 512^3 "
                 "voxels, into DIR/render_frames.csv")
      ->type_name("BACKEND")
      ->check(CLI::IsMember({"osmesa", "egl", "window"}));
  app.add_option_function<std::string>(
         "--size", [&frames](const std::string& text) { read_size(text, frames); }, "size of those pictures (default 1920x1080)")
      ->type_name("WIDTHxHEIGHT");
}
#endif

void add_options(CLI::App& app, Request& request) {
  app.add_option("AREA", request.names, "contact, erosion, growth, import, render, servo or step; default: all");
  app.add_option("--out", request.out, "folder of bench.json")->type_name("DIR")->capture_default_str();
  app.add_option("--revision", request.revision, "of the sources, written into bench.json")->type_name("TEXT");
  app.add_option_function<std::string>(
         "--simd",
         [](const std::string& level) {
           if (const Status chosen = choose_simd(level); !chosen) throw CLI::ValidationError("--simd", chosen.error().message);
         },
         "auto (the best), sse4, avx2 or avx512")
      ->type_name("LEVEL");
  app.add_flag("--quick", request.quick, "few iterations: checks that results agree; the times are not meaningful");
  app.add_flag("--sabotage", request.sabotage, "flips one bit of every result before it is compared: every comparison must then fail");
#ifdef BH_WITH_RENDER
  add_frames_options(app, request.frames);
  app.add_option("--growth-edge", request.growth_edge, "only prints the figures of one volume of the area growth, which calls this")
      ->type_name("VOXELS")
      ->check(CLI::IsMember(growth_edges()));
#endif
  app.footer(kFooter);
}

Status find_areas(Request& request) {
  for (const std::string& name : request.names) {
    const auto area = std::ranges::find(kAreas, name, &Area::name);
    if (area == kAreas.end()) {
      std::string known;
      for (const Area& each : kAreas) known += (known.empty() ? "" : ", ") + std::string(each.name);
      return bad_input(fmt::format("there is no area \"{}\"; this build has {}", name, known));
    }
    request.areas.push_back(*area);
  }
#ifdef BH_WITH_RENDER
  if (!request.frames.gl.empty() && !(request.areas.size() == 1 && request.areas[0].name == "render"))
    return bad_input("--gl is valid only with the area render");
#endif
  if (request.areas.empty()) request.areas.assign(kAreas.begin(), kAreas.end());
  return {};
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

/// Runs the areas and writes their rows. @returns the exit code.
int run(const Request& request) {
  Bench bench(request.quick, request.sabotage, request.out);
  int code = 0;
  for (const Area& area : request.areas) {
    fmt::print(stderr, "bench: {}\n", area.name);
    bench.start_area(std::string(area.name));
#ifdef BH_WITH_RENDER
    if (!request.frames.gl.empty()) {
      FramesRequest frames = request.frames;
      frames.csv = request.out + "/render_frames.csv";
      if (const Status done = bench_frames(bench, frames); !done) return report(done.error());
      continue;
    }
#endif
    if (const Status done = area.run(bench); !done) code = report(done.error());  // the other areas still run
  }
  fmt::print("{}", bench_table(bench.rows()));
  const std::string json = bench_json(this_machine(request.revision), request.quick, bench.rows());
  if (const Status written = write_file(request.out + "/bench.json", json); !written) return report(written.error());
  for (const std::string& line : bench.disagreements()) fmt::print(stderr, "bench: {}\n", line);
  return bench.disagreements().empty() ? code : 3;
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): an exception that leaves main is a bug of the benchmarks and ends them.
int main(int count, char** arguments) {
  CLI::App app{kAbout, "burrhole_bench"};
  Request request;
  add_options(app, request);
  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    fmt::print(stderr, "bench: {} (see --help)\n", error.what());
    return 2;
  }
#ifdef BH_WITH_RENDER
  if (request.growth_edge > 0) {
    const Status done = print_growth(request.growth_edge, request.quick);
    return done.ok() ? 0 : report(done.error());
  }
#endif
  if (const Status found = find_areas(request); !found) return report(found.error());
  return run(request);
}
