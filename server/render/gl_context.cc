// SPDX-License-Identifier: MIT
#include "server/render/gl_context.h"

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iterator>

namespace coopdyn {

namespace {

constexpr const char* kRendererWords[] = {"auto", "osmesa", "egl"};  // as RendererKind

class OsmesaContext final : public GlContext {
 public:
  OsmesaContext() : GlContext(RendererKind::kOsmesa) {}
  ~OsmesaContext() override {
    if (context_ == nullptr) return;
    api_->MakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0);
    api_->Destroy(context_);
  }

 private:
  // Copied from GL/osmesa.h, whose gl.h conflicts with glcorearb.h.
  using Handle = void*;
  static constexpr int kFormat = 0x22, kDepthBits = 0x30, kProfile = 0x33, kCoreProfile = 0x34, kMajor = 0x36,
                       kMinor = 0x37;
  struct Api {
    SymbolLoader load;
    Handle (*Create)(const int* attributes, Handle shared) = load("OSMesaCreateContextAttribs");
    void (*Destroy)(Handle) = load("OSMesaDestroyContext");
    GLboolean (*MakeCurrent)(Handle, void* buffer, GLenum type, GLsizei width,
                             GLsizei height) = load("OSMesaMakeCurrent");
    void* (*GetProcAddress)(const char*) = load("OSMesaGetProcAddress");
  };

  std::string Start() override {
    std::string why;
    void* library = OpenLibrary({"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}, why);
    if (library == nullptr) return "no OSMesa (" + why + "): install libosmesa6, or use --renderer egl";
    api_.emplace(Api{SymbolLoader([library](const char* name) { return dlsym(library, name); })});
    if (!api_->load.missing().empty()) {
      return "this OSMesa is too old: version 12 or newer is needed, or use --renderer egl";
    }
    const int attributes[] = {kFormat, GL_RGBA, kDepthBits, 0, kProfile, kCoreProfile,
                              kMajor,  3,       kMinor,     3, 0};
    context_ = api_->Create(attributes, nullptr);
    if (context_ == nullptr || !api_->MakeCurrent(context_, buffer_.data(), GL_UNSIGNED_BYTE, kSide, kSide)) {
      return "OSMesa cannot make a GL 3.3 core context: use --renderer egl";
    }
    return {};
  }
  void* Find(const char* name) const override { return api_->GetProcAddress(name); }

  static constexpr int kSide = 16;
  std::optional<Api> api_;
  Handle context_ = nullptr;
  std::array<unsigned char, 4 * kSide * kSide> buffer_{};  // required; pictures use framebuffer objects
};

class EglContext final : public GlContext {
 public:
  EglContext() : GlContext(RendererKind::kEgl) {}
  ~EglContext() override {
    if (display_ == EGL_NO_DISPLAY) return;
    api_->MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context_ != EGL_NO_CONTEXT) api_->DestroyContext(display_, context_);
    // Keep the display, which belongs to the process: eglTerminate would unload the driver under its own
    // thread-local data.
    api_->ReleaseThread();
  }

 private:
  struct Api {
    SymbolLoader load;
    decltype(&eglGetProcAddress) GetProcAddress = load("eglGetProcAddress");
    decltype(&eglInitialize) Initialize = load("eglInitialize");
    decltype(&eglBindAPI) BindAPI = load("eglBindAPI");
    decltype(&eglChooseConfig) ChooseConfig = load("eglChooseConfig");
    decltype(&eglCreateContext) CreateContext = load("eglCreateContext");
    decltype(&eglDestroyContext) DestroyContext = load("eglDestroyContext");
    decltype(&eglMakeCurrent) MakeCurrent = load("eglMakeCurrent");
    decltype(&eglReleaseThread) ReleaseThread = load("eglReleaseThread");
  };

  std::string Start() override {
    std::string why;
    void* library = OpenLibrary({"libEGL.so.1", "libEGL.so"}, why);
    if (library == nullptr) return "no EGL (" + why + "): install libegl1, or use --renderer osmesa";
    api_.emplace(Api{SymbolLoader([library](const char* name) { return dlsym(library, name); })});
    const bool old = !api_->load.missing().empty();
    const auto platform_display = old ? nullptr
                                      : reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
                                            api_->GetProcAddress("eglGetPlatformDisplayEXT"));
    if (platform_display == nullptr) {
      return "this EGL is too old (no eglGetPlatformDisplayEXT): use --renderer osmesa";
    }
    EGLDisplay display = platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display != EGL_NO_DISPLAY && api_->Initialize(display, nullptr, nullptr)) display_ = display;
    if (display_ != EGL_NO_DISPLAY && MakeContext()) return {};
    return "EGL cannot make a GL 3.3 core context on a surfaceless display: install libegl-mesa0 and "
           "libgl1-mesa-dri, or use --renderer osmesa";
  }
  bool MakeContext() {
    const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE,
                                        EGL_PBUFFER_BIT, EGL_NONE};
    const EGLint context_attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                         3,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         3,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                         EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!api_->BindAPI(EGL_OPENGL_API)) return false;
    if (!api_->ChooseConfig(display_, config_attributes, &config, 1, &count) || count < 1) return false;
    context_ = api_->CreateContext(display_, config, EGL_NO_CONTEXT, context_attributes);
    return context_ != EGL_NO_CONTEXT &&
           api_->MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
  }
  void* Find(const char* name) const override { return reinterpret_cast<void*>(api_->GetProcAddress(name)); }

  std::optional<Api> api_;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

