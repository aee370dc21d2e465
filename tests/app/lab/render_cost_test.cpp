// What drawing costs, as the lab measures it: the bars on accuracy, and that each knob acts on what it is for. No time is judged.
#include "app/lab/render_cost.h"

#include "app/report/file.h"
#include "tests/support/skip.h"
#include "tests/support/source_folder.h"
#include "tests/support/svg_names.h"
#include "tests/support/temporary_folder.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>

using namespace burrhole;

namespace {

const RenderCost& measured() {
  static const RenderCost cost = [] {
    auto made = measure_render_cost({.share_folder = test::in_source("app"),
                                     .width = 400,
                                     .height = 300,
                                     .frames = 1,
                                     .pareto = false,
                                     .drilled = true,
                                     .gl = GlBackend::osmesa});
    if (!made && made.error().code == ErrorCode::unavailable) test::skip(made.error().text());
    REQUIRE_MESSAGE(made.ok(), (made ? "" : made.error().text()));
    return std::move(made).value();
  }();
  return cost;
}

/// The figure of a row; reference and model by what they begin with.
double figure(const std::string& subject, const std::string& model, const std::string& knob, double setting, const std::string& reference,
              const std::string& name = "psnr") {
  const auto row = std::ranges::find_if(measured().rows, [&](const CostRow& one) {
    return one.subject == subject && one.model == model && one.knob == knob && one.setting == setting &&
           one.reference.starts_with(reference) && one.error_name == name;
  });
  REQUIRE_MESSAGE(row != measured().rows.end(), (model + ", " + knob));
  return row->error;
}

const std::vector<std::string> kSubjects{"skull patch", "drilled hole"};

}  // namespace

TEST_CASE("render cost: the shipped first hit is within 40 dB of an eighth of a voxel in floats, and a step twice as long is not") {
  for (const std::string& subject : kSubjects) {
    CAPTURE(subject);
    CHECK(figure(subject, "rays, no finish, stored normals", "step [voxel]", 0.5, "same rays") >= 40.0);
    // A ray that grazes bone for less than a step may pass it, whatever the bisections.
    CHECK(figure(subject, "rays, step 1 voxel, no finish", "bisections", 8.0, "same rays") < 40.0);
    CHECK(figure(subject, "rays, no finish, normals by differences", "step [voxel]", 0.5, "same rays") < 40.0);
  }
}

TEST_CASE("render cost: compositing is within 42 dB of an eighth of a voxel in floats") {
  for (const std::string& subject : kSubjects) {
    CAPTURE(subject);
    CHECK(figure(subject, "translucent", "step [voxel]", 1.0, "same rays") >= 42.0);
    CHECK(figure(subject, "translucent", "step [voxel]", 0.25, "same rays") >=
          figure(subject, "translucent", "step [voxel]", 1.0, "same rays"));
  }
}

TEST_CASE("render cost: each knob acts on the error that it is for") {
  for (const std::string& subject : kSubjects) {
    CAPTURE(subject);
    const auto bisections = [&](double count) {
      return figure(subject, "rays, step 1 voxel, no finish", "bisections", count, "same rays");
    };
    CHECK(bisections(1) > bisections(0) + 0.5);
    CHECK(bisections(4) > bisections(1));
    const auto steps = [&](double step) { return figure(subject, "rays, 4 bisections, no finish", "step [voxel]", step, "same rays"); };
    CHECK(steps(0.5) > steps(1.0) + 1.0);
    CHECK(steps(0.125) > steps(0.5) + 6.0);  // only texels and bisections are left
    const auto rays = [&](double side, const std::string& name) {
      return figure(subject, "rays, finish", "rays along a pixel's side", side, "4 x 4 rays", name);
    };
    CHECK(rays(2, "psnr") > rays(1, "psnr") + 2.0);
    CHECK(rays(2, "flip") < rays(1, "flip"));
    CHECK(rays(2, "ssim") > rays(1, "ssim"));
    const auto resolution = [&](double share) { return figure(subject, "rays, finish", "resolution", share, "4 x 4 rays"); };
    CHECK(resolution(0.5) > resolution(0.25) + 1.0);
    CHECK(resolution(0.5) < rays(1, "psnr"));
    // Without the finish it is another picture, however many rays are spent.
    CHECK(figure(subject, "rays, no finish", "rays along a pixel's side", 4, "4 x 4 rays") < rays(4, "psnr"));
    // Rays are nearer to the surface than the paper's slices by what the design promises.
    CHECK(figure(subject, "rays, 4 bisections, no finish", "step [voxel]", 1.0, "same rays") >
          figure(subject, "slices", "slices a voxel", 1.0, "same rays") + 5.0);
  }
}

TEST_CASE("render cost: bytes lose what they round, and 16 bits next to nothing") {
  for (const std::string& subject : kSubjects) {
    CAPTURE(subject);
    const auto bits = [&](const std::string& normals, double density) {
      return figure(subject, "rays, 1/8 voxel, normals of " + normals + " bits", "density [bits]", density, "same rays");
    };
    CHECK(bits("16", 16) > bits("8", 8) + 6.0);
    CHECK(bits("16", 16) > 50.0);
    // 16 bits for the density alone buy nothing that is seen, being so far below what steps lose, and normals round more: they are there
    // because they are filtered faster.
    CHECK(bits("8", 8) > 55.0);
    CHECK(bits("8", 16) + 6.0 < bits("16", 16));
    // Shipped texels are what was emulated, but for the weights of the normals' filter, which are bytes too.
    const double shipped = figure(subject, "rays, 1/8 voxel, as shipped", "density [bits]", 16, "same rays");
    CHECK(shipped > 50.0);
    CHECK(shipped < bits("8", 16) + 0.5);
  }
}

