/// app/scene/schema_samples.h: small documents that lead the readers of a file format through each of their branches, for its reference.
///   A new branch (a shape, a source of bone, a word that asks for keys of its own) is one more line in schema_samples.cpp; a choice's word
///   or a table that no sample reaches is found by merge_logs() and fails a test.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/config/key_log.h"

namespace burrhole {

/// The formats that have a reference: scenes, tools and the descriptions of raw volumes.
enum class SchemaFile { scene, tool, raw };

struct SchemaSample {
  std::string name;   ///< the branch it is there for
  std::string text;   ///< TOML
  std::string fault;  ///< part of the one fault it may bring (a file that is not there); empty: none
};

[[nodiscard]] std::vector<SchemaSample> schema_samples(SchemaFile file);

/// The commented example at the head of the reference: a sound document.
[[nodiscard]] std::string schema_example(SchemaFile file);

struct ReadSample {
  KeyLog log;
  std::vector<Error> issues;
};
/// Reads a document with the reader that the program uses; tools that a scene names are not looked for.
[[nodiscard]] ReadSample read_sample(SchemaFile file, const std::string& text);

}  // namespace burrhole
