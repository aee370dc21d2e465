// Any numbers as the planes of slices: what is accepted is a usable grid that has every slice once, each where its header says.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <numeric>

#include "volumes/read/scan_geometry.h"
#include "volumes/read/slice_stack.h"

namespace {

/// Reads numbers from the input.
class Source {
 public:
  Source(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  [[nodiscard]] bool more() const { return left_ >= sizeof(double); }
  double number() {
    double out = 0.0;
    if (left_ < sizeof out) return out;
    std::memcpy(&out, data_, sizeof out);
    data_ += sizeof out;
    left_ -= sizeof out;
    return out;
  }
  burrhole::Vec3 vector() {
    const double x = number(), y = number();
    return {x, y, number()};
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

/// Planes of slices. Plane n is one step behind the plane before it if bit n % 8 of `follow` is set; otherwise it has a position and a step of
/// its own, and directions of its own if bit n % 8 of `turns` is set, the first plane's if not: stacks come about at all.
std::vector<burrhole::SlicePlane> planes(unsigned follow, int rows, unsigned turns, Source source) {
  std::vector<burrhole::SlicePlane> out;
  burrhole::Vec3 step(0.0, 0.0, 1.0);
  while (source.more() && out.size() < 300) {
    const std::size_t bit = out.size() % 8;
    burrhole::SlicePlane plane = out.empty() ? burrhole::SlicePlane{} : out.front();
    plane.columns = 4;
    plane.rows = rows;
    if (!out.empty() && (follow >> bit & 1) != 0) {
      plane = out.back();
      plane.position += step;
      (void)source.number();
    } else {
      plane.position = source.vector();
      step = source.vector();
      if ((turns >> bit & 1) != 0) {
        plane.row = source.vector();
        plane.column = source.vector();
        plane.row_spacing = source.number();
        plane.column_spacing = source.number();
      }
    }
    out.push_back(plane);
  }
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace burrhole;
  if (size < 3) return 0;
  Source source(data + 3, size - 3);
  const double single_slice_mm = source.number();
  const std::vector<SlicePlane> slices = planes(data[0], data[1], data[2], source);
  const auto stack = stack_slices(slices, single_slice_mm);
  if (!stack) return 0;
  if (affine_error(stack->bone_from_index)) std::abort();
  std::vector<std::size_t> order = stack->order, each(slices.size());
  std::sort(order.begin(), order.end());
  std::iota(each.begin(), each.end(), 0u);
  if (order != each) std::abort();
  // What the header of stack_slices allows a slice to be off its place: a tenth of the shortest voxel edge and 0.01 mm. Coordinates are up
  // to 1e6 mm, whose doubles are 1e-10 mm apart: 1e-8 mm is some tens of roundings.
  double shortest = 1e300;
  for (int axis = 0; axis < 3; ++axis) shortest = std::min(shortest, glm::length(stack->bone_from_index.linear[axis]) * 1e3);
  const double allowed = 0.1 * shortest + 0.01 + 1e-8;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Vec3 at = (stack->bone_from_index * Vec3(0, 0, static_cast<double>(k))) * 1e3;
    const Vec3 off = at - slices[stack->order[k]].position;
    if (glm::length(off) > allowed) std::abort();
  }
  return 0;
}
