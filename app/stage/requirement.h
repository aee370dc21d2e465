/// app/stage/requirement.h: what an effect requires of the other tables of a scene. A table whose requirement no table meets contradicts the
///   scene: reading the scene is then an error at that table.
///   Units  none.   Errors  none.   Thread  any.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/stage/effect.h"

namespace burrhole {

/// One thing that an effect requires.
struct Requirement {
  std::string table;    ///< whose effect provides it
  bool met = false;     ///< some effect of the scene provides it
  std::string without;  ///< what the effect would do without it
  std::string keys{};   ///< the key that requires it with its value, or the table below: "law = \"energy\""; empty: the whole table does
};

/// Base of a plan that requires something, beside EffectPlan.
class RequiringPlan {
 public:
  virtual ~RequiringPlan() = default;
  /// @param needs of all effects of the scene.
  [[nodiscard]] virtual std::vector<Requirement> requirements(const Needs& needs) const = 0;
};

/// A requirement that a scene does not meet, and the table that has it.
struct UnmetRequirement {
  std::string table;
  Requirement requirement;
  [[nodiscard]] std::string text() const;  ///< one line: what is missing, what follows, what to do
};

/// @returns the unmet requirements, in the order of the effects; of each effect the first.
[[nodiscard]] std::vector<UnmetRequirement> unmet_requirements(const EffectPlans& effects, const StageConfig& config);

/// @returns the other tables that cannot stay in a scene without this one, in the order in which they have to go.
[[nodiscard]] std::vector<std::string> tables_that_require(std::string_view table, EffectPlans effects, const StageConfig& config);

}  // namespace burrhole
