#include "words_twin.h"

#include <array>
#include <cmath>
#include <optional>

namespace burrhole::contact_test {
namespace {

constexpr int kOne = 16384;  // a voxel
using Int3 = std::array<int, 3>;
using Float3 = std::array<float, 3>;

int floor_div(int x) { return x >= 0 ? x / kOne : -((-x + kOne - 1) / kOne); }

Float3 rows_times(const Mat3& m, const Float3& v) {
  Float3 out;
  for (std::size_t r = 0; r < 3; ++r) {
    const auto cell = [&](std::size_t c) { return static_cast<float>(m[c][r]); };
    out[r] = cell(0) * v[0] + cell(1) * v[1] + cell(2) * v[2];
  }
  return out;
}

Int3 one_voxel_along(const Float3& v, float sign) {
  const float square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  if (!(square > 0.0f)) return {0, 0, 0};
  const float scale = sign * float(kOne) / std::sqrt(square);
  Int3 out;
  for (std::size_t a = 0; a < 3; ++a) out[a] = static_cast<int>(std::nearbyint(v[a] * scale));
  return out;
}

struct Surface {
  Int3 voxel;
  Float3 gradient;
  bool flat;
};

/// Places here are whole numbers of 1/16384 voxel from the centre of the window's first voxel.
class Walk {
 public:
  explicit Walk(const WordsTwin& t) : t_(t), size_{t.box.hi.x - t.box.lo.x, t.box.hi.y - t.box.lo.y, t.box.hi.z - t.box.lo.z} {}

  std::uint32_t word(const Int3& v) const {
    return t_.words[std::size_t(v[0]) + std::size_t(size_[0]) * (std::size_t(v[1]) + std::size_t(size_[1]) * std::size_t(v[2]))];
  }
  int density(const Int3& v) const { return int(word(v) % 256); }
  bool still(const Int3& v) const { return word(v) / (1u << 24) == 128; }
  Float3 gradient(const Int3& v) const {
    const std::uint32_t w = word(v);
    if (still(v)) return {0.0f, 0.0f, 0.0f};
    Float3 out;
    for (unsigned a = 0; a < 3; ++a) out[a] = float(std::int8_t(w >> (8 * a + 8)));
    return out;
  }
  bool solid(const Int3& v) const { return density(v) >= (t_.paper ? 1 : 128); }
  static Int3 voxel(const Int3& p) { return {floor_div(p[0] + kOne / 2), floor_div(p[1] + kOne / 2), floor_div(p[2] + kOne / 2)}; }
  static Int3 cell(const Int3& p) { return {floor_div(p[0]), floor_div(p[1]), floor_div(p[2])}; }
  static Int3 corner(Int3 c, int n) { return {c[0] + n % 2, c[1] + n / 2 % 2, c[2] + n / 4}; }
  bool known(const Int3& p) const {
    const Int3 v = voxel(p);
    for (std::size_t a = 0; a < 3; ++a)
      if (v[a] < 1 || v[a] > size_[a] - 2) return false;
    return true;
  }

  bool collides(const Int3& p) const {
    if (t_.paper) return density(voxel(p)) > 0;
    const Int3 low = cell(p);
    std::array<float, 8> d;
    for (int n = 0; n < 8; ++n) d[std::size_t(n)] = float(density(corner(low, n)));
    std::size_t count = 8;
    for (std::size_t a = 0; a < 3; ++a, count /= 2) {
      const float t = float(p[a] - low[a] * kOne) / float(kOne);
      for (std::size_t n = 0; n < count / 2; ++n) d[n] = d[2 * n] + (d[2 * n + 1] - d[2 * n]) * t;
    }
    return d[0] >= 127.5f;
  }

  std::optional<Surface> find(Int3 p, const Int3& step) const {
    if (!solid(voxel(p))) {
      const Int3 low = cell(p);
      int best = 0;
      for (int n = 1; n < 8; ++n)
        if (density(corner(low, n)) > density(corner(low, best))) best = n;
      p = corner(low, best);
      for (int& x : p) x *= kOne;
    }
    Int3 last = voxel(p);
    for (int marched = 0; still(voxel(p)) && marched < t_.max_march;) {
      const int stride = t_.trust_leaps ? 2 * int(word(voxel(p)) / 256 % 256) : 1;
      for (std::size_t a = 0; a < 3; ++a) p[a] += stride * step[a];
      marched += stride;
      if (!known(p) && t_.trust_leaps) return std::nullopt;
      if (solid(voxel(p)))
        last = voxel(p);
      else
        break;
    }
    Int3 way{0, 0, 0};
    bool has_way = false;
    for (int ascended = 0; solid(voxel(p)); ++ascended) {
      if (ascended == t_.max_ascent) return std::nullopt;
      last = voxel(p);
      if (!still(last)) {
        way = one_voxel_along(gradient(last), -1.0f);
        has_way = true;
      }
      if (!has_way) return std::nullopt;
      for (std::size_t a = 0; a < 3; ++a) p[a] += way[a];
    }
    return Surface{last, gradient(last), still(last)};
  }

