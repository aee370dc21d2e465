/// tests/support/shipped_spec.h: the numbers of a shipped bit's file.
#pragma once

#include <doctest/doctest.h>

#include <string>
#include <utility>

#include "core/tool/tool_spec.h"
#include "tests/support/source_folder.h"

namespace burrhole::test {

/// A fault of the file fails the test. @param name without folder and extension.
[[nodiscard]] inline ToolSpec shipped_spec(const std::string& name) {
  Issues issues;
  auto document = TomlDocument::load(in_source("app/tools/") + name + ".toml");
  REQUIRE(document.ok());
  auto spec = read_tool_spec(document.value(), issues);
  REQUIRE(spec);
  return std::move(*spec);
}

}  // namespace burrhole::test
