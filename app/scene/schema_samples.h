/// app/scene/schema_samples.h: small documents that cover every branch of a file format's reader, for the generated reference.
///   A new branch (a shape, a source of bone, a choice with keys of its own) needs one more line in schema_samples.cpp. merge_logs()
///   reports each table or word of a choice that no sample covers, which fails a test.   Thread  any.   Errors  as issues of ReadSample.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/config/key_log.h"

namespace burrhole {

/// The formats that have a reference: scenes, tools and the descriptions of raw volumes.
enum class SchemaFile { scene, tool, raw };

struct SchemaSample {
  std::string name;            ///< of the branch that it covers
  std::string text;            ///< TOML
  std::string expected_error;  ///< part of the one message that reading it gives (a missing file); empty: no error
};

[[nodiscard]] std::vector<SchemaSample> schema_samples(SchemaFile file);

/// @returns the commented example at the head of the reference; it is a valid document.
[[nodiscard]] std::string schema_example(SchemaFile file);

struct ReadSample {
  KeyLog log;
  std::vector<Error> issues;
};
/// Reads a document with the reader that the program uses. Files of tools that a scene names are not searched for.
[[nodiscard]] ReadSample read_sample(SchemaFile file, const std::string& text);

}  // namespace burrhole
