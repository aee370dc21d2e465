/// tests/volumes/read/itk_twin.h: the same files read by ITK's image IO classes, an oracle that shares no code with the readers.
#pragma once

#include <string>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole::test {

struct TwinVolume {
  Vec3i dims{0};
  std::vector<double> values;  ///< as ITK gives them, its own rescaling included
  Vec3 spacing_mm{0.0}, origin_mm{0.0};
  Mat3 direction{1.0};
};

/// By ending: .nii, .nii.gz, .hdr; .nrrd, .nhdr; .mha, .mhd. An exception of ITK passes.
[[nodiscard]] TwinVolume read_by_itk(const std::string& path);

}  // namespace burrhole::test
