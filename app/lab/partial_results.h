/// app/lab/partial_results.h: results of a study's trials in a text file, one line each, so that a study that was interrupted goes on.
///   A line is the trial's key, its figures as hexadecimal floating-point numbers, which read back as the same bits, and a hash of the rest
///   of the line: a line that was cut off or changed is left out.
///   Units  as the study's.   Errors  bad_input: the file cannot be written.   Thread  one at a time.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/hash.h"
#include "core/base/result.h"

namespace burrhole {

/// The key of a trial: a hash of all that its result depends on. The build of the program, processor and SIMD level are part of it: results have
/// times.
class TrialKey {
 public:
  TrialKey();
  TrialKey& add(std::string_view text);
  TrialKey& add(double value);
  [[nodiscard]] std::string text() const { return hash_.hex(); }

 private:
  Hash64 hash_;
};

class PartialResults {
 public:
  /// Reads the whole lines that are there. @param path empty: nothing is kept.
  explicit PartialResults(std::string path);
  /// @returns the figures of that key, if there are `count` of them; nothing otherwise.
  [[nodiscard]] std::optional<std::vector<double>> find(const std::string& key, std::size_t count) const;
  /// Appends a line and flushes it. A line that was cut off is ended before.
  [[nodiscard]] Status add(const std::string& key, std::span<const double> figures);

 private:
  std::string path_;
  bool in_line_ = false;  ///< the file ends within a line
  std::map<std::string, std::vector<double>> results_;
};

}  // namespace burrhole
