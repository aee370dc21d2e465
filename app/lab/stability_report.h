/// app/lab/stability_report.h: hard cases as a table, as a page with a picture per case, and as text.
///   Units  in the names of the measures.   Errors  bad_input, unavailable.
#pragma once

#include <span>
#include <string>

#include "app/lab/stability_run.h"

namespace burrhole {

/// @returns whether a measure of the default model exceeds its bound, or one of its cases could not be run.
[[nodiscard]] bool default_model_failed(std::span<const StabilityOutcome> outcomes) noexcept;
/// Writes columns case, model, measure, value, bound, pass. Creates missing folders.
[[nodiscard]] Status write_stability_csv(std::span<const StabilityOutcome> outcomes, const std::string& path);
/// Writes one page: failures by model, and for each case its picture, description and table. Without gnuplot it has no pictures.
[[nodiscard]] Status write_stability_page(std::span<const StabilityOutcome> outcomes, const std::string& path);
/// @returns Markdown: cases with description and sabotage, bounds, and failures by model.
[[nodiscard]] std::string stability_markdown(std::span<const StabilityOutcome> outcomes);

}  // namespace burrhole
