/// app/lab/drilling_partial.h: results of drilling trials in a text file, one line each, so that a study that was interrupted goes on.
///   A line is the trial's key and the figures of the studies as hexadecimal floating-point numbers, which read back as the same bits.
///   Units  as DrillingResult.   Errors  bad_input: the file cannot be written.   Thread  one at a time.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "app/lab/drilling_trial.h"

namespace burrhole {

class PartialDrillings {
 public:
  /// Reads the lines that are there; one that was cut off is left out. @param path empty: nothing is kept.
  explicit PartialDrillings(std::string path);
  /// @returns the result of an equal trial by the same physics version. Of its summary only the figures of the studies are there.
  [[nodiscard]] std::optional<DrillingResult> find(const DrillingTrial& trial) const;
  /// Appends a line; after an error the file holds the lines of before.
  [[nodiscard]] Status add(const DrillingTrial& trial, const DrillingResult& result);

 private:
  std::string path_;
  std::map<std::string, DrillingResult> results_;
};

}  // namespace burrhole
