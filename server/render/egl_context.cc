// SPDX-License-Identifier: MIT
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "server/render/gl_context.h"
#include "server/render/shared_library.h"

namespace coopdyn {

namespace {

struct EglApi {
  decltype(&eglGetProcAddress) GetProcAddress = nullptr;
  decltype(&eglInitialize) Initialize = nullptr;
  decltype(&eglBindAPI) BindAPI = nullptr;
  decltype(&eglChooseConfig) ChooseConfig = nullptr;
  decltype(&eglCreateContext) CreateContext = nullptr;
  decltype(&eglDestroyContext) DestroyContext = nullptr;
  decltype(&eglMakeCurrent) MakeCurrent = nullptr;
  decltype(&eglReleaseThread) ReleaseThread = nullptr;
  PFNEGLGETPLATFORMDISPLAYEXTPROC GetPlatformDisplay = nullptr;

  bool Load(const SharedLibrary& library) {
    if (!library.Get("eglGetProcAddress", GetProcAddress)) return false;
    GetPlatformDisplay =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(GetProcAddress("eglGetPlatformDisplayEXT"));
    return GetPlatformDisplay && library.Get("eglInitialize", Initialize) &&
           library.Get("eglBindAPI", BindAPI) && library.Get("eglChooseConfig", ChooseConfig) &&
           library.Get("eglCreateContext", CreateContext) &&
           library.Get("eglDestroyContext", DestroyContext) && library.Get("eglMakeCurrent", MakeCurrent) &&
           library.Get("eglReleaseThread", ReleaseThread);
  }
};

class EglContext final : public GlContext {
 public:
  EglContext() : GlContext(RendererKind::kEgl) {}
  ~EglContext() override {
    if (display_ == EGL_NO_DISPLAY) return;
    api_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context_ != EGL_NO_CONTEXT) api_.DestroyContext(display_, context_);
    // The display is the process's, and stays: eglTerminate would unload the driver under its own
    // thread-local data.
    api_.ReleaseThread();
  }

  bool Start(std::string& error) {
    std::string why;
    const SharedLibrary library = SharedLibrary::Open({"libEGL.so.1", "libEGL.so"}, why);
    if (!library) {
      error = "no EGL (" + why + "): install libegl1, or use --renderer osmesa";
      return false;
    }
    if (!api_.Load(library)) {
      error = "this EGL is too old (no eglGetPlatformDisplayEXT): use --renderer osmesa";
      return false;
    }
    if (!OpenDisplay() || !MakeContext()) {
      error =
          "EGL cannot make a GL 3.3 core context on a surfaceless display: install libegl-mesa0 and "
          "libgl1-mesa-dri, or use --renderer osmesa";
      return false;
    }
    const std::string missing = gl_.Load(
        [this](const char* name) { return reinterpret_cast<GlFunction>(api_.GetProcAddress(name)); });
    if (!missing.empty()) error = "EGL lacks " + missing;
    return missing.empty();
  }

 private:
  bool OpenDisplay() {
    EGLDisplay display = api_.GetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || !api_.Initialize(display, nullptr, nullptr)) return false;
    display_ = display;
    return true;
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
    if (!api_.BindAPI(EGL_OPENGL_API)) return false;
    if (!api_.ChooseConfig(display_, config_attributes, &config, 1, &count) || count < 1) return false;
    context_ = api_.CreateContext(display_, config, EGL_NO_CONTEXT, context_attributes);
    return context_ != EGL_NO_CONTEXT && api_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
  }

  EglApi api_;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlContext> CreateEglContext(std::string& error) {
  auto context = std::make_unique<EglContext>();
  if (!context->Start(error)) return nullptr;
  return context;
}

}  // namespace coopdyn
