// SPDX-License-Identifier: MIT
#include "server/render/gl_objects.h"

#include <algorithm>
#include <array>

namespace coopdyn {

GlProgram::GlProgram(const GlApi& gl, const std::string& vertex, const std::string& fragment,
                     std::string& error)
    : gl_(gl), id_(gl.CreateProgram()) {
  std::array<char, 1024> log{};
  GLint ok = GL_TRUE;
  for (const auto& [kind, source] : {std::pair{GL_VERTEX_SHADER, &vertex}, {GL_FRAGMENT_SHADER, &fragment}}) {
    const GLuint shader = gl_.CreateShader(static_cast<GLenum>(kind));
    const char* text = source->c_str();
    gl_.ShaderSource(shader, 1, &text, nullptr);
    gl_.CompileShader(shader);
    gl_.GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (!ok && error.empty()) {
      gl_.GetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
      error = "the GL driver does not compile a shader: " + std::string(log.data());
    }
    gl_.AttachShader(id_, shader);
    gl_.DeleteShader(shader);
  }
  gl_.LinkProgram(id_);
  gl_.GetProgramiv(id_, GL_LINK_STATUS, &ok);
  if (!ok && error.empty()) {
    gl_.GetProgramInfoLog(id_, static_cast<GLsizei>(log.size()), nullptr, log.data());
    error = "the GL driver does not link a shader: " + std::string(log.data());
  }
}

GlProgram::~GlProgram() {
  gl_.DeleteProgram(id_);
}

GlVertices::GlVertices(const GlApi& gl) : gl_(gl) {
  gl_.GenVertexArrays(1, &array_);
  gl_.GenBuffers(1, &buffer_);
}

GlVertices::~GlVertices() {
  gl_.DeleteBuffers(1, &buffer_);
  gl_.DeleteVertexArrays(1, &array_);
}

void GlVertices::Upload(const void* data, std::size_t bytes, GLenum usage) const {
  gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), data, usage);
}

void GlVertices::Attribute(GLuint location, int count, std::size_t stride, std::size_t offset,
                           GLuint divisor) const {
  gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
  gl_.EnableVertexAttribArray(location);
  gl_.VertexAttribPointer(location, count, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                          reinterpret_cast<const void*>(offset));
  gl_.VertexAttribDivisor(location, divisor);
}

GlTexture::GlTexture(const GlApi& gl, int width, int height, const unsigned char* rgb) : gl_(gl) {
  gl_.GenTextures(1, &id_);
  Bind();
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, width, height, 0, GL_RGB, GL_UNSIGNED_BYTE, rgb);
  gl_.GenerateMipmap(GL_TEXTURE_2D);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

GlTexture::~GlTexture() {
  gl_.DeleteTextures(1, &id_);
}

GlTarget::GlTarget(const GlApi& gl, int width, int height, int samples)
    : gl_(gl), width_(width), height_(height), samples_(samples) {
  GLint most = 0;
  gl_.GetIntegerv(GL_MAX_SAMPLES, &most);
  samples = std::min<int>(most, samples);
  gl_.GenFramebuffers(1, &drawn_);
  gl_.GenFramebuffers(1, &resolved_);
  gl_.GenRenderbuffers(1, &color_);
  gl_.GenRenderbuffers(1, &depth_);
  gl_.GenRenderbuffers(1, &resolved_color_);
  complete_ = Attach(resolved_, resolved_color_, GL_COLOR_ATTACHMENT0, GL_RGBA8, 0);
  Attach(drawn_, color_, GL_COLOR_ATTACHMENT0, GL_RGBA8, samples);
  complete_ = Attach(drawn_, depth_, GL_DEPTH_STENCIL_ATTACHMENT, GL_DEPTH24_STENCIL8, samples) && complete_;
}

GlTarget::~GlTarget() {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl_.DeleteFramebuffers(1, &drawn_);
  gl_.DeleteFramebuffers(1, &resolved_);
  gl_.DeleteRenderbuffers(1, &color_);
  gl_.DeleteRenderbuffers(1, &depth_);
  gl_.DeleteRenderbuffers(1, &resolved_color_);
}

bool GlTarget::Attach(GLuint framebuffer, GLuint renderbuffer, GLenum attachment, GLenum format,
                      int samples) const {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, renderbuffer);
  gl_.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width_, height_);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, renderbuffer);
  return gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

GlNumbers::GlNumbers(const GlApi& gl, int width, int height) : gl_(gl), width_(width), height_(height) {
  gl_.GenFramebuffers(1, &framebuffer_);
  gl_.GenRenderbuffers(1, &numbers_);
  gl_.GenRenderbuffers(1, &depth_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  const auto attach = [&](GLuint renderbuffer, GLenum attachment, GLenum format) {
    gl_.BindRenderbuffer(GL_RENDERBUFFER, renderbuffer);
    gl_.RenderbufferStorageMultisample(GL_RENDERBUFFER, 0, format, width_, height_);
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, renderbuffer);
  };
  attach(numbers_, GL_COLOR_ATTACHMENT0, GL_RG32F);
  attach(depth_, GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT32F);
  complete_ = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

GlNumbers::~GlNumbers() {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl_.DeleteFramebuffers(1, &framebuffer_);
  gl_.DeleteRenderbuffers(1, &numbers_);
  gl_.DeleteRenderbuffers(1, &depth_);
}

void GlNumbers::Read(float* numbers) const {
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_.ReadPixels(0, 0, width_, height_, GL_RG, GL_FLOAT, numbers);
}

void GlTarget::Read(unsigned char* rgb) const {
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, drawn_);
  if (samples_ > 0) {
    gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
    gl_.BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
  }
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_.ReadPixels(0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, rgb);
}

}  // namespace coopdyn
