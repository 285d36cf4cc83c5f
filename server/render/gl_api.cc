// SPDX-License-Identifier: MIT
#include "server/render/gl_api.h"

#include <type_traits>

namespace coopdyn {

std::string GlApi::Load(const std::function<GlFunction(const char*)>& get_function) {
  std::string missing;
  const auto load = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(get_function(name));
    if (!function) missing += (missing.empty() ? "" : ", ") + std::string(name);
  };
  load(GetString, "glGetString");
  load(GetError, "glGetError");
  load(GetIntegerv, "glGetIntegerv");
  load(Viewport, "glViewport");
  load(Clear, "glClear");
  load(Enable, "glEnable");
  load(Disable, "glDisable");
  load(DepthFunc, "glDepthFunc");
  load(DepthMask, "glDepthMask");
  load(BlendFunc, "glBlendFunc");
  load(StencilFunc, "glStencilFunc");
  load(StencilOp, "glStencilOp");
  load(PolygonOffset, "glPolygonOffset");
  load(ReadPixels, "glReadPixels");
  load(PixelStorei, "glPixelStorei");
  load(GenBuffers, "glGenBuffers");
  load(DeleteBuffers, "glDeleteBuffers");
  load(BindBuffer, "glBindBuffer");
  load(BufferData, "glBufferData");
  load(GenVertexArrays, "glGenVertexArrays");
  load(DeleteVertexArrays, "glDeleteVertexArrays");
  load(BindVertexArray, "glBindVertexArray");
  load(EnableVertexAttribArray, "glEnableVertexAttribArray");
  load(VertexAttribPointer, "glVertexAttribPointer");
  load(VertexAttribDivisor, "glVertexAttribDivisor");
  load(DrawArrays, "glDrawArrays");
  load(DrawElementsInstanced, "glDrawElementsInstanced");
  load(CreateShader, "glCreateShader");
  load(ShaderSource, "glShaderSource");
  load(CompileShader, "glCompileShader");
  load(GetShaderiv, "glGetShaderiv");
  load(GetShaderInfoLog, "glGetShaderInfoLog");
  load(DeleteShader, "glDeleteShader");
  load(CreateProgram, "glCreateProgram");
  load(AttachShader, "glAttachShader");
  load(LinkProgram, "glLinkProgram");
  load(GetProgramiv, "glGetProgramiv");
  load(GetProgramInfoLog, "glGetProgramInfoLog");
  load(DeleteProgram, "glDeleteProgram");
  load(UseProgram, "glUseProgram");
  load(GetUniformLocation, "glGetUniformLocation");
  load(Uniform1f, "glUniform1f");
  load(Uniform3f, "glUniform3f");
  load(UniformMatrix4fv, "glUniformMatrix4fv");
  load(GenFramebuffers, "glGenFramebuffers");
  load(DeleteFramebuffers, "glDeleteFramebuffers");
  load(BindFramebuffer, "glBindFramebuffer");
  load(FramebufferRenderbuffer, "glFramebufferRenderbuffer");
  load(CheckFramebufferStatus, "glCheckFramebufferStatus");
  load(BlitFramebuffer, "glBlitFramebuffer");
  load(GenRenderbuffers, "glGenRenderbuffers");
  load(DeleteRenderbuffers, "glDeleteRenderbuffers");
  load(BindRenderbuffer, "glBindRenderbuffer");
  load(RenderbufferStorageMultisample, "glRenderbufferStorageMultisample");
  return missing;
}

}  // namespace coopdyn
