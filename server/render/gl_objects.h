// SPDX-License-Identifier: MIT
// RAII wrappers of GL objects. Use and destroy them on the context's thread while the context is current.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "server/render/gl_api.h"

namespace coopdyn {

/// A linked program.
class GlProgram {
 public:
  /// Compiles and links the program; sets `error` if the driver rejects it.
  GlProgram(const GlApi& gl, const std::string& vertex, const std::string& fragment, std::string& error);
  ~GlProgram();
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  GLuint id() const { return id_; }
  GLint Uniform(const char* name) const { return gl_.GetUniformLocation(id_, name); }

 private:
  const GlApi& gl_;
  GLuint id_ = 0;
};

/// A buffer and a vertex array that reads it.
class GlVertices {
 public:
  explicit GlVertices(const GlApi& gl);
  ~GlVertices();
  GlVertices(const GlVertices&) = delete;
  GlVertices& operator=(const GlVertices&) = delete;

  void Bind() const { gl_.BindVertexArray(array_); }
  GLuint buffer() const { return buffer_; }
  /// Replaces the content.
  void Upload(const void* data, std::size_t bytes, GLenum usage) const;
  /// Defines attribute `location`: `count` floats at `offset` in every `stride` bytes; `divisor` 1: one per
  /// instance. @pre Bind()
  void Attribute(GLuint location, int count, std::size_t stride, std::size_t offset,
                 GLuint divisor = 0) const;

 private:
  const GlApi& gl_;
  GLuint array_ = 0;
  GLuint buffer_ = 0;
};

/// A texture that repeats over shapes.
class GlTexture {
 public:
  /// `rgb`: width × height × 3 bytes.
  GlTexture(const GlApi& gl, int width, int height, const unsigned char* rgb);
  ~GlTexture();
  GlTexture(const GlTexture&) = delete;
  GlTexture& operator=(const GlTexture&) = delete;

  void Bind() const { gl_.BindTexture(GL_TEXTURE_2D, id_); }

 private:
  const GlApi& gl_;
  GLuint id_ = 0;
};

/// An off-screen picture, drawn with several samples per pixel and read with one.
class GlTarget {
 public:
  /// `samples` 0: no multisampling.
  GlTarget(const GlApi& gl, int width, int height, int samples);
  ~GlTarget();
  GlTarget(const GlTarget&) = delete;
  GlTarget& operator=(const GlTarget&) = delete;

  bool complete() const { return complete_; }
  int width() const { return width_; }
  int height() const { return height_; }
  int samples() const { return samples_; }
  void Bind() const { gl_.BindFramebuffer(GL_FRAMEBUFFER, drawn_); }
  /// Writes width × height × 3 bytes, the lowest row first.
  void Read(unsigned char* rgb) const;

 private:
  bool Attach(GLuint framebuffer, GLuint renderbuffer, GLenum attachment, GLenum format, int samples) const;

  const GlApi& gl_;
  const int width_, height_, samples_;
  GLuint drawn_ = 0, resolved_ = 0;
  GLuint color_ = 0, depth_ = 0, resolved_color_ = 0;
  bool complete_ = false;
};

/// An off-screen picture with two 32-bit floats per pixel.
class GlNumbers {
 public:
  GlNumbers(const GlApi& gl, int width, int height);
  ~GlNumbers();
  GlNumbers(const GlNumbers&) = delete;
  GlNumbers& operator=(const GlNumbers&) = delete;

  bool complete() const { return complete_; }
  int width() const { return width_; }
  int height() const { return height_; }
  void Bind() const { gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_); }
  /// Writes width × height × 2 floats, the lowest row first.
  void Read(float* numbers) const;

 private:
  const GlApi& gl_;
  const int width_, height_;
  GLuint framebuffer_ = 0, numbers_ = 0, depth_ = 0;
  bool complete_ = false;
};

}  // namespace coopdyn
