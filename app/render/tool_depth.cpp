#include "app/render/tool_depth.h"

#include "app/render/frame_block.h"

namespace burrhole {

Result<ToolDepth> ToolDepth::create(const GladGLContext& gl) {
  ToolDepth made;
  made.gl_ = &gl;
  made.depths_ = make_texture(gl, GL_TEXTURE_2D);
  const GLuint depths = made.depths_.name();
  gl.TextureStorage2D(depths, 1, GL_DEPTH_COMPONENT32F, kToolDepthTexels.x, kToolDepthTexels.y);
  gl.TextureParameteri(depths, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl.TextureParameteri(depths, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl.TextureParameteri(depths, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TextureParameteri(depths, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl.TextureParameteri(depths, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl.TextureParameteri(depths, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  made.framebuffer_ = make_framebuffer(gl);
  const GLuint framebuffer = made.framebuffer_.name();
  gl.NamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, depths, 0);
  gl.NamedFramebufferDrawBuffer(framebuffer, GL_NONE);
  gl.NamedFramebufferReadBuffer(framebuffer, GL_NONE);
  if (gl.CheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE || gl.GetError() != GL_NO_ERROR)
    return Error{ErrorCode::unavailable, "the driver cannot draw the shadow of the tool; set display.shadow = false", {}};
  return made;
}

void ToolDepth::draw(const ToolMesh& tool, GLuint program) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  gl_->Viewport(0, 0, kToolDepthTexels.x, kToolDepthTexels.y);
  gl_->Scissor(0, 0, kToolDepthTexels.x, kToolDepthTexels.y);
  gl_->Clear(GL_DEPTH_BUFFER_BIT);
  gl_->UseProgram(program);
  tool.draw();
}

}  // namespace burrhole