  /// Twice the plane point, in voxels.
  Int3 plane_point_doubled(const Int3& v) const {
    Int3 shift{0, 0, 0};
    int exposed = 0;
    for (std::size_t a = 0; a < 3; ++a)
      for (const int side : {-1, 1}) {
        Int3 beside = v;
        beside[a] += side;
        if (solid(beside)) continue;
        ++exposed;
        shift = {0, 0, 0};
        shift[a] = side;
      }
    if (exposed != 1) shift = {0, 0, 0};
    return {2 * v[0] + shift[0], 2 * v[1] + shift[1], 2 * v[2] + shift[2]};
  }

 private:
  const WordsTwin& t_;
  Int3 size_;
};

/// Force, torque and the normals' products of one contact, per unit of stiffness.
constexpr std::size_t kTerms = 12;
std::array<double, kTerms> terms_of(const Contact& contact, const Vec3& origin) {
  const Vec3 push = contact.normal * contact.depth, arm = contact.position - origin, n = contact.normal;
  return {push.x,
          push.y,
          push.z,
          arm.y * push.z - arm.z * push.y,
          arm.z * push.x - arm.x * push.z,
          arm.x * push.y - arm.y * push.x,
          n.x * n.x,
          n.x * n.y,
          n.x * n.z,
          n.y * n.y,
          n.y * n.z,
          n.z * n.z};
}

/// Sixteen sums folded in halves.
double folded(const std::array<double, 16>& sums) {
  std::vector<double> left(sums.begin(), sums.end());
  while (left.size() > 1) {
    const std::size_t half = left.size() / 2;
    for (std::size_t n = 0; n < half; ++n) left[n] += left[n + half];
    left.resize(half);
  }
  return left[0];
}

/// Place of a point of the tool in fractions of a voxel; outside what is known where it does not fit.
Int3 place_of(const Affine& index_from_tool, const Vec3& at) {
  Int3 p{-kOne, -kOne, -kOne};
  for (std::size_t a = 0; a < 3; ++a) {
    const Mat3& m = index_from_tool.linear;
    const double index = m[0][a] * at.x + m[1][a] * at.y + m[2][a] * at.z + index_from_tool.offset[a];
    if (index > -1.0 && index < 512.0) p[a] = static_cast<int>(std::floor(index * kOne + 0.5));
  }
  return p;
}

}  // namespace

ContactResult WordsTwin::operator()(const PointShell& shell, std::span<const std::uint32_t> order, const Pose& world_from_tool) const {
  const Walk walk(*this);
  const Affine tool = Affine::from_pose(world_from_tool);
  Affine index_from_tool = index_from_world * tool;
  index_from_tool.offset -= Vec3(box.lo);
  const Affine world_from_window = world_from_index * Affine{Mat3(1.0), Vec3(box.lo)};
  ContactResult out;
  std::array<std::array<double, 16>, kTerms> sums{};
  std::size_t touching = 0;
  for (const std::uint32_t n : order) {
    const Int3 p = place_of(index_from_tool, shell.positions[n]);
    if (!walk.known(p)) {
      out.flags |= kContactOutsideWindow;
      continue;
    }
    if (!walk.collides(p)) continue;
    const std::size_t sum = touching++ % 16;
    const Vec3 inward = shell.inward_normals[n];
    const Float3 tool_vector{float(inward.x), float(inward.y), float(inward.z)};
    const auto surface = walk.find(p, one_voxel_along(rows_times(index_from_tool.linear, tool_vector), 1.0f));
    if (!surface) {
      out.flags |= kContactNoSurface;
      continue;
    }
    const Int3 plane = walk.plane_point_doubled(surface->voxel);
    Float3 way;
    for (std::size_t a = 0; a < 3; ++a) way[a] = float(plane[a] * (kOne / 2) - p[a]) / float(kOne);
    way = rows_times(world_from_window.linear, way);
    Float3 normal;
    if (surface->flat) {
      out.flags |= kContactZeroGradient;
      normal = rows_times(tool.linear, tool_vector);
    } else {
      normal = rows_times(glm::transpose(index_from_world.linear), surface->gradient);
      const float scale = -1.0f / std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
      for (float& x : normal) x *= scale;
    }
    const float depth = std::fmax(0.0f, way[0] * normal[0] + way[1] * normal[1] + way[2] * normal[2]);
    Contact contact;
    contact.point = n;
    contact.depth = double(depth);
    for (std::size_t a = 0; a < 3; ++a) {
      const Mat3& m = world_from_window.linear;
      const double x = double(p[0]) / kOne, y = double(p[1]) / kOne, z = double(p[2]) / kOne;
      contact.position[a] = m[0][a] * x + m[1][a] * y + m[2][a] * z + world_from_window.offset[a];
      contact.plane_point[a] = contact.position[a] + double(way[a]);
      contact.normal[a] = double(normal[a]);
    }
    out.contacts.push_back(contact);
    if (!(depth > 0.0f)) continue;
    const std::array<double, kTerms> terms = terms_of(contact, world_from_tool.translation);
    for (std::size_t k = 0; k < kTerms; ++k) sums[k][sum] += terms[k];
  }
  if (out.contacts.empty()) return out;
  const double share = stiffness / double(out.contacts.size());
  std::array<double, kTerms> total{};
  for (std::size_t k = 0; k < kTerms; ++k) total[k] = folded(sums[k]) * share;
  out.wrench = {{total[0], total[1], total[2]}, {total[3], total[4], total[5]}};
  out.force_gradient = -Mat3(total[6], total[7], total[8], total[7], total[9], total[10], total[8], total[10], total[11]);
  return out;
}

}  // namespace burrhole::contact_test
