// SPDX-License-Identifier: MIT
#include "server/render/gl_context.h"
#include "server/render/shared_library.h"

#include <array>

namespace coopdyn {

namespace {

// From GL/osmesa.h, whose gl.h cannot stand beside glcorearb.h.
using OsmesaHandle = void*;
constexpr int kFormat = 0x22, kDepthBits = 0x30, kProfile = 0x33, kCoreProfile = 0x34, kMajor = 0x36,
              kMinor = 0x37;
constexpr int kRgba = GL_RGBA;

struct OsmesaApi {
  OsmesaHandle (*Create)(const int* attributes, OsmesaHandle shared) = nullptr;
  void (*Destroy)(OsmesaHandle) = nullptr;
  GLboolean (*MakeCurrent)(OsmesaHandle, void* buffer, GLenum type, GLsizei width, GLsizei height) = nullptr;
  GlFunction (*GetProcAddress)(const char*) = nullptr;
};

class OsmesaContext final : public GlContext {
 public:
  OsmesaContext() : GlContext(RendererKind::kOsmesa) {}
  ~OsmesaContext() override {
    if (!context_) return;
    api_.MakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0);
    api_.Destroy(context_);
  }

  bool Start(std::string& error) {
    std::string why;
    const SharedLibrary library =
        SharedLibrary::Open({"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}, why);
    if (!library) {
      error = "no OSMesa (" + why + "): install libosmesa6, or use --renderer egl";
      return false;
    }
    const int attributes[] = {kFormat, kRgba, kDepthBits, 0, kProfile, kCoreProfile, kMajor, 3, kMinor, 3, 0};
    if (!library.Get("OSMesaCreateContextAttribs", api_.Create) ||
        !library.Get("OSMesaDestroyContext", api_.Destroy) ||
        !library.Get("OSMesaMakeCurrent", api_.MakeCurrent) ||
        !library.Get("OSMesaGetProcAddress", api_.GetProcAddress)) {
      error = "this OSMesa is too old: version 12 or newer is needed, or use --renderer egl";
      return false;
    }
    context_ = api_.Create(attributes, nullptr);
    if (!context_ || !api_.MakeCurrent(context_, buffer_.data(), GL_UNSIGNED_BYTE, kSide, kSide)) {
      error = "OSMesa cannot make a GL 3.3 core context: use --renderer egl";
      return false;
    }
    const std::string missing = gl_.Load([this](const char* name) { return api_.GetProcAddress(name); });
    if (!missing.empty()) error = "OSMesa lacks " + missing;
    return missing.empty();
  }

 private:
  static constexpr int kSide = 16;
  OsmesaApi api_;
  OsmesaHandle context_ = nullptr;
  std::array<unsigned char, 4 * kSide * kSide> buffer_{};  // a context needs one; pictures are drawn off it
};

}  // namespace

std::unique_ptr<GlContext> CreateOsmesaContext(std::string& error) {
  auto context = std::make_unique<OsmesaContext>();
  if (!context->Start(error)) return nullptr;
  return context;
}

}  // namespace coopdyn
