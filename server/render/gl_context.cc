// SPDX-License-Identifier: MIT
#include "server/render/gl_context.h"

#include <cstdlib>

namespace coopdyn {

std::optional<RendererKind> ParseRenderer(const std::string& word) {
  for (const RendererKind kind : {RendererKind::kAuto, RendererKind::kOsmesa, RendererKind::kEgl}) {
    if (word == ToString(kind)) return kind;
  }
  return std::nullopt;
}

const char* ToString(RendererKind kind) {
  switch (kind) {
    case RendererKind::kAuto:
      return "auto";
    case RendererKind::kOsmesa:
      return "osmesa";
    case RendererKind::kEgl:
      break;
  }
  return "egl";
}

RendererKind RendererFromEnvironment(RendererKind fallback, std::string& error) {
  const char* word = std::getenv("COOPDYN_RENDERER");
  if (!word || !*word) return fallback;
  const std::optional<RendererKind> kind = ParseRenderer(word);
  if (!kind) error = "COOPDYN_RENDERER=" + std::string(word) + " is not known: write auto, osmesa or egl";
  return kind.value_or(fallback);
}

void SetRendererDefaults() {
  // Pictures are small and physics needs its processor: one rasteriser beside the render thread.
  setenv("LP_NUM_THREADS", "1", 0);
}

std::unique_ptr<GlContext> GlContext::Create(RendererKind kind, std::string& error) {
  if (kind == RendererKind::kEgl) return CreateEglContext(error);
  std::unique_ptr<GlContext> context = CreateOsmesaContext(error);
  if (!context && kind == RendererKind::kAuto) {
    std::string egl_error;
    context = CreateEglContext(egl_error);
    if (!context) error += "; " + egl_error;
  }
  if (context) error.clear();
  return context;
}

}  // namespace coopdyn