TEST_CASE("render cost: every row has its figures, and pictures are there") {
  for (const CostRow& row : measured().rows) {
    CAPTURE(row.model);
    CHECK((std::isfinite(row.error) || (row.error_name == "psnr" && row.error > 0.0)));
    if (row.error_name == "ssim" || row.error_name == "flip") CHECK((row.error >= 0.0 && row.error <= 1.0 + 1e-12));
    if (row.error_name == "time_over_shipped") CHECK(row.error > 0.0);
    CHECK((row.subject == kSubjects[0] || row.subject == kSubjects[1]));
  }
  CHECK(measured().pictures.size() == 2 * 4);
}

TEST_CASE("render cost: a study that goes on has the rows, points and pictures of the whole one, times included") {
  const TemporaryFolder folder;
  RenderCostOptions options{
      .share_folder = test::in_source("app"), .width = 32, .height = 24, .frames = 1, .drilled = false, .gl = GlBackend::osmesa};
  std::vector<RenderCost> runs;
  for (int n = 0; n < 2; ++n) {
    Study study({.partial = folder.file("partial.txt")}, count_of_trials(options));
    options.study = &study;
    auto made = measure_render_cost(options);
    if (!made && made.error().code == ErrorCode::unavailable) test::skip(made.error().text());
    REQUIRE_MESSAGE(made.ok(), (made ? "" : made.error().text()));
    CHECK(study.done() == count_of_trials(options));
    runs.push_back(std::move(made).value());
  }
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  REQUIRE(runs[0].rows.size() == runs[1].rows.size());
  for (std::size_t n = 0; n < runs[0].rows.size(); ++n) {
    CHECK(same(runs[0].rows[n].error, runs[1].rows[n].error));
    CHECK(same(runs[0].rows[n].median_us, runs[1].rows[n].median_us));
  }
  REQUIRE(runs[0].points.size() == runs[1].points.size());
  for (std::size_t n = 0; n < runs[0].points.size(); ++n) CHECK(same(runs[0].points[n].median_us, runs[1].points[n].median_us));
  REQUIRE(runs[0].pictures.size() == 4);
  REQUIRE(runs[1].pictures.size() == 4);
  for (std::size_t n = 0; n < 4; ++n) CHECK(runs[0].pictures[n].image.pixels == runs[1].pictures[n].image.pixels);
}

TEST_CASE("render cost: in the plot each point of a Pareto front has its number, and no two numbers intersect") {
  RenderCost cost;
  for (const char* subject : {"skull patch", "drilled hole"})
    for (const char* method : {"rays", "translucent"})
      for (int n = 0; n < 20; ++n) {
        // Clusters of four settings, a hundredth apart in cost and a tenth of a decibel in accuracy.
        const int cluster = n / 4, setting = n % 4;
        const double cost_us = 3e3 * std::pow(2.5, cluster) * (1.0 + 0.01 * setting), psnr = 25.0 + 5.0 * cluster + 0.1 * setting;
        cost.points.push_back({.subject = subject,
                               .method = method,
                               .quality = {.step_voxels = 0.1 + 0.01 * n},
                               .median_us = cost_us,
                               .over_shipped = 1.0,
                               .psnr = psnr,
                               .flip = 0.1 / psnr});
      }
  const TemporaryFolder folder;
  const Status written = write_render_cost(cost, folder.path().string());
  if (!written && written.error().code == ErrorCode::unavailable) return;  // no gnuplot
  REQUIRE(written.ok());
  const auto svg = read_file(folder.file("render.svg"));
  REQUIRE(svg.ok());
  const std::vector<test::SvgText> numbers = test::svg_texts(*svg, 10.0);
  CHECK(numbers.size() == 6 * 20);  // PSNR and FLIP of rays, PSNR of translucent bone
  CHECK(test::intersecting_pairs(numbers) == 0);
}

TEST_CASE("render cost: a Pareto front over two subjects takes the mean cost and the least accuracy") {
  const DrawingQuality low{.resolution = 0.5}, high{}, worse{.bisections = 0};
  const auto point = [](const std::string& subject, const DrawingQuality& quality, double cost, double psnr) {
    return DrawnPoint{.subject = subject, .method = "rays", .quality = quality, .over_shipped = cost, .psnr = psnr};
  };
  const std::vector<ParetoRow> front = pareto_rows({point("a", low, 0.1, 20.0), point("a", high, 0.5, 35.0), point("a", worse, 0.6, 34.0),
                                                    point("b", low, 0.3, 22.0), point("b", high, 0.7, 31.0), point("b", worse, 0.8, 40.0)},
                                                   "rays");
  // Mean costs 0.2, 0.6 and 0.7; least PSNR 20, 31 and 34.
  REQUIRE(front.size() == 3);
  CHECK(front[0].cost == doctest::Approx(1.0));
  CHECK(front[1].cost == doctest::Approx(3.0));
  CHECK(front[2].cost == doctest::Approx(3.5));
  CHECK(front[1].psnr == 31.0);
  CHECK(pareto_rows({}, "rays").empty());
}
