/// app/effect/record.h: what [record] holds.
#pragma once

#include <string>

namespace burrhole {

struct RecordConfig {
  std::string path = "session.sqlite";  ///< relative to the output folder
};

}  // namespace burrhole
