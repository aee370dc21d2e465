#include "tests/volumes/read/scanned_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "core/base/units.h"
#include "tests/support/plain_trilinear.h"

namespace burrhole::test {
namespace {

constexpr double kFar = 1e3;  // [m] beyond any scan

struct Span {
  double lo = 0.0, hi = 0.0;
};

/// Part of the line (x, y, z), all x, below the plane or in the ball that lies `depth` under the outer surface.
Span solid_span(const Body& body, double depth, double y, double z) {
  const Vec3& n = body.normal;
  if (!body.radius) {
    const double end = -(depth + n.y * y + n.z * z) / n.x;
    return n.x > 0.0 ? Span{-kFar, end} : Span{end, kFar};
  }
  const Vec3 centre = -*body.radius * n;
  const double r = *body.radius - depth;
  const double across = r * r - (y - centre.y) * (y - centre.y) - (z - centre.z) * (z - centre.z);
  if (across <= 0.0) return {};
  return {centre.x - std::sqrt(across), centre.x + std::sqrt(across)};
}

double common(const Span& a, double lo, double hi) { return std::max(std::min(a.hi, hi) - std::max(a.lo, lo), 0.0); }

/// Length of bone on the line between two x.
double bone_length(const Body& body, double y, double z, double lo, double hi) {
  const double all = common(solid_span(body, 0.0, y, z), lo, hi);
  return body.thickness ? all - common(solid_span(body, *body.thickness, y, z), lo, hi) : all;
}

/// Share of bone in the box round a point.
double box_share(const Body& body, const Scanner& scanner, const Vec3& at) {
  constexpr int kAcross = 6, kAlong = 12;
  const double edge = scanner.spacing.x, across = scanner.spacing.y;
  double sum = 0.0;
  for (int k = 0; k < kAlong; ++k)
    for (int j = 0; j < kAcross; ++j)
      sum += bone_length(body, at.y + across * ((j + 0.5) / kAcross - 0.5), at.z + scanner.slice * ((k + 0.5) / kAlong - 0.5),
                         at.x - 0.5 * edge, at.x + 0.5 * edge);
  return sum / (edge * kAcross * kAlong);
}

double voxel_share(const Body& body, const Scanner& scanner, const Vec3& at) {
  if (scanner.blur == 0.0) return box_share(body, scanner, at);
  const double step = std::sqrt(3.0) * scanner.blur;
  constexpr std::array<double, 3> kWeight{1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0};
  double sum = 0.0;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      sum += kWeight[static_cast<std::size_t>(i)] * kWeight[static_cast<std::size_t>(j)] *
             box_share(body, scanner, at + step * Vec3(i - 1, j - 1, 0));
  return sum;
}

/// Occupancy of all voxels, as the model has it.
class Field {
 public:
  explicit Field(const BoneModel& bone) : box_(bone.bounds()), values_(box_.count()), index_from_bone_(bone.bone_from_index().inverse()) {
    bone.read_occupancy(box_, values_);
  }
  [[nodiscard]] double at(const Vec3& p) const {
    return plain_trilinear(index_from_bone_ * p, [&](const Vec3i& v) { return box_.contains(v) ? values_[box_.offset_of(v)] : 0.0f; });
  }

