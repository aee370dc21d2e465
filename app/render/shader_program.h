/// app/render/shader_program.h: linked programs, made on first use. Internal: only app/render's sources include it.
#pragma once

#include <map>
#include <string>

#include "app/render/gl_object.h"
#include "app/render/shader_source.h"

namespace burrhole {

/// Compiles and links one variant. @returns ErrorCode::bad_input with the driver's log and the variant's name.
[[nodiscard]] Result<GlObject> link_variant(const GladGLContext& gl, const ShaderFiles& files, const ShaderVariant& variant);

/// Programs by variant name; the files stay as they were when it was made.
class ProgramCache {
 public:
  ProgramCache(const GladGLContext& gl, ShaderFiles files) : gl_(&gl), files_(std::move(files)) {}
  [[nodiscard]] Result<GLuint> find_or_link(const ShaderVariant& variant);

 private:
  const GladGLContext* gl_;
  ShaderFiles files_;
  std::map<std::string, GlObject> programs_;
};

}  // namespace burrhole
