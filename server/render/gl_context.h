// SPDX-License-Identifier: MIT
// A GL 3.3 core context without a window: OSMesa, or EGL on a surfaceless display. Both libraries are loaded
// when the first picture is asked for, so that one program runs where only one of them is installed, and pays
// for neither until then.
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <string>

#include "server/render/gl_api.h"

namespace coopdyn {

/// kAuto: OSMesa, and EGL where OSMesa is not installed.
enum class RendererKind { kAuto, kOsmesa, kEgl };
/// "auto", "osmesa", "egl"; nothing if it is another word.
std::optional<RendererKind> ParseRenderer(const std::string& word);
const char* ToString(RendererKind kind);
/// The value of COOPDYN_RENDERER; `fallback` if it is missing. Sets `error` if it is another word.
RendererKind RendererFromEnvironment(RendererKind fallback, std::string& error);

/// Says how many threads Mesa's software renderer may use, unless LP_NUM_THREADS says it already. Call before
/// the first thread starts: it writes to the environment.
void SetRendererDefaults();

/// Loads the first of `names` that exists, for good: Mesa leaves thread-local data behind that outlives its
/// contexts. Null, and `error` says why none could be loaded.
void* OpenLibrary(std::initializer_list<const char*> names, std::string& error);

/// Used and destroyed on the thread that made it. One at a time per thread.
class GlContext {
 public:
  virtual ~GlContext() = default;
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  const GlApi& gl() const { return *gl_; }
  RendererKind kind() const { return kind_; }

  /// Makes a context and makes it current. Null with what is missing, and what to install, in `error`.
  static std::unique_ptr<GlContext> Create(RendererKind kind, std::string& error);

 protected:
  explicit GlContext(RendererKind kind) : kind_(kind) {}

 private:
  /// Makes a context and makes it current; an error text, empty if it is there.
  virtual std::string Start() = 0;
  /// The GL function of this name. @pre it is current.
  virtual void* Find(const char* name) const = 0;

  RendererKind kind_;
  std::unique_ptr<GlApi> gl_;
};

}  // namespace coopdyn