 private:
  VoxelBox box_;
  std::vector<float> values_;
  Affine index_from_bone_;
};

/// Distance [m] from p along `out` of the outermost point of bone within 2.5 mm of p; NaN without one.
double surface_along(const Field& field, const Vec3& p, const Vec3& out) {
  constexpr double kReach = 2.5e-3, kStep = 0.1e-3;
  for (int n = 0; n < 50; ++n) {
    const double s = kReach - n * kStep;
    if (field.at(p + out * (s - kStep)) < 0.5) continue;
    double inside = s - kStep, outside = s;
    for (int half = 0; half < 20; ++half)
      (field.at(p + out * (0.5 * (inside + outside))) >= 0.5 ? inside : outside) = 0.5 * (inside + outside);
    return 0.5 * (inside + outside);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

constexpr int kHalf = 16, kSide = 2 * kHalf + 1;
constexpr double kStepOnPatch = 0.5e-3;

struct PatchPoint {
  Vec3 place, normal;
};

/// kSide x kSide points of the outer surface round the origin, in rows.
std::vector<PatchPoint> patch_of(const Body& body) {
  const Mat3 frame = glm::mat3_cast(rotation_from_z(body.normal));
  std::vector<PatchPoint> out;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const double u = (i - kHalf) * kStepOnPatch, w = (j - kHalf) * kStepOnPatch;
      PatchPoint p{frame[0] * u + frame[1] * w, body.normal};
      if (body.radius) {
        const Vec3 centre = -*body.radius * body.normal;
        p.normal = glm::normalize(p.place - centre);
        p.place = centre + *body.radius * p.normal;
      }
      out.push_back(p);
    }
  return out;
}

/// Errors of the outer or the inner surface at the points of the patch.
std::vector<double> errors_of(const Field& field, const Body& body, bool inner) {
  std::vector<double> out;
  for (const auto& [place, normal] : patch_of(body))
    out.push_back(inner ? -surface_along(field, place - *body.thickness * normal, -normal) : surface_along(field, place, normal));
  return out;
}

double percentile95(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[(values.size() * 95) / 100];
}

SurfaceFigures figures_of(const std::vector<double>& errors) {
  SurfaceFigures out;
  std::vector<double> size;
  double sum = 0.0, squares = 0.0;
  for (const double e : errors) {
    if (std::isnan(e)) {
      ++out.missing;
      continue;
    }
    sum += e;
    squares += e * e;
    size.push_back(std::abs(e));
  }
  const double count = std::max<double>(static_cast<double>(size.size()), 1.0);
  out.mean = sum / count;
  out.rms = std::sqrt(squares / count);
  out.ripple = std::sqrt(std::max(squares / count - out.mean * out.mean, 0.0));
  out.p95 = percentile95(size);
  return out;
}

}  // namespace

Vec3 tilted_normal(double tilt) {
  constexpr double kTurn = 27.0 * kDegree;
  const double s = std::sin(tilt * kDegree);
  return {s * std::cos(kTurn), s * std::sin(kTurn), std::cos(tilt * kDegree)};
}

Scan scan_body(const Body& body, const Scanner& scanner) {
  const Vec3i half = Vec3i(glm::ceil(scanner.extent / scanner.spacing)) + 1;
  Scan scan;
  scan.dims = 2 * half + 1;
  scan.quantity = Quantity::hounsfield;
  const Vec3& d = scanner.spacing;
  scan.bone_from_index = {Mat3(d.x, 0, 0, 0, d.y, 0, 0, 0, d.z), -d * (Vec3(half) + Vec3(0.0, 0.0, scanner.phase))};
  std::mt19937_64 random(20);
  std::normal_distribution<double> noise(0.0, 1.0);
  for_each_voxel({Vec3i(0), scan.dims}, [&](const Vec3i& v) {
    const double share = voxel_share(body, scanner, scan.bone_from_index * Vec3(v));
    scan.values.push_back(static_cast<float>(kTissueHu + (kBoneHu - kTissueHu) * share + scanner.noise * noise(random)));
  });
  return scan;
}

SurfaceFigures measure_surface(const BoneModel& bone, const Body& body, bool inner) {
  const std::vector<double> errors = errors_of(Field(bone), body, inner);
  SurfaceFigures out = figures_of(errors);
  std::vector<double> angles;
  for (int j = 1; j + 1 < kSide; ++j)
    for (int i = 1; i + 1 < kSide; ++i) {
      const auto e = [&](int di, int dj) { return errors[VoxelBox{Vec3i(0), Vec3i(kSide, kSide, 1)}.offset_of({i + di, j + dj, 0})]; };
      const double slope = std::hypot(e(1, 0) - e(-1, 0), e(0, 1) - e(0, -1)) / (2.0 * kStepOnPatch);
      if (!std::isnan(slope)) angles.push_back(std::atan(slope) / kDegree);
    }
  out.angle = percentile95(angles);
  return out;
}

SurfaceFigures measure_thickness(const BoneModel& bone, const Body& body) {
  const Field field(bone);
  std::vector<double> errors = errors_of(field, body, false);
  const std::vector<double> inner = errors_of(field, body, true);
  for (std::size_t n = 0; n < errors.size(); ++n) errors[n] -= inner[n];
  return figures_of(errors);
}

int most_layers(const BoneModel& bone, const Body& body) {
  constexpr double kFarthest = 6e-3, kStep = 0.1e-3;
  const Field field(bone);
  int most = 0;
  for (const auto& [place, normal] : patch_of(body)) {
    int layers = 0;
    bool inside = false;
    for (int n = 0; n < 120; ++n) {
      const double s = kFarthest - n * kStep;
      const bool now = field.at(place + normal * s) >= 0.5;
      if (now && !inside) ++layers;
      inside = now;
    }
    most = std::max(most, layers);
  }
  return most;
}

}  // namespace burrhole::test
