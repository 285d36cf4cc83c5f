// SPDX-License-Identifier: MIT
// The GL functions that we use, as loaded by a context: no GL library is linked. Valid on the context's
// thread.
#pragma once

#include <GL/glcorearb.h>

#include <functional>
#include <string>

namespace coopdyn {

using GlFunction = void (*)();

struct GlApi {
  PFNGLGETSTRINGPROC GetString = nullptr;
  PFNGLGETERRORPROC GetError = nullptr;
  PFNGLGETINTEGERVPROC GetIntegerv = nullptr;
  PFNGLVIEWPORTPROC Viewport = nullptr;
  PFNGLCLEARPROC Clear = nullptr;
  PFNGLENABLEPROC Enable = nullptr;
  PFNGLDISABLEPROC Disable = nullptr;
  PFNGLDEPTHFUNCPROC DepthFunc = nullptr;
  PFNGLDEPTHMASKPROC DepthMask = nullptr;
  PFNGLBLENDFUNCPROC BlendFunc = nullptr;
  PFNGLSTENCILFUNCPROC StencilFunc = nullptr;
  PFNGLSTENCILOPPROC StencilOp = nullptr;
  PFNGLPOLYGONOFFSETPROC PolygonOffset = nullptr;
  PFNGLREADPIXELSPROC ReadPixels = nullptr;
  PFNGLPIXELSTOREIPROC PixelStorei = nullptr;

  PFNGLGENBUFFERSPROC GenBuffers = nullptr;
  PFNGLDELETEBUFFERSPROC DeleteBuffers = nullptr;
  PFNGLBINDBUFFERPROC BindBuffer = nullptr;
  PFNGLBUFFERDATAPROC BufferData = nullptr;
  PFNGLGENVERTEXARRAYSPROC GenVertexArrays = nullptr;
  PFNGLDELETEVERTEXARRAYSPROC DeleteVertexArrays = nullptr;
  PFNGLBINDVERTEXARRAYPROC BindVertexArray = nullptr;
  PFNGLENABLEVERTEXATTRIBARRAYPROC EnableVertexAttribArray = nullptr;
  PFNGLVERTEXATTRIBPOINTERPROC VertexAttribPointer = nullptr;
  PFNGLVERTEXATTRIBDIVISORPROC VertexAttribDivisor = nullptr;
  PFNGLDRAWARRAYSPROC DrawArrays = nullptr;
  PFNGLDRAWELEMENTSINSTANCEDPROC DrawElementsInstanced = nullptr;

  PFNGLCREATESHADERPROC CreateShader = nullptr;
  PFNGLSHADERSOURCEPROC ShaderSource = nullptr;
  PFNGLCOMPILESHADERPROC CompileShader = nullptr;
  PFNGLGETSHADERIVPROC GetShaderiv = nullptr;
  PFNGLGETSHADERINFOLOGPROC GetShaderInfoLog = nullptr;
  PFNGLDELETESHADERPROC DeleteShader = nullptr;
  PFNGLCREATEPROGRAMPROC CreateProgram = nullptr;
  PFNGLATTACHSHADERPROC AttachShader = nullptr;
  PFNGLLINKPROGRAMPROC LinkProgram = nullptr;
  PFNGLGETPROGRAMIVPROC GetProgramiv = nullptr;
  PFNGLGETPROGRAMINFOLOGPROC GetProgramInfoLog = nullptr;
  PFNGLDELETEPROGRAMPROC DeleteProgram = nullptr;
  PFNGLUSEPROGRAMPROC UseProgram = nullptr;
  PFNGLGETUNIFORMLOCATIONPROC GetUniformLocation = nullptr;
  PFNGLUNIFORM1FPROC Uniform1f = nullptr;
  PFNGLUNIFORM3FPROC Uniform3f = nullptr;
  PFNGLUNIFORMMATRIX4FVPROC UniformMatrix4fv = nullptr;

  PFNGLGENFRAMEBUFFERSPROC GenFramebuffers = nullptr;
  PFNGLDELETEFRAMEBUFFERSPROC DeleteFramebuffers = nullptr;
  PFNGLBINDFRAMEBUFFERPROC BindFramebuffer = nullptr;
  PFNGLFRAMEBUFFERRENDERBUFFERPROC FramebufferRenderbuffer = nullptr;
  PFNGLCHECKFRAMEBUFFERSTATUSPROC CheckFramebufferStatus = nullptr;
  PFNGLBLITFRAMEBUFFERPROC BlitFramebuffer = nullptr;
  PFNGLGENRENDERBUFFERSPROC GenRenderbuffers = nullptr;
  PFNGLDELETERENDERBUFFERSPROC DeleteRenderbuffers = nullptr;
  PFNGLBINDRENDERBUFFERPROC BindRenderbuffer = nullptr;
  PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC RenderbufferStorageMultisample = nullptr;

  /// Fills the table by `get_function`. Returns the names of what is missing; empty if nothing.
  std::string Load(const std::function<GlFunction(const char*)>& get_function);
};

}  // namespace coopdyn
