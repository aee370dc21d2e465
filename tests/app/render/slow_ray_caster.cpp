#include "tests/app/render/slow_ray_caster.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace burrhole::test {
namespace {

struct Sample {
  Vec3 normal_code, color;
  double seen = 0.0;
};

class Caster {
 public:
  Caster(const VolumeView& volume, const FrameView& view, double step, int bisections, Sabotage sabotage)
      : volume_(volume),
        view_(view),
        step_(step),
        bisections_(bisections),
        sabotage_(sabotage),
        world_from_index_(Affine::from_pose(view.world_from_bone) * volume.bone_from_index),
        index_from_world_(world_from_index_.inverse()) {}

  [[nodiscard]] Vec3 color_of(const Vec3& eye, const Vec3& direction, double screen_height) const;

 private:
  [[nodiscard]] Sample at(Vec3 index) const;
  [[nodiscard]] Vec3 normal_at(const Vec3& index, const Vec3& fallback) const;
  [[nodiscard]] Vec3 lit(const Vec3& color, const Vec3& normal, const Vec3& to_eye) const;

  const VolumeView& volume_;
  const FrameView& view_;
  double step_;
  int bisections_;
  Sabotage sabotage_;
  Affine world_from_index_, index_from_world_;
};

Sample Caster::at(Vec3 index) const {
  if (sabotage_ == Sabotage::half_voxel_shift) index += 0.5;
  const Vec3 base = glm::floor(index);
  const Vec3 f = index - base;
  Sample sum{Vec3(0.0), Vec3(0.0)};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i o(corner & 1, (corner >> 1) & 1, corner >> 2);
    const Vec3i v = glm::clamp(Vec3i(base) + o, Vec3i(0), volume_.dims - 1);
    const double w = (o.x ? f.x : 1 - f.x) * (o.y ? f.y : 1 - f.y) * (o.z ? f.z : 1 - f.z);
    const std::size_t n = (static_cast<std::size_t>(v.z) * volume_.dims.y + v.y) * volume_.dims.x + v.x;
    const Rgba8& t = volume_.normal_opacity[n];
    const Rgba8& c = volume_.color[n];
    sum.normal_code += w * Vec3(t.r, t.g, t.b) / 255.0;
    sum.color += w * Vec3(c.r, c.g, c.b) / 255.0;
    sum.seen += w * std::max(t.a, c.a) / 255.0;
  }
  return sum;
}

Vec3 Caster::normal_at(const Vec3& index, const Vec3& fallback) const {
  const Sample s = at(index);
  const Vec3 stored = 2.0 * (s.normal_code - 0.5);  // eq. 6
  const double sign = sabotage_ == Sabotage::flipped_normal ? -1.0 : 1.0;
  return glm::length(stored) > 0.15 ? sign * view_.world_from_bone.rotate(glm::normalize(stored)) : fallback;
}

Vec3 Caster::lit(const Vec3& color, const Vec3& normal, const Vec3& to_eye) const {
  Vec3 to_light = glm::normalize(view_.light.direction_to_light);
  if (sabotage_ == Sabotage::light_from_elsewhere) to_light = Vec3(to_light.y, to_light.z, to_light.x);
  return color * (view_.light.ambient + view_.light.diffuse * std::max(0.0, glm::dot(normal, to_light)) +
                  view_.light.fill * std::max(0.0, glm::dot(normal, to_eye)));
}

Vec3 Caster::color_of(const Vec3& eye, const Vec3& direction, double screen_height) const {
  const double s = std::clamp((screen_height + 0.1) / 1.1, 0.0, 1.0);
  const double blend = s * s * (3.0 - 2.0 * s);
  const Vec3 miss = (1.0 - blend) * Vec3(0.60, 0.65, 0.70) + blend * Vec3(0.19, 0.24, 0.30);
  // Half spaces that the ray must be in: six sides of the cells' box, and the kept side of the cut. value(t) = a + b t <= 0 inside.
  struct Side {
    double a, b;
    Vec3 outward;
  };
  std::vector<Side> sides;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 row(index_from_world_.linear[0][axis], index_from_world_.linear[1][axis], index_from_world_.linear[2][axis]);
    const double start = glm::dot(row, eye) + index_from_world_.offset[axis];
    const double slope = glm::dot(row, direction);
    sides.push_back({-0.5 - start, -slope, -glm::normalize(row)});
    sides.push_back({start - (volume_.dims[axis] - 0.5), slope, glm::normalize(row)});
  }
  if (view_.cut)
    sides.push_back({glm::dot(view_.cut->normal, eye) - view_.cut->offset, glm::dot(view_.cut->normal, direction), view_.cut->normal});
  double enter = 1e-3, leave = std::numeric_limits<double>::infinity();
  Vec3 face = -glm::normalize(direction);
  for (const Side& side : sides) {
    const double t = -side.a / side.b;
    if (side.b < 0.0 && t > enter) {
      enter = t;
      face = glm::normalize(side.outward);
    }
    if (side.b > 0.0) leave = std::min(leave, t);
  }
  const Vec3 to_eye = -glm::normalize(direction);
  const double dt = step_ / glm::length(index_from_world_.linear * direction);
  const auto index_at = [&](double t) { return index_from_world_ * (eye + t * direction); };
  for (int n = 0; enter + n * dt <= leave; ++n) {
    const Vec3 index = index_at(enter + n * dt);
    if (at(index).seen < 0.5) continue;
    if (n == 0) return lit(at(index).color, face, to_eye);
    double outside = enter + (n - 1) * dt, inside = enter + n * dt;
    for (int i = 0; i < bisections_; ++i) {
      const double middle = 0.5 * (outside + inside);
      (at(index_at(middle)).seen >= 0.5 ? inside : outside) = middle;
    }
    const Vec3 hit = index_at(inside);
    const Vec3 normal = normal_at(hit, to_eye);
    return lit(at(hit - 0.75 * glm::normalize(index_from_world_.linear * normal)).color, normal, to_eye);
  }
  return miss;
}

}  // namespace

Image cast_slowly(const VolumeView& volume, const FrameView& view, int width, int height, double step, int bisections, Sabotage sabotage) {
  const Caster caster(volume, view, step, bisections, sabotage);
  const CameraView& camera = view.camera;
  const Vec3 back = glm::normalize(camera.eye - camera.target);
  const Vec3 right = glm::normalize(glm::cross(camera.up, back));
  const Vec3 up = glm::cross(back, right);
  const double pixel = 2.0 * std::tan(0.5 * camera.vertical_fov) / height;  // at distance 1
  Image image{width, height, {}};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const Vec3 direction = -back + (column + 0.5 - 0.5 * width) * pixel * right + (0.5 * height - row - 0.5) * pixel * up;
      const Vec3 color = caster.color_of(camera.eye, direction, (height - row - 0.5) / height);
      const auto code = [](double c) { return static_cast<std::uint8_t>(std::floor(255.0 * std::clamp(c, 0.0, 1.0) + 0.5)); };
      image.pixels.push_back({code(color.x), code(color.y), code(color.z), 255});
    }
  return image;
}

}  // namespace burrhole::test