void* OpenLibrary(std::initializer_list<const char*> names, std::string& error) {
  for (const char* name : names) {
    if (void* library = dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE)) return library;
    if (error.empty()) error = dlerror();
  }
  return nullptr;
}

std::optional<RendererKind> ParseRenderer(const std::string& word) {
  const auto found = std::find(std::begin(kRendererWords), std::end(kRendererWords), word);
  if (found == std::end(kRendererWords)) return std::nullopt;
  return static_cast<RendererKind>(found - std::begin(kRendererWords));
}

const char* ToString(RendererKind kind) {
  return kRendererWords[static_cast<std::size_t>(kind)];
}

RendererKind RendererFromEnvironment(RendererKind fallback, std::string& error) {
  const char* word = std::getenv("COOPDYN_RENDERER");
  if (!word || !*word) return fallback;
  const std::optional<RendererKind> kind = ParseRenderer(word);
  if (!kind) error = "COOPDYN_RENDERER=" + std::string(word) + " is not known: write auto, osmesa or egl";
  return kind.value_or(fallback);
}

void SetRendererDefaults() {
  // Pictures are small and physics needs the CPU: one rasteriser thread beside the render thread.
  setenv("LP_NUM_THREADS", "1", 0);
}

std::unique_ptr<GlContext> GlContext::Create(RendererKind kind, std::string& error) {
  std::unique_ptr<GlContext> context;
  if (kind == RendererKind::kEgl) {
    context = std::make_unique<EglContext>();
  } else {
    context = std::make_unique<OsmesaContext>();
  }
  error = context->Start();
  if (error.empty()) {
    context->gl_ = std::make_unique<GlApi>(
        GlApi{SymbolLoader([raw = context.get()](const char* name) { return raw->Find(name); })});
    const std::string& missing = context->gl_->load.missing();
    if (!missing.empty()) error = (kind == RendererKind::kEgl ? "EGL lacks " : "OSMesa lacks ") + missing;
  }
  if (error.empty()) return context;
  if (kind != RendererKind::kAuto) return nullptr;
  std::string egl_error;
  auto egl = Create(RendererKind::kEgl, egl_error);
  error = egl == nullptr ? error + "; " + egl_error : "";
  return egl;
}

}  // namespace coopdyn
