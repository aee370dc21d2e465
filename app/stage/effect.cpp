#include "app/stage/effect.h"

#include <algorithm>

namespace burrhole {

EffectPlans& EffectPlans::operator=(const EffectPlans& other) {
  std::vector<Item> copies;
  for (const Item& item : other.items_) copies.push_back({item.table, item.plan->clone()});
  items_ = std::move(copies);
  return *this;
}

bool EffectPlans::remove(std::string_view table) {
  return std::erase_if(items_, [&](const Item& item) { return item.table == table; }) > 0;
}

bool EffectPlans::has(std::string_view table) const noexcept {
  return std::ranges::any_of(items_, [&](const Item& item) { return item.table == table; });
}

Needs EffectPlans::needs(const StageConfig& config) const {
  Needs out;
  out.servo = config.servo;
  for (const Item& item : items_) item.plan->add_needs(config, out);
  return out;
}

int read_rate(TableReader& table, const StageConfig& stage, int fallback, int least, const char* about) {
  const int rate = static_cast<int>(table.integer("rate_hz", fallback, least, 20000, about));
  if (stage.servo_hz % rate != 0) table.fault("rate_hz", "must divide servo_hz = " + std::to_string(stage.servo_hz));
  return rate;
}

}  // namespace burrhole
