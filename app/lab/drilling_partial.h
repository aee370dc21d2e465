/// app/lab/drilling_partial.h: results of drilling trials as partial results of a study (partial_results.h).
///   Units  as DrillingResult.   Errors  bad_input: the file cannot be written; those of a tool file.   Thread  one at a time.
#pragma once

#include <optional>
#include <string>

#include "app/lab/drilling_trial.h"
#include "app/lab/partial_results.h"

namespace burrhole {

/// @returns the key of a trial: of the texts of its scene and tool and its assignments. @param tool_folder of the shipped tools.
[[nodiscard]] Result<std::string> key_of(const DrillingTrial& trial, const std::string& tool_folder);

class PartialDrillings {
 public:
  /// @param path empty: nothing is kept. @param tool_folder of the shipped tools.
  PartialDrillings(const std::string& path, std::string tool_folder) : results_(path), tool_folder_(std::move(tool_folder)) {}
  /// @returns the result of an equal trial. Of its summary only the figures of the studies are there.
  [[nodiscard]] std::optional<DrillingResult> find(const DrillingTrial& trial) const;
  [[nodiscard]] Status add(const DrillingTrial& trial, const DrillingResult& result);

 private:
  PartialResults results_;
  std::string tool_folder_;
};

}  // namespace burrhole
