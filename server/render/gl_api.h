// SPDX-License-Identifier: MIT
// The GL functions that the renderer uses, looked up by name: no GL library is linked. Valid on the thread of
// the context they were looked up for.
#pragma once

#include <GL/glcorearb.h>

#include <functional>
#include <string>
#include <utility>

namespace coopdyn {

/// Looks up functions in a library or a context.
class SymbolLoader {
 public:
  /// Converts to a pointer to any function type.
  struct Symbol {
    void* address;
    template <typename Function>
    operator Function() const {
      return reinterpret_cast<Function>(address);
    }
  };

  explicit SymbolLoader(std::function<void*(const char* name)> find) : find_(std::move(find)) {}

  Symbol operator()(const char* name) {
    void* address = find_(name);
    if (address == nullptr) missing_ += (missing_.empty() ? "" : ", ") + std::string(name);
    return {address};
  }
  /// Names of functions not found; empty if all were found.
  const std::string& missing() const { return missing_; }

 private:
  std::function<void*(const char*)> find_;
  std::string missing_;
};

struct GlApi {
  SymbolLoader load;  // first: loads all others

  PFNGLGETSTRINGPROC GetString = load("glGetString");
  PFNGLGETINTEGERVPROC GetIntegerv = load("glGetIntegerv");
  PFNGLVIEWPORTPROC Viewport = load("glViewport");
  PFNGLCLEARPROC Clear = load("glClear");
  PFNGLENABLEPROC Enable = load("glEnable");
  PFNGLDISABLEPROC Disable = load("glDisable");
  PFNGLDEPTHFUNCPROC DepthFunc = load("glDepthFunc");
  PFNGLDEPTHMASKPROC DepthMask = load("glDepthMask");
  PFNGLBLENDFUNCPROC BlendFunc = load("glBlendFunc");
  PFNGLSTENCILFUNCPROC StencilFunc = load("glStencilFunc");
  PFNGLSTENCILOPPROC StencilOp = load("glStencilOp");
  PFNGLREADPIXELSPROC ReadPixels = load("glReadPixels");
  PFNGLPIXELSTOREIPROC PixelStorei = load("glPixelStorei");

  PFNGLGENBUFFERSPROC GenBuffers = load("glGenBuffers");
  PFNGLDELETEBUFFERSPROC DeleteBuffers = load("glDeleteBuffers");
  PFNGLBINDBUFFERPROC BindBuffer = load("glBindBuffer");
  PFNGLBUFFERDATAPROC BufferData = load("glBufferData");
  PFNGLGENVERTEXARRAYSPROC GenVertexArrays = load("glGenVertexArrays");
  PFNGLDELETEVERTEXARRAYSPROC DeleteVertexArrays = load("glDeleteVertexArrays");
  PFNGLBINDVERTEXARRAYPROC BindVertexArray = load("glBindVertexArray");
  PFNGLENABLEVERTEXATTRIBARRAYPROC EnableVertexAttribArray = load("glEnableVertexAttribArray");
  PFNGLVERTEXATTRIBPOINTERPROC VertexAttribPointer = load("glVertexAttribPointer");
  PFNGLVERTEXATTRIBDIVISORPROC VertexAttribDivisor = load("glVertexAttribDivisor");
  PFNGLDRAWARRAYSPROC DrawArrays = load("glDrawArrays");
  PFNGLDRAWELEMENTSINSTANCEDPROC DrawElementsInstanced = load("glDrawElementsInstanced");

  PFNGLCREATESHADERPROC CreateShader = load("glCreateShader");
  PFNGLSHADERSOURCEPROC ShaderSource = load("glShaderSource");
  PFNGLCOMPILESHADERPROC CompileShader = load("glCompileShader");
  PFNGLGETSHADERIVPROC GetShaderiv = load("glGetShaderiv");
  PFNGLGETSHADERINFOLOGPROC GetShaderInfoLog = load("glGetShaderInfoLog");
  PFNGLDELETESHADERPROC DeleteShader = load("glDeleteShader");
  PFNGLCREATEPROGRAMPROC CreateProgram = load("glCreateProgram");
  PFNGLATTACHSHADERPROC AttachShader = load("glAttachShader");
  PFNGLLINKPROGRAMPROC LinkProgram = load("glLinkProgram");
  PFNGLGETPROGRAMIVPROC GetProgramiv = load("glGetProgramiv");
  PFNGLGETPROGRAMINFOLOGPROC GetProgramInfoLog = load("glGetProgramInfoLog");
  PFNGLDELETEPROGRAMPROC DeleteProgram = load("glDeleteProgram");
  PFNGLUSEPROGRAMPROC UseProgram = load("glUseProgram");
  PFNGLGETUNIFORMLOCATIONPROC GetUniformLocation = load("glGetUniformLocation");
  PFNGLGENTEXTURESPROC GenTextures = load("glGenTextures");
  PFNGLDELETETEXTURESPROC DeleteTextures = load("glDeleteTextures");
  PFNGLBINDTEXTUREPROC BindTexture = load("glBindTexture");
  PFNGLTEXIMAGE2DPROC TexImage2D = load("glTexImage2D");
  PFNGLTEXPARAMETERIPROC TexParameteri = load("glTexParameteri");
  PFNGLGENERATEMIPMAPPROC GenerateMipmap = load("glGenerateMipmap");

  PFNGLUNIFORM1IPROC Uniform1i = load("glUniform1i");
  PFNGLUNIFORM2FPROC Uniform2f = load("glUniform2f");
  PFNGLUNIFORM3FPROC Uniform3f = load("glUniform3f");
  PFNGLUNIFORM3FVPROC Uniform3fv = load("glUniform3fv");
  PFNGLUNIFORMMATRIX4FVPROC UniformMatrix4fv = load("glUniformMatrix4fv");

  PFNGLGENFRAMEBUFFERSPROC GenFramebuffers = load("glGenFramebuffers");
  PFNGLDELETEFRAMEBUFFERSPROC DeleteFramebuffers = load("glDeleteFramebuffers");
  PFNGLBINDFRAMEBUFFERPROC BindFramebuffer = load("glBindFramebuffer");
  PFNGLFRAMEBUFFERRENDERBUFFERPROC FramebufferRenderbuffer = load("glFramebufferRenderbuffer");
  PFNGLCHECKFRAMEBUFFERSTATUSPROC CheckFramebufferStatus = load("glCheckFramebufferStatus");
  PFNGLBLITFRAMEBUFFERPROC BlitFramebuffer = load("glBlitFramebuffer");
  PFNGLGENRENDERBUFFERSPROC GenRenderbuffers = load("glGenRenderbuffers");
  PFNGLDELETERENDERBUFFERSPROC DeleteRenderbuffers = load("glDeleteRenderbuffers");
  PFNGLBINDRENDERBUFFERPROC BindRenderbuffer = load("glBindRenderbuffer");
  PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC RenderbufferStorageMultisample =
      load("glRenderbufferStorageMultisample");
};

}  // namespace coopdyn
