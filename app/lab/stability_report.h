/// app/lab/stability_report.h: hard cases as a table, as a page with a picture a case, and as findings in words.
#pragma once

#include <span>
#include <string>

#include "app/lab/stability_run.h"

namespace burrhole {

/// Whether a figure of the default model is beyond its bound, or a case of it could not be run.
[[nodiscard]] bool default_model_failed(std::span<const StabilityOutcome> outcomes) noexcept;
/// Columns case, model, measure, value, bound, pass. Folders that lack are made.
[[nodiscard]] Status write_stability_csv(std::span<const StabilityOutcome> outcomes, const std::string& path);
/// One page: what fails for which model, and for each case its picture, what it shows and its table. Without gnuplot it has no pictures.
[[nodiscard]] Status write_stability_page(std::span<const StabilityOutcome> outcomes, const std::string& path);
/// Markdown: cases with what they show, how each is broken on purpose, bounds, and what fails for which model.
[[nodiscard]] std::string stability_markdown(std::span<const StabilityOutcome> outcomes);

}  // namespace burrhole
