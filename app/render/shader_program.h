/// app/render/shader_program.h: linked programs, made on first use. Internal to app/render.   Errors  bad_input.
#pragma once

#include <map>
#include <string>

#include "app/render/gl_object.h"
#include "app/render/shader_source.h"

namespace burrhole {

/// Compiles and links one variant. @returns ErrorCode::bad_input with the driver's log and the variant's name.
[[nodiscard]] Result<GlObject> link_variant(const GladGLContext& gl, const ShaderFiles& files, const ShaderVariant& variant);

/// Programs by variant name; the shader files are those at its construction.
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
