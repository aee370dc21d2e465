#include "app/render/shader_program.h"

#include <array>

namespace burrhole {
namespace {

constexpr GLsizei kLogLength = 4096;

Result<GlObject> compile_stage(const GladGLContext& gl, GLenum kind, const ShaderFiles& files, const std::string& file,
                               const ShaderVariant& variant) {
  const auto text = expand_shader(files, file, variant.defines);
  if (!text) return text.error();
  GlObject stage(gl, gl.CreateShader(kind), [](const GladGLContext& g, GLuint n) { g.DeleteShader(n); });
  const char* source = text.value().c_str();
  gl.ShaderSource(stage.name(), 1, &source, nullptr);
  gl.CompileShader(stage.name());
  GLint compiled = 0;
  gl.GetShaderiv(stage.name(), GL_COMPILE_STATUS, &compiled);
  if (compiled != 0) return stage;
  std::array<char, kLogLength> log{};
  gl.GetShaderInfoLog(stage.name(), kLogLength, nullptr, log.data());
  const Error error = shader_error(files, log.data());
  return bad_input("does not compile as variant " + variant.name + ": " + error.message, error.place.empty() ? file : error.place);
}

}  // namespace

Result<GlObject> link_variant(const GladGLContext& gl, const ShaderFiles& files, const ShaderVariant& variant) {
  const auto vertex = compile_stage(gl, GL_VERTEX_SHADER, files, variant.vertex, variant);
  if (!vertex) return vertex.error();
  const auto fragment = compile_stage(gl, GL_FRAGMENT_SHADER, files, variant.fragment, variant);
  if (!fragment) return fragment.error();
  GlObject program(gl, gl.CreateProgram(), [](const GladGLContext& g, GLuint n) { g.DeleteProgram(n); });
  gl.AttachShader(program.name(), vertex.value().name());
  gl.AttachShader(program.name(), fragment.value().name());
  gl.LinkProgram(program.name());
  GLint linked = 0;
  gl.GetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (linked != 0) return program;
  std::array<char, kLogLength> log{};
  gl.GetProgramInfoLog(program.name(), kLogLength, nullptr, log.data());
  return bad_input("shader variant " + variant.name + " does not link: " + log.data());
}

Result<GLuint> ProgramCache::find_or_link(const ShaderVariant& variant) {
  const auto found = programs_.find(variant.name);
  if (found != programs_.end()) return found->second.name();
  auto program = link_variant(*gl_, files_, variant);
  if (!program) return program.error();
  const GLuint name = program.value().name();
  programs_.emplace(variant.name, std::move(program).value());
  return name;
}

}  // namespace burrhole
