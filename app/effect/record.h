/// app/effect/record.h: configuration of [record].
#pragma once

#include <string>

namespace burrhole {

struct RecordConfig {
  std::string path = "session.sqlite";  ///< relative to the output folder
};

}  // namespace burrhole
