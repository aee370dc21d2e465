// Any numbers as the planes of slices: what is accepted is a usable grid that has every slice once, each where its header says.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <numeric>

#include "volumes/read/scan_geometry.h"
#include "volumes/read/slice_stack.h"

namespace {

/// Reads numbers off the input; half of the planes follow the one before, so that stacks come about at all.
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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace burrhole;
  if (size < 2) return 0;
  const std::uint8_t follow = data[0], rows = data[1];
  Source source(data + 2, size - 2);
  std::vector<SlicePlane> slices;
  Vec3 step(0.0, 0.0, 1.0);
  while (source.more() && slices.size() < 300) {
    SlicePlane plane;
    plane.columns = 4;
    plane.rows = rows;
    if (!slices.empty() && (follow >> (slices.size() % 8) & 1) != 0) {
      plane = slices.back();
      plane.position += step;
      (void)source.number();
    } else {
      plane.position = source.vector();
      step = source.vector();
      if (slices.size() % 3 == 2) {
        plane.row = source.vector();
        plane.column = source.vector();
        plane.row_spacing = source.number();
        plane.column_spacing = source.number();
      }
    }
    slices.push_back(plane);
  }
  const auto stack = stack_slices(slices, source.number());
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
