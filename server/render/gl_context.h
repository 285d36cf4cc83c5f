// SPDX-License-Identifier: MIT
// A GL 3.3 core context without a window: OSMesa, or EGL on a surfaceless display. The first picture loads
// the library, so the program runs where only one of them is installed and does not pay for them before.
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <string>

#include "server/render/gl_api.h"

namespace coopdyn {

/// kAuto: OSMesa, or EGL if OSMesa is not installed.
enum class RendererKind { kAuto, kOsmesa, kEgl };
/// Parses "auto", "osmesa" or "egl"; nullopt for any other word.
std::optional<RendererKind> ParseRenderer(const std::string& word);
const char* ToString(RendererKind kind);
/// The value of COOPDYN_RENDERER; `fallback` if it is not set. Sets `error` if the value is unknown.
RendererKind RendererFromEnvironment(RendererKind fallback, std::string& error);

/// Limits the threads of Mesa's software renderer, unless LP_NUM_THREADS is set. Writes to the environment:
/// call before the first thread starts.
void SetRendererDefaults();

/// Loads the first of `names` that exists and never unloads it: Mesa's thread-local data outlives its
/// contexts. Null with `error` if none could be loaded.
void* OpenLibrary(std::initializer_list<const char*> names, std::string& error);

/// Use and destroy it on the thread that made it. One context at a time per thread.
class GlContext {
 public:
  virtual ~GlContext() = default;
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  const GlApi& gl() const { return *gl_; }
  RendererKind kind() const { return kind_; }

  /// Makes a context and makes it current. Null with `error`, which says what is missing and what to install.
  static std::unique_ptr<GlContext> Create(RendererKind kind, std::string& error);

 protected:
  explicit GlContext(RendererKind kind) : kind_(kind) {}

 private:
  /// Makes the context and makes it current. Returns an error text, empty on success.
  virtual std::string Start() = 0;
  /// The GL function `name`. @pre the context is current
  virtual void* Find(const char* name) const = 0;

  RendererKind kind_;
  std::unique_ptr<GlApi> gl_;
};

}  // namespace coopdyn
